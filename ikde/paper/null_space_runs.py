"""Simulated runs of the robot of [Zhang2022] under its laws and under exact priority, several side by side.

None of them is in the paper, which has no experiment about the null space: targets, gains and times are ours.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import Literal, NamedTuple

import numpy as np

from ikde.kernels.arrays import Floats
from ikde.paper.mecanum_arm import MecanumArm, Place
from ikde.paper.null_space_laws import blend, enter, exact, printed, smooth
from ikde.solver.priority import Bounds, Level, damped_inverse, solve_levels

Family = Literal[
    "printed", "printed in m/s", "exact", "enters", "enters in limits", "enters smoothly", "weights in limits"
]
"""`printed`: by ten actuators, the wheels in rad/s; `in m/s`: by X', Y', phi' in their place. `in limits`: of speeds;
`smoothly`: of accelerations as well."""
Reference = Callable[[float], tuple[Floats, Floats]]
"""Where something should be at a time in s, and its velocity."""
Share = Callable[[float, "State"], Floats | float]
"""How much of `tool first` there is, from 0 to 1, at a time in s and in a state."""


Rolling = Callable[[float], Floats]
LIMITS = np.array([0.5, 0.5, 1.0, *(6 * [1.0])])
"""m/s and rad/s: of X', Y', phi' and the joints, where a law keeps limits."""
ACCELERATIONS = np.array([1.0, 1.0, 2.0, *(6 * [5.0])])
"""m/s^2 and rad/s^2, of the same."""
RIDGE = 3e-2  # weight of small speeds beside tasks in one least squares


class State(NamedTuple):
    """What a share may depend on."""

    distance_m: Floats
    """[K] from the platform's middle to the tool's target, in the plane (27)"""
    axis_ratio: Floats
    """[K] of the arm's ellipsoid of velocities (28)"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Way:
    """A law, and which of the two tasks comes first."""

    name: str
    family: Family
    share: Share
    softest: float = 0.0
    """Below which singular values are damped; 0: nowhere."""


class Scene(NamedTuple):
    """What is asked for, and how it is simulated."""

    tool: Reference
    platform: Reference
    seconds: float
    dt_s: float
    gains: tuple[Floats | float, Floats | float] = (2.0, 1.0)
    """1/s, of tool and platform; [K, 1] where they differ"""
    fastest: tuple[float, float] = (np.inf, np.inf)
    """What is asked of tool and platform at most."""


class Run(NamedTuple):
    """What came of it, a column a way."""

    t_s: Floats
    """[S]"""
    tool_m: Floats
    """[S, K] error of the tool"""
    platform_m: Floats
    """[S, K] error of the platform in X, Y and heading, m and rad"""
    twist: Floats
    """[S, K, 3] X', Y', phi'"""
    wheels: Floats
    """[S, K, 4] rad/s"""
    joints: Floats
    """[S, K, 6] rad/s"""


def simulate(arm: MecanumArm, start: Floats, ways: Sequence[Way], scene: Scene, rolling: Rolling | None = None) -> Run:
    """Follow the scene in all ways at once, from the platform at rest in the origin and the joints at `start` [6].

    `rolling`: how much of the wheels' way the floor sees at a time in s, [K, 1].
    """
    count, steps = len(ways), round(scene.seconds / scene.dt_s)
    platform, q, before = np.zeros((count, 3)), np.tile(start, (count, 1)), np.zeros((count, 9))
    run = Run(*(np.empty((steps, *size)) for size in ((), (count,), (count,), (count, 3), (count, 4), (count, 6))))
    for i in range(steps):
        t = i * scene.dt_s
        place = arm.place(platform, q)
        (tool_at, tool_v), (platform_at, platform_v) = scene.tool(t), scene.platform(t)
        left = tool_at - place.tool, platform_at - platform
        wanted = [
            _shorten(velocity + gain * error, most)
            for velocity, gain, error, most in zip((tool_v, platform_v), scene.gains, left, scene.fastest, strict=True)
        ]
        state = State(np.linalg.norm(tool_at[..., :2] - platform[:, :2], axis=-1), axis_ratio(place.by_joints))
        share = np.array([np.broadcast_to(way.share(t, state), count)[k] for k, way in enumerate(ways)])
        x = _decide(arm, ways, place, wanted, share, before, scene.dt_s)
        run.t_s[i], run.tool_m[i], run.platform_m[i] = t, *(np.linalg.norm(error, axis=-1) for error in left)
        run.wheels[i], run.joints[i] = x[:, :4], x[:, 4:]
        moved, q = arm.advance(platform, q, x, scene.dt_s, 1.0 if rolling is None else rolling(t))
        run.twist[i], platform = (moved - platform) / scene.dt_s, moved
    return run


def axis_ratio(jacobian: Floats) -> Floats:
    """sqrt(largest / smallest eigenvalue of J J^T) [...] (28)."""
    s = np.linalg.svd(jacobian, compute_uv=False)
    return s[..., 0] / np.maximum(s[..., -1], 1e-300)


def _shorten(wanted: Floats, most: float) -> Floats:
    size = np.linalg.norm(wanted, axis=-1, keepdims=True)
    return wanted if most == np.inf else wanted * np.minimum(1.0, most / np.maximum(size, 1e-300))


def _decide(
    arm: MecanumArm,
    ways: Sequence[Way],
    place: Place,
    wanted: list[Floats],
    share: Floats,
    before: Floats,
    dt_s: float,
) -> Floats:
    """Speeds of ten actuators [K, 10]; ways of one law are computed side by side. `before` [K, 9] is set anew."""
    x = np.empty((len(ways), 10))
    for (family, softest), members in groupby(range(len(ways)), lambda k: (ways[k].family, ways[k].softest)):
        some = list(members)
        own = Place(*(part[some] for part in place))
        by_wheels = family == "printed"
        J1, J2 = arm.tasks_by_wheels(own) if by_wheels else arm.tasks_by_platform(own)
        tool, platform = Level(J1, wanted[0][some]), Level(J2, wanted[1][some])
        if by_wheels:
            x[some] = blend(share[some], printed(tool, platform, softest), printed(platform, tool, softest))
            continue
        change = ACCELERATIONS * dt_s if family == "enters smoothly" else np.full(9, np.inf)
        box = np.maximum(-LIMITS, before[some] - change), np.minimum(LIMITS, before[some] + change)
        before[some] = _apply(family, share[some], (tool, platform), softest, box)
        x[some] = arm.to_wheels(own.heading, before[some])
    return x


def _apply(
    family: Family, share: Floats, tasks: tuple[Level, Level], softest: float, box: tuple[Floats, Floats]
) -> Floats:
    """Speeds [K, 9] by one law, inside a box [K, 9] if it keeps one."""
    tool, platform = tasks
    if family == "printed in m/s":
        return blend(share, printed(tool, platform, softest), printed(platform, tool, softest))
    if family == "exact":
        return blend(share, exact(tool, platform, softest), exact(platform, tool, softest))
    if family == "enters":
        return enter(share, tool, platform, softest)
    law = _weigh_inside if family == "weights in limits" else _enter_inside
    rows = []
    for k, own in enumerate(share):
        pair = Level(tool.matrix[k], tool.wanted[k]), Level(platform.matrix[k], platform.wanted[k])
        rows.append(law(own, *pair, softest, Bounds(np.eye(9), box[0][k], box[1][k])))
    return np.array(rows)


def _enter_inside(share: float, tool: Level, platform: Level, softest: float, box: Bounds) -> Floats:
    """The same as `enter`, each level inside the box."""
    there = platform.matrix @ solve_levels([tool, platform], box, softest).x if share > 0.0 else 0.0
    between = Level(platform.matrix, share * there + (1.0 - share) * platform.wanted)
    return solve_levels([between, tool], box, softest).x


def _weigh_inside(share: float, tool: Level, platform: Level, _: float, box: Bounds) -> Floats:
    """No priority, but weights, from 1 : 100 to 100 : 1, in one least squares inside the box."""
    weights = 10.0 ** (2.0 * share), 10.0 ** (2.0 - 2.0 * share)
    matrix = np.vstack([weights[0] * tool.matrix, weights[1] * platform.matrix, RIDGE * np.eye(9)])
    wanted = np.concatenate([weights[0] * tool.wanted, weights[1] * platform.wanted, np.zeros(9)])
    return solve_levels([Level(matrix, wanted)], box, 0.0).x


def always(share: float) -> Share:
    """`tool first` for 1, `platform first` for 0."""
    return lambda t, state: share


def after(begin_s: float, seconds: float) -> Share:
    """From platform first to tool first, smoothly over some seconds; at once over none."""
    if seconds == 0.0:
        return lambda t, state: float(t >= begin_s)
    return lambda t, state: smooth((t - begin_s) / seconds)


def by_distance(near_m: float, far_m: float, shape: Literal["at once", "linear", "smooth"]) -> Share:
    """(27): tool first as the platform comes nearer to the target than `far_m`, altogether at `near_m`."""

    def share(t: float, state: State) -> Floats:
        part = (far_m - state.distance_m) / (far_m - near_m)
        if shape == "at once":
            return (part > 0.0).astype(float)
        return np.clip(part, 0.0, 1.0) if shape == "linear" else smooth(part)

    return share


def by_axis_ratio(low: float, high: float) -> Share:
    """(28): tool first, smoothly, as the arm's ellipsoid gets longer than `low`, altogether at `high`."""
    return lambda t, state: smooth((state.axis_ratio - low) / (high - low))


class Stretch(NamedTuple):
    """An arm drawn straight out of reach, a column a way of inverting its Jacobian."""

    t_s: Floats
    """[S]"""
    speed: Floats
    """[S, K] the fastest joint, rad/s"""
    error_m: Floats
    """[S, K]"""
    sigma: Floats
    """[S, K] smallest singular value, m/rad"""


STRETCHES = ("undamped", "damped everywhere", "damped near the singularity alone")
CAP = 50.0  # rad/s: what a joint is moved by at most, lest the undamped one leave the picture


def stretch(
    arm: MecanumArm, start: Floats, steps: int, dt_s: float, *, v: float = 0.1, softest: float = 0.05
) -> Stretch:
    """The platform stands; the tool is drawn forward at `v` m/s, with a gain of 2/s, in three ways at once."""
    q, forward = np.tile(start, (3, 1)), np.array([1.0, 0.0, 0.0])
    begin = arm.place(np.zeros((1, 3)), start[None]).tool[0]
    out = Stretch(*(np.empty((steps, *size)) for size in ((), (3,), (3,), (3,))))
    for i in range(steps):
        place = arm.place(np.zeros((3, 3)), q)
        left = begin + v * i * dt_s * forward - place.tool
        wanted, J = v * forward + 2.0 * left, place.by_joints
        inverses = np.array(
            [
                damped_inverse(J[0], 0.0),
                J[1].T @ np.linalg.inv(J[1] @ J[1].T + softest**2 * np.eye(3)),
                damped_inverse(J[2], softest),
            ]
        )
        speeds = (inverses @ wanted[..., None])[..., 0]
        out.t_s[i], out.speed[i], out.error_m[i] = i * dt_s, np.abs(speeds).max(axis=-1), np.linalg.norm(left, axis=-1)
        out.sigma[i] = np.linalg.svd(J, compute_uv=False)[..., -1]
        q = q + dt_s * np.clip(speeds, -CAP, CAP)
    return out

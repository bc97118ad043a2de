"""The judge of a motion: plain numpy, straight from the path and the joint values; no kernel of the search has a say.

Everything is computed again from `q` alone: the base's twist from its places, speeds from differences. Between samples
joints run linearly and a base with wheels along its arc, so speeds are constant there and joint values lie between
those of the samples, but for the base's x and y, which its ranges must hold all along the arc.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ikde.kernels.arrays import Floats, Ints
from ikde.model.base_motion import base_twist, find_wheels, step_base
from ikde.model.collision_model import CollisionModel
from ikde.model.robot import Robot
from ikde.model.wheels import wheel_speeds
from ikde.solver.plain import compute_frames, compute_gaps
from ikde.solver.verify import Bools, compute_orientation_errors
from ikde.track.limits import MotionLimits
from ikde.track.moving import MovingWorld
from ikde.track.path import ToolPath

AT_ONCE = 256  # configurations whose clearances are computed together: more do not fit into the cache
ROUNDING = 1e-9  # share of a limit, and m or rad of a range, that rounding may take


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Violations:
    """How often each limit is broken; 0 where it is kept, or off."""

    error: int
    """Samples beyond the error per axis, or the orientation error."""
    range: int
    """Joint values outside their range at samples; and arcs of a base that leave that of x or y on their way."""
    speed: int
    """Speeds of joints, or of a base with wheels along its heading, in a segment."""
    acceleration: int
    wheel: int
    distance: int
    """Samples with the tool too far from the platform's centre."""
    collision: int | None
    """Samples within the safe distance, or nearer to an obstacle than is asked for; None: not checked, no detector."""
    sideways: int
    """Segments in which a base with wheels would slip sideways, by more than 1e-9 m/s."""

    @property
    def total(self) -> int:
        """All of them, of what was checked."""
        return sum(getattr(self, name) or 0 for name in type(self).__slots__)


@dataclass(frozen=True, kw_only=True, eq=False)
class TrackGrade:
    """The figures of a motion of M segments, at its samples 0 .. M."""

    error_m: Floats
    """[M + 1, 3] tool minus path."""
    orientation_error_rad: Floats
    """[M + 1]"""
    speeds: Floats
    """[M, N] m/s and rad/s of each segment; of a base with wheels the chord's."""
    driven: Floats
    """[M, N] the same as limits mean them: of a base with wheels along its heading, in the columns of x and y."""
    v: Floats
    """[M] m/s along the base's heading; NaN without a base on arcs."""
    omega: Floats
    """[M] rad/s"""
    wheel_speeds: Floats
    """[M, 2] rad/s, left and right; NaN without a base on arcs, or for a robot without `wheels`."""
    sideways_m_s: Floats
    """[M] chord velocity across the mid heading (5); 0 without wheels."""
    gaps_m: Floats
    """[M + 1, P] clearance of each pair; in a world that of each component and obstacle follows, less what is asked for
    beyond the safe distance, so that all are compared with that."""
    extras_m: Floats
    """[P] what is asked for beyond it: 0 between components."""
    distance_m: Floats
    """[M + 1] of the tool from the platform's centre (18); NaN if none is named."""
    violations: Violations

    def __repr__(self) -> str:
        broken = self.violations.total
        said = "accepted" if self.accepted else f"{broken} violation{'s' if broken > 1 else ''} of limits"
        return f"<TrackGrade of {len(self.error_m)} samples: {said}>"

    @cached_property
    def largest_axis_error_m(self) -> float:
        """Largest error of any axis at any sample."""
        return float(np.abs(self.error_m).max(initial=0.0))

    @cached_property
    def total_error_m(self) -> float:
        """Largest distance of the tool from the path at a sample."""
        return float(np.linalg.norm(self.error_m, axis=1).max(initial=0.0))

    @cached_property
    def largest_orientation_error_rad(self) -> float:
        """Largest at any sample."""
        return float(self.orientation_error_rad.max(initial=0.0))

    @cached_property
    def clearance_m(self) -> float | None:
        """Of what has the least room, at any sample; None without a pair or a sample: not checked."""
        return float(self.clearances_m[self.gaps_m.min(axis=1).argmin()]) if self.gaps_m.size else None

    @cached_property
    def clearances_m(self) -> Floats:
        """[M + 1] of what has the least room at each sample, m; there must be pairs."""
        tightest = self.gaps_m.argmin(axis=1)
        return self.gaps_m[np.arange(len(tightest)), tightest] + self.extras_m[tightest]

    @property
    def accepted(self) -> bool:
        """True if no limit is broken, collisions among them if they were checked."""
        return self.violations.total == 0


def verify_track(
    collision: CollisionModel,
    path: ToolPath,
    q: Floats,
    *,
    drive: str,
    limits: MotionLimits,
    moving: MovingWorld | None = None,
) -> TrackGrade:
    """Grade the joint values `q` [M + 1, N] of the samples 0 .. M, M <= K, against path and limits.

    `moving`: obstacles that are elsewhere from sample to sample.

    Raises `InputError` for limits that do not fit the robot.
    """
    robot = collision.robot
    limits.check(robot)
    dt_s = path.dt_s
    targets = path.targets()[: len(q)]
    frames = compute_frames(robot, q)
    tool = frames[robot.tool]
    error = tool[:, :3, 3] - targets.p_world_tool
    angle = compute_orientation_errors(targets, tool[:, :3, :3])
    speeds = np.diff(q, axis=0) / dt_s
    base = find_wheels(robot, drive)
    nothing = np.full(max(len(q) - 1, 0), np.nan)
    v, omega, across = (nothing, nothing, np.zeros(len(nothing)))
    if base[0] >= 0:
        v, omega, across = base_twist(q[:-1, base], q[1:, base], dt_s)
    wheels = wheel_speeds(robot.wheels, v, omega) if robot.wheels else np.full((len(v), 2), np.nan)
    gaps = np.concatenate([compute_gaps(collision, q[k : k + AT_ONCE]) for k in range(0, len(q) or 1, AT_ONCE)])
    if moving is not None and len(q):
        gaps[:, len(collision.pairs) :] = moving.compute_gaps(q, path.times_s[: len(q)])
    centre = frames[limits.center][:, :3, 3] if limits.center else np.full((len(q), 3), np.nan)
    distance = np.linalg.norm(tool[:, :3, 3] - centre, axis=1)
    driven = np.where(np.isin(np.arange(q.shape[1]), base[:2]), v[:, None], speeds)
    wrong = (np.abs(error) > limits.position_error_m).any(axis=1) | (angle > limits.orientation_error_rad)
    return TrackGrade(
        error_m=error,
        orientation_error_rad=angle,
        speeds=speeds,
        driven=driven,
        v=v,
        omega=omega,
        wheel_speeds=wheels,
        sideways_m_s=across,
        gaps_m=gaps,
        extras_m=collision.extras_m,
        distance_m=distance,
        violations=Violations(
            error=int(wrong.sum()),
            range=_count_outside(robot, q, base, v, omega, dt_s) if limits.ranges else 0,
            speed=_count_above(driven, limits.speed),
            acceleration=_count_above(np.diff(driven, axis=0) / dt_s, limits.acceleration),
            wheel=_count_above(wheels, limits.wheel_speed_rad_s),
            distance=_count_above(distance, limits.max_distance_m),
            collision=_count_collisions(gaps, collision),
            sideways=int((np.abs(across) > ROUNDING).sum()),
        ),
    )


def _count_collisions(gaps_m: Floats, collision: CollisionModel) -> int | None:
    """Samples of `gaps_m` [M + 1, P] in collision; None if no pair was compared."""
    if not collision.pairs:
        return None
    return int((gaps_m <= collision.limit_m).any(axis=1).sum())


def _count_above(values: Floats, limit: Floats | float | None) -> int:
    """How many values exceed the limit in size; NaN does not."""
    return 0 if limit is None else int((np.abs(values) > np.asarray(limit) * (1.0 + ROUNDING)).sum())


def _count_outside(robot: Robot, q: Floats, base: Ints, v: Floats, omega: Floats, dt_s: float) -> int:
    """Joint values of `q` [M + 1, N] outside their range, and arcs that leave that of x or y on their way."""
    count = int(np.count_nonzero(_is_outside(robot, np.arange(q.shape[1]), q)))
    if base[0] < 0:
        return count
    rotation, heading = omega * dt_s, q[:-1, base[2]]
    for k, quarter in ((0, 0.5), (1, 0.0)):  # x is largest where the heading is along y, y where it is along x
        quarters = heading / np.pi - quarter
        first = np.where(rotation > 0.0, np.ceil(quarters), np.floor(quarters))
        for further in (0.0, 1.0):
            ahead = (first + np.sign(rotation) * further + quarter) * np.pi - heading
            share = np.divide(ahead, rotation, out=np.zeros_like(rotation), where=np.abs(ahead) < np.abs(rotation))
            place = step_base(q[:-1, base], v, omega, share * dt_s)[:, k]
            count += int(np.count_nonzero(_is_outside(robot, base[k], place) & (share > 0.0)))
    return count


def _is_outside(robot: Robot, joint: Ints, values: Floats) -> Bools:
    return (values < robot.lower[joint] - ROUNDING) | (values > robot.upper[joint] + ROUNDING)

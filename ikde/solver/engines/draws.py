"""Configurations drawn by their numbers, where their tools are and which are free: in numpy, without a compiler.

A splitmix64 stream is a counter, so draw k is computed without those before it: what was found free once is kept as the
numbers of its draws. Poses come from the kernels' own text, run on arrays (the same bits). No sum is a product of
matrices: their bits would depend on the machine.
"""

from types import FunctionType
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ikde.kernels import frames, rng
from ikde.kernels.arrays import BODY, FIRST, LAST, CollisionArrays, Floats, Ints, RobotArrays
from ikde.kernels.trig import fold_angle

STREAM = np.uint64(2**64 - 2)  # in place of a user's seed: the pool is the same for all solves
DRAWS = 16  # for each configuration that is wanted, before there seem to be none that are free
CHUNK = 4096  # rows at a time: their numbers stay in the processor's cache
GROUP = 16  # spheres of a component that are asked together
SLACK = 1e-9  # of the room that spheres around groups have for rounding, as a share


def draw(numbers: Ints, lower: Floats, upper: Floats) -> Floats:
    """Draws [K, N] of these numbers [K], uniform within [lower, upper] [N]."""
    joints = len(lower)
    with np.errstate(over="ignore"):  # words of 64 bits wrap around
        words = numbers.astype(np.uint64)[:, None] * np.uint64(joints) + np.arange(1, joints + 1, dtype=np.uint64)
        words = rng.mix.py_func(_START + words * rng.GOLDEN)
    return lower + (words >> rng.SHIFT_11).astype(np.float64) * rng.UNIT * (upper - lower)


def draw_free(robot: RobotArrays, collision: CollisionArrays, lower: Floats, upper: Floats, count: int) -> Ints:
    """Numbers of the first `count` draws that are free of collision, or of as many as are found in `DRAWS` times it."""
    found, total = [], 0
    for first in range(0, DRAWS * count, CHUNK):
        numbers = np.arange(first, min(first + CHUNK, DRAWS * count))
        T_world_body = place_bodies(robot, draw(numbers, lower, upper))
        found.append(numbers[find_free(collision, T_world_body)])
        total += len(found[-1])
        if total >= count:
            break
    return np.concatenate(found)[:count]


def place_bodies(robot: RobotArrays, q: Floats) -> Floats:
    """Poses [B, 3, 4, K] of all bodies in the world at `q` [K, N]."""
    T_world_body = np.empty((len(robot.bodies), 3, 4, len(q)))
    _compute_bodies(robot, np.ascontiguousarray(q.T), T_world_body)
    return T_world_body


def place_tools(robot: RobotArrays, q: Floats) -> Floats:
    """Poses [12, K] of the tool in the world at `q` [K, N]: the transform [3, 4] row by row."""
    T_world_tool, place = np.empty((3, 4, len(q))), frames.compute_frame.py_func
    for first in range(0, len(q), CHUNK):
        rows = slice(first, first + CHUNK)
        place(robot, len(robot.frame_body) - 1, place_bodies(robot, q[rows]), T_world_tool[:, :, rows])
    return T_world_tool.reshape(12, -1)


def find_free(collision: CollisionArrays, T_world_body: Floats) -> NDArray[np.bool_]:
    """Which [K] of some poses of all bodies [B, 3, 4, K] keep every pair farther apart than the safe distance.

    Pairs of few spheres are asked first: what touches there is not asked about any other.
    """
    is_free = np.ones(T_world_body.shape[-1], dtype=bool)
    counts = collision.components[:, LAST] - collision.components[:, FIRST]
    bounds = [
        _place(T_world_body[int(part[BODY])], bound[:3, None])[:, 0]
        for part, bound in zip(collision.components, collision.bounds, strict=True)
    ]
    groups: dict[int, list[Group]] = {}
    for a, b in collision.pairs[np.argsort(counts[collision.pairs].prod(axis=1), kind="stable")].tolist():
        reach = collision.bounds[a, 3] + collision.bounds[b, 3] + collision.safe_distance
        near = np.flatnonzero((_square(bounds[a] - bounds[b]) <= reach * reach) & is_free)
        if len(near):
            for part in {a, b} - groups.keys():
                groups[part] = group_spheres(collision, part)
            is_free[near] = ~_touch(collision, groups[a], groups[b], T_world_body, near)
    return is_free


class Group(NamedTuple):
    """Spheres of a component that are near each other."""

    body: int
    centres: Floats  # [3, S] m, in the body
    radii: Floats  # [S] m
    middle: Floats  # [3, 1] of a sphere around them all
    radius: float


def group_spheres(collision: CollisionArrays, component: int) -> list[Group]:
    """The spheres of a component, halved across their longest way until there are `GROUP` at most in each."""
    body, first, last = (int(collision.components[component, column]) for column in (BODY, FIRST, LAST))
    waiting, groups = [np.arange(first, last)], []
    while waiting:
        rows = waiting.pop()
        centres, radii = collision.p_body_sphere[:, rows], collision.radius[rows]
        low, high = (centres - radii).min(axis=1), (centres + radii).max(axis=1)
        if len(rows) > GROUP:
            order = np.argsort(centres[np.argmax(high - low)], kind="stable")
            waiting += [rows[order[: len(rows) // 2]], rows[order[len(rows) // 2 :]]]
            continue
        middle = 0.5 * (low + high)[:, None]
        radius = float((np.sqrt(_square(centres - middle)) + radii).max())
        groups.append(Group(body, centres, radii, middle, radius * (1.0 + SLACK)))
    return groups


def _touch(
    collision: CollisionArrays, groups: list[Group], others: list[Group], T_world_body: Floats, rows: Ints
) -> NDArray[np.bool_]:
    """In which of some rows a sphere of a component is within the safe distance of one of another."""
    touching = np.zeros(len(rows), dtype=bool)
    (T, T_other), safe = (T_world_body[own[0].body][:, :, rows] for own in (groups, others)), collision.safe_distance
    middles = [_place(T, group.middle)[:, 0] for group in groups]
    for other in others:
        middle = _place(T_other, other.middle)[:, 0]
        for group, own in zip(groups, middles, strict=True):
            reach = (group.radius + other.radius + safe) * (1.0 + SLACK)
            near = np.flatnonzero((_square(own - middle) <= reach * reach) & ~touching)
            if len(near):
                touching[near] = _touch_in(group, T[:, :, near], other, T_other[:, :, near], safe)
    return touching


def _touch_in(group: Group, T: Floats, other: Group, T_other: Floats, safe_m: float) -> NDArray[np.bool_]:
    """The same of two groups, in rows where both bodies stand at `T` [3, 4, K]."""
    touching = np.zeros(T.shape[-1], dtype=bool)
    centres, others = _place(T, group.centres), _place(T_other, other.centres)
    for k, radius in enumerate(other.radii.tolist()):
        reach = group.radii + radius + safe_m
        touching |= (_square(centres - others[:, k, None]) <= (reach * reach)[:, None]).any(axis=0)
    return touching


def _place(T: Floats, points: Floats) -> Floats:
    """Points [3, S] moved by transforms [3, 4, K]: [3, S, K]."""
    x, y, z = points[:, :, None]
    return T[:, None, 0] * x + T[:, None, 1] * y + T[:, None, 2] * z + T[:, None, 3]


def _square(v: Floats) -> Floats:
    """Squared lengths of vectors [3, ...]."""
    return v[0] * v[0] + v[1] * v[1] + v[2] * v[2]


def sin_cos(x: Floats) -> tuple[Floats, Floats]:
    """`trig.sin_cos` of an array: the same bits."""
    s, c, quadrant = fold_angle.py_func(x)
    is_odd = (quadrant & 1) == 1
    s, c = np.where(is_odd, c, s), np.where(is_odd, s, c)
    return s * (1 - (quadrant & 2)), c * (1 - ((quadrant + 1) & 2))


def _start_stream() -> np.uint64:
    """The state of the stream that pools are drawn from."""
    state = np.empty(1, dtype=np.uint64)
    with np.errstate(over="ignore"):
        rng.seed_stream.plain(STREAM, 0, 0, state)
    return state[0]


_START = _start_stream()
_bodies = frames.compute_bodies.py_func
_compute_bodies = FunctionType(_bodies.__code__, {**_bodies.__globals__, "sin_cos": sin_cos})

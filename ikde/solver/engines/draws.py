"""Configurations drawn by their numbers, where their tools are and which are free: in numpy, without a compiler.

A splitmix64 stream is a counter, so draw k is computed without those before it: what was found free once is kept as the
numbers of its draws. Poses come from the kernels' own text, run on arrays (the same bits). No sum is a product of
matrices: their bits would depend on the machine.
"""

from types import FunctionType

import numpy as np
from numpy.typing import NDArray

from ikde.kernels import frames, rng
from ikde.kernels.arrays import BODY, FIRST, LAST, CollisionArrays, Floats, Ints, RobotArrays
from ikde.kernels.trig import fold_angle

STREAM = np.uint64(2**64 - 2)  # in place of a user's seed: the pool is the same for all solves
DRAWS = 16  # for each configuration that is wanted, before there seem to be none that are free
CHUNK = 4096  # rows at a time: their numbers stay in the processor's cache


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
    """Which [K] of some poses of all bodies [B, 3, 4, K] keep every pair farther apart than the safe distance."""
    is_free = np.ones(T_world_body.shape[-1], dtype=bool)
    bounds = [
        _place(T_world_body[int(part[BODY])], bound[:3, None])[:, 0]
        for part, bound in zip(collision.components, collision.bounds, strict=True)
    ]
    for a, b in collision.pairs.tolist():
        reach = collision.bounds[a, 3] + collision.bounds[b, 3] + collision.safe_distance
        near = np.flatnonzero((_square(bounds[a] - bounds[b]) <= reach * reach) & is_free)
        if len(near):
            is_free[near] = ~_touch(collision, a, b, T_world_body, near)
    return is_free


def _touch(collision: CollisionArrays, a: int, b: int, T_world_body: Floats, rows: Ints) -> NDArray[np.bool_]:
    """In which of some rows a sphere of component `a` is within the safe distance of one of `b`."""
    (centres, radii), (others, other_radii) = (_spheres(collision, part, T_world_body, rows) for part in (a, b))
    touching = np.zeros(len(rows), dtype=bool)
    for k, radius in enumerate(other_radii.tolist()):
        reach = radii + radius + collision.safe_distance
        touching |= (_square(centres - others[:, k, None]) <= (reach * reach)[:, None]).any(axis=0)
    return touching


def _spheres(collision: CollisionArrays, component: int, T_world_body: Floats, rows: Ints) -> tuple[Floats, Floats]:
    """Centres [3, S, rows] and radii [S] of the spheres of a component."""
    body, first, last = (int(collision.components[component, column]) for column in (BODY, FIRST, LAST))
    T = np.take(T_world_body[body], rows, axis=2)
    return _place(T, collision.p_body_sphere[:, first:last]), collision.radius[first:last]


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

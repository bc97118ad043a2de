"""What stays from target to target, in flat arrays: numba unpacks every array that it hands over.

A named tuple is unpacked field by field, in Python, on every call: the 27 arrays and numbers of a search took 12 us,
five times as long as the search. The `flatten_` functions lay named tuples end to end; kernels unpack them free. What
they give is writable: numba takes what is read-only for a type of its own, and compiles all that it is handed to anew.
"""

from collections.abc import Iterator, Sequence
from itertools import chain
from typing import Any, NamedTuple

import numpy as np

from ikde.kernels.arrays import (
    ClosedFormArrays,
    CollisionArrays,
    DescentArrays,
    Floats,
    Indices,
    Ints,
    RobotArrays,
    SeedArrays,
    WorldArrays,
)
from ikde.kernels.jit import inline_kernel, inline_view_kernel, kernel

Value = Floats | Ints | Indices | float
Turns = tuple[Floats, Floats, Any, Floats]
"""Lower, upper, is_revolute and centre, each [N], as `kernels.turns.unwind` takes them."""


SOLID_COLUMNS, GRID_COLUMNS = 21, 7  # of a world
HEADER = 11
"""Sizes: solids, components, obstacles, faces, points, clouds, cells of clouds, cells, entries, unbounded solids; and
how many pairs of components, the last ones, are those of what is attached, which no written kernel knows."""
ATTACHED_PAIRS = 10


class Terms(NamedTuple):
    """What the grader asks of every configuration beside its target."""

    limits: Floats  # [2, N] lower and upper, m or rad
    position_tolerance: float  # m
    orientation_tolerance: float  # rad


def flatten_search(
    robot: RobotArrays, collision: CollisionArrays, ranges: Floats, descent: DescentArrays, seeds: SeedArrays
) -> tuple[Floats, Ints, Floats, Floats]:
    """What `unpack_search` takes; the pool, which is large, stays as it is."""
    q, T_world_tool, *others = seeds
    sizes = np.array([ranges.shape[1], len(seeds.grid)])
    numbers, whole = _flatten(collision.safe_distance, sizes, np.zeros(2, dtype=np.int64), ranges, *descent, *others)
    return *_append_models(numbers, whole, robot, collision), q, T_world_tool


def flatten_closed_form(
    robot: RobotArrays, collision: CollisionArrays, ranges: Floats, arm: ClosedFormArrays, carrier: int
) -> tuple[Floats, Ints]:
    """What `unpack_closed_form` takes: safe distance and ranges stand where `flatten_search` puts them."""
    sizes = np.array([ranges.shape[1], carrier, 0, 0])
    numbers, whole = _flatten(collision.safe_distance, ranges, arm.transforms, arm.lengths, arm.angles, sizes, arm[0])
    return _append_models(numbers, whole, robot, collision)


def flatten_models(robot: RobotArrays, collision: CollisionArrays) -> tuple[Floats, Ints]:
    """What `unpack_models` takes."""
    return _flatten(*_list_models(robot, collision))


def flatten_grader(robot: RobotArrays, collision: CollisionArrays, terms: Terms) -> tuple[Floats, Ints]:
    """What `unpack_grader` takes."""
    joints = np.array([terms.limits.shape[1]])
    return _flatten(*terms, *_list_models(robot, collision), joints)


def flatten_answer(
    search: Sequence[Any], grader: tuple[Floats, Ints], kind: int, turns: Turns, *, is_graded: bool = True
) -> tuple[Floats, Ints]:
    """What `unpack_answer` takes: the block of a search, which stands first, what `unwind` takes, and the grader's.

    `is_graded`: by the search; not so what is moved further and graded then. The world, which may be large, stands
    last, once for both.

    Of an array that is read-only numba takes twice as long to see the type.
    """
    *bounds, is_revolute, centre = (np.asarray(part) for part in turns)
    own = search[0][: len(search[0]) - int(search[1][search[1][3] + 6])]
    where = [int(is_graded), kind, len(own) + 3 * len(centre), len(search[1])]
    numbers = np.concatenate([own, *bounds, centre, grader[0]])
    return numbers, np.concatenate([search[1], grader[1], is_revolute.astype(np.int64), where])


def exchange_world(numbers: Floats, whole: Ints, world: Floats) -> tuple[Floats, Ints]:
    """The block of `flatten_answer` in another world: it stands last, and its size in both models."""
    other = whole.copy()
    other[whole[3] + 6] = other[whole[-1] + 6] = len(world)
    return np.concatenate([numbers[: len(numbers) - int(whole[whole[3] + 6])], world]), other


def _append_models(numbers: Floats, whole: Ints, robot: RobotArrays, collision: CollisionArrays) -> tuple[Floats, Ints]:
    """Both models behind a search's own numbers; where they begin stands in whole[2:4]."""
    models = flatten_models(robot, collision)
    whole[2:4] = len(numbers), len(whole)
    return np.concatenate([numbers, models[0]]), np.concatenate([whole, models[1]])


def _list_models(robot: RobotArrays, collision: CollisionArrays) -> Iterator[Value]:
    """What `unpack_models` takes: seven sizes, then all values."""
    tables = (robot.bodies, robot.frame_body, collision.components, collision.pairs, collision.rows, collision.radius)
    tables = (*tables, collision.world)
    return chain([np.array([len(table) for table in tables])], robot, collision)


def _flatten(*values: Value) -> tuple[Floats, Ints]:
    """All numbers and all whole numbers, each in the order of the values."""
    arrays = [np.asarray(value) for value in values]
    assert all(array.dtype.kind in "fiu" for array in arrays)
    numbers = np.concatenate([array.ravel() for array in arrays if array.dtype.kind == "f"])
    whole = np.concatenate([array.ravel().astype(np.int64) for array in arrays if array.dtype.kind in "iu"])
    return numbers, whole


@inline_view_kernel
def unpack_models(numbers, whole):
    """`RobotArrays` and `CollisionArrays` as views; the world is what `numbers` ends with.

    Views that are handed on are counted: numba would free what an `inline_kernel` never took.
    """
    bodies, frames, components, pairs, rows, spheres = whole[0], whole[1], whole[2], whole[3], whole[4], whole[5]
    w, u, world = whole[7:], whole[7 + 4 * bodies :].view(np.uint64), whole[6]
    T_body_frame = 12 * bodies
    safe_distance = T_body_frame + 12 * frames
    radius = safe_distance + 1 + 3 * spheres
    bounds = radius + spheres
    offset = bounds + 4 * components
    robot = RobotArrays(
        w[: 4 * bodies].reshape((bodies, 4)),
        numbers[:T_body_frame].reshape((bodies, 3, 4)),
        u[:frames],
        numbers[T_body_frame:safe_distance].reshape((frames, 3, 4)),
    )
    first_pair = frames + 3 * components
    first_row = first_pair + 2 * pairs
    end = first_row + 4 * rows
    collision = CollisionArrays(
        numbers[safe_distance],
        numbers[safe_distance + 1 : radius].reshape((3, spheres)),
        numbers[radius:bounds],
        u[frames:first_pair].reshape((components, 3)),
        numbers[bounds:offset].reshape((components, 4)),
        u[first_pair:first_row].reshape((pairs, 2)),
        u[first_row:end].reshape((rows, 4)),
        numbers[offset : offset + spheres],
        numbers[numbers.size - world :],
    )
    return robot, collision


@kernel
def unpack_search(numbers, whole, q, T_world_tool):
    """Ranges [3, N], `DescentArrays` and `SeedArrays`, as views.

    Before them stands the safe distance, behind them both models, from numbers[whole[2]] and whole[whole[3]] on: not
    every search unpacks those, which took it 2 us.
    """
    joints, directions = whole[0], whole[1]
    n, w, scale = numbers[1 + 3 * joints :], whole[4 : whole[3]], 2 * directions
    descent = DescentArrays(n[0], n[1], n[2], n[3], n[4], n[5], w[0], w[1], n[6])
    seeds = SeedArrays(
        q,
        T_world_tool,
        w[2:5],
        w[5 : 5 + scale].reshape((directions, 2)),
        n[7 : 7 + scale].reshape((directions, 2)),
        w[5 + scale :],
        n[7 + scale],
        n[8 + scale],
    )
    return numbers[1 : 1 + 3 * joints].reshape((3, joints)), descent, seeds


@kernel
def unpack_closed_form(numbers, whole):
    """Ranges [3, N], `ClosedFormArrays` and the body that carries the arm, as views; behind them stand both models."""
    joints, n = whole[0], numbers[1 + 3 * whole[0] :]
    arm = ClosedFormArrays(whole[4:10].view(np.uint64), n[:24].reshape((2, 3, 4)), n[24:32], n[32:50].reshape((3, 6)))
    return numbers[1 : 1 + 3 * joints].reshape((3, joints)), arm, whole[1]


@kernel
def unpack_grader(numbers, whole):
    """`RobotArrays`, `CollisionArrays` and `Terms`, as views."""
    end = 2 * whole[whole.size - 1]
    robot, collision = unpack_models(numbers[end + 2 :], whole)
    return robot, collision, Terms(numbers[:end].reshape((2, end // 2)), numbers[end], numbers[end + 1])


@inline_view_kernel
def unpack_answer(numbers, whole):
    """The grader's numbers and whole numbers, the kind of target [1], and what `unwind` takes beside q, as views."""
    joints, end = whole[0], whole.size - 3
    grader, bounds = numbers[whole[end + 1] :], numbers[whole[end + 1] - 3 * joints : whole[end + 1]]
    is_revolute = whole[end - 1 - joints : end - 1]
    turns = bounds[:joints], bounds[joints : 2 * joints], is_revolute, bounds[2 * joints :]
    return grader, whole[whole[end + 2] : end - 1 - joints], whole[end : end + 1], turns


@inline_kernel
def grades(whole):
    """Whether a search of one target grades what it finds."""
    return whole[whole.size - 4] == 1


@inline_view_kernel
def unpack_world(world):
    """`WorldArrays` as views of one array, which begins with their sizes."""
    solids, components, obstacles, faces = int(world[0]), int(world[1]), int(world[2]), int(world[3])
    points, clouds, cloud_cells, cells = int(world[4]), int(world[5]), int(world[6]), int(world[7])
    entries, unbounded = int(world[8]), int(world[9])
    r = HEADER + SOLID_COLUMNS * solids
    a = r + 4 * solids
    b = a + components * obstacles
    c = b + 12 * faces
    d = c + 3 * points
    e = d + GRID_COLUMNS * clouds
    f = e + cloud_cells
    g = f + cloud_cells
    h = g + GRID_COLUMNS
    i = h + cells + 1
    j = i + entries
    k = j + cells
    return WorldArrays(
        world[HEADER:r].reshape((solids, SOLID_COLUMNS)),
        world[r:a].reshape((4, solids)),
        world[a:b].reshape((components, obstacles)),
        world[b:c].reshape((faces, 12)),
        world[c:d].reshape((3, points)),
        world[d:e].reshape((clouds, GRID_COLUMNS)),
        world[e:f],
        world[f:g],
        world[g:h],
        world[h:i],
        world[i:j],
        world[j:k],
        world[k : k + unbounded],
    )

"""Exact poses drawn from a region: draw 0 is its centre, the others fill it, each computed from its number alone.

The draws of one part follow a lattice whose steps are powers of the root of x^(d+1) = x + 1, d being how many numbers
are free: any first so many of them lie about as evenly spaced as so many can. Seed and stream shift it. What a target
says as well, such as a free turn about the tool's axis, is drawn as that target again and again, each time with a
random stream of its own.
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from ikde.kernels import rng
from ikde.kernels.arrays import Floats, Ints
from ikde.model.region import WHOLE, Region, RegionPart
from ikde.model.rotation import rotation_with_z
from ikde.model.target import KINDS, Targets
from ikde.solver.engines.draws import sin_cos
from ikde.solver.settings import SolveSettings
from ikde.solver.verify import Bools

SHIFTS, STREAMS = 2**62, 2**61
"""Where the numbers of shifts and of streams begin, apart from those of attempts."""
ROTATION_ROOM = 1.6  # a rotation vector changes by up to pi / 2 times the angle


class Drawn(NamedTuple):
    """Exact targets, the part of the region that each belongs to, and their numbers."""

    targets: Targets
    parts: Ints
    numbers: Ints


class _Shape(NamedTuple):
    """A part as its sampler takes it: what is free is drawn, from these ranges."""

    kind: int
    box_m: Floats  # [3, 2]
    angles: Floats  # [A, 2] rotation vector, turn, or distance; then nothing
    cap: float  # angle of the cone of directions, rad; 0: none
    free: Bools  # [3 + A + 2] which numbers are drawn


def draw_poses(region: Region, first: int, count: int, settings: SolveSettings, seed: int, stream: int) -> Drawn:
    """Draws `first` .. `first + count` - 1: the parts take turns, so the first ones are their centres.

    Fewer than `count` come back where a rotation vector that was drawn is none.
    """
    numbers, many = np.arange(first, first + count), len(region.parts)
    places, kinds, poses, keep = numbers % many, np.zeros(count, dtype=np.int64), np.zeros((count, 3, 4)), numbers >= 0
    for place, part in enumerate(region.parts):
        rows = np.flatnonzero(places == place)
        if len(rows):
            kinds[rows], poses[rows], keep[rows] = _draw_part(part, numbers[rows] // many, settings, seed, stream)
    return Drawn(Targets.packed(kinds[keep], poses[keep]), places[keep], numbers[keep])


def draw_streams(seed: int, stream: int, numbers: Ints) -> list[int]:
    """The random stream of each draw [K]; that of draw 0 is the caller's, as for an exact target."""
    words = (_mix(seed, stream, STREAMS + numbers.astype(np.uint64)) >> np.uint64(1)).tolist()
    return [stream if number == 0 else word for number, word in zip(numbers.tolist(), words, strict=True)]


def draw_points(numbers: Ints, dimensions: int, seed: int, stream: int) -> Floats:
    """Points [K, d] of the unit cube; point 0 is its middle."""
    shift = _mix(seed, stream, SHIFTS + np.arange(dimensions, dtype=np.uint64)) >> rng.SHIFT_11
    shifts = np.where(numbers[:, None] > 0, shift.astype(np.float64) * rng.UNIT, 0.5)
    return (shifts + numbers[:, None] * _find_steps(dimensions)) % 1.0


@lru_cache
def _find_steps(dimensions: int) -> Floats:
    """Steps [d] of the lattice."""
    low, high = 1.0, 2.0
    for _ in range(60):
        middle = 0.5 * (low + high)
        power = 1.0
        for _ in range(dimensions + 1):
            power *= middle
        low, high = (middle, high) if power < middle + 1.0 else (low, middle)
    return np.array([1.0 / low for _ in range(dimensions)]).cumprod()


def _mix(seed: int, stream: int, words: np.ndarray) -> np.ndarray:
    """Scattered words [K] of 64 bits."""
    with np.errstate(over="ignore"):
        start = rng.mix.py_func(np.array([seed], dtype=np.uint64) + rng.GOLDEN)
        start = rng.mix.py_func(start ^ (np.array([stream], dtype=np.uint64) * rng.GOLDEN + rng.MIX_1))
        return rng.mix.py_func(start ^ (words * rng.GOLDEN + rng.MIX_2))


def _draw_part(
    part: RegionPart, numbers: Ints, settings: SolveSettings, seed: int, stream: int
) -> tuple[int, Floats, Bools]:
    """The kind of its draws, their poses [K, 3, 4], and which of them are any [K]."""
    shape = _shape(part, settings)
    free = int(shape.free.sum())
    if not free:
        return shape.kind, np.tile(part.target.T_world_tool, (len(numbers), 1, 1)), numbers >= 0
    share = np.full((len(numbers), len(shape.free)), 0.5)
    share[:, shape.free] = draw_points(numbers, free, seed, stream)
    ranges = np.concatenate([shape.box_m, shape.angles])
    values = ranges[:, 0] + share[:, : len(ranges)] * (ranges[:, 1] - ranges[:, 0])
    offset = _sum_up(part.R_world_box, values[:, :3])
    if part.rule == "look_at":
        T = _look(part, shape, values[:, 3], share[:, -2:], numbers == 0)
        return shape.kind, T, np.ones(len(numbers), dtype=np.bool_)
    R, keep = _rotate(part, shape, values[:, 3:], share[:, -2:], numbers == 0)
    return shape.kind, np.concatenate([R, (part.target.p_world_tool + offset)[:, :, None]], axis=2), keep


def _shape(part: RegionPart, settings: SolveSettings) -> _Shape:
    """Ranges drawn from are smaller by the tolerances where they can be: so answers lie inside."""
    room_m, room_rad = settings.position_tolerance_m, settings.orientation_tolerance_rad
    kind, cap, angles = KINDS.index(part.target.kind), 0.0, np.empty((0, 2))
    if part.rule == "rotation":
        angles = _shrink(part.numbers, ROTATION_ROOM * room_rad)
    elif part.rule == "turn":
        kind = KINDS.index("axis" if is_free_about_z(part) else "pose")
        angles = part.numbers[None, 3:] if is_free_about_z(part) else _shrink(part.numbers[None, 3:], room_rad)
    elif part.rule in ("cone", "look_at"):
        kind, cap = KINDS.index("axis"), float(part.numbers[-1])
        cap = max(0.0, cap - room_rad) if cap < np.pi else cap
        angles = _shrink(part.numbers[None, :2], room_m) if part.rule == "look_at" else angles
    box = _shrink(part.box_m, room_m)
    ranges = np.concatenate([box, angles])
    free = np.array([*(ranges[:, 1] > ranges[:, 0]), cap > 0.0, cap > 0.0])
    if part.rule == "turn" and is_free_about_z(part):
        free[3] = False  # the target itself leaves it free
    return _Shape(kind, box, angles, cap, free)


def is_free_about_z(part: RegionPart) -> bool:
    """Whether any turn about the tool's own axis z will do, which an axis target says as well."""
    x, y, z, low, high = part.numbers.tolist()
    return x == 0.0 and y == 0.0 and abs(z) == 1.0 and high - low >= WHOLE - 1e-12


def _shrink(ranges: Floats, room: float) -> Floats:
    """Ranges [n, 2] smaller at either end, but not by so much that a range of some width becomes none."""
    less = np.minimum(room, 0.25 * (ranges[:, 1] - ranges[:, 0]))
    return np.stack([ranges[:, 0] + less, ranges[:, 1] - less], axis=1)


def _rotate(part: RegionPart, shape: _Shape, values: Floats, cap: Floats, centre: Bools) -> tuple[Floats, Bools]:
    """Orientations [K, 3, 3] of draws, and which are any: rotation vectors beyond a half turn stand for others."""
    R, keep = part.target.R_world_tool, np.ones(len(values), dtype=np.bool_)
    if part.rule == "rotation":
        angles = np.sqrt(_dot(values, values))
        axes = values / np.where(angles > 0.0, angles, 1.0)[:, None]
        return _compose(R, _turn_about(axes, angles)), angles <= np.pi
    if part.rule == "turn" and not is_free_about_z(part):
        axes = np.broadcast_to(part.numbers[:3], (len(values), 3))
        return _compose(R, _turn_about(axes, values[:, 0])), keep
    if part.rule == "cone":
        return rotation_with_z(_sum_up(R, _draw_directions(cap, shape.cap, centre))), keep
    return np.broadcast_to(R, (len(values), 3, 3)), keep


def _look(part: RegionPart, shape: _Shape, distances: Floats, cap: Floats, centre: Bools) -> Floats:
    """Poses [K, 3, 4] from these distances [K] whose z axes point at the target."""
    directions = _sum_up(part.target.R_world_tool, _draw_directions(cap, shape.cap, centre))
    places = part.target.p_world_tool - distances[:, None] * directions
    return np.concatenate([rotation_with_z(directions), places[:, :, None]], axis=2)


def _draw_directions(share: Floats, angle: float, centre: Bools) -> Floats:
    """Directions [K, 3] about z, uniform in the cone of this angle; z itself for the centre."""
    _, cosine = sin_cos(np.array([angle]))
    along = np.where(centre, 1.0, 1.0 - share[:, 0] * (1.0 - cosine[0]))
    across = np.sqrt(np.maximum(0.0, 1.0 - along * along))
    sine, cosine = sin_cos(WHOLE * share[:, 1])
    directions = np.stack([across * cosine, across * sine, along], axis=1)
    return directions / np.sqrt(_dot(directions, directions))[:, None]


def _turn_about(axes: Floats, angles: Floats) -> Floats:
    """Rotations [K, 3, 3] about unit axes [K, 3] by angles [K] (Rodrigues)."""
    sine, cosine = sin_cos(angles)
    x, y, z = axes.T
    nothing = np.zeros(len(axes))
    K = np.stack([np.stack(row, axis=1) for row in ([nothing, -z, y], [z, nothing, -x], [-y, x, nothing])], axis=1)
    outer = axes[:, :, None] * axes[:, None]
    c = cosine[:, None, None]
    return c * np.eye(3) + sine[:, None, None] * K + (1.0 - c) * outer


def _sum_up(R: Floats, vectors: Floats) -> Floats:
    """`R` [3, 3] times each of vectors [K, 3], element by element: the same bits on every machine."""
    return vectors[:, 0, None] * R[:, 0] + vectors[:, 1, None] * R[:, 1] + vectors[:, 2, None] * R[:, 2]


def _compose(R: Floats, others: Floats) -> Floats:
    """`R` [3, 3] times each of rotations [K, 3, 3], likewise."""
    return sum(R[None, :, k, None] * others[:, k, None, :] for k in range(3))  # type: ignore[return-value]


def _dot(a: Floats, b: Floats) -> Floats:
    return a[:, 0] * b[:, 0] + a[:, 1] * b[:, 1] + a[:, 2] * b[:, 2]

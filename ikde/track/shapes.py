"""Curves: lines, arcs, splines, chains of them, points in a row; a share 0 .. 1 of the way -> positions in m."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from ikde.errors import InputError
from ikde.kernels.arrays import Floats
from ikde.model.rotation import rotation_about

MIN_LENGTH_M = 1e-9
Curve = Callable[[Floats], Floats]
"""Shares [S] of the way, 0 .. 1 -> positions [S, 3] in m."""


def make_line(start: Floats, to: Floats) -> Curve:
    """A straight line; from a point to itself, the tool stands still."""
    return lambda share: start + share[:, None] * (to - start)


def make_arc(start: Floats, center: Floats, normal: Floats, angle_rad: float) -> Curve:
    """A circle's arc from `start` about the axis through `center` along `normal`, right-handed; several turns may do.

    Raises:
        InputError: for a normal of length 0, or a start on the axis.
    """
    length = np.linalg.norm(normal)
    if not length > MIN_LENGTH_M:
        raise InputError("a normal of length 0 has no direction", ("normal",))
    axis = normal / length
    spoke = start - center
    if not np.linalg.norm(np.cross(axis, spoke)) > MIN_LENGTH_M:
        raise InputError("the arc starts on its own axis: its radius is 0", ("center",))
    return lambda share: center + rotation_about(axis, share * angle_rad) @ spoke


def make_arc_through(start: Floats, via: Floats, to: Floats) -> Curve:
    """The arc of a circle from `start` through `via` to `to`.

    Raises:
        InputError: for points on one line, or two in one place.
    """
    a, b = via - start, to - start
    normal = np.cross(a, b)
    squared = normal @ normal
    if not squared > (1e-9 * np.linalg.norm(a) * np.linalg.norm(b)) ** 2:
        raise InputError("start, via and to lie on one line: no circle goes through them", ("via",))
    spoke = np.cross((a @ a) * b - (b @ b) * a, normal) / (2.0 * squared)  # from the start to the centre
    u, w = -spoke, to - start - spoke
    angle = np.arctan2(np.cross(u, w) @ normal / np.sqrt(squared), u @ w) % (2.0 * np.pi)
    return make_arc(start, start + spoke, normal, float(angle))


def make_spline(points: Floats) -> Curve:
    """The natural cubic spline through points [P, 3]; each piece takes time as its chord is long.

    Raises:
        InputError: for two points in a row in one place, with the second one's index.
    """
    chords = np.linalg.norm(np.diff(points, axis=0), axis=1)
    for (index,) in np.argwhere(~(chords > MIN_LENGTH_M))[:1]:
        raise InputError("this point is the one before it", (int(index) + 1,))
    knots = np.concatenate([[0.0], np.cumsum(chords)])
    bends = _natural_bends(points, chords)

    def curve(share: Floats) -> Floats:
        at = share * knots[-1]
        piece = np.clip(np.searchsorted(knots, at, side="right") - 1, 0, len(chords) - 1)
        h, a = chords[piece][:, None], (knots[piece + 1] - at)[:, None]
        b = (at - knots[piece])[:, None]
        straight = (a * points[piece] + b * points[piece + 1]) / h
        return straight + ((a**3 / h - a * h) * bends[piece] + (b**3 / h - b * h) * bends[piece + 1]) / 6.0

    return curve


def _natural_bends(points: Floats, chords: Floats) -> Floats:
    """Second derivatives [P, 3] at the knots of the spline that does not bend at its ends (a tridiagonal system)."""
    count = len(points)
    matrix, right = np.eye(count), np.zeros((count, 3))
    slopes = np.diff(points, axis=0) / chords[:, None]
    for i in range(1, count - 1):
        matrix[i, i - 1 : i + 2] = chords[i - 1], 2.0 * (chords[i - 1] + chords[i]), chords[i]
        right[i] = 6.0 * (slopes[i] - slopes[i - 1])
    return np.linalg.solve(matrix, right).astype(float)


def follow_points(points: Floats, at: Floats) -> Floats:
    """Positions [S, 3] on straight lines through points [P, 3], at places `at` [S]: 0 the first point, 1 the next."""
    return np.stack([np.interp(at, np.arange(len(points)), column) for column in points.T], axis=1)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Segment:
    """A piece of a chain."""

    curve: Curve
    samples: int
    """How many samples it takes."""
    smooth: bool = False
    """Whether it starts and ends with no speed and no acceleration (minimum jerk), or keeps an even pace."""


def follow_segments(segments: Sequence[Segment], k: Floats) -> Floats:
    """Positions [S, 3] at samples `k` [S] of a chain; a sample where two segments meet belongs to the second."""
    ends = np.cumsum([segment.samples for segment in segments])
    chosen = np.minimum(np.searchsorted(ends, k, side="right"), len(segments) - 1)
    positions = np.empty((len(k), 3))
    for index, segment in enumerate(segments):
        own = chosen == index
        share = (k[own] - (ends[index] - segment.samples)) / segment.samples
        positions[own] = segment.curve(ease(share) if segment.smooth else share)
    return positions


def ease(share: Floats) -> Floats:
    """The minimum-jerk profile 10 s^3 - 15 s^4 + 6 s^5: from rest to rest; at most 15/8 of the even pace."""
    return share**3 * (10.0 - 15.0 * share + 6.0 * share**2)

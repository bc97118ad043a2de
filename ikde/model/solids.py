"""What obstacles are made of: convex solids and point clouds, each in a frame of its own. Sizes in m."""

from dataclasses import dataclass
from itertools import pairwise
from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import ArrayLike

from ikde.errors import InputError
from ikde.kernels.arrays import Floats, Ints
from ikde.model.hull import make_hull
from ikde.model.numbers import is_number, read_numbers
from ikde.model.robot import MAX_MAGNITUDE
from ikde.model.rotation import TOLERANCE, is_rotation, straighten
from ikde.model.value import ByFields

SolidKind = Literal["sphere", "box", "cylinder", "capsule", "cone", "half_space", "hull", "cloud"]
KINDS: tuple[SolidKind, ...] = get_args(SolidKind)
SIZES: dict[SolidKind, tuple[str, ...]] = {
    "sphere": ("radius",),
    "box": ("x", "y", "z"),  # whole edges
    "cylinder": ("radius", "height"),  # about z, half the height either side of the origin
    "capsule": ("radius", "height"),  # the height between the centres of its ends
    "cone": ("radius", "height"),  # the base at -height / 2, the tip at height / 2
    "half_space": (),  # all z <= 0
    "hull": (),
    "cloud": ("radius",),  # of every point
}
MAX_HULL_POINTS, MAX_CLOUD_POINTS = 20_000, 20_000_000
MAX_COLUMNS = 100_000  # boxes of a height field
MIN_SIZE_M = 1e-6
IDENTITY = np.eye(4)[:3]
"""The pose [3, 4] of what stands where its frame does."""
IDENTITY.setflags(write=False)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Solid(ByFields):
    """One convex solid, or a cloud of equal balls, in the frame of its obstacle."""

    kind: SolidKind
    size_m: tuple[float, ...] = ()
    """As `SIZES` names them."""
    T_obstacle_solid: Floats
    """[3, 4]; rotation and m."""
    points: Floats | None = None
    """[K, 3] m, in the solid's own frame: the corners of a hull, or the points of a cloud; read-only."""
    triangles: Ints | None = None
    """[F, 3] of a hull, into `points`, counter-clockwise from outside; read-only."""

    def __repr__(self) -> str:
        size = " x ".join(f"{value:g}" for value in self.size_m)
        points = "" if self.points is None else f" of {len(self.points):,} points"
        return f"<Solid: {self.kind}{points}{f', {size} m' if size else ''}>"


def make_solid(
    kind: SolidKind, size_m: ArrayLike = (), T_obstacle_solid: ArrayLike | None = None, points: ArrayLike | None = None
) -> Solid:
    """A solid that is known to be right; raises `InputError` that names the size that is wrong."""
    if kind not in KINDS:
        raise InputError(f"expected one of {', '.join(KINDS)}, got {kind!r}", ("kind",))
    sizes = _check_sizes(kind, size_m)
    T = IDENTITY if T_obstacle_solid is None else read_pose(T_obstacle_solid, ("T_obstacle_solid",))
    own: dict[str, Any] = {"kind": kind, "size_m": sizes, "T_obstacle_solid": T}
    if kind == "hull":
        corners, triangles = make_hull(read_points(points, MAX_HULL_POINTS))
        return Solid(points=_frozen(corners), triangles=_frozen(triangles), **own)
    if kind == "cloud":
        return Solid(points=_frozen(read_points(points, MAX_CLOUD_POINTS)), **own)
    return Solid(**own)


def read_points(points: ArrayLike | None, most: int) -> Floats:
    """Points [K, 3] in m, finite and not too many."""
    P = read_numbers([] if points is None else points, ("points",))
    if P.ndim != 2 or P.shape[1] != 3 or not len(P):
        raise InputError(f"expected points [K, 3], got shape {P.shape}", ("points",))
    if len(P) > most:
        raise InputError(f"expected at most {most:,} points, got {len(P):,}", ("points",))
    if not (P.min() >= -MAX_MAGNITUDE and P.max() <= MAX_MAGNITUDE):  # or NaN: row by row it took 30 ms for 10^6
        good = (np.abs(P) <= MAX_MAGNITUDE).all(axis=1)
        row = int(np.argmin(good))
        others = int(len(P) - good.sum()) - 1
        more = f", and {others:,} more like it" if others else ""
        message = f"expected finite numbers up to {MAX_MAGNITUDE:g} m, got {P[row].tolist()}{more}"
        raise InputError(message, ("points", row))
    P += 0.0  # no -0.0
    return P


def make_columns(heights_m: ArrayLike, cell_m: float, base_m: float = 0.0) -> list[Solid]:
    """A height field as boxes: cell (i, j) reaches from z = base to its height, about x = i cell, y = j cell.

    Cells of one height side by side along x are one box; cells that are not above the base are none.
    """
    heights = read_numbers(heights_m, ("heights",))
    if heights.ndim != 2 or not heights.size:
        raise InputError(f"expected heights [X, Y], got shape {heights.shape}", ("heights",))
    if not (np.abs(heights) <= MAX_MAGNITUDE).all():
        raise InputError("expected finite heights", ("heights",))
    if not (is_number(cell_m) and MIN_SIZE_M <= cell_m <= MAX_MAGNITUDE):
        raise InputError(f"expected a size of at least {MIN_SIZE_M:g} m, got {cell_m!r}", ("cell",))
    count = heights.shape[1] + np.count_nonzero(np.diff(heights, axis=0))
    if count > MAX_COLUMNS:
        raise InputError(f"expected columns of at most {MAX_COLUMNS:,} boxes, got {count:,}", ("heights",))
    solids = []
    for j, column in enumerate(heights.T):
        ends = [0, *(np.flatnonzero(np.diff(column)) + 1).tolist(), len(column)]
        for first, last in pairwise(ends):
            height = float(column[first]) - base_m
            if height > MIN_SIZE_M:
                T = np.eye(4)[:3]
                T[:, 3] = 0.5 * (first + last - 1) * cell_m, j * cell_m, base_m + 0.5 * height
                solids.append(make_solid("box", ((last - first) * cell_m, cell_m, height), T))
    return solids


def read_pose(T: ArrayLike, where: tuple[str | int, ...]) -> Floats:
    """A pose [3, 4] from [4, 4] or [3, 4], read-only; rotation and m. Of rounded numbers the nearest rotation."""
    if T is IDENTITY:
        return IDENTITY
    pose = read_numbers(T, where)
    if pose.shape not in ((4, 4), (3, 4)):
        raise InputError(f"expected a pose [4, 4], got shape {pose.shape}", where)
    last = pose[3:].ravel().tolist()
    pose = pose[:3] + 0.0  # no -0.0: what is written and read again has the same bits
    if not all(abs(value) <= MAX_MAGNITUDE for value in pose.ravel().tolist()) or not is_rotation(pose[:, :3]):
        raise InputError("expected a rotation and a place of finite numbers", where)
    if not all(abs(value - one) <= TOLERANCE for value, one in zip(last, (0.0, 0.0, 0.0, 1.0), strict=False)):
        raise InputError(f"expected the last row 0 0 0 1, got {last}", where)
    pose[:, :3] = straighten(pose[:, :3])
    return _frozen(pose)


def _check_sizes(kind: SolidKind, size_m: ArrayLike) -> tuple[float, ...]:
    sizes, names = read_numbers(size_m, ("size",)).ravel().tolist(), SIZES[kind]
    if len(sizes) != len(names):
        raise InputError(f"expected {len(names)} sizes ({', '.join(names) or 'none'}), got {len(sizes)}", ("size",))
    for name, size in zip(names, sizes, strict=True):
        if not MIN_SIZE_M <= size <= MAX_MAGNITUDE:
            expected = f"a size from {MIN_SIZE_M:g} to {MAX_MAGNITUDE:g} m"
            raise InputError(f"expected {expected}, got {size:g}", (name,))
    return tuple(sizes)


def _frozen(array: Any) -> Any:
    array.setflags(write=False)
    return array

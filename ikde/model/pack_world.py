"""From a `World` to the one array that the kernels take (`kernels/world_grid.py`)."""

import math
from collections.abc import Mapping, Sequence
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from ikde.errors import InputError, nearest
from ikde.kernels.arrays import Floats, Ints
from ikde.kernels.flat_arguments import ATTACHED_PAIRS, GRID_COLUMNS, HEADER, SOLID_COLUMNS, unpack_world
from ikde.model.hull import measure_normals
from ikde.model.per_obstacle import PerObstacle, find_changed
from ikde.model.robot import WORLD, Robot
from ikde.model.solids import IDENTITY, KINDS, Solid
from ikde.model.tree import build_tree
from ikde.model.world import Obstacle, World

CLOUD_PITCH_M = 0.04  # 171 ns a check of 1e5 points, with a field built in 16 ms; 2 cm: 122 ns, 377 ms
GRID_PITCH_M = 0.08  # 149 ns a check in a bookshelf of 21 solids; 4 cm 238, 2 cm 298: the cache is missed
MAX_CELLS = 2_000_000
MIN_FOR_GRID = 30  # solids
_EYE = np.eye(4)
FAR_CELLS = 12  # cells that a cloud's field looks away


class Cells(NamedTuple):
    """A grid over points: its row of numbers, the first entry of each cell, and how far occupied ones are, m."""

    numbers: Floats
    starts: Ints
    far: Floats


class PackedObstacle(NamedTuple):
    """What of an obstacle depends on no other: rows of its solids [S, 21], its hulls and its clouds, by solid."""

    rows: Floats
    faces: list[tuple[int, Floats]]
    clouds: list[tuple[int, Cells, Floats]]


class Packed(NamedTuple):
    """A world as it was packed, and of what."""

    obstacles: tuple[Obstacle, ...]
    kept_m: bytes
    whole: Floats


class WorldPacker:
    """Packs worlds for a robot; one that differs from the last by where obstacles are costs what those cost."""

    def __init__(
        self, components: Sequence[str], frames: Mapping[str, Floats], reach_m: float, attached_pairs: int = 0
    ) -> None:
        """As `pack_world`; `attached_pairs`: the last pairs of components, which no written kernel knows."""
        self._components, self._frames, self._reach_m = components, frames, reach_m
        self._attached_pairs = attached_pairs
        self._parts = PerObstacle(self._pack_obstacle)
        self._last: Packed | None = None

    def pack(self, world: World, kept_m: Floats) -> Floats:
        """As `pack_world`."""
        key, packed = kept_m.tobytes(), self._parts.list(world.active)
        whole = self._move(world.active, key, packed)
        if whole is None:
            whole = _join_obstacles(packed, _list_asked(world, self._components, kept_m), self._reach_m)
            whole[ATTACHED_PAIRS] = self._attached_pairs
        whole.setflags(write=False)
        self._last = Packed(world.active, key, whole)
        return whole

    def _move(self, obstacles: tuple[Obstacle, ...], key: bytes, packed: list[PackedObstacle]) -> Floats | None:
        """The last world with rows of obstacles that have moved; None where more than that is new, or has a grid."""
        last = self._last
        if last is None or last.kept_m != key or len(last.obstacles) != len(obstacles) or last.whole[7] > 0.0:
            return None
        whole, solids = last.whole.copy(), int(last.whole[0])
        rows = whole[HEADER : HEADER + SOLID_COLUMNS * solids].reshape(solids, SOLID_COLUMNS)
        places = whole[HEADER + SOLID_COLUMNS * solids :][: 3 * solids].reshape(3, solids)
        for place in find_changed(last.obstacles, obstacles) or ():
            if not _differ_by_place(last.obstacles[place], obstacles[place]):
                return None
            own, first = packed[place].rows, sum(len(part.rows) for part in packed[:place])
            end = first + len(own)
            rows[first:end, 1:13], places[:, first:end] = own[:, 1:13], own[:, 10:13].T
        return whole

    def _pack_obstacle(self, obstacle: Obstacle) -> PackedObstacle:
        T_world_frame = self._frames.get(obstacle.frame)
        if T_world_frame is None:
            known = nearest(obstacle.frame, self._frames)
            message = f"no frame that stays in its place is called {obstacle.frame!r}{known}"
            raise InputError(message, ("obstacles", obstacle.name, "frame"))
        T, rows, faces, clouds = obstacle.T_world_obstacle, [], [], []
        if obstacle.frame != WORLD:
            T = T_world_frame @ _whole(T)
        for place, solid in enumerate(obstacle.solids):
            is_there = solid.T_obstacle_solid is IDENTITY
            rows.append(_solid_row(solid, T if is_there else T[:3] @ _whole(solid.T_obstacle_solid)))
            if solid.kind == "hull":
                faces.append((place, _faces(solid)))
            elif solid.kind == "cloud":
                clouds.append((place, *sort_cloud(solid.points, CLOUD_PITCH_M)))  # type: ignore[arg-type]
        return PackedObstacle(np.array(rows), faces, clouds)


def _differ_by_place(one: Obstacle, other: Obstacle) -> bool:
    """True if everything but the pose of two obstacles is the same."""
    same = one.solids is other.solids and one.ignore is other.ignore
    return same and (one.name, one.frame, one.margin_m) == (other.name, other.frame, other.margin_m)


def pack_world(
    world: World, components: Sequence[str], frames: Mapping[str, Floats], reach_m: float, kept_m: Floats
) -> Floats:
    """Pack a world for a robot.

    Args:
        world: what is in the way; what is switched off is left out.
        components: of the packed collision model, in their order.
        frames: T_world_frame [4, 4] of the robot's frames that no joint moves.
        reach_m: no bounding sphere of a component is larger.
        kept_m: [C] distance that each component keeps, beside an obstacle's own margin; -inf: it is not compared.

    Raises:
        InputError: for a frame or a component that the robot does not have.
    """
    return WorldPacker(components, frames, reach_m).pack(world, kept_m)


def _join_obstacles(packed: list[PackedObstacle], asked: Floats, reach_m: float) -> Floats:
    """The whole array; `asked` [C, O], m."""
    faces, points, clouds, starts, far = [], [], [], [], []
    count, widest = 0, np.where(np.isfinite(asked), asked, 0.0).max(axis=0, initial=0.0)
    solids = np.concatenate([np.empty((0, SOLID_COLUMNS)), *(obstacle.rows for obstacle in packed)])
    owners = np.repeat(np.arange(len(packed)), [len(obstacle.rows) for obstacle in packed])
    solids[:, 17], solids[:, 18] = widest[owners], owners
    first = 0
    for obstacle in packed:
        for place, own in obstacle.faces:
            solids[first + place, 19:21] = sum(map(len, faces)), len(own)
            faces.append(own)
        for place, cells, sorted_points in obstacle.clouds:
            solids[first + place, 14:16] = sum(map(len, starts)), len(clouds)
            clouds.append(cells.numbers)
            starts.append(cells.starts + count)
            far.append(np.append(cells.far, 0.0))
            points.append(sorted_points)
            count += len(sorted_points)
        first += len(obstacle.rows)
    parts = [solids, _spheres(solids), asked, _stack(faces, 12), _join_points(points), _stack(clouds, GRID_COLUMNS)]
    parts += [np.concatenate([*starts, np.empty(0)]), np.concatenate([*far, np.empty(0)])]
    sizes = [len(solids), *asked.shape, len(parts[3]), count, len(clouds), len(parts[6])]
    return _join(sizes, parts, solids, reach_m)


@lru_cache(maxsize=64)
def find_fixed_frames(robot: Robot) -> dict[str, Floats]:
    """T_world_frame [4, 4] of the frames that no joint moves, the world among them."""
    tree = build_tree(robot)
    return {WORLD: np.eye(4), **{name: tree.T_body_frame[name] for name, body in tree.frame_body.items() if body == 0}}


def sort_cloud(points: Floats, pitch: float) -> tuple[Cells, Floats]:
    """Points [K, 3] sorted by cell, and the cells."""
    P = np.ascontiguousarray(points.T)  # along each axis at once: the smallest of a column took 80 times as long
    low, high = P.min(axis=1), P.max(axis=1)
    while np.prod(np.floor((high - low) / pitch) + 1.0) > MAX_CELLS:
        pitch *= 1.5
    dims = (np.floor((high - low) / pitch) + 1).astype(np.int64)
    cells = np.zeros(len(points), dtype=np.int32)
    for k, count in enumerate(dims.tolist()):
        place = ((P[k] - low[k]) / pitch).astype(np.int32)
        cells *= count
        cells += np.minimum(place, count - 1, out=place)
    counts = np.bincount(cells, minlength=int(dims.prod()))
    starts = np.concatenate([[0], np.cumsum(counts)])
    numbers = np.array([*low, pitch, *dims], dtype=float)
    found = Cells(numbers, starts, _measure_far(counts.reshape(dims) > 0, pitch))
    return found, P[:, _find_order(cells)].T


def _find_order(cells: np.ndarray) -> np.ndarray:
    """The order that sorts numbers below 2^32, equals as they come: numpy counts 16 bits, of more it compares."""
    order = np.argsort(cells.astype(np.uint16), kind="stable")
    high = (cells >> 16).astype(np.uint16)
    return order[np.argsort(high[order], kind="stable")] if high.any() else order


def _measure_far(occupied: np.ndarray, pitch: float) -> Floats:
    """Distance [cells] from each cell to the nearest occupied one, box to box, m; at most `FAR_CELLS` cells of it."""
    most = float(FAR_CELLS**2)
    field = np.where(occupied, 0.0, most)
    for axis in range(3):
        found = field.copy()
        for step in range(1, min(FAR_CELLS, field.shape[axis] - 1) + 1):
            cost = float((step - 1) ** 2)
            here, there = [slice(None)] * 3, [slice(None)] * 3
            here[axis], there[axis] = slice(step, None), slice(None, -step)
            np.minimum(found[tuple(here)], field[tuple(there)] + cost, out=found[tuple(here)])
            np.minimum(found[tuple(there)], field[tuple(here)] + cost, out=found[tuple(there)])
        field = found
    return pitch * np.sqrt(np.minimum(field, most)).ravel()


def _solid_row(solid: Solid, T: Floats) -> list[float]:
    """A row of the table but for what depends on other solids: margin, owner, and where its faces or points are."""
    sizes = list(solid.size_m)
    if solid.kind == "box":
        sizes = [0.5 * size for size in sizes]
    elif solid.kind in ("cylinder", "capsule", "cone"):
        sizes[1] *= 0.5
    place = [KINDS.index(solid.kind), *T[:3, :3].ravel().tolist(), *T[:3, 3].tolist()]
    return [*place, *sizes, *[0.0] * (3 - len(sizes)), _bound(solid, sizes), 0.0, 0.0, 0.0, 0.0]


def _bound(solid: Solid, sizes: list[float]) -> float:
    """Radius of a sphere about the solid's origin that holds all of it, m."""
    if solid.kind == "half_space":
        return np.inf
    if solid.points is not None:
        return float(np.linalg.norm(solid.points, axis=1).max()) + (sizes[0] if len(sizes) else 0.0)
    if solid.kind == "sphere":
        return sizes[0]
    return (sum(sizes) if solid.kind == "capsule" else math.sqrt(math.fsum(size * size for size in sizes))) * (
        1.0 + 1e-12
    )


def _faces(solid: Solid) -> Floats:
    """Corners and outward normals [F, 12] of a hull."""
    assert solid.points is not None
    assert solid.triangles is not None
    a, b, c = (solid.points[solid.triangles[:, k]] for k in range(3))
    return np.hstack([a, b, c, measure_normals(solid.points, solid.triangles)])


def _spheres(solids: Floats) -> Floats:
    """Middle and radius [4, S] of a sphere that holds each solid and what it asks for; -inf of what has no end."""
    radius = np.where(np.isfinite(solids[:, 16]), solids[:, 16] + solids[:, 17], -np.inf)
    return np.vstack([solids[:, 10:13].T, radius])


def _list_asked(world: World, components: Sequence[str], kept_m: Floats) -> Floats:
    """Distance [C, O] that components keep from obstacles, m; -inf where they are not compared."""
    asked = kept_m[:, None] + np.array([obstacle.margin_m for obstacle in world.active])
    for owner, obstacle in enumerate(world.active):
        for place, name in enumerate(obstacle.ignore):
            if name not in components:
                message = f"no component is called {name!r}{nearest(name, components)}"
                raise InputError(message, ("obstacles", obstacle.name, "ignore", place))
            asked[list(components).index(name), owner] = -np.inf
    for thing in world.attached:
        allowed = [obstacle.name in thing.may_touch for obstacle in world.active]
        asked[list(components).index(thing.name), allowed] = -np.inf
    return asked


def _join(sizes: Sequence[int], parts: list[Floats], solids: Floats, reach_m: float) -> Floats:
    """The whole array, with a grid over the solids if there are many."""
    bounded = np.isfinite(solids[:, 16])
    unbounded = np.flatnonzero(~bounded).astype(float)
    grid = np.zeros(GRID_COLUMNS)
    own = [np.zeros(1), np.empty(0), np.empty(0)]
    if bounded.sum() >= MIN_FOR_GRID:
        grid, own = _make_grid(sizes, parts, solids[bounded], reach_m)
    return _concatenate(sizes, parts, grid, own, unbounded)


def _concatenate(
    sizes: Sequence[int], parts: list[Floats], grid: Floats, own: list[Floats], unbounded: Floats
) -> Floats:
    starts, entries, near = own
    head = np.zeros(HEADER)
    head[: len(sizes)], head[7:10] = sizes, (len(near), len(entries), len(unbounded))
    return np.concatenate([head, *(part.ravel() for part in parts), grid, starts, entries, near, unbounded])


def _make_grid(
    sizes: Sequence[int], parts: list[Floats], bounded: Floats, reach_m: float
) -> tuple[Floats, list[Floats]]:
    from ikde.kernels.world_grid import count_cells, fill_cells

    radius, pitch = bounded[:, 16] + bounded[:, 17], GRID_PITCH_M
    low = (bounded[:, 10:13] - radius[:, None]).min(axis=0) - reach_m
    high = (bounded[:, 10:13] + radius[:, None]).max(axis=0) + reach_m
    while np.prod(np.ceil((high - low) / pitch)) > MAX_CELLS:
        pitch *= 1.5
    dims = np.ceil((high - low) / pitch)
    grid, cells = np.array([*low, pitch, *dims]), int(dims.prod())
    blank = [np.zeros(cells + 1), np.empty(0), np.full(cells, np.inf)]
    world = unpack_world(_concatenate(sizes, parts, grid, blank, np.empty(0)))
    reach = reach_m + 0.5 * np.sqrt(3.0) * pitch + 1e-6
    counts = np.zeros(cells)
    count_cells(world, reach, counts)
    starts = np.concatenate([[0.0], np.cumsum(counts)])
    entries, near = np.empty(int(starts[-1])), np.full(cells, reach)
    counts[:] = 0.0
    fill_cells(world, reach, starts, counts, entries, near)
    return grid, [starts, entries, near]


def _stack(rows: list[Floats], columns: int) -> Floats:
    return np.vstack(rows) if rows else np.empty((0, columns))


def _join_points(points: list[Floats]) -> Floats:
    """Points [3, K] of clouds [K, 3]; of one alone, which may be large, without a copy."""
    return points[0].T if len(points) == 1 else _stack(points, 3).T


def _whole(T: Floats) -> Floats:
    whole = _EYE.copy()
    whole[:3] = T
    return whole

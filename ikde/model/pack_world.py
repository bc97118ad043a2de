"""From a `World` to the one array that the kernels take (`kernels/world_grid.py`)."""

import math
from collections.abc import Mapping, Sequence
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from ikde.errors import InputError, nearest
from ikde.kernels.arrays import Floats
from ikde.kernels.flat_arguments import ATTACHED_PAIRS, GRID_COLUMNS, HEADER, SOLID_COLUMNS, unpack_world
from ikde.model.cloud_cells import SortedCloud, find_sorted
from ikde.model.hull import measure_normals
from ikde.model.large_worlds import KEPT
from ikde.model.per_obstacle import PerObstacle, find_changed
from ikde.model.robot import WORLD, Robot
from ikde.model.solids import IDENTITY, KINDS, Solid
from ikde.model.tree import build_tree
from ikde.model.world import Obstacle, World

GRID_PITCH_M = 0.08  # 149 ns a check in a bookshelf of 21 solids; 4 cm 238, 2 cm 298: the cache is missed
MIN_FOR_GRID, MAX_CELLS = 30, 2_000_000  # solids
_EYE = np.eye(4)


class PackedObstacle(NamedTuple):
    """What of an obstacle depends on no other: rows of its solids [S, 21], its hulls and its clouds, by solid."""

    rows: Floats
    faces: list[tuple[int, Floats]]
    clouds: list[tuple[int, SortedCloud]]


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
            KEPT.note(int(whole[4]))
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
                clouds.append((place, find_sorted(solid.points)))  # type: ignore[arg-type]
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
        for place, (cells, by_cell) in obstacle.clouds:
            solids[first + place, 14:16] = sum(map(len, starts)), len(clouds)
            clouds.append(cells.numbers)
            starts.append(cells.starts + count)
            far.append(np.append(cells.far, 0.0))
            points.append(by_cell)
            count += by_cell.shape[1]
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
    if solid.kind == "cloud" and solid.points is not None:
        return find_sorted(solid.points).radius_m + sizes[0]
    if solid.points is not None:
        return float(np.linalg.norm(solid.points, axis=1).max())
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
    """Points [3, K] of clouds; of one alone, which may be large, without a copy."""
    return points[0] if len(points) == 1 else np.hstack([np.empty((3, 0)), *points])


def _whole(T: Floats) -> Floats:
    whole = _EYE.copy()
    whole[:3] = T
    return whole

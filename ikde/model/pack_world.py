"""From a `World` to the one array that the kernels take (`kernels/world_grid.py`)."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from ikde.errors import InputError, nearest
from ikde.kernels.arrays import Floats, Ints
from ikde.kernels.flat_arguments import GRID_COLUMNS, HEADER, SOLID_COLUMNS, unpack_world
from ikde.model.hull import measure_normals
from ikde.model.robot import WORLD, Robot
from ikde.model.solids import KINDS, Solid
from ikde.model.tree import build_tree
from ikde.model.world import World

CLOUD_PITCH_M = 0.04  # 171 ns a check of 1e5 points, with a field built in 16 ms; 2 cm: 122 ns, 377 ms
GRID_PITCH_M = 0.08  # 149 ns a check in a bookshelf of 21 solids; 4 cm 238, 2 cm 298: the cache is missed
MAX_CELLS = 2_000_000
MIN_FOR_GRID = 30  # solids
FAR_CELLS = 12  # cells that a cloud's field looks away


class Cells(NamedTuple):
    """A grid over points: its row of numbers, the first entry of each cell, and how far occupied ones are, m."""

    numbers: Floats
    starts: Ints
    far: Floats


def pack_world(
    world: World,
    components: Sequence[str],
    frames: Mapping[str, Floats],
    reach_m: float,
    kept_m: Floats,
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
    rows, faces, points, clouds, starts, far = [], [], [], [], [], []
    count, asked = 0, _list_asked(world, components, kept_m)
    widest = np.where(np.isfinite(asked), asked, 0.0).max(axis=0, initial=0.0)
    for owner, obstacle in enumerate(world.active):
        if obstacle.frame not in frames:
            known = nearest(obstacle.frame, frames)
            message = f"no frame that stays in its place is called {obstacle.frame!r}{known}"
            raise InputError(message, ("obstacles", obstacle.name, "frame"))
        T = frames[obstacle.frame] @ _whole(obstacle.T_world_obstacle)
        for solid in obstacle.solids:
            row = _solid_row(solid, T @ _whole(solid.T_obstacle_solid), owner, widest[owner])
            if solid.kind == "hull":
                own = _faces(solid)
                row[19:21] = sum(map(len, faces)), len(own)
                faces.append(own)
            elif solid.kind == "cloud":
                cells, sorted_points = sort_cloud(solid.points, CLOUD_PITCH_M)  # type: ignore[arg-type]
                row[14:16] = sum(map(len, starts)), len(clouds)
                clouds.append(cells.numbers)
                starts.append(cells.starts + count)
                far.append(np.append(cells.far, 0.0))
                points.append(sorted_points)
                count += len(sorted_points)
            rows.append(row)
    solids = np.array(rows).reshape(-1, SOLID_COLUMNS)
    parts = [solids, _spheres(solids), asked, _stack(faces, 12), _stack(points, 3).T, _stack(clouds, GRID_COLUMNS)]
    parts += [np.concatenate([*starts, np.empty(0)]), np.concatenate([*far, np.empty(0)])]
    sizes = [len(solids), *asked.shape, len(parts[3]), count, len(clouds), len(parts[6])]
    packed = _join(sizes, parts, solids, reach_m)
    packed.setflags(write=False)
    return packed


def find_fixed_frames(robot: Robot) -> dict[str, Floats]:
    """T_world_frame [4, 4] of the frames that no joint moves, the world among them."""
    tree = build_tree(robot)
    return {WORLD: np.eye(4), **{name: tree.T_body_frame[name] for name, body in tree.frame_body.items() if body == 0}}


def sort_cloud(points: Floats, pitch: float) -> tuple[Cells, Floats]:
    """Points [K, 3] sorted by cell, and the cells."""
    low, high = points.min(axis=0), points.max(axis=0)
    while np.prod(np.floor((high - low) / pitch) + 1.0) > MAX_CELLS:
        pitch *= 1.5
    dims = (np.floor((high - low) / pitch) + 1).astype(np.int64)
    places = np.minimum(((points - low) / pitch).astype(np.int64), dims - 1)
    cells = np.ravel_multi_index(tuple(places.T), tuple(dims))
    order = np.argsort(cells, kind="stable")
    counts = np.bincount(cells, minlength=int(dims.prod()))
    starts = np.concatenate([[0], np.cumsum(counts)])
    numbers = np.array([*low, pitch, *dims], dtype=float)
    return Cells(numbers, starts, _measure_far(counts.reshape(dims) > 0, pitch)), points[order]


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


def _solid_row(solid: Solid, T: Floats, owner: int, asked_m: float) -> Floats:
    row = np.zeros(SOLID_COLUMNS)
    row[0], row[1:10], row[10:13] = KINDS.index(solid.kind), T[:3, :3].ravel(), T[:3, 3]
    sizes = np.array(solid.size_m)
    if solid.kind == "box":
        sizes = 0.5 * sizes
    elif solid.kind in ("cylinder", "capsule", "cone"):
        sizes = sizes * (1.0, 0.5)
    row[13 : 13 + len(sizes)] = sizes
    row[16], row[17], row[18] = _bound(solid, sizes), asked_m, owner
    return row


def _bound(solid: Solid, sizes: Floats) -> float:
    """Radius of a sphere about the solid's origin that holds all of it, m."""
    if solid.kind == "half_space":
        return np.inf
    if solid.points is not None:
        return float(np.linalg.norm(solid.points, axis=1).max()) + (sizes[0] if len(sizes) else 0.0)
    if solid.kind == "sphere":
        return float(sizes[0])
    return float(sizes.sum() if solid.kind == "capsule" else np.linalg.norm(sizes)) * (1.0 + 1e-12)


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


def _whole(T: Floats) -> Floats:
    return np.vstack([T, [0.0, 0.0, 0.0, 1.0]])

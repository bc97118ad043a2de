"""What of a robot is within a distance of a world: boxes or cells first, then bounding spheres, then every sphere.

Each step only leaves out what the next would find free, so the verdicts are those of comparing everything, and so is
what is found first. The packed world is read where its numbers lie (`Places`), not cut into tables, and nothing is
counted or allocated: of a check of half a microsecond that would be more than all else.
"""

import math
from typing import NamedTuple

import numpy as np

from ikde.kernels.arrays import BODY, FIRST, LAST
from ikde.kernels.flat_arguments import (
    BALL_COLUMNS,
    BOX_ROWS,
    BOXES,
    GRID_COLUMNS,
    HEADER,
    SOLID_COLUMNS,
    unpack_world,
)
from ikde.kernels.jit import counting_kernel, inline_kernel, kernel, leaf_kernel
from ikde.kernels.obstacles import (
    ASKED,
    BOUND,
    CELL_DIMS,
    CELL_PITCH,
    OWNER,
    PLACE,
    ROUNDING,
    find_cell,
    is_apart,
    solid_gap,
)
from ikde.kernels.placing import apply, place_component

UPRIGHT = 19  # row of boxes where those along the axes of the world begin: lowest, highest
BLOCK = 62  # solids whose boxes are asked at once: a bit for each, in a number with a sign


class Places(NamedTuple):
    """Where tables of a packed world begin, and how long some are: as `flat_arguments.unpack_world` cuts it."""

    obstacles: int
    columns: int  # of boxes
    boxes: int
    balls: int
    asked: int
    cells: int
    grid: int
    starts: int
    entries: int
    near: int
    unbounded: int
    end: int


@inline_kernel
def find_places(world):
    """Those of a packed world."""
    solids, components, obstacles, faces = int(world[0]), int(world[1]), int(world[2]), int(world[3])
    points, clouds, cloud_cells, cells = int(world[4]), int(world[5]), int(world[6]), int(world[7])
    columns, boxes = int(world[BOXES]), HEADER + SOLID_COLUMNS * solids
    balls = boxes + BOX_ROWS * columns
    asked = balls + BALL_COLUMNS * components
    grid = asked + components * obstacles + 12 * faces + 3 * points + GRID_COLUMNS * clouds + 2 * cloud_cells
    starts = grid + GRID_COLUMNS
    entries = starts + cells + 1
    near = entries + int(world[8])
    unbounded = near + cells
    end = unbounded + int(world[9])
    return Places(obstacles, columns, boxes, balls, asked, cells, grid, starts, entries, near, unbounded, end)


@inline_kernel
def find_owner(world, s):
    """The obstacle that solid `s` is of."""
    return int(world[HEADER + SOLID_COLUMNS * s + OWNER])


@inline_kernel
def is_near(world, places, collision, bounds, component, s):
    """True unless a component is proved to be farther from solid `s` than is asked for."""
    limit = world[places.asked + component * places.obstacles + find_owner(world, s)]
    if limit == -math.inf:
        return False
    x, y, z = bounds[component, 0], bounds[component, 1], bounds[component, 2]
    return not is_apart(world, s, x, y, z, collision.bounds[component, 3] + limit)


@inline_kernel
def is_hit(world, places, collision, bounds, centres, component, s):
    """True if a component, whose spheres are placed, is within the distance of solid `s` that is asked for."""
    if not is_near(world, places, collision, bounds, component, s):
        return False
    limit = world[places.asked + component * places.obstacles + find_owner(world, s)]
    for i in range(collision.components[component, FIRST], collision.components[component, LAST]):
        reach = collision.radius[i] + limit
        if solid_gap(world, s, centres[0, i], centres[1, i], centres[2, i], reach, reach) <= reach:
            return True
    return False


@leaf_kernel
def list_near(world, columns, place, x, y, z, radius):
    """A bit for each solid, of `BLOCK` at most, whose box may be within `radius` of a point, m.

    `place`: of the first of `columns` boxes. First boxes along the axes of the world, then, if one is
    near, those along the solids' own. Without branches, so they are vectorised; the boxes hold the solids, and
    `ROUNDING` more than any rounding.
    """
    row, xx = np.uint64(columns), np.uint64(place)  # without a sign: an index that has one is tested for it
    lx = xx + np.uint64(UPRIGHT) * row
    ly, near = lx + row, np.int64(0)
    lz = ly + row
    hx = lz + row
    hy = hx + row
    hz = hy + row
    for s in range(row):
        u = max(world[lx + s] - x, x - world[hx + s], 0.0)
        v = max(world[ly + s] - y, y - world[hy + s], 0.0)
        w = max(world[lz + s] - z, z - world[hz + s], 0.0)
        near |= np.int64(u * u + v * v + w * w <= radius * radius) << np.int64(s)
    if near == 0:
        return near
    return list_turned(world, row, xx, x, y, z, radius)


@inline_kernel
def list_turned(world, row, xx, x, y, z, radius):
    """The same by the boxes along the solids' own axes, of `row` columns from place `xx` on."""
    xy, near = xx + row, np.int64(0)
    xz = xy + row
    yx = xz + row
    yy = yx + row
    yz = yy + row
    zx = yz + row
    zy = zx + row
    zz = zy + row
    px = zz + row
    py = px + row
    pz = py + row
    a = pz + row
    b = a + row
    c = b + row
    asked = c + row
    for s in range(row):
        dx, dy, dz = x - world[px + s], y - world[py + s], z - world[pz + s]
        u = abs(world[xx + s] * dx + world[yx + s] * dy + world[zx + s] * dz) - world[a + s]
        v = abs(world[xy + s] * dx + world[yy + s] * dy + world[zy + s] * dz) - world[b + s]
        w = abs(world[xz + s] * dx + world[yz + s] * dy + world[zz + s] * dz) - world[c + s]
        u, v, w, limit = max(u, 0.0), max(v, 0.0), max(w, 0.0), radius + world[asked + s]
        near |= np.int64(u * u + v * v + w * w <= limit * limit) << np.int64(s)
    return near


@leaf_kernel
def find_listed(world, collision, bounds, centres, component, near):
    """The first of `list_near` that a component is too near to, or -1."""
    places, s = find_places(world), 0
    while near != 0:
        if near & 1 and is_hit(world, places, collision, bounds, centres, component, s):
            return s
        near >>= 1
        s += 1
    return -1


@leaf_kernel
def find_others(world, collision, bounds, centres, component, is_placed):
    """The same of solids without an end, of all where they are too many for a list, and of the component's cell.

    Unless its spheres are placed, the first that may be too near.
    """
    places = find_places(world)
    for entry in range(places.unbounded, places.end):
        s = int(world[entry])
        if is_near(world, places, collision, bounds, component, s) and (
            not is_placed or is_hit(world, places, collision, bounds, centres, component, s)
        ):
            return s
    if places.columns > BLOCK:
        for s in range(int(world[0])):
            if world[HEADER + SOLID_COLUMNS * s + BOUND] < math.inf and (
                is_near(world, places, collision, bounds, component, s)
                and (not is_placed or is_hit(world, places, collision, bounds, centres, component, s))
            ):
                return s
    if places.cells == 0:
        return -1
    cell, away = look_up(world[places.grid :], bounds[component, 0], bounds[component, 1], bounds[component, 2])
    if world[places.near + cell] - away - ROUNDING > collision.bounds[component, 3]:
        return -1
    first, last = int(world[places.starts + cell]), int(world[places.starts + cell + 1])
    for entry in range(places.entries + first, places.entries + last):
        s = int(world[entry])
        if is_near(world, places, collision, bounds, component, s) and (
            not is_placed or is_hit(world, places, collision, bounds, centres, component, s)
        ):
            return s
    return -1


@inline_kernel
def look_up(grid, x, y, z):
    """The cell that holds a point, and how far, at most, the point is from its middle, m."""
    i, j, k = find_cell(grid, 0, x), find_cell(grid, 1, y), find_cell(grid, 2, z)
    pitch = grid[CELL_PITCH]
    dx, dy, dz = x - grid[0] - (i + 0.5) * pitch, y - grid[1] - (j + 0.5) * pitch, z - grid[2] - (k + 0.5) * pitch
    cell = (i * int(grid[CELL_DIMS + 1]) + j) * int(grid[CELL_DIMS + 2]) + k
    return cell, math.sqrt(dx * dx + dy * dy + dz * dz)


@inline_kernel
def has_others(places):
    """True if there is something for `find_others`."""
    return places.cells > 0 or places.end > places.unbounded or places.columns > BLOCK


@inline_kernel
def find_hit(collision, T_world_body, bounds, centres):
    """Component * obstacles + obstacle of the first that is found nearer than is asked for, or -1.

    Bodies and the middles of components are placed (`kernels/placing.py`); spheres are, once they are near. Balls about
    all that a body carries are asked first: few of them are near anything.
    """
    world = collision.world
    places = find_places(world)
    near, listed, is_listed, looks_on = np.int64(0), -1.0, 0 < places.columns <= BLOCK, has_others(places)
    for component in range(collision.components.shape[0]):
        ball = places.balls + BALL_COLUMNS * component
        body, s = world[ball + 4], -1
        if body < 0.0:
            continue
        if looks_on and find_others(world, collision, bounds, centres, component, False) >= 0:
            place_component(collision, T_world_body, component, bounds, centres)
            s = find_others(world, collision, bounds, centres, component, True)
        if is_listed and body != listed:
            x, y, z = world[ball], world[ball + 1], world[ball + 2]
            T = T_world_body[collision.components[component, BODY]]
            x, y, z = apply(T, 0, x, y, z), apply(T, 1, x, y, z), apply(T, 2, x, y, z)
            near, listed = list_near(world, places.columns, places.boxes, x, y, z, world[ball + 3]), body
        own = near
        if near != 0:
            x, y, z = bounds[component, 0], bounds[component, 1], bounds[component, 2]
            own = list_near(world, places.columns, places.boxes, x, y, z, collision.bounds[component, 3])
        if s < 0 and own != 0:
            place_component(collision, T_world_body, component, bounds, centres)
            s = find_listed(world, collision, bounds, centres, component, own)
        if s >= 0:
            return component * places.obstacles + find_owner(world, s)
    return -1


@leaf_kernel
def find_obstacle(collision, bounds, centres):
    """Pairs + obstacle of the first that is found too near, or -1: as `find_hit`, of spheres that are all placed.

    `bounds` [C, 3] and `centres` [3, S] in the world, m, as `kernels/spheres.py` computes them.
    """
    world = collision.world
    places = find_places(world)
    near, is_listed, looks_on = np.int64(0), 0 < places.columns <= BLOCK, has_others(places)
    for component in range(collision.components.shape[0]):
        s, x, y, z = -1, bounds[component, 0], bounds[component, 1], bounds[component, 2]
        if looks_on:
            s = find_others(world, collision, bounds, centres, component, True)
        if is_listed:
            near = list_near(world, places.columns, places.boxes, x, y, z, collision.bounds[component, 3])
        if s < 0 and near != 0:
            s = find_listed(world, collision, bounds, centres, component, near)
        if s >= 0:
            return np.int64(collision.pairs.shape[0] + find_owner(world, s))
    return np.int64(-1)


@counting_kernel
def count_obstacles(collision, bounds, centres, out_counts):
    """Add 1 to `out_counts` [P + O] for each obstacle that is too near."""
    world, pairs = collision.world, collision.pairs.shape[0]
    places = find_places(world)
    touched = np.zeros(places.obstacles, dtype=np.bool_)
    for component in range(collision.components.shape[0]):
        for s in range(int(world[0])):
            owner = find_owner(world, s)
            if not touched[owner] and is_hit(world, places, collision, bounds, centres, component, s):
                touched[owner] = True
                out_counts[pairs + owner] += 1


@kernel
def count_cells(whole, reach, out_counts):
    """How many solids of a packed world each cell of the grid has within `reach` of its middle."""
    world = unpack_world(whole)
    for s in range(world.solids.shape[0]):
        if world.solids[s, BOUND] < math.inf:
            visit_cells(whole, s, world.grid, reach, out_counts, np.empty(0), np.empty(0), np.empty(0))


@kernel
def visit_cells(world, s, grid, reach, out_counts, starts, out_solids, out_near):
    """Count solid `s` in each cell whose middle it is within `reach` of; with `starts`, enter it there, too."""
    row, pitch = HEADER + SOLID_COLUMNS * s, grid[CELL_PITCH]
    ny, nz = int(grid[CELL_DIMS + 1]), int(grid[CELL_DIMS + 2])
    x, y, z, asked = world[row + PLACE], world[row + PLACE + 1], world[row + PLACE + 2], world[row + ASKED]
    limit = reach + asked
    wide = world[row + BOUND] + limit
    for i in range(find_cell(grid, 0, x - wide), find_cell(grid, 0, x + wide) + 1):
        for j in range(find_cell(grid, 1, y - wide), find_cell(grid, 1, y + wide) + 1):
            for k in range(find_cell(grid, 2, z - wide), find_cell(grid, 2, z + wide) + 1):
                cx, cy, cz = grid[0] + (i + 0.5) * pitch, grid[1] + (j + 0.5) * pitch, grid[2] + (k + 0.5) * pitch
                gap = solid_gap(world, s, cx, cy, cz, limit, -math.inf)
                if gap > limit:
                    continue
                cell = (i * ny + j) * nz + k
                if starts.size:
                    out_solids[int(starts[cell]) + int(out_counts[cell])] = s
                    out_near[cell] = min(out_near[cell], gap - asked)
                out_counts[cell] += 1


@kernel
def fill_cells(whole, reach, starts, out_counts, out_solids, out_near):
    """Enter each solid in its cells, in their order; `out_near`, which begins at `reach`, becomes the nearest gap."""
    world = unpack_world(whole)
    for s in range(world.solids.shape[0]):
        if world.solids[s, BOUND] < math.inf:
            visit_cells(whole, s, world.grid, reach, out_counts, starts, out_solids, out_near)

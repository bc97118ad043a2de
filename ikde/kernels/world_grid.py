"""What of a robot is within a distance of a world: cells first, then bounding spheres, then every sphere.

Each step only leaves out what the next would find free, so the verdicts are those of comparing everything.
"""

import math

import numpy as np

from ikde.kernels.arrays import FIRST, LAST
from ikde.kernels.flat_arguments import unpack_world
from ikde.kernels.jit import counting_kernel, inline_kernel, kernel
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


@inline_kernel
def component_touches(world, collision, centres, component, s, limit):
    """True if a sphere of a component is within `limit` of solid `s`, m."""
    for i in range(collision.components[component, FIRST], collision.components[component, LAST]):
        reach = collision.radius[i] + limit
        if solid_gap(world, s, centres[0, i], centres[1, i], centres[2, i], reach, reach) <= reach:
            return True
    return False


@inline_kernel
def is_hit(world, collision, bounds, centres, component, s):
    """True if a component is within the distance of solid `s` that is asked for."""
    limit = world.asked[component, int(world.solids[s, OWNER])]
    if limit == -math.inf:
        return False
    reach = collision.bounds[component, 3] + limit
    x, y, z = bounds[component, 0], bounds[component, 1], bounds[component, 2]
    if is_apart(world, s, x, y, z, reach):
        return False
    return component_touches(world, collision, centres, component, s, limit)


@inline_kernel
def is_near_any(world, x, y, z, reach):
    """True if a solid's sphere is within `reach` of a point; it counts without leaving early, so it is vectorised."""
    px, py, pz, radius = world.spheres[0], world.spheres[1], world.spheres[2], world.spheres[3]
    hits = 0
    for s in range(radius.size):
        dx, dy, dz, limit = px[s] - x, py[s] - y, pz[s] - z, max(radius[s] + reach, 0.0)
        hits += dx * dx + dy * dy + dz * dz <= limit * limit
    return hits > 0


@inline_kernel
def look_up(world, x, y, z):
    """The cell that holds a point, and how far, at most, the point is from its middle, m."""
    grid = world.grid
    i, j, k = find_cell(grid, 0, x), find_cell(grid, 1, y), find_cell(grid, 2, z)
    pitch = grid[CELL_PITCH]
    dx, dy, dz = x - grid[0] - (i + 0.5) * pitch, y - grid[1] - (j + 0.5) * pitch, z - grid[2] - (k + 0.5) * pitch
    cell = (i * int(grid[CELL_DIMS + 1]) + j) * int(grid[CELL_DIMS + 2]) + k
    return cell, math.sqrt(dx * dx + dy * dy + dz * dz)


@kernel
def find_hit(world, collision, bounds, centres):
    """Component * obstacles + obstacle of the first that is found nearer than is asked for, or -1.

    `bounds` [C, 3] and `centres` [3, S] in the world, m, as `kernels/spheres.py` computes them.
    """
    obstacles = world.asked.shape[1]
    has_grid = world.grid_near.size > 0
    for component in range(collision.components.shape[0]):
        x, y, z = bounds[component, 0], bounds[component, 1], bounds[component, 2]
        for h in range(world.unbounded.size):
            s = int(world.unbounded[h])
            if is_hit(world, collision, bounds, centres, component, s):
                return component * obstacles + int(world.solids[s, OWNER])
        if not has_grid:
            if not is_near_any(world, x, y, z, collision.bounds[component, 3]):
                continue
            for s in range(world.solids.shape[0]):
                if world.solids[s, BOUND] < math.inf and is_hit(world, collision, bounds, centres, component, s):
                    return component * obstacles + int(world.solids[s, OWNER])
            continue
        cell, away = look_up(world, x, y, z)
        if world.grid_near[cell] - away - ROUNDING > collision.bounds[component, 3]:
            continue
        for entry in range(int(world.grid_starts[cell]), int(world.grid_starts[cell + 1])):
            s = int(world.grid_solids[entry])
            if is_hit(world, collision, bounds, centres, component, s):
                return component * obstacles + int(world.solids[s, OWNER])
    return -1


@counting_kernel
def find_obstacle(collision, bounds, centres):
    """Pairs + obstacle of the first that is found too near, or -1; as `find_hit`."""
    world = unpack_world(collision.world)
    hit = find_hit(world, collision, bounds, centres)
    return np.int64(collision.pairs.shape[0] + hit % world.asked.shape[1] if hit >= 0 else -1)


@counting_kernel
def count_obstacles(collision, bounds, centres, out_counts):
    """Add 1 to `out_counts` [P + O] for each obstacle that is too near."""
    world, pairs = unpack_world(collision.world), collision.pairs.shape[0]
    obstacles = world.asked.shape[1]
    touched = np.zeros(obstacles, dtype=np.bool_)
    for component in range(collision.components.shape[0]):
        for s in range(world.solids.shape[0]):
            owner = int(world.solids[s, OWNER])
            if not touched[owner] and is_hit(world, collision, bounds, centres, component, s):
                touched[owner] = True
                out_counts[pairs + owner] += 1


@kernel
def count_cells(world, reach, out_counts):
    """How many solids each cell of the grid has within `reach` of its middle."""
    grid = world.grid
    dims = (int(grid[CELL_DIMS]), int(grid[CELL_DIMS + 1]), int(grid[CELL_DIMS + 2]))
    for s in range(world.solids.shape[0]):
        if world.solids[s, BOUND] < math.inf:
            visit_cells(world, s, dims, reach, out_counts, np.empty(0), np.empty(0), np.empty(0))


@kernel
def visit_cells(world, s, dims, reach, out_counts, starts, out_solids, out_near):
    """Count solid `s` in each cell whose middle it is within `reach` of; with `starts`, enter it there, too."""
    grid, pitch = world.grid, world.grid[CELL_PITCH]
    x, y, z = world.solids[s, PLACE], world.solids[s, PLACE + 1], world.solids[s, PLACE + 2]
    limit = reach + world.solids[s, ASKED]
    wide = world.solids[s, BOUND] + limit
    for i in range(find_cell(grid, 0, x - wide), find_cell(grid, 0, x + wide) + 1):
        for j in range(find_cell(grid, 1, y - wide), find_cell(grid, 1, y + wide) + 1):
            for k in range(find_cell(grid, 2, z - wide), find_cell(grid, 2, z + wide) + 1):
                cx, cy, cz = grid[0] + (i + 0.5) * pitch, grid[1] + (j + 0.5) * pitch, grid[2] + (k + 0.5) * pitch
                gap = solid_gap(world, s, cx, cy, cz, limit, -math.inf)
                if gap > limit:
                    continue
                cell = (i * dims[1] + j) * dims[2] + k
                if starts.size:
                    out_solids[int(starts[cell]) + int(out_counts[cell])] = s
                    out_near[cell] = min(out_near[cell], gap - world.solids[s, ASKED])
                out_counts[cell] += 1


@kernel
def fill_cells(world, reach, starts, out_counts, out_solids, out_near):
    """Enter each solid in its cells, in their order; `out_near`, which begins at `reach`, becomes the nearest gap."""
    grid = world.grid
    dims = (int(grid[CELL_DIMS]), int(grid[CELL_DIMS + 1]), int(grid[CELL_DIMS + 2]))
    for s in range(world.solids.shape[0]):
        if world.solids[s, BOUND] < math.inf:
            visit_cells(world, s, dims, reach, out_counts, starts, out_solids, out_near)

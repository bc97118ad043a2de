"""How far a robot is from a world, for graders: every sphere and every solid, by distances of its own.

Nothing is shared with what searches (`kernels/world_grid.py`, `kernels/obstacles.py`) but the tables and how they are
cut; nothing is left out by cells or by spheres about components. Of a cloud only the cells under a sphere are compared.
"""

import math

import numpy as np

from ikde.kernels.arrays import FIRST, LAST
from ikde.kernels.flat_arguments import unpack_world
from ikde.kernels.jit import counting_kernel, inline_kernel, kernel
from ikde.kernels.obstacles import (
    AXES,
    BOUND,
    BOX,
    CAPSULE,
    CELL_DIMS,
    CELL_PITCH,
    CLOUD,
    CONE,
    COUNT,
    CYLINDER,
    FIRST_ROW,
    HULL,
    KIND,
    OWNER,
    PLACE,
    SIZE,
    SPHERE,
)

ROUNDING = 1.0 + 1e-12  # of a square, which may come out too large


@inline_kernel
def square_from_segment(px, py, pz, ax, ay, az, bx, by, bz):
    """Squared distance of a point from a segment, m^2."""
    ex, ey, ez, dx, dy, dz = bx - ax, by - ay, bz - az, px - ax, py - ay, pz - az
    share = max(0.0, min(1.0, (dx * ex + dy * ey + dz * ez) / (ex * ex + ey * ey + ez * ez)))
    dx, dy, dz = dx - share * ex, dy - share * ey, dz - share * ez
    return dx * dx + dy * dy + dz * dz


@inline_kernel
def grade_block(a, b, c):
    """Signed distance by how far a point is beyond three pairs of faces: outside that of the part beyond, m."""
    x, y, z = max(a, 0.0), max(b, 0.0), max(c, 0.0)
    square = x * x + y * y + z * z
    return math.sqrt(square) if square > 0.0 else -min(-a, -b, -c)


@inline_kernel
def grade_cone(rho, z, radius, half):
    """Signed distance from a cone in its half-plane: of base and side, whose sign is that of both their lines."""
    base = square_from_segment(rho, z, 0.0, 0.0, -half, 0.0, radius, -half, 0.0)
    side = square_from_segment(rho, z, 0.0, radius, -half, 0.0, 0.0, half, 0.0)
    inside = z >= -half and 2.0 * half * (rho - radius) + radius * (z + half) <= 0.0
    return -math.sqrt(min(base, side)) if inside else math.sqrt(min(base, side))


@kernel
def grade_hull(faces, first, last, x, y, z, reach):
    """Signed distance from a hull: of its planes inside, of all its triangles outside; a bound of it above `reach`."""
    height = -math.inf
    for f in range(first, last):
        nx, ny, nz = faces[f, 9], faces[f, 10], faces[f, 11]
        height = max(height, nx * (x - faces[f, 0]) + ny * (y - faces[f, 1]) + nz * (z - faces[f, 2]))
    if height <= 0.0 or height > reach:
        return height
    square = math.inf
    for f in range(first, last):
        ax, ay, az, bx, by, bz = faces[f, 0], faces[f, 1], faces[f, 2], faces[f, 3], faces[f, 4], faces[f, 5]
        cx, cy, cz, nx, ny, nz = faces[f, 6], faces[f, 7], faces[f, 8], faces[f, 9], faces[f, 10], faces[f, 11]
        over = nx * (x - ax) + ny * (y - ay) + nz * (z - az)
        is_above = True
        for edge in range(3):  # towards the inside of each edge: n x e
            ox, oy, oz, tx, ty, tz = ax, ay, az, bx, by, bz
            if edge == 1:
                ox, oy, oz, tx, ty, tz = bx, by, bz, cx, cy, cz
            elif edge == 2:
                ox, oy, oz, tx, ty, tz = cx, cy, cz, ax, ay, az
            ex, ey, ez = tx - ox, ty - oy, tz - oz
            ix, iy, iz = ny * ez - nz * ey, nz * ex - nx * ez, nx * ey - ny * ex
            is_above = is_above and ix * (x - ox) + iy * (y - oy) + iz * (z - oz) >= 0.0
            square = min(square, square_from_segment(x, y, z, ox, oy, oz, tx, ty, tz))
        if is_above:
            square = min(square, over * over)
    return math.sqrt(square)


@inline_kernel
def clip_cell(layer, count):
    """A layer of cells, or the outermost one."""
    return int(min(max(layer, 0.0), count - 1.0))


@kernel
def grade_cloud(cells, starts, points, x, y, z, reach):
    """Distance from the nearest point [3, K] within `reach`, of the cells that a ball touches; else inf, m."""
    pitch, rows, layers = cells[CELL_PITCH], int(cells[CELL_DIMS + 1]), int(cells[CELL_DIMS + 2])
    u, v, w, r = (x - cells[0]) / pitch, (y - cells[1]) / pitch, (z - cells[2]) / pitch, reach / pitch
    low, high = clip_cell(w - r, layers), clip_cell(w + r, layers)
    square, found = math.inf if reach == math.inf else reach * reach, math.inf
    for i in range(clip_cell(u - r, cells[CELL_DIMS]), clip_cell(u + r, cells[CELL_DIMS]) + 1):
        for j in range(clip_cell(v - r, rows), clip_cell(v + r, rows) + 1):
            first = layers * (rows * i + j)
            for p in range(int(starts[first + low]), int(starts[first + high + 1])):
                dx, dy, dz = x - points[0, p], y - points[1, p], z - points[2, p]
                d = dx * dx + dy * dy + dz * dz
                if d <= square:
                    square, found = d, d
    return math.sqrt(found)


@kernel
def grade_solid(world, s, x, y, z, reach):
    """Signed distance of a point from solid `s`, m, if it is within `reach`; else a number above it."""
    row, kind = world.solids[s], int(world.solids[s, KIND])
    dx, dy, dz = x - row[PLACE], y - row[PLACE + 1], z - row[PLACE + 2]
    away = math.sqrt(dx * dx + dy * dy + dz * dz)
    if away - row[BOUND] > reach:
        return away - row[BOUND]
    px = row[AXES] * dx + row[AXES + 3] * dy + row[AXES + 6] * dz
    py = row[AXES + 1] * dx + row[AXES + 4] * dy + row[AXES + 7] * dz
    pz = row[AXES + 2] * dx + row[AXES + 5] * dy + row[AXES + 8] * dz
    a, b, c, rho = row[SIZE], row[SIZE + 1], row[SIZE + 2], math.sqrt(px * px + py * py)
    gap = pz  # of a half-space
    if kind == SPHERE:
        gap = math.sqrt(px * px + py * py + pz * pz) - a
    elif kind == BOX:
        gap = grade_block(abs(px) - a, abs(py) - b, abs(pz) - c)
    elif kind == CYLINDER:
        gap = grade_block(rho - a, abs(pz) - b, -math.inf)
    elif kind == CAPSULE:
        gap = math.sqrt(square_from_segment(px, py, pz, 0.0, 0.0, -b, 0.0, 0.0, b)) - a
    elif kind == CONE:
        gap = grade_cone(rho, pz, a, b)
    elif kind == HULL:
        gap = grade_hull(world.faces, int(row[FIRST_ROW]), int(row[FIRST_ROW] + row[COUNT]), px, py, pz, reach)
    elif kind == CLOUD:
        gap = grade_cloud(world.clouds[int(c)], world.cloud_starts[int(b) :], world.points, px, py, pz, reach + a) - a
    return gap


@kernel
def measure_world(world, collision, centres, reach):
    """Smallest distance - R - what is asked for, m, and component * obstacles + obstacle; inf and -1 above `reach`.

    `centres` [3, S] in the world, m.
    """
    best, which, obstacles = reach, -1, world.asked.shape[1]
    for component in range(collision.components.shape[0]):
        for s in range(world.solids.shape[0]):
            owner = int(world.solids[s, OWNER])
            asked = world.asked[component, owner]
            if asked == -math.inf:
                continue
            row = world.solids[s]
            ox, oy, oz, bound = row[PLACE], row[PLACE + 1], row[PLACE + 2], row[BOUND]
            for i in range(collision.components[component, FIRST], collision.components[component, LAST]):
                less = collision.radius[i] + asked
                far = best + less + bound
                dx, dy, dz = centres[0, i] - ox, centres[1, i] - oy, centres[2, i] - oz
                if far < 0.0 or dx * dx + dy * dy + dz * dz > ROUNDING * far * far:
                    continue  # as `grade_solid` would find: not to call it takes 0.6 of the time of an answer
                gap = grade_solid(world, s, centres[0, i], centres[1, i], centres[2, i], best + less) - less
                if gap < best:
                    best, which = gap, component * obstacles + owner
    return (best, which) if which >= 0 else (math.inf, -1)


@counting_kernel
def compute_world_clearance(collision, centres, reach):
    """Smallest distance less what an obstacle asks for beyond the safe distance, m, and pairs + place in the table.

    So it is compared with the safe distance, as that of the robot's own pairs. The table is [C, O]: component *
    obstacles + obstacle. inf and -1 if all are farther than `reach`.
    """
    world, safe = unpack_world(collision.world), collision.safe_distance
    gap, which = measure_world(world, collision, centres, reach - safe)
    return gap + safe, np.int64(collision.pairs.shape[0] + which if which >= 0 else -1)

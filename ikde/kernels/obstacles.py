"""Signed distances from points to the solids and clouds of a world, and whether anything of a robot is within them.

A world is a table of values (`WorldArrays`): another world, or a moved obstacle, compiles nothing. A distance is asked
for with a `reach`: beyond it any number above it will do, which lets bounding spheres and cells answer most.
"""

import math

from ikde.kernels.jit import inline_kernel, kernel

SPHERE, BOX, CYLINDER, CAPSULE, CONE, HALF_SPACE, HULL, CLOUD = range(8)
KIND, AXES, PLACE, SIZE, BOUND, ASKED, OWNER, FIRST_ROW, COUNT = 0, 1, 10, 13, 16, 17, 18, 19, 20  # columns of a solid
CELL_ORIGIN, CELL_PITCH, CELL_DIMS = 0, 3, 4  # entries of a grid's row of numbers
ROUNDING = 1e-6  # m: bounds kept in single precision are cut by it


@inline_kernel
def to_solid(solids, s, x, y, z):
    """A point of the world in a solid's own frame, m."""
    dx, dy, dz = x - solids[s, PLACE], y - solids[s, PLACE + 1], z - solids[s, PLACE + 2]
    return (
        solids[s, AXES] * dx + solids[s, AXES + 3] * dy + solids[s, AXES + 6] * dz,
        solids[s, AXES + 1] * dx + solids[s, AXES + 4] * dy + solids[s, AXES + 7] * dz,
        solids[s, AXES + 2] * dx + solids[s, AXES + 5] * dy + solids[s, AXES + 8] * dz,
    )


@inline_kernel
def box_gap(x, y, z, a, b, c):
    """From a box with half edges a, b, c."""
    qx, qy, qz = abs(x) - a, abs(y) - b, abs(z) - c
    largest = max(qx, qy, qz)
    if largest <= 0.0:
        return largest
    qx, qy, qz = max(qx, 0.0), max(qy, 0.0), max(qz, 0.0)
    return math.sqrt(qx * qx + qy * qy + qz * qz)


@inline_kernel
def cylinder_gap(rho, z, radius, half):
    """From a cylinder, at distance `rho` from its axis."""
    a, b = rho - radius, abs(z) - half
    if max(a, b) <= 0.0:
        return max(a, b)
    a, b = max(a, 0.0), max(b, 0.0)
    return math.sqrt(a * a + b * b)


@inline_kernel
def cone_gap(rho, z, radius, half):
    """From a cone of base radius `radius` at -half, its tip at half, at distance `rho` from its axis.

    By the regions of the base's disk, the side, the rim and the tip, seen from the rim along the side.
    """
    slant = math.sqrt(radius * radius + 4.0 * half * half)
    cos, sin = radius / slant, 2.0 * half / slant  # the side runs from the rim inwards and up
    across = sin * (rho - radius) + cos * (z + half)  # outwards of the side's line
    along = cos * (radius - rho) + sin * (z + half)  # from the rim on
    below = -half - z
    if across <= 0.0 and below <= 0.0:
        return max(across, below)
    if across > 0.0 and 0.0 <= along <= slant:
        return across
    if along > slant:
        return math.sqrt(rho * rho + (z - half) * (z - half))
    if rho <= radius:
        return below
    out = rho - radius
    return math.sqrt(out * out + below * below)


@inline_kernel
def triangle_gap(faces, f, x, y, z):
    """Squared distance from a triangle of the table of faces: corners a, b, c, then the outward normal."""
    ax, ay, az = x - faces[f, 0], y - faces[f, 1], z - faces[f, 2]
    ux, uy, uz = faces[f, 3] - faces[f, 0], faces[f, 4] - faces[f, 1], faces[f, 5] - faces[f, 2]
    vx, vy, vz = faces[f, 6] - faces[f, 0], faces[f, 7] - faces[f, 1], faces[f, 8] - faces[f, 2]
    uu, uv, vv = ux * ux + uy * uy + uz * uz, ux * vx + uy * vy + uz * vz, vx * vx + vy * vy + vz * vz
    du, dv = ux * ax + uy * ay + uz * az, vx * ax + vy * ay + vz * az
    s, t, scale = vv * du - uv * dv, uu * dv - uv * du, uu * vv - uv * uv
    if s >= 0.0 and t >= 0.0 and s + t <= scale and scale > 0.0:
        height = faces[f, 9] * ax + faces[f, 10] * ay + faces[f, 11] * az
        return height * height
    best = math.inf
    for edge in range(3):
        i, j = 3 * edge, 3 * ((edge + 1) % 3)
        px, py, pz = faces[f, i], faces[f, i + 1], faces[f, i + 2]
        ex, ey, ez = faces[f, j] - px, faces[f, j + 1] - py, faces[f, j + 2] - pz
        share = (ex * (x - px) + ey * (y - py) + ez * (z - pz)) / (ex * ex + ey * ey + ez * ez)
        share = min(1.0, max(0.0, share))
        rx, ry, rz = x - px - share * ex, y - py - share * ey, z - pz - share * ez
        best = min(best, rx * rx + ry * ry + rz * rz)
    return best


@kernel
def hull_gap(faces, first, count, x, y, z):
    """From a convex hull: its highest plane inside, its nearest triangle outside."""
    highest = -math.inf
    for f in range(first, first + count):
        height = faces[f, 9] * (x - faces[f, 0]) + faces[f, 10] * (y - faces[f, 1]) + faces[f, 11] * (z - faces[f, 2])
        highest = max(highest, height)
    if highest <= 0.0:
        return highest
    best = math.inf
    for f in range(first, first + count):
        height = faces[f, 9] * (x - faces[f, 0]) + faces[f, 10] * (y - faces[f, 1]) + faces[f, 11] * (z - faces[f, 2])
        if height > 0.0 and height * height < best:  # what a point sees; the others are farther
            best = min(best, triangle_gap(faces, f, x, y, z))
    return math.sqrt(best)


@inline_kernel
def find_cell(numbers, k, x):
    """Which of a grid's layers along axis k holds the number x; what is outside belongs to the outermost."""
    layer = (x - numbers[CELL_ORIGIN + k]) / numbers[CELL_PITCH]
    return int(min(max(layer, 0.0), numbers[CELL_DIMS + k] - 1.0))  # cut first: the infinite is no whole number


@inline_kernel
def cloud_bound(numbers, far, x, y, z):
    """How far, at least, the nearest point of a cloud is: by the cell that holds (x, y, z), or is next to it."""
    pitch, nx, ny, nz = numbers[CELL_PITCH], numbers[CELL_DIMS], numbers[CELL_DIMS + 1], numbers[CELL_DIMS + 2]
    ox = max(numbers[0] - x, x - numbers[0] - nx * pitch, 0.0)  # beyond the cells
    oy = max(numbers[1] - y, y - numbers[1] - ny * pitch, 0.0)
    oz = max(numbers[2] - z, z - numbers[2] - nz * pitch, 0.0)
    outside = math.sqrt(ox * ox + oy * oy + oz * oz)
    i, j, k = find_cell(numbers, 0, x), find_cell(numbers, 1, y), find_cell(numbers, 2, z)
    return max(outside, far[(i * int(ny) + j) * int(nz) + k] - outside) - ROUNDING


@inline_kernel
def face_gap(numbers, k, layer, x):
    """How far, at least, the number x is from one of a grid's layers along axis k."""
    low = numbers[CELL_ORIGIN + k] + layer * numbers[CELL_PITCH]
    return max(max(low - x, x - low - numbers[CELL_PITCH]) - ROUNDING, 0.0)


@inline_kernel
def count_within(points, x, y, z, square):
    """How many points [3, n] are within a squared distance: vectorised, since none waits for the one before it."""
    px, py, pz, count = points[0], points[1], points[2], 0
    for p in range(px.size):
        dx, dy, dz = px[p] - x, py[p] - y, pz[p] - z
        count += dx * dx + dy * dy + dz * dz <= square
    return count


@kernel
def cloud_gap(numbers, starts, points, far, x, y, z, reach, enough):
    """From the nearest point of a cloud [3, K], sorted by cell, if it is within `reach`; else inf.

    `far`: by cell how far, at least, an occupied one is, box to box, m. Cells under the ball of `reach`, which shrinks
    to what is found, are searched from the middle outwards, until a point is within `enough`.
    """
    if cloud_bound(numbers, far, x, y, z) > reach:
        return math.inf
    ny, nz = int(numbers[CELL_DIMS + 1]), int(numbers[CELL_DIMS + 2])
    best, found = math.inf if reach == math.inf else reach * reach, False
    stop = enough * enough if enough > 0.0 else -1.0
    i0, i1 = find_cell(numbers, 0, x - reach), find_cell(numbers, 0, x + reach)
    j0, j1 = find_cell(numbers, 1, y - reach), find_cell(numbers, 1, y + reach)
    i, j = find_cell(numbers, 0, x), find_cell(numbers, 1, y)
    for m in range(2 * max(i - i0, i1 - i) + 1):
        a = i + (m + 1) // 2 if m % 2 else i - m // 2
        across = face_gap(numbers, 0, a, x)
        if a < i0 or a > i1 or across * across > best:
            continue
        for n in range(2 * max(j - j0, j1 - j) + 1):
            b = j + (n + 1) // 2 if n % 2 else j - n // 2
            beside = face_gap(numbers, 1, b, y)
            left = best - across * across - beside * beside
            if b < j0 or b > j1 or left < 0.0:
                continue
            half, row = math.sqrt(left) + ROUNDING, (a * ny + b) * nz
            first, last = find_cell(numbers, 2, z - half), find_cell(numbers, 2, z + half) + 1
            own = points[:, int(starts[row + first]) : int(starts[row + last])]
            if count_within(own, x, y, z, best) == 0:
                continue
            found = True
            for p in range(own.shape[1]):
                dx, dy, dz = own[0, p] - x, own[1, p] - y, own[2, p] - z
                best = min(best, dx * dx + dy * dy + dz * dz)
            if best <= stop:
                return math.sqrt(best)
    return math.sqrt(best) if found else math.inf


@kernel
def solid_gap(world, s, x, y, z, reach, enough):
    """Signed distance of a point from solid `s`, m, if it is within `reach`; else a number above it.

    Of a cloud it may be that of a point which is not the nearest, once it is within `enough`.
    """
    solids = world.solids
    dx, dy, dz = x - solids[s, PLACE], y - solids[s, PLACE + 1], z - solids[s, PLACE + 2]
    limit = reach + solids[s, BOUND]
    if limit < 0.0 or dx * dx + dy * dy + dz * dz > limit * limit:
        return math.sqrt(dx * dx + dy * dy + dz * dz) - solids[s, BOUND]
    px, py, pz = to_solid(solids, s, x, y, z)
    kind, a, b, c = int(solids[s, KIND]), solids[s, SIZE], solids[s, SIZE + 1], solids[s, SIZE + 2]
    gap = pz  # of a half-space
    if kind == BOX:
        gap = box_gap(px, py, pz, a, b, c)
    elif kind == CYLINDER:
        gap = cylinder_gap(math.sqrt(px * px + py * py), pz, a, b)
    elif kind == SPHERE:
        gap = math.sqrt(px * px + py * py + pz * pz) - a
    elif kind == CAPSULE:
        pz -= min(max(pz, -b), b)
        gap = math.sqrt(px * px + py * py + pz * pz) - a
    elif kind == CONE:
        gap = cone_gap(math.sqrt(px * px + py * py), pz, a, b)
    elif kind == HULL:
        gap = hull_gap(world.faces, int(solids[s, FIRST_ROW]), int(solids[s, COUNT]), px, py, pz)
    elif kind == CLOUD:
        first, which = int(b), int(c)
        starts, far = world.cloud_starts[first:], world.cloud_far[first:]
        gap = cloud_gap(world.clouds[which], starts, world.points, far, px, py, pz, reach + a, enough + a) - a
    return gap


@inline_kernel
def is_apart(world, s, x, y, z, reach):
    """True if a point is proved to be farther than `reach` from solid `s`; of a cloud its cells alone are asked."""
    solids = world.solids
    if int(solids[s, KIND]) != CLOUD:
        return solid_gap(world, s, x, y, z, reach, reach) > reach
    px, py, pz = to_solid(solids, s, x, y, z)
    first, which, radius = int(solids[s, SIZE + 1]), int(solids[s, SIZE + 2]), solids[s, SIZE]
    return cloud_bound(world.clouds[which], world.cloud_far[first:], px, py, pz) - radius > reach

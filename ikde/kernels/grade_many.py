"""The grader of many: metrics and verdict of finished configurations, in lanes.

It shares nothing with what searches but the tables of robot, collision model and targets, and the functions of `trig`:
it walks the tree itself, places every sphere and measures every pair, with no bounds around many. Up to 32
configurations stand side by side in each row of its buffers, so that the compiler vectorises every inner loop.
Sums stand in the order of the scalar kernels, so the bits are theirs; `tests/kernels/test_grade_many.py` holds it.
"""

import math
from typing import NamedTuple

import numpy as np

from ikde.kernels.arrays import AXIS, BODY, COORDINATE, FIRST, LAST, PARENT, POSITION, PRISMATIC, Floats, Ints
from ikde.kernels.flat_arguments import unpack_grader
from ikde.kernels.jit import inline_kernel, kernel
from ikde.kernels.trig import angle_from_sides, sin_cos
from ikde.kernels.world_grades import compute_world_clearance

POSITION_ERROR, ORIENTATION_ERROR, CLEARANCE = range(3)
SLACK = 1e-9  # m: more than rounding could hide
LANES = 32  # shorter loops are unrolled instead, and roots are then taken one by one


class Lanes(NamedTuple):
    """Buffers, a column a lane. A transform is twelve rows: 4 i + j for entry (i, j) of its upper three rows."""

    q: Floats  # [N, L] m or rad
    motion: Floats  # [3, L] sine, cosine and travel of one joint
    product: Floats  # [4, L] one row of a transform, before the joint moves
    bodies: Floats  # [12 B, L] T_world_body
    tool: Floats  # [12, L] T_world_tool
    centres: Floats  # [3 S, L] x, y, z of each sphere in the world, m
    square: Floats  # [L] smallest squared distance of centres so far, m^2
    clearance: Floats  # [L] smallest of all pairs, m
    closest: Ints  # [L] the pair it belongs to


@inline_kernel
def load(q, first, count, out_q):
    """Configurations first .. first + count - 1 of `q` [T, N], a column each; beyond the last it stands again."""
    for lane in range(count):
        row = min(first + lane, q.shape[0] - 1)
        for k in range(q.shape[1]):
            out_q[k, lane] = q[row, k]


@inline_kernel
def place_body(robot, body, count, lanes):
    """T_world_body = T_world_parent @ T_parent_body @ (Rz(q) or Tz(q)) of one body, by its parent's."""
    T, product, motion, L = lanes.bodies, lanes.product, lanes.motion, robot.T_parent_body[body]
    joint, is_prismatic = np.uint64(robot.bodies[body, COORDINATE]), robot.bodies[body, PRISMATIC] == 1
    for lane in range(count):
        s, c = sin_cos(lanes.q[joint, lane])
        motion[0, lane], motion[1, lane], motion[2, lane] = s, c, 0.0
    if is_prismatic:
        for lane in range(count):
            motion[0, lane], motion[1, lane], motion[2, lane] = 0.0, 1.0, lanes.q[joint, lane]
    for i in range(3):
        parent, own = np.uint64(12 * robot.bodies[body, PARENT] + 4 * i), np.uint64(12 * body + 4 * i)
        multiply_row(L, T, parent, count, product)
        for lane in range(count):
            s, c, along = motion[0, lane], motion[1, lane], motion[2, lane]
            x, y, z = product[0, lane], product[1, lane], product[2, lane]
            T[own, lane] = x * c + y * s
            T[own + np.uint64(1), lane] = y * c - x * s
            T[own + np.uint64(2), lane] = z
            T[own + np.uint64(3), lane] = T[parent + np.uint64(3), lane] + product[3, lane] + z * along


@inline_kernel
def multiply_row(L, T, row, count, out_product):
    """Entries `row` .. `row` + 2 of `T` times the transform `L` [3, 4]; the translation of `T` is left out. [4, L]."""
    for j in range(4):
        l0, l1, l2 = L[0, j], L[1, j], L[2, j]
        for lane in range(count):
            a, b, d = T[row, lane], T[row + np.uint64(1), lane], T[row + np.uint64(2), lane]
            out_product[j, lane] = a * l0 + b * l1 + d * l2


@inline_kernel
def place_tool(robot, count, lanes):
    """T_world_tool from the pose of the body it is fixed to."""
    frame = robot.frame_body.size - 1
    body = robot.frame_body[frame]
    for i in range(3):
        row, own = np.uint64(12) * body + np.uint64(4 * i), 4 * i
        multiply_row(robot.T_body_frame[frame], lanes.bodies, row, count, lanes.product)
        for lane in range(count):
            for j in range(3):
                lanes.tool[own + j, lane] = lanes.product[j, lane]
            lanes.tool[own + 3, lane] = lanes.product[3, lane] + lanes.bodies[row + np.uint64(3), lane]


@inline_kernel
def place_spheres(collision, count, lanes):
    """Centres of all spheres in the world."""
    T, p = lanes.bodies, collision.p_body_sphere
    for component in range(collision.components.shape[0]):
        body = collision.components[component, BODY]
        for sphere in range(collision.components[component, FIRST], collision.components[component, LAST]):
            x, y, z = p[0, sphere], p[1, sphere], p[2, sphere]
            for i in range(3):
                row, own = np.uint64(12) * body + np.uint64(4 * i), np.uint64(3) * sphere + np.uint64(i)
                for lane in range(count):
                    a, b, c, d = (
                        T[row, lane],
                        T[row + np.uint64(1), lane],
                        T[row + np.uint64(2), lane],
                        T[row + np.uint64(3), lane],
                    )
                    lanes.centres[own, lane] = a * x + b * y + c * z + d


@inline_kernel
def end_of_run(radius, first, last):
    """The first sphere after `first` that has another radius, or `last`."""
    end = first + np.uint64(1)
    while end < last and radius[end] == radius[first]:
        end += np.uint64(1)
    return end


@inline_kernel
def approach(first_i, last_i, first_j, last_j, count, lanes):
    """Smallest squared distance between two runs of spheres into `lanes.square`."""
    centres, square = lanes.centres, lanes.square
    for lane in range(count):
        square[lane] = np.inf
    for i in range(first_i, last_i):
        a = np.uint64(3) * i
        for j in range(first_j, last_j):
            b = np.uint64(3) * j
            for lane in range(count):
                dx = centres[a, lane] - centres[b, lane]
                dy = centres[a + np.uint64(1), lane] - centres[b + np.uint64(1), lane]
                dz = centres[a + np.uint64(2), lane] - centres[b + np.uint64(2), lane]
                candidate, best = dx * dx + dy * dy + dz * dz, square[lane]
                # Adding nothing keeps the store whole: a masked store must reach the cache before it is read again.
                square[lane] = (candidate if candidate < best else best) + 0.0


@inline_kernel
def measure_pair(collision, pair, count, lanes):
    """Distance - R_i - R_j of two components' spheres into `lanes.clearance`, and the pair, where it is smaller.

    Between spheres of equal radii the nearest centres decide: rounding keeps order, so one root is enough, and none
    where no lane could become smaller: 10.0 us a configuration in place of 12.6 with 200 spheres of as many radii.
    """
    a, b, radius = collision.pairs[pair, 0], collision.pairs[pair, 1], collision.radius
    i, last_i = collision.components[a, FIRST], collision.components[a, LAST]
    while i < last_i:
        end_i = end_of_run(radius, i, last_i)
        j, last_j = collision.components[b, FIRST], collision.components[b, LAST]
        while j < last_j:
            end_j = end_of_run(radius, j, last_j)
            approach(i, end_i, j, end_j, count, lanes)
            radius_i, radius_j, nearer = radius[i], radius[j], 0
            for lane in range(count):
                limit = lanes.clearance[lane] + radius_i + radius_j + SLACK
                nearer += lanes.square[lane] <= limit * limit
            if nearer > 0:
                for lane in range(count):
                    gap, smallest = math.sqrt(lanes.square[lane]) - radius_i - radius_j, lanes.clearance[lane]
                    closer = gap < smallest
                    lanes.closest[lane] = pair if closer else lanes.closest[lane]
                    lanes.clearance[lane] = (gap if closer else smallest) + 0.0
            j = end_j
        i = end_i


@inline_kernel
def measure_pairs(collision, count, lanes):
    """Smallest clearance over all pairs and the first pair that has it (inf and -1 without pairs)."""
    for lane in range(count):
        lanes.clearance[lane], lanes.closest[lane] = np.inf, -1
    for pair in range(collision.pairs.shape[0]):
        measure_pair(collision, pair, count, lanes)


@inline_kernel
def measure_obstacles(collision, count, lanes, centres):
    """The distances from a world, lane by lane, where they are smaller than those of the pairs."""
    for lane in range(count):
        for i in range(collision.radius.size):
            for axis in range(3):
                centres[axis, i] = lanes.centres[3 * i + axis, lane]
        gap, place = compute_world_clearance(collision, centres, lanes.clearance[lane])
        if gap < lanes.clearance[lane]:
            lanes.clearance[lane], lanes.closest[lane] = gap, place


@inline_kernel
def measure_position(asked, tool, lane):
    """Distance in m between the tool of one lane and what is asked [3, 4]."""
    dx, dy, dz = tool[3, lane] - asked[0, 3], tool[7, lane] - asked[1, 3], tool[11, lane] - asked[2, 3]
    return math.sqrt(dx * dx + dy * dy + dz * dz)


@inline_kernel
def measure_orientation(kind, asked, tool, lane):
    """Angle in rad between the tool of one lane and what is asked [3, 4], by its sine and cosine."""
    if kind == POSITION:
        return 0.0
    if kind == AXIS:
        u, v, w = tool[2, lane], tool[6, lane], tool[10, lane]
        x = asked[1, 2] * w - asked[2, 2] * v
        y = asked[2, 2] * u - asked[0, 2] * w
        z = asked[0, 2] * v - asked[1, 2] * u
        cosine = asked[0, 2] * u + asked[1, 2] * v + asked[2, 2] * w
        return angle_from_sides(math.sqrt(x * x + y * y + z * z), cosine)
    trace, x, y, z = 0.0, 0.0, 0.0, 0.0
    for i in range(3):
        u, v, w = tool[4 * i, lane], tool[4 * i + 1, lane], tool[4 * i + 2, lane]
        trace += asked[i, 0] * u + asked[i, 1] * v + asked[i, 2] * w
        x += asked[i, 2] * v - asked[i, 1] * w
        y += asked[i, 0] * w - asked[i, 2] * u
        z += asked[i, 1] * u - asked[i, 0] * v
    return angle_from_sides(0.5 * math.sqrt(x * x + y * y + z * z), 0.5 * (trace - 1.0))


@inline_kernel
def is_inside(limits, q):
    """True if every joint of `q` [N] is inside its limits [2, N]."""
    outside = 0
    for k in range(q.size):
        outside += not limits[0, k] <= q[k] <= limits[1, k]
    return outside == 0


@kernel
def grade_many(numbers, whole, kinds, T_world_tool, q, out_metrics, out_pairs, out_accepted):
    """Metrics of configurations `q` [T, N], a target each.

    numbers, whole are those of `flat_arguments.unpack_grader`; kinds and T_world_tool those of `TargetArrays`.
    `out_metrics` [T, 3]: position error in m, orientation error in rad, clearance in m (inf without pairs);
    `out_pairs` [T]: index of the closest pair (-1 without pairs); `out_accepted` [T]: within tolerances and limits of
    `terms`, and farther apart than the safe distance.
    """
    robot, collision, terms = unpack_grader(numbers, whole)
    lanes = Lanes(
        np.empty((q.shape[1], LANES)),
        np.empty((3, LANES)),
        np.empty((4, LANES)),
        np.empty((12 * robot.bodies.shape[0], LANES)),
        np.empty((12, LANES)),
        np.empty((3 * collision.radius.size, LANES)),
        np.empty(LANES),
        np.empty(LANES),
        np.empty(LANES, dtype=np.int64),
    )
    centres = np.empty((3, collision.radius.size))
    for entry in range(12):
        lanes.bodies[entry] = 1.0 if entry % 5 == 0 else 0.0
    for first in range(0, q.shape[0], LANES):
        count = LANES  # also where fewer are left: a shorter loop takes three times as long
        load(q, first, count, lanes.q)
        for body in range(1, robot.bodies.shape[0]):
            place_body(robot, body, count, lanes)
        place_tool(robot, count, lanes)
        place_spheres(collision, count, lanes)
        measure_pairs(collision, count, lanes)
        if collision.world.size > 0:
            measure_obstacles(collision, min(LANES, q.shape[0] - first), lanes, centres)
        for lane in range(min(LANES, q.shape[0] - first)):
            index = first + lane
            asked = T_world_tool[index]
            position = measure_position(asked, lanes.tool, lane)
            orientation = measure_orientation(kinds[index], asked, lanes.tool, lane)
            clearance = lanes.clearance[lane]
            out_metrics[index, POSITION_ERROR], out_metrics[index, ORIENTATION_ERROR] = position, orientation
            out_metrics[index, CLEARANCE], out_pairs[index] = clearance, lanes.closest[lane]
            meets = position <= terms.position_tolerance and orientation <= terms.orientation_tolerance
            out_accepted[index] = meets and clearance > collision.safe_distance and is_inside(terms.limits, q[index])

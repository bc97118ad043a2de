"""Pairs of components that are nearer than a reach, and how the joints change their distances; damped steps with them.

This is the one place where contacts are found: the damped steps of `memetic` turn each into a row of the tool's system,
which is to grow its gap to the reach; steps along a path turn each into a constraint (`kernels/step_constraints.py`).
"""

import math
from typing import NamedTuple

import numpy as np

from ikde.kernels.arrays import BODY, COORDINATE, PARENT, PRISMATIC, Floats, Indices
from ikde.kernels.clearance import bounds_are_apart, find_closest_spheres
from ikde.kernels.damped import descend, fill_jacobian
from ikde.kernels.jit import inline_kernel, kernel, leaf_kernel

MAX_CONTACTS = 6  # of a damped step towards a whole pose; what a simpler target leaves of its rows is theirs too


class Contacts(NamedTuple):
    """The nearest pairs of components, and the placed spheres in which they are found."""

    gap: Floats  # [K] m
    spheres: Indices  # [K, 3] the pair, and the closest sphere of either component
    bounds: Floats  # [C, 3] m
    centres: Floats  # [3, S] m


@kernel
def make_contacts(bounds, centres, size):
    """Room for so many contacts between spheres placed at `bounds` [C, 3] and `centres` [3, S]."""
    return Contacts(np.empty(size), np.empty((size, 3), dtype=np.uint64), bounds, centres)


@inline_kernel
def find_contacts(collision, reach, room, contacts):
    """Find the pairs nearer than `reach` (m), the nearest `room` of them if there are more; returns how many."""
    count = 0
    for pair in range(collision.pairs.shape[0]):
        a, b = collision.pairs[pair, 0], collision.pairs[pair, 1]
        if bounds_are_apart(collision, contacts.bounds, a, b, reach):
            continue
        gap, i, j = find_closest_spheres(collision, contacts.centres, a, b)
        if gap >= reach:
            continue
        place = count
        if count == room:
            place = 0
            for other in range(1, count):
                if contacts.gap[other] > contacts.gap[place]:
                    place = other
            if gap >= contacts.gap[place]:
                continue
        else:
            count += 1
        contacts.gap[place] = gap
        contacts.spheres[place, 0], contacts.spheres[place, 1], contacts.spheres[place, 2] = pair, i, j
    return count


@inline_kernel
def add_chain(robot, T_world_body, body, x, y, z, nx, ny, nz, out_row):
    """Add d(n . p)/dq to `out_row` [N] for the point p = (x, y, z) of `body`: z . n, or (z x (p - p_joint)) . n."""
    body = np.int64(body)
    while body != 0:
        T, column = T_world_body[body], robot.bodies[body, COORDINATE]
        ax, ay, az = T[0, 2], T[1, 2], T[2, 2]
        if robot.bodies[body, PRISMATIC] == 1:
            out_row[column] += ax * nx + ay * ny + az * nz
        else:
            dx, dy, dz = x - T[0, 3], y - T[1, 3], z - T[2, 3]
            out_row[column] += (ay * dz - az * dy) * nx + (az * dx - ax * dz) * ny + (ax * dy - ay * dx) * nz
        body = robot.bodies[body, PARENT]


@inline_kernel
def fill_gradient(robot, collision, T_world_body, contacts, k, out_row):
    """Gradient of the gap of contact `k` by the joints, into `out_row` [N]; 0 where two centres coincide."""
    centres, pair, i, j = contacts.centres, contacts.spheres[k, 0], contacts.spheres[k, 1], contacts.spheres[k, 2]
    for column in range(out_row.size):
        out_row[column] = 0.0
    x, y, z = centres[0, i] - centres[0, j], centres[1, i] - centres[1, j], centres[2, i] - centres[2, j]
    distance = math.sqrt(x * x + y * y + z * z)
    if distance == 0.0:
        return
    x, y, z = x / distance, y / distance, z / distance
    a, b = collision.pairs[pair, 0], collision.pairs[pair, 1]
    body_a, body_b = collision.components[a, BODY], collision.components[b, BODY]
    add_chain(robot, T_world_body, body_a, centres[0, i], centres[1, i], centres[2, i], x, y, z, out_row)
    add_chain(robot, T_world_body, body_b, centres[0, j], centres[1, j], centres[2, j], -x, -y, -z, out_row)


@leaf_kernel
def add_contacts(robot, collision, reach, rows, contacts, work):
    """Append a row for each contact to Jacobian and error in `work`: its gap is to grow to `reach` (m).

    Returns the rows in use.
    """
    count = find_contacts(collision, reach, work.error.size - rows, contacts)
    for k in range(count):
        fill_gradient(robot, collision, work.T_world_body, contacts, k, work.jacobian[rows + k])
        work.error[rows + k] = reach - contacts.gap[k]
    return rows + count


@inline_kernel
def take_clear_step(robot, collision, target, index, ranges, descent, reach, contacts, q, work):
    """One damped step on `q` [N], in place, towards the target and away from contact.

    `work`, a `DescentWorkspace`, holds the poses and the tool's error at `q`; the spheres of `contacts` are placed
    there, too. Where joints are left over, contacts move in the null space of the tool's Jacobian; where none are, both
    share. With a reach of -inf it is the tool's step alone. Returns the squared error before the step, m^2.
    """
    rows = fill_jacobian(robot, target, index, descent, work)
    if reach > -math.inf:
        rows = add_contacts(robot, collision, reach, rows, contacts, work)
    return descend(ranges, descent, rows, q, work)

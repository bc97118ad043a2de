"""Damped steps that mind collisions: pairs that are too near are pushed apart while the tool goes to its target.

Every pair of components nearer than a reach adds one row to the tool's system: its smallest clearance is to grow to the
reach. Where joints are left over, the push lies in the null space of the tool's Jacobian; where none are, both share.
"""

import math

import numpy as np

from ikde.kernels.arrays import BODY, COORDINATE, FIRST, LAST, PARENT, SLIDES
from ikde.kernels.clearance import bounds_are_apart
from ikde.kernels.damped import descend, fill_jacobian
from ikde.kernels.jit import inline_kernel, kernel

MOST_CONTACTS = 6  # pairs pushed apart in one step: the deepest


@inline_kernel
def find_contact(detector, centres, a, b):
    """Smallest distance - R_i - R_j between two components in m, and its spheres i, j."""
    smallest, first, second = math.inf, detector.components[a, FIRST], detector.components[b, FIRST]
    for i in range(detector.components[a, FIRST], detector.components[a, LAST]):
        for j in range(detector.components[b, FIRST], detector.components[b, LAST]):
            dx, dy, dz = (
                centres[0, i] - centres[0, j],
                centres[1, i] - centres[1, j],
                centres[2, i] - centres[2, j],
            )
            gap = math.sqrt(dx * dx + dy * dy + dz * dz) - detector.radius[i] - detector.radius[j]
            if gap < smallest:
                smallest, first, second = gap, i, j
    return smallest, first, second


@inline_kernel
def add_chain(robot, T_world_body, body, x, y, z, nx, ny, nz, out_row):
    """Add d(n . p)/dq to `out_row` [N] for the point p = (x, y, z) of `body`: z . n, or (z x (p - p_joint)) . n."""
    body = np.int64(body)
    while body != 0:
        T, column = T_world_body[body], robot.bodies[body, COORDINATE]
        ax, ay, az = T[0, 2], T[1, 2], T[2, 2]
        if robot.bodies[body, SLIDES] == 1:
            out_row[column] += ax * nx + ay * ny + az * nz
        else:
            dx, dy, dz = x - T[0, 3], y - T[1, 3], z - T[2, 3]
            out_row[column] += (ay * dz - az * dy) * nx + (az * dx - ax * dz) * ny + (ax * dy - ay * dx) * nz
        body = robot.bodies[body, PARENT]


@inline_kernel
def fill_contact(robot, detector, T_world_body, centres, a, b, i, j, out_row):
    """Gradient of the distance between spheres i of component a and j of b by the joints, into `out_row` [N]."""
    for k in range(out_row.size):
        out_row[k] = 0.0
    x, y, z = centres[0, i] - centres[0, j], centres[1, i] - centres[1, j], centres[2, i] - centres[2, j]
    distance = math.sqrt(x * x + y * y + z * z)
    if distance == 0.0:
        return
    x, y, z = x / distance, y / distance, z / distance
    body_a, body_b = detector.components[a, BODY], detector.components[b, BODY]
    add_chain(robot, T_world_body, body_a, centres[0, i], centres[1, i], centres[2, i], x, y, z, out_row)
    add_chain(robot, T_world_body, body_b, centres[0, j], centres[1, j], centres[2, j], -x, -y, -z, out_row)


@kernel
def add_contacts(robot, detector, reach, rows, bounds, centres, work):
    """Append a row for each pair nearer than `reach` (m) to Jacobian and error in `work`; returns the rows in use.

    Of more pairs than fit, those that are deepest stay.
    """
    first = rows
    for pair in range(detector.pairs.shape[0]):
        a, b = detector.pairs[pair, 0], detector.pairs[pair, 1]
        if bounds_are_apart(detector, bounds, a, b, reach):
            continue
        gap, i, j = find_contact(detector, centres, a, b)
        if gap >= reach:
            continue
        row = rows
        if rows == work.error.size:
            row = first
            for other in range(first + 1, rows):
                if work.error[other] < work.error[row]:
                    row = other
            if reach - gap <= work.error[row]:
                continue
        else:
            rows += 1
        fill_contact(robot, detector, work.T_world_body, centres, a, b, i, j, work.jacobian[row])
        work.error[row] = reach - gap
    return rows


@inline_kernel
def clear_step(robot, detector, target, index, ranges, descent, reach, bounds, centres, q, work):
    """One damped step on `q` [N], in place, towards the target and away from contact.

    `work`, a `DescentWorkspace`, holds the poses and the tool's error at `q`; `bounds` [C, 3] and `centres` [3, S] are
    those of `q`. Pairs nearer than `reach` (m) are pushed apart; with a reach of -inf it is the tool's step alone.
    Returns the squared error before the step, m^2.
    """
    rows = fill_jacobian(robot, target, index, descent, work)
    if reach > -math.inf:
        rows = add_contacts(robot, detector, reach, rows, bounds, centres, work)
    return descend(ranges, descent, rows, q, work)

"""One step of the descent of `kernels/least_motion.py`: Newton's, in the null space of the tool, within constraints.

A step is along + Z u: what brings the tool onto its target, and a motion that leaves it there. Minimised is
|y + step|^2 / 2 less what the tool's rows bend, times their multipliers. With its Hessian Z^T (I - bend) Z = L L^T and
the point L^T u, the least within joint ranges and contacts is the nearest point of a polytope
(`kernels/dual_active_set.py`).
"""

import math
from typing import NamedTuple

import numpy as np

from ikde.kernels.arrays import Floats, Ints
from ikde.kernels.clearance import find_colliding_pair
from ikde.kernels.contacts import Contacts, fill_gradient, find_contacts, make_contacts
from ikde.kernels.dual_active_set import HalfSpaces, find_nearest_point, make_half_spaces
from ikde.kernels.jit import inline_kernel, kernel, leaf_kernel
from ikde.kernels.spheres import compute_bounds, compute_centres
from ikde.kernels.tool_tangent import (
    Tangent,
    apply,
    apply_transposed,
    make_tangent,
    set_multipliers,
    solve_along,
)

MIN_PIVOT = 0.1  # of the reduced Hessian, which is 1 where the tool moves straight
MAX_CONTACTS = 12
REACH = 0.1  # m beyond the safe distance: nearer pairs are constrained
INSIDE = 2e-9  # m beyond the safe distance: where contacts are set, so that rounding and bend leave them free
DOUBT, MOST_DOUBT = 2.0, 100.0
DOWNHILL = 0.05  # how much of the square of a step it shall win at least
MIN_SLOPE = 1e-9  # below it no step along the null space changes a constraint


class MotionWork(NamedTuple):
    """Room for the numbers of a descent."""

    tangent: Tangent
    y: Floats  # [N] the motion so far, of the joints that move
    split: Floats  # [N] Q^T y
    behind: Floats  # [N] the motion that takes away the error behind a step
    step: Floats  # [N]
    q: Floats  # [N] where the descent stands
    trial: Floats  # [N]
    best: Floats  # [N]
    hessian: Floats  # [N, N] in the null space, then its Cholesky factor
    gradient: Floats  # [N] in the null space
    free_point: Floats  # [N] the minimum without constraints, in coordinates in which the Hessian is 1
    point: Floats  # [N] the minimum within them
    product: Floats  # [N]
    row: Floats  # [N]
    slope: Floats  # [MAX_CONTACTS, N] of the gaps
    slack: Floats  # [MAX_CONTACTS] m
    pair: Ints  # [MAX_CONTACTS]
    length: Floats  # [2 N + MAX_CONTACTS] of the normals of the half spaces
    owner: Ints  # [2 N + MAX_CONTACTS] 2 k and 2 k + 1: lower and upper end of joint k; beyond: contacts
    contacts: Contacts
    spaces: HalfSpaces


@kernel
def make_motion_work(robot, collision, joints):
    """Room for a robot and a collision model."""
    return MotionWork(
        make_tangent(robot, joints),
        np.empty(joints),
        np.empty(joints),
        np.empty(joints),
        np.empty(joints),
        np.empty(joints),
        np.empty(joints),
        np.empty(joints),
        np.empty((joints, joints)),
        np.empty(joints),
        np.empty(joints),
        np.empty(joints),
        np.empty(joints),
        np.empty(joints),
        np.empty((MAX_CONTACTS, joints)),
        np.empty(MAX_CONTACTS),
        np.empty(MAX_CONTACTS, dtype=np.int64),
        np.empty(2 * joints + MAX_CONTACTS),
        np.empty(2 * joints + MAX_CONTACTS, dtype=np.int64),
        make_contacts(np.empty((collision.components.shape[0], 3)), np.empty((3, collision.radius.size)), MAX_CONTACTS),
        make_half_spaces(2 * joints + MAX_CONTACTS, joints),
    )


@inline_kernel
def set_motion(weight, near, q, count, work):
    """The weighed motion from `near` to `q` [N] of the joints that move, into `y`."""
    for k in range(count):
        joint = work.tangent.moving[k]
        work.y[k] = weight[joint] * (q[joint] - near[joint])


@inline_kernel
def square_motion(weight, near, q, count, work):
    """Square of the weighed motion from `near` to `q` [N] of the joints that move."""
    total = 0.0
    for k in range(count):
        joint = work.tangent.moving[k]
        moved = weight[joint] * (q[joint] - near[joint])
        total += moved * moved
    return total


@inline_kernel
def is_free(collision, work):
    """Whether the poses in `work` are free of collision; the spheres are placed there."""
    contacts = work.contacts
    compute_bounds(collision, work.tangent.T_world_body, contacts.bounds)
    compute_centres(collision, work.tangent.T_world_body, contacts.centres)
    return find_colliding_pair(collision, contacts.bounds, contacts.centres) < 0


@inline_kernel
def split_motion(work, rank, count):
    """Q^T y, into `split`."""
    for k in range(count):
        work.split[k] = work.y[k]
    apply_transposed(work.tangent, rank, count, work.split)


@inline_kernel
def judge_place(work, rank, used, square, doubt):
    """What a place is worth, by the split and the multipliers at hand, and the square of what its error takes away.

    |y|^2, `square`, is corrected by what taking the tool's error away costs: to first order by the multipliers, and by
    `doubt` times the square of that motion, since more than the first order is not known.
    """
    tangent, behind, cost = work.tangent, 0.0, 0.0
    solve_along(tangent, rank, work.behind)
    for k in range(rank):
        behind += work.behind[k] * work.behind[k]
    for i in range(used):
        cost += tangent.multipliers[i] * tangent.error[i]
    return square + 2.0 * cost + doubt * behind, behind


@inline_kernel
def choose_doubt(work, used, count):
    """So much doubt that the step is downhill by a share of its square."""
    slope, square, behind = 0.0, 0.0, 0.0
    for k in range(count):
        slope += work.y[k] * work.step[k]
        square += work.step[k] * work.step[k]
        behind += work.tangent.along[k] * work.tangent.along[k]
    for i in range(used):
        slope -= work.tangent.multipliers[i] * work.tangent.error[i]
    lacking = slope + DOWNHILL * square
    return min(DOUBT + lacking / behind, MOST_DOUBT) if lacking > 0.0 and behind > 0.0 else DOUBT


@inline_kernel
def fill_hessian(work, rank, count, carrying):
    """Upper triangle of Z^T (I - bend) Z, and its diagonal in `product`."""
    tangent, size = work.tangent, count - rank
    for b in range(size):
        for j in range(carrying):
            total = 0.0
            for k in range(carrying):
                total += tangent.bend[j, k] * tangent.null[b, k]
            work.row[j] = total
        for a in range(b + 1):
            total = 1.0 if a == b else 0.0
            for j in range(carrying):
                total -= tangent.null[a, j] * work.row[j]
            if a == b:
                work.product[a] = total
            else:
                work.hessian[a, b] = total


@inline_kernel
def factor_hessian(work, size):
    """Cholesky factor of the reduced Hessian, into its lower triangle; what bends the wrong way counts as straight.

    Returns whether anything does.
    """
    is_bent = False
    for row in range(size):
        pivot = work.product[row]
        for b in range(row):
            total = work.hessian[b, row]
            for k in range(b):
                total -= work.hessian[row, k] * work.hessian[b, k]
            work.hessian[row, b] = total / work.hessian[b, b]
            pivot -= work.hessian[row, b] * work.hessian[row, b]
        if pivot < MIN_PIVOT:
            is_bent, pivot = True, max(1.0, -pivot)
        work.hessian[row, row] = math.sqrt(pivot)
    return is_bent


@inline_kernel
def whiten(work, size, x):
    """L^-1 x, in place, with the Cholesky factor L."""
    for a in range(size):
        for k in range(a):
            x[a] -= work.hessian[a, k] * x[k]
        x[a] /= work.hessian[a, a]


@inline_kernel
def apply_bend(work, carrying, x, out_x):
    """The bend times a motion `x` [n], of the joints that carry the tool."""
    for j in range(carrying):
        out_x[j] = 0.0
        for k in range(carrying):
            out_x[j] += work.tangent.bend[j, k] * x[k]


@inline_kernel
def set_free_point(work, rank, count, carrying):
    """The minimum without constraints: -L^-1 Z^T (y - bend along)."""
    tangent, size = work.tangent, count - rank
    solve_along(tangent, rank, tangent.along)
    for k in range(rank, count):
        tangent.along[k] = 0.0
    apply(tangent, rank, count, tangent.along)
    apply_bend(work, carrying, tangent.along, work.row)
    for a in range(size):
        work.free_point[a] = -work.split[rank + a]
        for j in range(carrying):
            work.free_point[a] += tangent.null[a, j] * work.row[j]
    whiten(work, size, work.free_point)


@inline_kernel
def set_step(work, rank, count):
    """The step [n] of `point`: along + Z L^-T point."""
    tangent, size = work.tangent, count - rank
    for a in range(size - 1, -1, -1):
        total = work.point[a]
        for k in range(a + 1, size):
            total -= work.hessian[k, a] * work.product[k]
        work.product[a] = total / work.hessian[a, a]
    for k in range(count):
        work.step[k] = tangent.along[k]
        for a in range(size):
            work.step[k] += work.product[a] * tangent.null[a, k]


@inline_kernel
def stays_inside(ranges, weight, work, count):
    """Whether the step stays in the joint ranges."""
    for k in range(count):
        joint = work.tangent.moving[k]
        end = work.q[joint] + work.step[k] / weight[joint]
        if end < ranges[0, joint] or end > ranges[1, joint]:
            return False
    return True


@inline_kernel
def add_half_space(work, size, offset, owner, at):
    """The half space row . u >= offset of the null space's coordinates u as number `at`; returns how many then."""
    spaces, square = work.spaces, 0.0
    whiten(work, size, work.row)
    for a in range(size):
        square += work.row[a] * work.row[a]
    length = math.sqrt(square)
    if length < MIN_SLOPE:
        return at
    for a in range(work.row.size):
        spaces.normals[at, a] = work.row[a] / length if a < size else 0.0
    spaces.offsets[at] = offset / length
    work.length[at], work.owner[at] = length, owner
    return at + 1


@inline_kernel
def fill_half_spaces(ranges, weight, largest, work, rank, count, contacts):
    """Contacts, and the ends of joint ranges nearer than `largest` (m or rad), as half spaces; returns how many."""
    tangent, size, at = work.tangent, count - rank, 0
    for k in range(count):
        joint = tangent.moving[k]
        for side in range(2):
            sign = 1.0 - 2.0 * side
            for a in range(size):
                work.row[a] = sign * tangent.null[a, k]
            room = sign * (ranges[side, joint] - work.q[joint])
            if room > -largest:
                offset = weight[joint] * room - sign * tangent.along[k]
                at = add_half_space(work, size, offset, 2 * k + side, at)
    for i in range(contacts):
        offset = -work.slack[i]
        for k in range(count):
            offset -= work.slope[i, k] * tangent.along[k]
        for a in range(size):
            work.row[a] = 0.0
            for k in range(count):
                work.row[a] += tangent.null[a, k] * work.slope[i, k]
        at = add_half_space(work, size, offset, 2 * count + i, at)
    return at


@inline_kernel
def constrain_point(ranges, weight, largest, work, rank, count, contacts):
    """Move `point` to the nearest one from which all constraints are met; False if there is none."""
    spaces = fill_half_spaces(ranges, weight, largest, work, rank, count, contacts)
    for a in range(work.point.size):
        work.point[a] = work.free_point[a] if a < count - rank else 0.0
    return find_nearest_point(work.spaces, spaces, work.point)


@inline_kernel
def update_multipliers(work, rank, used, count, carrying, is_bound):
    """Multipliers of the target's rows behind the step: what constraints leave of y + step - bend step."""
    tangent, spaces = work.tangent, work.spaces
    apply_bend(work, carrying, work.step, work.row)
    for k in range(count):
        work.split[k] = work.y[k] + work.step[k]
        if k < carrying:
            work.split[k] -= work.row[k]
    active = 0
    while is_bound and spaces.active[active] >= 0:
        number = spaces.active[active]
        force, owner = spaces.multipliers[active] / work.length[number], work.owner[number]
        if owner < 2 * count:
            work.split[owner // 2] -= force * (1.0 - 2.0 * (owner % 2))
        else:
            for k in range(count):
                work.split[k] -= force * work.slope[owner - 2 * count, k]
        active += 1
    apply_transposed(tangent, rank, count, work.split)
    set_multipliers(tangent, rank, used, work.split)


@leaf_kernel
def list_contacts(robot, collision, weight, work, count):
    """Slack and weighed slope of the pairs that are near at the poses in `work`; returns how many."""
    margin = collision.safe_distance + INSIDE
    found = find_contacts(collision, margin + REACH, MAX_CONTACTS, work.contacts)
    for i in range(found):
        fill_gradient(robot, collision, work.tangent.T_world_body, work.contacts, i, work.row)
        work.slack[i], work.pair[i] = work.contacts.gap[i] - margin, work.contacts.spheres[i, 0]
        for k in range(count):
            joint = work.tangent.moving[k]
            work.slope[i, k] = work.row[joint] / weight[joint]
    return found

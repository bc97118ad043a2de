"""One step of the descent of `kernels/least_motion.py`: Newton's, in the null space of the tool, within constraints.

A step is along + Z u: what brings the tool onto its target, and a motion that leaves it there. Minimised is
|y + step|^2 / 2 less what the tool's rows bend, times their multipliers. With its Hessian Z^T (I - bend) Z = L L^T and
the point L^T u, the least within joint ranges and contacts is the nearest point of a polytope
(`kernels/dual_active_set.py`).
"""

import math

import numpy as np

from ikde.kernels.clearance import find_colliding_pair
from ikde.kernels.contacts import fill_gradient, find_contacts
from ikde.kernels.dual_active_set import find_nearest_point
from ikde.kernels.jit import inline_kernel, leaf_kernel
from ikde.kernels.motion_work import (
    ALONG,
    BEHIND,
    BEND,
    ERROR,
    FREE_POINT,
    HERE,
    HESSIAN,
    MAX_CONTACTS,
    MOVING,
    MULTIPLIER,
    NULL,
    PAIR,
    POINT,
    PRODUCT,
    ROW,
    SLACK,
    SLOPE,
    SPLIT,
    STEP,
    Y,
)
from ikde.kernels.spheres import compute_bounds, compute_centres
from ikde.kernels.tool_tangent import (
    apply,
    apply_transposed,
    set_multipliers,
    solve_along,
)

MIN_PIVOT = 0.1  # of the reduced Hessian, which is 1 where the tool moves straight
REACH = 0.1  # m beyond the safe distance: nearer pairs are constrained
INSIDE = 2e-9  # m beyond the safe distance: where contacts are set, so that rounding and bend leave them free
FIRST_SHIFT = 0.125  # of its diagonal, where it is less
DOUBT, MAX_DOUBT = 2.0, 100.0
DOWNHILL = 0.05  # how much of the square of a step it shall win at least
MIN_SLOPE = 1e-9  # below it no step along the null space changes a constraint


@inline_kernel
def set_motion(weight, near, q, count, tables):
    """The weighed motion from `near` to `q` [N] of the joints that move, into `y`."""
    for k in range(count):
        joint = tables.whole[MOVING, k]
        tables.vectors[Y, k] = weight[joint] * (q[joint] - near[joint])


@inline_kernel
def square_motion(weight, near, q, count, tables):
    """Square of the weighed motion from `near` to `q` [N] of the joints that move."""
    total = 0.0
    for k in range(count):
        joint = tables.whole[MOVING, k]
        moved = weight[joint] * (q[joint] - near[joint])
        total += moved * moved
    return total


@leaf_kernel
def is_free(collision, work):
    """Whether the poses in `work` are free of collision; the spheres are placed there."""
    contacts = work.contacts
    compute_bounds(collision, work.tables.T_world_body, contacts.bounds)
    compute_centres(collision, work.tables.T_world_body, contacts.centres)
    return find_colliding_pair(collision, contacts.bounds, contacts.centres) < 0


@inline_kernel
def split_motion(tables, rank, count):
    """Q^T y, into `split`."""
    for k in range(count):
        tables.vectors[SPLIT, k] = tables.vectors[Y, k]
    apply_transposed(tables, rank, count, tables.vectors[SPLIT])


@inline_kernel
def judge_place(tables, rank, used, square, doubt):
    """What a place is worth, by the split and the multipliers at hand, and the square of what its error takes away.

    |y|^2, `square`, is corrected by what taking the tool's error away costs: to first order by the multipliers, and by
    `doubt` times the square of that motion, since more than the first order is not known.
    """
    behind, cost = 0.0, 0.0
    solve_along(tables, rank, tables.vectors[BEHIND])
    for k in range(rank):
        behind += tables.vectors[BEHIND, k] * tables.vectors[BEHIND, k]
    for i in range(used):
        cost += tables.numbers[MULTIPLIER, i] * tables.numbers[ERROR, i]
    return square + 2.0 * cost + doubt * behind, behind


@inline_kernel
def choose_doubt(tables, used, count):
    """So much doubt that the step is downhill by a share of its square."""
    slope, square, behind = 0.0, 0.0, 0.0
    for k in range(count):
        slope += tables.vectors[Y, k] * tables.vectors[STEP, k]
        square += tables.vectors[STEP, k] * tables.vectors[STEP, k]
        behind += tables.vectors[ALONG, k] * tables.vectors[ALONG, k]
    for i in range(used):
        slope -= tables.numbers[MULTIPLIER, i] * tables.numbers[ERROR, i]
    lacking = slope + DOWNHILL * square
    return min(DOUBT + lacking / behind, MAX_DOUBT) if lacking > 0.0 and behind > 0.0 else DOUBT


@inline_kernel
def fill_hessian(tables, rank, count, carrying):
    """Upper triangle of Z^T (I - bend) Z, and its diagonal in `product`."""
    size = count - rank
    for b in range(size):
        for j in range(carrying):
            total = 0.0
            for k in range(carrying):
                total += tables.matrices[BEND, j, k] * tables.matrices[NULL, b, k]
            tables.vectors[ROW, j] = total
        for a in range(b + 1):
            total = 1.0 if a == b else 0.0
            for j in range(carrying):
                total -= tables.matrices[NULL, a, j] * tables.vectors[ROW, j]
            if a == b:
                tables.vectors[PRODUCT, a] = total
            else:
                tables.matrices[HESSIAN, a, b] = total


@inline_kernel
def factor_hessian(tables, size):
    """Cholesky factor of the reduced Hessian, into its lower triangle; its diagonal grows until it is definite.

    Returns whether it had to.
    """
    shift, row = 0.0, 0
    while row < size:
        pivot = tables.vectors[PRODUCT, row] + shift
        for b in range(row):
            total = tables.matrices[HESSIAN, b, row]
            for k in range(b):
                total -= tables.matrices[HESSIAN, row, k] * tables.matrices[HESSIAN, b, k]
            tables.matrices[HESSIAN, row, b] = total / tables.matrices[HESSIAN, b, b]
            pivot -= tables.matrices[HESSIAN, row, b] * tables.matrices[HESSIAN, row, b]
        if pivot < MIN_PIVOT:
            shift, row = max(2.0 * shift, FIRST_SHIFT), 0
        else:
            tables.matrices[HESSIAN, row, row] = math.sqrt(pivot)
            row += 1
    return shift > 0.0


@inline_kernel
def whiten(tables, size, x):
    """L^-1 x, in place, with the Cholesky factor L."""
    for a in range(size):
        for k in range(a):
            x[a] -= tables.matrices[HESSIAN, a, k] * x[k]
        x[a] /= tables.matrices[HESSIAN, a, a]


@inline_kernel
def apply_bend(tables, carrying, x, out_x):
    """The bend times a motion `x` [n], of the joints that carry the tool."""
    for j in range(carrying):
        out_x[j] = 0.0
        for k in range(carrying):
            out_x[j] += tables.matrices[BEND, j, k] * x[k]


@inline_kernel
def set_free_point(tables, rank, count, carrying):
    """The minimum without constraints: -L^-1 Z^T (y - bend along)."""
    size = count - rank
    solve_along(tables, rank, tables.vectors[ALONG])
    for k in range(rank, count):
        tables.vectors[ALONG, k] = 0.0
    apply(tables, rank, count, tables.vectors[ALONG])
    apply_bend(tables, carrying, tables.vectors[ALONG], tables.vectors[ROW])
    for a in range(size):
        tables.vectors[FREE_POINT, a] = -tables.vectors[SPLIT, rank + a]
        for j in range(carrying):
            tables.vectors[FREE_POINT, a] += tables.matrices[NULL, a, j] * tables.vectors[ROW, j]
    whiten(tables, size, tables.vectors[FREE_POINT])


@inline_kernel
def set_step(tables, rank, count):
    """The step [n] of `point`: along + Z L^-T point."""
    size = count - rank
    for a in range(size - 1, -1, -1):
        total = tables.vectors[POINT, a]
        for k in range(a + 1, size):
            total -= tables.matrices[HESSIAN, k, a] * tables.vectors[PRODUCT, k]
        tables.vectors[PRODUCT, a] = total / tables.matrices[HESSIAN, a, a]
    for k in range(count):
        tables.vectors[STEP, k] = tables.vectors[ALONG, k]
        for a in range(size):
            tables.vectors[STEP, k] += tables.vectors[PRODUCT, a] * tables.matrices[NULL, a, k]


@inline_kernel
def stays_inside(ranges, weight, tables, count):
    """Whether the step stays in the joint ranges."""
    for k in range(count):
        joint = tables.whole[MOVING, k]
        end = tables.vectors[HERE, joint] + tables.vectors[STEP, k] / weight[joint]
        if end < ranges[0, joint] or end > ranges[1, joint]:
            return False
    return True


@leaf_kernel
def add_half_space(work, size, offset, owner, at):
    """The half space row . u >= offset of the null space's coordinates u as number `at`; returns how many then."""
    spaces, square = work.spaces, 0.0
    whiten(work.tables, size, work.tables.vectors[ROW])
    for a in range(size):
        square += work.tables.vectors[ROW, a] * work.tables.vectors[ROW, a]
    length = math.sqrt(square)
    if length < MIN_SLOPE:
        return at
    for a in range(work.tables.vectors.shape[1]):
        spaces.normals[at, a] = work.tables.vectors[ROW, a] / length if a < size else 0.0
    spaces.offsets[at] = offset / length
    work.tables.length[at], work.tables.owner[at] = length, owner
    return at + 1


@inline_kernel
def fill_half_spaces(ranges, weight, largest, work, rank, count, contacts):
    """Contacts, and the ends of joint ranges nearer than `largest` (m or rad), as half spaces; returns how many."""
    size, at = count - rank, np.int64(0)  # a literal would be compiled into functions of its own
    for k in range(count):
        joint = work.tables.whole[MOVING, k]
        for side in range(2):
            sign = 1.0 - 2.0 * side
            for a in range(size):
                work.tables.vectors[ROW, a] = sign * work.tables.matrices[NULL, a, k]
            room = sign * (ranges[side, joint] - work.tables.vectors[HERE, joint])
            if room > -largest:
                offset = weight[joint] * room - sign * work.tables.vectors[ALONG, k]
                at = add_half_space(work, size, offset, 2 * k + side, at)
    for i in range(contacts):
        offset = -work.tables.numbers[SLACK, i]
        for k in range(count):
            offset -= work.tables.vectors[SLOPE + i, k] * work.tables.vectors[ALONG, k]
        for a in range(size):
            work.tables.vectors[ROW, a] = 0.0
            for k in range(count):
                work.tables.vectors[ROW, a] += work.tables.matrices[NULL, a, k] * work.tables.vectors[SLOPE + i, k]
        at = add_half_space(work, size, offset, 2 * count + i, at)
    return at


@inline_kernel
def constrain_point(ranges, weight, largest, work, rank, count, contacts):
    """Move `point` to the nearest one from which all constraints are met; False if there is none."""
    spaces = fill_half_spaces(ranges, weight, largest, work, rank, count, contacts)
    for a in range(work.tables.vectors.shape[1]):
        work.tables.vectors[POINT, a] = work.tables.vectors[FREE_POINT, a] if a < count - rank else 0.0
    return find_nearest_point(work.spaces, spaces, work.tables.vectors[POINT])


@inline_kernel
def update_multipliers(work, rank, used, count, carrying, is_bound):
    """Multipliers of the target's rows behind the step: what constraints leave of y + step - bend step."""
    spaces = work.spaces
    apply_bend(work.tables, carrying, work.tables.vectors[STEP], work.tables.vectors[ROW])
    for k in range(count):
        work.tables.vectors[SPLIT, k] = work.tables.vectors[Y, k] + work.tables.vectors[STEP, k]
        if k < carrying:
            work.tables.vectors[SPLIT, k] -= work.tables.vectors[ROW, k]
    active = 0
    while is_bound and spaces.active[active] >= 0:
        number = spaces.active[active]
        force, owner = spaces.multipliers[active] / work.tables.length[number], work.tables.owner[number]
        if owner < 2 * count:
            work.tables.vectors[SPLIT, owner // 2] -= force * (1.0 - 2.0 * (owner % 2))
        else:
            for k in range(count):
                work.tables.vectors[SPLIT, k] -= force * work.tables.vectors[SLOPE + owner - 2 * count, k]
        active += 1
    apply_transposed(work.tables, rank, count, work.tables.vectors[SPLIT])
    set_multipliers(work.tables, rank, used, work.tables.vectors[SPLIT])


@leaf_kernel
def list_contacts(robot, collision, weight, work, count):
    """Slack and weighed slope of the pairs that are near at the poses in `work`; returns how many."""
    margin = collision.safe_distance + INSIDE
    found = find_contacts(collision, margin + REACH, MAX_CONTACTS, work.contacts)
    for i in range(found):
        fill_gradient(robot, collision, work.tables.T_world_body, work.contacts, i, work.tables.vectors[ROW])
        work.tables.numbers[SLACK, i], work.tables.whole[PAIR, i] = (
            work.contacts.gap[i] - margin,
            work.contacts.spheres[i, 0],
        )
        for k in range(count):
            joint = work.tables.whole[MOVING, k]
            work.tables.vectors[SLOPE + i, k] = work.tables.vectors[ROW, joint] / weight[joint]
    return found

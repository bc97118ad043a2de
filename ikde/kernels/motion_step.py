"""One step of the descent of `kernels/least_motion.py`: Newton's, in the null space of the tool, within constraints.

A step is along + Z u: what brings the tool onto its target, and a motion that leaves it there. Minimised is
|y + step|^2 / 2 less what the tool's rows bend, times their multipliers. With its Hessian Z^T (I - bend) Z = L L^T and
the point L^T u, the least within joint ranges and contacts is the nearest point of a polytope
(`kernels/dual_active_set.py`).
"""

import math

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
DOUBT, MOST_DOUBT = 2.0, 100.0
DOWNHILL = 0.05  # how much of the square of a step it shall win at least
MIN_SLOPE = 1e-9  # below it no step along the null space changes a constraint


@inline_kernel
def set_motion(weight, near, q, count, work):
    """The weighed motion from `near` to `q` [N] of the joints that move, into `y`."""
    for k in range(count):
        joint = work.whole[MOVING, k]
        work.vectors[Y, k] = weight[joint] * (q[joint] - near[joint])


@inline_kernel
def square_motion(weight, near, q, count, work):
    """Square of the weighed motion from `near` to `q` [N] of the joints that move."""
    total = 0.0
    for k in range(count):
        joint = work.whole[MOVING, k]
        moved = weight[joint] * (q[joint] - near[joint])
        total += moved * moved
    return total


@leaf_kernel
def is_free(collision, work):
    """Whether the poses in `work` are free of collision; the spheres are placed there."""
    contacts = work.contacts
    compute_bounds(collision, work.T_world_body, contacts.bounds)
    compute_centres(collision, work.T_world_body, contacts.centres)
    return find_colliding_pair(collision, contacts.bounds, contacts.centres) < 0


@inline_kernel
def split_motion(work, rank, count):
    """Q^T y, into `split`."""
    for k in range(count):
        work.vectors[SPLIT, k] = work.vectors[Y, k]
    apply_transposed(work, rank, count, work.vectors[SPLIT])


@inline_kernel
def judge_place(work, rank, used, square, doubt):
    """What a place is worth, by the split and the multipliers at hand, and the square of what its error takes away.

    |y|^2, `square`, is corrected by what taking the tool's error away costs: to first order by the multipliers, and by
    `doubt` times the square of that motion, since more than the first order is not known.
    """
    behind, cost = 0.0, 0.0
    solve_along(work, rank, work.vectors[BEHIND])
    for k in range(rank):
        behind += work.vectors[BEHIND, k] * work.vectors[BEHIND, k]
    for i in range(used):
        cost += work.numbers[MULTIPLIER, i] * work.numbers[ERROR, i]
    return square + 2.0 * cost + doubt * behind, behind


@inline_kernel
def choose_doubt(work, used, count):
    """So much doubt that the step is downhill by a share of its square."""
    slope, square, behind = 0.0, 0.0, 0.0
    for k in range(count):
        slope += work.vectors[Y, k] * work.vectors[STEP, k]
        square += work.vectors[STEP, k] * work.vectors[STEP, k]
        behind += work.vectors[ALONG, k] * work.vectors[ALONG, k]
    for i in range(used):
        slope -= work.numbers[MULTIPLIER, i] * work.numbers[ERROR, i]
    lacking = slope + DOWNHILL * square
    return min(DOUBT + lacking / behind, MOST_DOUBT) if lacking > 0.0 and behind > 0.0 else DOUBT


@inline_kernel
def fill_hessian(work, rank, count, carrying):
    """Upper triangle of Z^T (I - bend) Z, and its diagonal in `product`."""
    size = count - rank
    for b in range(size):
        for j in range(carrying):
            total = 0.0
            for k in range(carrying):
                total += work.matrices[BEND, j, k] * work.matrices[NULL, b, k]
            work.vectors[ROW, j] = total
        for a in range(b + 1):
            total = 1.0 if a == b else 0.0
            for j in range(carrying):
                total -= work.matrices[NULL, a, j] * work.vectors[ROW, j]
            if a == b:
                work.vectors[PRODUCT, a] = total
            else:
                work.matrices[HESSIAN, a, b] = total


@inline_kernel
def factor_hessian(work, size):
    """Cholesky factor of the reduced Hessian, into its lower triangle; its diagonal grows until it is definite.

    Returns whether it had to.
    """
    shift, row = 0.0, 0
    while row < size:
        pivot = work.vectors[PRODUCT, row] + shift
        for b in range(row):
            total = work.matrices[HESSIAN, b, row]
            for k in range(b):
                total -= work.matrices[HESSIAN, row, k] * work.matrices[HESSIAN, b, k]
            work.matrices[HESSIAN, row, b] = total / work.matrices[HESSIAN, b, b]
            pivot -= work.matrices[HESSIAN, row, b] * work.matrices[HESSIAN, row, b]
        if pivot < MIN_PIVOT:
            shift, row = max(2.0 * shift, FIRST_SHIFT), 0
        else:
            work.matrices[HESSIAN, row, row] = math.sqrt(pivot)
            row += 1
    return shift > 0.0


@inline_kernel
def whiten(work, size, x):
    """L^-1 x, in place, with the Cholesky factor L."""
    for a in range(size):
        for k in range(a):
            x[a] -= work.matrices[HESSIAN, a, k] * x[k]
        x[a] /= work.matrices[HESSIAN, a, a]


@inline_kernel
def apply_bend(work, carrying, x, out_x):
    """The bend times a motion `x` [n], of the joints that carry the tool."""
    for j in range(carrying):
        out_x[j] = 0.0
        for k in range(carrying):
            out_x[j] += work.matrices[BEND, j, k] * x[k]


@inline_kernel
def set_free_point(work, rank, count, carrying):
    """The minimum without constraints: -L^-1 Z^T (y - bend along)."""
    size = count - rank
    solve_along(work, rank, work.vectors[ALONG])
    for k in range(rank, count):
        work.vectors[ALONG, k] = 0.0
    apply(work, rank, count, work.vectors[ALONG])
    apply_bend(work, carrying, work.vectors[ALONG], work.vectors[ROW])
    for a in range(size):
        work.vectors[FREE_POINT, a] = -work.vectors[SPLIT, rank + a]
        for j in range(carrying):
            work.vectors[FREE_POINT, a] += work.matrices[NULL, a, j] * work.vectors[ROW, j]
    whiten(work, size, work.vectors[FREE_POINT])


@inline_kernel
def set_step(work, rank, count):
    """The step [n] of `point`: along + Z L^-T point."""
    size = count - rank
    for a in range(size - 1, -1, -1):
        total = work.vectors[POINT, a]
        for k in range(a + 1, size):
            total -= work.matrices[HESSIAN, k, a] * work.vectors[PRODUCT, k]
        work.vectors[PRODUCT, a] = total / work.matrices[HESSIAN, a, a]
    for k in range(count):
        work.vectors[STEP, k] = work.vectors[ALONG, k]
        for a in range(size):
            work.vectors[STEP, k] += work.vectors[PRODUCT, a] * work.matrices[NULL, a, k]


@inline_kernel
def stays_inside(ranges, weight, work, count):
    """Whether the step stays in the joint ranges."""
    for k in range(count):
        joint = work.whole[MOVING, k]
        end = work.vectors[HERE, joint] + work.vectors[STEP, k] / weight[joint]
        if end < ranges[0, joint] or end > ranges[1, joint]:
            return False
    return True


@leaf_kernel
def add_half_space(work, size, offset, owner, at):
    """The half space row . u >= offset of the null space's coordinates u as number `at`; returns how many then."""
    spaces, square = work.spaces, 0.0
    whiten(work, size, work.vectors[ROW])
    for a in range(size):
        square += work.vectors[ROW, a] * work.vectors[ROW, a]
    length = math.sqrt(square)
    if length < MIN_SLOPE:
        return at
    for a in range(work.vectors.shape[1]):
        spaces.normals[at, a] = work.vectors[ROW, a] / length if a < size else 0.0
    spaces.offsets[at] = offset / length
    work.length[at], work.owner[at] = length, owner
    return at + 1


@inline_kernel
def fill_half_spaces(ranges, weight, largest, work, rank, count, contacts):
    """Contacts, and the ends of joint ranges nearer than `largest` (m or rad), as half spaces; returns how many."""
    size, at = count - rank, 0
    for k in range(count):
        joint = work.whole[MOVING, k]
        for side in range(2):
            sign = 1.0 - 2.0 * side
            for a in range(size):
                work.vectors[ROW, a] = sign * work.matrices[NULL, a, k]
            room = sign * (ranges[side, joint] - work.vectors[HERE, joint])
            if room > -largest:
                offset = weight[joint] * room - sign * work.vectors[ALONG, k]
                at = add_half_space(work, size, offset, 2 * k + side, at)
    for i in range(contacts):
        offset = -work.numbers[SLACK, i]
        for k in range(count):
            offset -= work.vectors[SLOPE + i, k] * work.vectors[ALONG, k]
        for a in range(size):
            work.vectors[ROW, a] = 0.0
            for k in range(count):
                work.vectors[ROW, a] += work.matrices[NULL, a, k] * work.vectors[SLOPE + i, k]
        at = add_half_space(work, size, offset, 2 * count + i, at)
    return at


@inline_kernel
def constrain_point(ranges, weight, largest, work, rank, count, contacts):
    """Move `point` to the nearest one from which all constraints are met; False if there is none."""
    spaces = fill_half_spaces(ranges, weight, largest, work, rank, count, contacts)
    for a in range(work.vectors.shape[1]):
        work.vectors[POINT, a] = work.vectors[FREE_POINT, a] if a < count - rank else 0.0
    return find_nearest_point(work.spaces, spaces, work.vectors[POINT])


@inline_kernel
def update_multipliers(work, rank, used, count, carrying, is_bound):
    """Multipliers of the target's rows behind the step: what constraints leave of y + step - bend step."""
    spaces = work.spaces
    apply_bend(work, carrying, work.vectors[STEP], work.vectors[ROW])
    for k in range(count):
        work.vectors[SPLIT, k] = work.vectors[Y, k] + work.vectors[STEP, k]
        if k < carrying:
            work.vectors[SPLIT, k] -= work.vectors[ROW, k]
    active = 0
    while is_bound and spaces.active[active] >= 0:
        number = spaces.active[active]
        force, owner = spaces.multipliers[active] / work.length[number], work.owner[number]
        if owner < 2 * count:
            work.vectors[SPLIT, owner // 2] -= force * (1.0 - 2.0 * (owner % 2))
        else:
            for k in range(count):
                work.vectors[SPLIT, k] -= force * work.vectors[SLOPE + owner - 2 * count, k]
        active += 1
    apply_transposed(work, rank, count, work.vectors[SPLIT])
    set_multipliers(work, rank, used, work.vectors[SPLIT])


@leaf_kernel
def list_contacts(robot, collision, weight, work, count):
    """Slack and weighed slope of the pairs that are near at the poses in `work`; returns how many."""
    margin = collision.safe_distance + INSIDE
    found = find_contacts(collision, margin + REACH, MAX_CONTACTS, work.contacts)
    for i in range(found):
        fill_gradient(robot, collision, work.T_world_body, work.contacts, i, work.vectors[ROW])
        work.numbers[SLACK, i], work.whole[PAIR, i] = work.contacts.gap[i] - margin, work.contacts.spheres[i, 0]
        for k in range(count):
            joint = work.whole[MOVING, k]
            work.vectors[SLOPE + i, k] = work.vectors[ROW, joint] / weight[joint]
    return found

"""Which small motions leave the tool where it is, which bring it onto its target, and how the target bends them.

Motions are weighed: p_j = w_j dq_j. A = L Q^T splits the tool's Jacobian A = J W^-1: the first columns of Q span the
motions that move the tool, the others those that do not. Q is kept as Householder reflections [Golub2013, 5.2].
"""

import math

from ikde.kernels.arrays import AXIS, COORDINATE, MOVES_TOOL, POSE, POSITION
from ikde.kernels.damped import compute_error
from ikde.kernels.frames import compute_bodies, compute_jacobian, compute_tool
from ikde.kernels.jit import inline_kernel, leaf_kernel
from ikde.kernels.motion_work import (
    BEND,
    DIAGONAL,
    ERROR,
    JACOBIAN,
    MOVING,
    MULTIPLIER,
    NULL,
    ORDER,
    ROTATED,
    ROWS,
    SCALE,
)

MIN_RANK = 1e-7  # share of the largest row that a row must keep to count: below, the target is singular there
SOFTEST = 1e-10  # share of the square of the largest row: what a row this weak is damped by


@inline_kernel
def list_moving(robot, ranges, tables):
    """The joints that have room to move; returns how many, and how many of them carry the tool."""
    count, carrying = 0, 0
    for carries in (1, 0):
        for body in range(1, robot.bodies.shape[0]):
            joint = robot.bodies[body, COORDINATE]
            if robot.bodies[body, MOVES_TOOL] == carries and ranges[1, joint] > ranges[0, joint]:
                tables.whole[MOVING, count] = joint
                count += 1
        if carries == 1:
            carrying = count
    return count, carrying


@leaf_kernel
def place_tool(robot, target, index, length, q, tables):
    """Poses and the tool's error at `q` [N]; returns its size in m and rad.

    Of an axis target the rotation has two rows, about the tool's own x and y.
    """
    compute_bodies(robot, q, tables.T_world_body)
    compute_tool(robot, tables.T_world_body, tables.T_world_tool)
    position, orientation = compute_error(target, index, length, tables.T_world_tool, tables.numbers[ERROR])
    if target.kind[index] == AXIS:
        T, e = tables.T_world_tool, tables.numbers[ERROR]
        x = e[3] * T[0, 0] + e[4] * T[1, 0] + e[5] * T[2, 0]
        y = e[3] * T[0, 1] + e[4] * T[1, 1] + e[5] * T[2, 1]
        e[3], e[4], e[5] = x, y, 0.0
    return position, orientation


@inline_kernel
def fill_rows(robot, kind, length, weight, count, tables):
    """The weighed Jacobian's rows over the moving joints; returns how many rows the target needs."""
    J, T, rows = tables.vectors[JACOBIAN : JACOBIAN + 6], tables.T_world_tool, tables.vectors[ROWS : ROWS + 6]
    compute_jacobian(robot, tables.T_world_body, T, J)
    for k in range(count):
        joint = tables.whole[MOVING, k]
        share = 1.0 / weight[joint]
        for i in range(3):
            rows[i, k] = share * J[i, joint]
        if kind == AXIS:
            for i in range(2):
                rotation = J[3, joint] * T[0, i] + J[4, joint] * T[1, i] + J[5, joint] * T[2, i]
                rows[3 + i, k] = share * length * rotation
        elif kind == POSE:
            for i in range(3, 6):
                rows[i, k] = share * length * J[i, joint]
    return 3 if kind == POSITION else (5 if kind == AXIS else 6)


@inline_kernel
def find_longest_row(tables, done, used, count):
    """The row from `done` on of which most is left, and the square of that."""
    best, largest = done, -1.0
    for i in range(done, used):
        square = 0.0
        for k in range(done, count):
            square += tables.vectors[ROWS + i, k] * tables.vectors[ROWS + i, k]
        if square > largest:
            best, largest = i, square
    return best, largest


@inline_kernel
def split(tables, used, count):
    """A = L Q^T of the first `used` rows, the longest first; returns the rank."""
    rows, order, least = tables.vectors[ROWS : ROWS + 6], tables.whole[ORDER], 0.0
    for i in range(used):
        order[i] = i
    for done in range(min(used, count)):
        best, square = find_longest_row(tables, done, used, count)
        if square <= least:
            return done
        if done == 0:
            least = MIN_RANK * MIN_RANK * square
        if best != done:
            order[done], order[best] = order[best], order[done]
            for k in range(count):
                rows[done, k], rows[best, k] = rows[best, k], rows[done, k]
        head, size = rows[done, done], math.sqrt(square)
        tables.numbers[DIAGONAL, done] = -size if head >= 0.0 else size
        rows[done, done] = head - tables.numbers[DIAGONAL, done]
        tables.numbers[SCALE, done] = 1.0 / (size * (size + abs(head)))
        for i in range(done + 1, used):
            reflect(tables, done, count, rows[i])
    return min(used, count)


@inline_kernel
def reflect(tables, which, count, x):
    """Apply one reflection to `x` [n], in place."""
    total = 0.0
    for k in range(which, count):
        total += tables.vectors[ROWS + which, k] * x[k]
    total *= tables.numbers[SCALE, which]
    for k in range(which, count):
        x[k] -= total * tables.vectors[ROWS + which, k]


@leaf_kernel
def apply(tables, rank, count, x):
    """Q x, in place."""
    for which in range(rank - 1, -1, -1):
        reflect(tables, which, count, x)


@leaf_kernel
def apply_transposed(tables, rank, count, x):
    """Q^T x, in place: first the part that moves the tool, then the part that does not."""
    for which in range(rank):
        reflect(tables, which, count, x)


@inline_kernel
def solve_along(tables, rank, out_x):
    """The first `rank` entries of Q^T p for the smallest motion p that takes the tool's error away; the weak damped."""
    softest = SOFTEST * tables.numbers[DIAGONAL, 0] * tables.numbers[DIAGONAL, 0]
    for i in range(rank):
        total = tables.numbers[ERROR, tables.whole[ORDER, i]]
        for k in range(i):
            total -= tables.vectors[ROWS + i, k] * out_x[k]
        pivot = tables.numbers[DIAGONAL, i]
        out_x[i] = total * pivot / (pivot * pivot + softest)


@inline_kernel
def set_multipliers(tables, rank, used, x):
    """Multipliers of the target's rows from x = Q^T y: what of the motion `y` each row holds, by least squares."""
    for i in range(used):
        tables.numbers[MULTIPLIER, i] = 0.0
    for i in range(rank - 1, -1, -1):
        total = x[i]
        for k in range(i + 1, rank):
            total -= tables.vectors[ROWS + k, i] * tables.numbers[MULTIPLIER, tables.whole[ORDER, k]]
        tables.numbers[MULTIPLIER, tables.whole[ORDER, i]] = total / tables.numbers[DIAGONAL, i]


@inline_kernel
def fill_null(tables, rank, count):
    """The motions that leave the tool in place, a row each."""
    for row in range(count - rank):
        for k in range(count):
            tables.matrices[NULL, row, k] = 1.0 if k == rank + row else 0.0
        apply(tables, rank, count, tables.matrices[NULL, row])


@inline_kernel
def fill_bend(kind, length, weight, carrying, tables):
    """Second derivative of the target's rows times their multipliers, over the joints that carry the tool.

    A joint that rotates about z_j moves what a joint k behind it does to the tool: d J_k / d q_j = z_j x J_k. For the
    rotation vector of a pose half of that counts; for an axis z_j x (z_k x axis).
    """
    J, rotated = tables.vectors[JACOBIAN : JACOBIAN + 6], tables.vectors[ROTATED : ROTATED + 3]
    T, m = tables.T_world_tool, tables.numbers[MULTIPLIER]
    mx, my, mz = 0.0, 0.0, 0.0
    if kind == POSE:
        mx, my, mz = 0.5 * length * m[3], 0.5 * length * m[4], 0.5 * length * m[5]
    elif kind == AXIS:  # (m_x x + m_y y) x z = m_y x - m_x y of the tool
        mx = length * (m[4] * T[0, 0] - m[3] * T[0, 1])
        my = length * (m[4] * T[1, 0] - m[3] * T[1, 1])
        mz = length * (m[4] * T[2, 0] - m[3] * T[2, 1])
    for k in range(carrying):
        joint = tables.whole[MOVING, k]
        x, y, z = J[3, joint], J[4, joint], J[5, joint]
        if kind == AXIS:
            x, y, z = y * T[2, 2] - z * T[1, 2], z * T[0, 2] - x * T[2, 2], x * T[1, 2] - y * T[0, 2]
        rotated[0, k], rotated[1, k], rotated[2, k] = x, y, z
    for j in range(carrying):
        first = tables.whole[MOVING, j]
        x, y, z = J[3, first], J[4, first], J[5, first]
        ax, ay, az = m[1] * z - m[2] * y, m[2] * x - m[0] * z, m[0] * y - m[1] * x
        bx, by, bz = my * z - mz * y, mz * x - mx * z, mx * y - my * x
        for k in range(j, carrying):
            joint = tables.whole[MOVING, k]
            total = ax * J[0, joint] + ay * J[1, joint] + az * J[2, joint]
            total += bx * rotated[0, k] + by * rotated[1, k] + bz * rotated[2, k]
            tables.matrices[BEND, j, k] = tables.matrices[BEND, k, j] = total / (weight[first] * weight[joint])

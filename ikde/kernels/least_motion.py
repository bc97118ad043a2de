"""From a configuration that meets its target to the one near it that moves least from `near`.

Minimised is |y|^2 / 2, y_j = w_j (q_j - near_j), where the tool meets its target, in the joint ranges and free of
collision. Each step is Newton's for the Lagrangian [Nocedal2006, ch. 18], with the exact second derivative of the tool
(`kernels/motion_step.py`): first without a thought of collisions; if what comes of it collides, once more from the
start, with linearised contacts (`kernels/contacts.py`), every step of it free.
"""

import numpy as np

from ikde.kernels.answer import FIRST_COUNT, METRICS, SCORE, grade_row
from ikde.kernels.arrays import COORDINATE, PRISMATIC, REACHED, DescentArrays, TargetArrays
from ikde.kernels.attempt import is_inside
from ikde.kernels.clearance import find_closest_spheres
from ikde.kernels.flat_arguments import unpack_answer, unpack_models
from ikde.kernels.jit import inline_kernel, inline_view_kernel, kernel, leaf_kernel
from ikde.kernels.motion_step import (
    INSIDE,
    choose_doubt,
    constrain_point,
    factor_hessian,
    fill_hessian,
    is_free,
    judge_place,
    list_contacts,
    set_free_point,
    set_motion,
    set_step,
    split_motion,
    square_motion,
    stays_inside,
    update_multipliers,
)
from ikde.kernels.motion_work import (
    ALONG,
    BEST,
    ERROR,
    ERROR_HERE,
    FREE_POINT,
    HERE,
    MOVING,
    PAIR,
    POINT,
    SLACK,
    SLOPE,
    SPLIT,
    STEP,
    TRIAL,
    make_motion_work,
)
from ikde.kernels.tool_tangent import (
    fill_bend,
    fill_null,
    fill_rows,
    list_moving,
    place_tool,
    set_multipliers,
    split,
)
from ikde.kernels.turns import unwind

MAX_STEPS = 40
MAX_SLIDES = 32  # 24 lose 2 of 18 long walks
RETURNING = 4  # last steps, which do nothing but bring the tool back to its target
MAX_WALKS = 4  # walks, each from where a full turn brings a joint nearer
TRIALS = 10  # of one step: halved, or turned away from a contact
CORRECTIONS = 2  # of one step that goes into a contact
DONE = 1e-6  # square of the last step, as a share of |y|^2: a next one would be as its square
DONE_SLIDING = 1e-8  # where each step is a share of the last one
SHORTER, SHORTEST = 0.2, 0.05  # steps after a walk that got lost; m or rad
TAKEN, LAST, LOST, CORRECTED = range(4)  # what comes of a step; one that goes into a contact is chosen anew
MAX_ERROR_SHARE = 0.5  # how much of a step's length taking away the error behind it may take


@inline_kernel
def copy(source, target):
    """Copy [N]."""
    for k in range(source.size):
        target[k] = source[k]


@inline_kernel
def clear(target):
    """Zeros into `target` [N]."""
    for k in range(target.size):
        target[k] = 0.0


@inline_kernel
def meets(descent, position, orientation):
    """Whether errors are within the tolerances."""
    return position <= descent.position_tolerance and orientation <= descent.orientation_tolerance


@inline_kernel
def set_trial(ranges, weight, share, count, tables):
    """The end of a share of the step, cut to the joint ranges; returns the square of the motion there, weighed."""
    total = 0.0
    copy(tables.vectors[HERE], tables.vectors[TRIAL])
    for k in range(count):
        joint = tables.whole[MOVING, k]
        value = tables.vectors[HERE, joint] + share * tables.vectors[STEP, k] / weight[joint]
        tables.vectors[TRIAL, joint] = min(max(value, ranges[0, joint]), ranges[1, joint])
        moved = weight[joint] * (tables.vectors[TRIAL, joint] - tables.vectors[HERE, joint])
        total += moved * moved
    return total


@inline_kernel
def cap_step(weight, largest, count, tables):
    """The share of the step at which no joint moves more than `largest` (m or rad)."""
    most = 0.0
    for k in range(count):
        most = max(most, abs(tables.vectors[STEP, k]) / weight[tables.whole[MOVING, k]])
    return largest / most if most > largest else 1.0


@inline_kernel
def yield_to_contacts(collision, share, work, count, contacts):
    """Take from the slack of contacts what they miss at the trial's poses, for a second step from the same place."""
    margin = collision.safe_distance + INSIDE
    for i in range(contacts):
        a, b = collision.pairs[work.tables.whole[PAIR, i], 0], collision.pairs[work.tables.whole[PAIR, i], 1]
        gap, _, _ = find_closest_spheres(collision, work.contacts.centres, a, b)
        if gap < margin:
            expected = work.tables.numbers[SLACK, i]
            for k in range(count):
                expected += share * work.tables.vectors[SLOPE + i, k] * work.tables.vectors[STEP, k]
            work.tables.numbers[SLACK, i] += gap - margin - max(expected, 0.0)


@leaf_kernel
def prepare_step(robot, collision, kind, ranges, length, weight, is_first, slides, returns, size, work):
    """Set the free point of a step from `HERE`, whose poses and error are in `work`.

    `is_first`: there are no multipliers yet; `returns`: it only brings the tool back; `size`: how many
    joints move, and how many of them carry the tool.
    Returns rank and rows of the target, how many contacts are near, and which share of |y|^2 is too little to go on.
    """
    tables, (count, carrying) = work.tables, size
    contacts = list_contacts(robot, collision, weight, work, count) if slides else 0
    used = fill_rows(robot, kind, length, weight, count, tables)
    rank = split(tables, used, count)
    set_motion(weight, ranges[2], tables.vectors[HERE], count, tables)
    split_motion(tables, rank, count)
    if is_first:
        set_multipliers(tables, rank, used, tables.vectors[SPLIT])
    fill_bend(kind, length, weight, carrying, tables)
    fill_null(tables, rank, count)
    fill_hessian(tables, rank, count, carrying)
    is_bent = factor_hessian(tables, count - rank)
    set_free_point(tables, rank, count, carrying)
    if returns:
        clear(tables.vectors[FREE_POINT])
    return rank, used, contacts, DONE_SLIDING if contacts > 0 or is_bent else DONE


@leaf_kernel
def choose_step(ranges, weight, largest, rank, used, size, contacts, work):
    """The step to the least motion within joint ranges and contacts, and its multipliers; False if there is none."""
    is_possible, (count, carrying) = contacts == 0, size
    copy(work.tables.vectors[FREE_POINT], work.tables.vectors[POINT])
    set_step(work.tables, rank, count)
    is_bound = contacts > 0 or not stays_inside(ranges, weight, work.tables, count)
    if is_bound:
        for tries in range(2):
            if tries == 1:  # there is no room to take the tool's error away
                for k in range(count):
                    work.tables.vectors[ALONG, k] = 0.0
            is_possible = constrain_point(ranges, weight, largest, work, rank, count, contacts)
            if is_possible:
                break
        set_step(work.tables, rank, count)
    update_multipliers(work, rank, used, count, carrying, is_bound)
    return is_possible


@leaf_kernel
def try_step(robot, collision, target, index, ranges, descent, weight, largest, way, work):
    """Go as much of the step as is better, and free if there are contacts; `way`: rank, used, count, slides,
    contacts, enough.

    `largest` of any joint, m or rad. Returns what came of it and whether the tool meets its target there.
    """
    tables, length, (rank, used, count, slides, contacts, enough) = work.tables, descent.rotation_length, way
    square = square_motion(weight, ranges[2], tables.vectors[HERE], count, tables)
    copy(tables.numbers[ERROR, :6], tables.numbers[ERROR_HERE, :6])
    doubt = choose_doubt(tables, used, count)
    before, error = judge_place(tables, rank, used, square, doubt)
    share = cap_step(weight, largest, count, tables)
    for _ in range(TRIALS):
        moved = set_trial(ranges, weight, share, count, tables)
        if moved == 0.0:
            break
        position, orientation = place_tool(robot, target, index, length, tables.vectors[TRIAL], tables)
        square_there = square_motion(weight, ranges[2], tables.vectors[TRIAL], count, tables)
        after, behind = judge_place(tables, rank, used, square_there, doubt)
        if behind <= max(MAX_ERROR_SHARE * MAX_ERROR_SHARE * moved, error) and after < before:
            if not slides or is_free(collision, work):
                copy(tables.vectors[TRIAL], tables.vectors[HERE])
                return (LAST if moved <= enough * square else TAKEN), meets(descent, position, orientation)
            if contacts > 0:
                yield_to_contacts(collision, share, work, count, contacts)
                copy(tables.numbers[ERROR_HERE, :6], tables.numbers[ERROR, :6])
                return CORRECTED, False
        share *= 0.5
    return LOST, False


@leaf_kernel
def stand(robot, collision, target, index, descent, slides, work):
    """Go back to `BEST`: its poses and error, and the places of its spheres."""
    copy(work.tables.vectors[BEST], work.tables.vectors[HERE])
    place_tool(robot, target, index, descent.rotation_length, work.tables.vectors[HERE], work.tables)
    if slides:
        is_free(collision, work)


@leaf_kernel
def is_answer(robot, collision, target, index, ranges, descent, work):
    """Whether `BEST` meets the target, inside the joint ranges and free of collision."""
    if not is_inside(ranges, work.tables.vectors[BEST]):
        return False
    best, length = work.tables.vectors[BEST], descent.rotation_length
    position, orientation = place_tool(robot, target, index, length, best, work.tables)
    return meets(descent, position, orientation) and is_free(collision, work)


@leaf_kernel
def turn_back(robot, ranges, q):
    """Take from `q` [N] the whole turns that a walk has made too many; whether there are any."""
    is_changed = False
    for body in range(1, robot.bodies.shape[0]):
        k = robot.bodies[body, COORDINATE]
        if robot.bodies[body, PRISMATIC] == 0:
            before, here = q[k], slice(k, k + 1)
            unwind(ranges[0, here], ranges[1, here], (1,), ranges[2, here], q[here])
            is_changed |= q[k] != before
    return is_changed


@kernel
def reduce_motion(robot, collision, target, index, ranges, descent, weight, q):
    """Move `q` [N], which meets target `index`, to a local minimum of the motion from `near`, in place.

    The motion is sqrt(sum (w_j (q_j - near_j))^2); the target stays met, the joint ranges kept, and nothing collides.
    It never grows: where nothing better is found `q` stays, to the bit. If `near` itself is an answer, `q` becomes
    that, to the bit. All loops are in this one function: each further level took 4 s to compile.

    Args:
        robot: `RobotArrays`.
        collision: `CollisionArrays`, whose safe distance leaves room for rounding.
        target: `TargetArrays`.
        index: which target.
        ranges: [3, N] lower, upper, near; m or rad.
        descent: `DescentArrays`: tolerances as `damped.compute_rotation` measures them, rotation length, largest step.
        weight: [N] above 0, per m or per rad.
        q: [N] within tolerance, in the ranges and free.
    """
    work, kind, length = make_motion_work(robot, collision, q.size), target.kind[index], descent.rotation_length
    here, best, size = work.tables.vectors[HERE], work.tables.vectors[BEST], list_moving(robot, ranges, work.tables)
    copy(ranges[2], best)
    if is_answer(robot, collision, target, index, ranges, descent, work):
        copy(best, q)
        return
    walks, slides = MAX_WALKS, size[0] < 0
    while walks > 0:
        largest, is_better = descent.largest_step, False
        is_first = is_met = size[0] > 0  # true, and no constant: that would be compiled into a step of its own
        began = square_motion(weight, ranges[2], q, size[0], work.tables)
        copy(q, best)
        steps = (MAX_SLIDES if slides else MAX_STEPS) if is_first else 0
        for step in range(steps):
            if is_first:
                stand(robot, collision, target, index, descent, slides, work)
            returns = not is_met and step >= steps - RETURNING
            rank, used, contacts, enough = prepare_step(
                robot, collision, kind, ranges, length, weight, is_first, slides, returns, size, work
            )
            outcome, meets_there, corrections = CORRECTED if rank < size[0] else LOST, False, CORRECTIONS
            while outcome == CORRECTED and choose_step(ranges, weight, largest, rank, used, size, contacts, work):
                way = rank, used, size[0], slides, contacts if corrections > 0 else 0, enough
                outcome, meets_there = try_step(
                    robot, collision, target, index, ranges, descent, weight, largest, way, work
                )
                corrections -= 1
            if outcome >= LOST:
                if is_met or largest < SHORTEST:
                    break
                is_first, is_met, largest = True, True, SHORTER * largest
                continue
            square = square_motion(weight, ranges[2], here, size[0], work.tables)
            is_first, is_met = False, meets_there
            if is_met and square < began:
                is_better = True
                copy(here, best)
            if is_met and outcome == LAST:
                break
        slides = is_better and not slides and not is_answer(robot, collision, target, index, ranges, descent, work)
        if not slides:
            walks -= 1
            if is_better:
                copy(best, q)
            if not turn_back(robot, ranges, q):
                return


@inline_view_kernel
def unpack_walk(walk):
    """`DescentArrays` and weights [N] out of one array [9 + N]."""
    w = walk
    return DescentArrays(w[0], w[1], w[2], w[3], w[4], w[5], int(w[6]), int(w[7]), w[8]), w[9:]


@kernel
def reduce_motions(numbers, whole, ranges, walk, kinds, T_world_tool, rows, q):
    """`reduce_motion` of some rows [K] of `q` [T, N], a target each: the same bits.

    `numbers` and `whole` as `unpack_models` takes them: of types as below, so that `reduce_motion` is compiled once.
    """
    robot, collision = unpack_models(numbers, whole)
    target, (descent, weight) = TargetArrays(kinds, T_world_tool), unpack_walk(walk)
    for row in rows:
        reduce_motion(robot, collision, target, row, ranges, descent, weight, q[row])


@kernel
def descend_row(numbers, whole, walk, T_world_tool, out):
    """`reduce_motion` of what `lm` or the closed form has reached, and its grade, from one call of Python.

    Of all robots: in the modules that are written for them it took 5 s more to compile for each kind of target.
    `numbers` and `whole` are those of `unpack_answer`, `out` is the row that the search has filled. Returns True if
    the target is reached and the grader accepts it.
    """
    joints = whole[0]
    if out[joints + METRICS + SCORE] == np.inf:
        return False  # no branch meets the pose
    grader, terms, kinds, _ = unpack_answer(numbers, whole)
    robot, collision = unpack_models(numbers[whole[2] :], whole[whole[3] :])
    target, (descent, weight) = TargetArrays(kinds, T_world_tool.reshape((1, 3, 4))), unpack_walk(walk)
    ranges = numbers[1 : 1 + 3 * joints].reshape((3, joints))
    if out[joints + METRICS :].view(np.int64)[FIRST_COUNT + REACHED] == 1:
        index = np.int64(0)  # a literal would be compiled into functions of its own
        reduce_motion(robot, collision, target, index, ranges, descent, weight, out[:joints])
    return grade_row(grader, terms, target, joints, out)

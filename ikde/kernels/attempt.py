"""How an attempt of a differential evolution begins and ends: the box it searches, and what is kept and counted."""

from ikde.kernels.arrays import ATTEMPTS, COLLIDING, IGNORE, OUTSIDE, REACHED
from ikde.kernels.clearance import compute_depth, count_colliding_pairs
from ikde.kernels.jit import inline_kernel, kernel


@kernel
def set_box(ranges, first_box, attempt, out_lower, out_upper):
    """Ranges of one attempt: a box around `near` that doubles with each attempt, cut to the joint ranges [3, N]."""
    share = first_box
    for _ in range(attempt):
        share = min(1.0, 2.0 * share)
    for k in range(ranges.shape[1]):
        lower, upper, near = ranges[0, k], ranges[1, k], ranges[2, k]
        half_width = share * (upper - lower)
        out_lower[k] = max(lower, near - half_width)
        out_upper[k] = min(upper, near + half_width)


@kernel
def is_inside(ranges, q):
    """True if every joint of `q` [N] is inside its range, lower and upper."""
    outside = 0
    for k in range(q.size):
        outside += not ranges[0, k] <= q[k] <= ranges[1, k]
    return outside == 0


@inline_kernel
def keep_better(met, badness, q, out_q, out_score):
    """Keep `q` [N] and its score if they are better than those kept: lower by `met` (0 or 1), then by `badness`."""
    if met < out_score[0] or (met == out_score[0] and badness < out_score[1]):
        out_score[0], out_score[1] = met, badness
        for k in range(q.size):
            out_q[k] = q[k]


@inline_kernel
def finish_attempt(collision, search, q, cost, meets, work, out_q, out_score, out_counts, out_pairs):
    """Keep and count what an attempt came to, `q` [N], whose poses are those in `work`; True if it is reached.

    What is kept is the best by `out_score` [2]: poses that were met (0, depth in m) before those that were not (1, cost
    in m), so `out_score` starts at (inf, inf). `out_counts` [COUNTS] and `out_pairs` [P], how often each pair blocked a
    pose that was met, are added to.
    """
    out_counts[ATTEMPTS] += 1
    depth = 0.0
    if search.collision_rule != IGNORE:
        depth = compute_depth(collision, work.T_world_body, work.bounds, work.centres)
    inside = is_inside(search.ranges, q)
    is_met = meets and inside
    keep_better(0.0 if is_met else 1.0, depth if is_met else cost, q, out_q, out_score)
    if meets and not inside:
        out_counts[OUTSIDE] += 1
    elif meets and depth > 0.0:
        out_counts[COLLIDING] += 1
        count_colliding_pairs(collision, work.bounds, work.centres, out_pairs)
    elif meets:
        out_counts[REACHED] = 1
        return True
    return False

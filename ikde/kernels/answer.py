"""One target answered in one compiled call: what goes in beside a search's own block, and what comes out.

Called from Python, a kernel takes 0.05 us for an array and 0.1 us for one that is read-only, so all that comes out
lies in one row of numbers: q [N], metrics, then as whole numbers the closest pair, counts, and how often each pair
blocked. The search and the grader are those of the long way, so the bits are, too.
"""

import numpy as np

from ikde.kernels.arrays import COUNTS, REACHED
from ikde.kernels.grade_one import grade_one
from ikde.kernels.jit import inline_view_kernel, kernel

METRICS = 3  # position error in m, orientation error in rad, clearance in m
PAIR, FIRST_COUNT = 0, 1  # of the whole numbers
SCORE = FIRST_COUNT + COUNTS
BLOCKED = SCORE + 2


def size_of(joints: int, pairs: int) -> int:
    """Numbers in the row of a robot with so many joints and a collision model with so many pairs."""
    return joints + METRICS + BLOCKED + pairs


@inline_view_kernel
def open_row(joints, first, out):
    """Where a search puts q [N], score [2], counts [COUNTS] and blocked [P] in a row, cleared if it begins there."""
    whole = out[joints + METRICS :].view(np.int64)
    score = out[joints + METRICS + SCORE : joints + METRICS + BLOCKED]
    if first == 0:
        whole[:] = 0
        score[:] = np.inf
    return out[:joints], score, whole[FIRST_COUNT:SCORE], whole[BLOCKED:]


@kernel
def grade_row(numbers, whole, target, joints, out):
    """Grade the q of a row, `numbers` and `whole` being the grader's; True if it is reached and accepted."""
    out_whole = out[joints + METRICS :].view(np.int64)
    position, orientation, clearance, pair, accepted = grade_one(
        numbers, whole, target.kind, target.T_world_tool, out[:joints]
    )
    out[joints], out[joints + 1], out[joints + 2] = position, orientation, clearance
    out_whole[PAIR] = pair
    return accepted and out_whole[FIRST_COUNT + REACHED] == 1


def pack_row(q, metrics, pair, counts, blocked):
    """The row of what is known by its parts: q [N], metrics [METRICS], counts [COUNTS], blocked [P]."""
    row = np.full(size_of(len(q), len(blocked)), np.inf)  # no score is known
    row[: len(q)], row[len(q) : len(q) + METRICS] = q, metrics
    whole = row[len(q) + METRICS :].view(np.int64)
    whole[PAIR], whole[FIRST_COUNT:SCORE], whole[BLOCKED:] = pair, counts, blocked
    return row

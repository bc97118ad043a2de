"""Counts of poses, and the line that is made of them."""

import numpy as np
import pytest

import ikde
from ikde.kernels.answer import pack_row
from ikde.model.target import Target
from ikde.solver.region_grade import RegionGrade
from ikde.solver.region_tally import Tally, Tried, tell_still
from ikde.solver.result import StopReason
from tests.problems import problem_of

TARGET = Target((0.4, 0.2, 0.3))


@pytest.fixture(scope="module")
def asked():
    return problem_of(ikde.load_robot("ur5"))


def tried(asked, colliding, blocked=None, cost=0.1):
    pairs = np.zeros(len(asked.collision.counted), dtype=np.int64)
    for place, count in (blocked or {}).items():
        pairs[place] = count
    row = pack_row(asked.lower, (0.1, 0.2, 0.3), 0, (0, 4, 20, colliding, 0), pairs)
    row[-len(pairs) - 2 : -len(pairs)] = (1.0, cost)
    return Tried(asked, TARGET, 0, row, "lm", False)


def test_counts_add_up_and_the_best_is_kept(asked):
    tally, better = Tally(asked), tried(asked, 0, cost=0.05)
    for each in (tried(asked, 2, {3: 2}), better, tried(asked, 1, {0: 1, 3: 1})):
        tally.add(each)
    tally.add_excluded()
    assert tally.best is better
    pairs = asked.collision.pairs
    assert tally.spent == {
        "attempts": 12,
        "evaluations": 60,
        "rejected": 3,
        "poses": 4,
        "blocking_pairs": {pairs[3]: 3, pairs[0]: 1},
    }


def test_the_line_says_what_came_of_each_pose(asked):
    tally, pairs = Tally(asked), ["-".join(pair) for pair in asked.collision.pairs]
    tally.add(tried(asked, 2, {3: 2, 0: 1}))
    tally.add(tried(asked, 0))
    tally.add_excluded()
    stop, reason, _ = tally.tell(is_late=False)
    assert stop is StopReason.COLLISION
    assert reason == (
        "3 poses of the region tried: 1 met only in collision, 1 proved to be out of reach, 1 not met; "
        f"2 answers in collision, blocked by {pairs[3]} (2), {pairs[0]} (1)"
    )
    late = Tally(asked.with_settings(timeout_s=2.0)).tell(is_late=True)
    assert late[:2] == (StopReason.TIMED_OUT, "timed out after 2 s, with 0 poses of the region tried")


def test_without_a_collision_it_is_the_budget(asked):
    tally = Tally(asked)
    tally.add(tried(asked, 0))
    assert tally.tell(is_late=False) == (StopReason.BUDGET, "1 pose of the region tried: 1 not met", {})


def test_what_stands_still_is_so_far_out():
    assert tell_still(RegionGrade(0, 0.25, 0.0, False)).reason.endswith("the tool is 0.250 m out of the region")
    assert tell_still(RegionGrade(0, 0.25, 0.5, False)).reason.endswith("0.250 m and 0.500 rad out of the region")

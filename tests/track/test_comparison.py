"""Methods beside one another: rows with every figure, dead ends from starts at the first pose."""

import json

import numpy as np
import pytest

import ikde
from ikde.track.comparison import (
    TrackBudget,
    compare_methods,
    count_dead_ends,
    count_runs,
    draw_random_starts,
    measure,
)
from tests.track.measured import make_measured

BUDGET = TrackBudget(seeds=2, starts=2)
SHORT = {
    "robot": "qiao2021",
    "dt_s": 0.02,
    "samples": 5,
    "path": {"expressions": {"x": "0.9 + 0.002*k", "y": 0.2, "z": 0.9}},
}


class Silent:
    """Counts."""

    def __init__(self):
        self.sections, self.runs = [], 0

    def begin(self, section):
        self.sections.append(section)

    def advance(self, solves):
        self.runs += solves


@pytest.fixture(scope="module")
def plan():
    return ikde.load_track(SHORT)


def test_a_row_holds_what_a_motion_breaks(qiao):
    row = measure(make_measured(qiao, amplitude=2.6, steps=40))
    assert (row["points"], row["reached_points"]) == (40, 40)
    assert row["colliding_samples"] == row["broken"]["collision"] > 0
    assert row["limit_violations"] == row["broken"]["speed"] + row["broken"]["range"] > 0
    assert row["largest_jump_m"] == pytest.approx(0.004)
    assert row["largest_jump_rad"] > 0.1
    assert row["smallest_clearance_mm"] >= row["certified_clearance_mm"]


def test_a_method_is_run_with_every_seed_and_from_every_start(plan):
    tell = Silent()
    compared = compare_methods(plan, ["continuation"], BUDGET, tell)
    assert tell.runs == count_runs(1, ["continuation"], BUDGET) == 4
    assert [run["seed"] for run in compared.data["runs"]] == [0, 1]
    assert all(run["reached_points"] == 5 and run["limit_violations"] == 0 for run in compared.data["runs"])
    assert compared.data["dead_ends"]["starts"] == 2
    assert set(compared.data["dead_ends"]["reached_points"]) == {"greedy", "continuation"}
    json.dumps(compared.data, allow_nan=False)
    assert compared.motions["continuation"].trajectory.reached


def test_random_starts_meet_the_first_pose_and_differ(plan):
    starts = draw_random_starts(plan, 3, seed=1)
    assert len(np.unique(starts.round(6), axis=0)) == 3
    for q in starts:
        graded = ikde.verify(plan.robot, plan.path.targets()[0], q)
        assert graded.position_error_m < 1e-8
        assert not graded.collision


def test_without_starts_there_are_no_dead_ends(plan):
    ends = count_dead_ends(plan, ["continuation"], 0, Silent())
    assert (ends["starts"], ends["greedy"], ends["continuation"]) == (0, 0, 0)

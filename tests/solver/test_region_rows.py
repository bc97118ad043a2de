"""Rows of goals of which some have freedom: columns say what the single results say."""

import pickle

import numpy as np

import ikde
from ikde.model.region import Region
from ikde.solver.region_rows import solve_goals
from tests.problems import problem_of

GOAL = ikde.Target.from_rpy((0.4, 0.2, 0.3), (3.0, 0.1, 0.2))


def test_columns_are_those_of_the_rows():
    asked = problem_of(ikde.load_robot("ur5"))
    goals = [Region.box(GOAL, 0.05), GOAL, Region.box((3.0, 0, 0), 0.1), Region.cone(GOAL, 0.1)]
    rows = solve_goals(asked, goals, seed=3)
    for name in ("position_error_m", "orientation_error_rad", "attempts", "evaluations", "rejected", "clearance_m"):
        assert np.array_equal(getattr(rows, name), [getattr(row, name) for row in rows])
    assert [row.region for row in rows] == [goals[0], None, goals[2], goals[3]]
    assert rows.targets[1] == GOAL
    assert rows.row(2) is rows[2]
    again = pickle.loads(pickle.dumps(rows))
    assert again[0].q.tobytes() == rows[0].q.tobytes()
    assert again[0].region == goals[0]


def test_no_goals_are_no_rows():
    assert len(solve_goals(problem_of(ikde.load_robot("ur5")), [], seed=0)) == 0

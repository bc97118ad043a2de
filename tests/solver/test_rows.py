"""Many solves as rows: what each says is what a single solve says, whatever its neighbours."""

import numpy as np
import pytest

import ikde
from ikde.solver.problem import make_problem
from ikde.solver.rows import solve_rows

QUICK = ikde.SolveSettings(population=20, generations=200, restarts=3)
TARGETS = [ikde.Target((0.8, 0.1 * k, 1.0)) for k in range(6)]


@pytest.fixture
def problem(qiao):
    return make_problem(qiao, QUICK, detector=None, near=None, freeze=None)


def test_a_row_is_the_solve_of_its_stream(qiao, problem):
    rows = solve_rows(problem, TARGETS, seed=7, first_stream=100)
    for k, target in enumerate(TARGETS):
        single, row = ikde.solve(qiao, target, QUICK, seed=7, stream=100 + k), rows.row(k)
        assert row.q.tobytes() == single.q.tobytes()
        assert (row.stream, row.attempts, row.evaluations, row.stop_reason, row.reason) == (
            *(single.stream, single.attempts, single.evaluations, single.stop_reason, single.reason),
        )


def test_columns_and_rows_tell_the_same(problem):
    rows = solve_rows(problem, TARGETS, seed=7)
    results = [rows.row(k) for k in range(len(rows))]
    assert rows.reached.tolist() == [result.reached for result in results]
    assert rows.attempts.tolist() == [result.attempts for result in results]
    assert rows.rejected.tolist() == [result.rejected for result in results]
    assert rows.figures.clearance_m == pytest.approx([result.clearance_m for result in results], abs=1e-11)
    assert np.all(rows.found.seconds > 0.0)


def test_without_probes_the_bound_still_proves_what_is_out_of_reach(problem):
    rows = solve_rows(problem, [ikde.Target((50.0, 0.0, 1.0)), TARGETS[0]], seed=0, probe=False)
    assert rows.row(0).stop_reason == "out_of_reach"
    assert "m beyond the stretched arm" in rows.row(0).reason
    assert rows.row(1).stop_reason != "out_of_reach"

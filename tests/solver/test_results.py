"""Many solves as rows: what each says is what a single solve says, whatever its neighbours."""

import numpy as np
import pytest

import ikde
from ikde.errors import InputError
from ikde.solver.engine_table import NAMES
from ikde.solver.result import STOP_REASONS
from ikde.solver.results import solve_rows
from ikde.solver.settings import BulkOptions
from ikde.solver.verify import verify_many
from tests.flat_settings import flat_settings
from tests.problems import problem_of

QUICK = flat_settings(population=20, generations=200, restarts=3)
SWIFT = flat_settings(population=6, generations=1, restarts=1)
TARGETS = [ikde.Target((0.8, 0.1 * k, 1.0)) for k in range(6)]


@pytest.fixture
def problem(qiao):
    return problem_of(qiao, QUICK)


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
    results, pairs = list(rows), problem.collision.pairs
    for name in ("reached", "verified", "collision", "attempts", "evaluations", "rejected"):
        assert getattr(rows, name).tolist() == [getattr(result, name) for result in results]
    for name in ("position_error_m", "orientation_error_rad", "clearance_m"):
        assert getattr(rows, name).tolist() == [getattr(result, name) for result in results]
        checked = [getattr(result.grade, name) for result in results]
        assert getattr(rows, name) == pytest.approx(checked, abs=1e-11)
    assert [STOP_REASONS[k] for k in rows.stop_reasons] == [result.stop_reason for result in results]
    assert [NAMES[k] for k in rows.engines] == [result.method for result in results]
    assert [pairs[k] for k in rows.closest_pair] == [result.closest_pair for result in results]
    assert np.all(rows.found.seconds > 0.0)


def test_rows_are_a_sequence(problem):
    rows = solve_rows(problem, TARGETS, seed=7)
    assert len(rows) == len(list(rows)) == 6
    assert rows[-1].q.tobytes() == rows[5].q.tobytes() == rows.q[5].tobytes()
    assert [tuple(result.target.p_world_tool) for result in rows] == [tuple(t.p_world_tool) for t in TARGETS]
    for outside in (6, -7):
        with pytest.raises(IndexError, match=f"row {outside} of 6"):
            rows[outside]


def test_no_targets_are_no_rows(problem):
    rows = solve_rows(problem, [], seed=7)
    assert len(rows) == 0
    assert (rows.q.shape, rows.reached.shape, rows.stop_reasons.shape) == ((0, 9), (0,), (0,))


def test_targets_as_arrays_are_the_same_targets(problem):
    arrays = ikde.Targets([target.p_world_tool for target in TARGETS])
    assert solve_rows(problem, arrays, seed=7).q.tobytes() == solve_rows(problem, TARGETS, seed=7).q.tobytes()


def watch_plain_numpy(substitute):
    """Sizes of the calls of `verify_many`."""
    calls = []

    def watched(collision, targets, Q, settings):
        calls.append(len(Q))
        return verify_many(collision, targets, Q, settings)

    substitute(verify_many, watched)
    return calls


@pytest.mark.parametrize(
    ("verify", "first_stream", "graded"),
    [
        ("all", 0, 130),
        ("none", 0, 0),
        ("sample", 0, 0),
        ("sample", 4000, 64),
        ("sample", 4096, 0),
        ("sample", 3 * 4096 - 70, 64),
        ("sample", 8191, 1),
    ],
)
def test_plain_numpy_grades_what_is_asked(qiao, substitute, verify, first_stream, graded):
    problem = problem_of(qiao, SWIFT)
    calls = watch_plain_numpy(substitute)
    rows = solve_rows(
        problem,
        TARGETS[:1] * 130,
        seed=7,
        first_stream=first_stream,
        bulk=BulkOptions(explain=False, verify=verify, threads=1),
    )
    assert calls == [graded] * (graded > 0)
    assert rows.verified.count() == graded
    assert rows.verified.compressed().all()


def test_a_row_that_is_looked_into_is_graded_whatever_is_asked(problem, substitute):
    calls = watch_plain_numpy(substitute)
    rows = solve_rows(problem, [*TARGETS, ikde.Target((50.0, 0.0, 1.0))], seed=7, bulk=BulkOptions(verify="none"))
    unreached = np.flatnonzero(~rows.reached).tolist()
    assert calls == [len(unreached)]
    assert list(rows.outcomes.explanations) == unreached


def test_the_grade_of_plain_numpy_is_made_when_it_is_looked_at(qiao, problem):
    result = solve_rows(problem, TARGETS[:2], seed=7, first_stream=1, bulk=BulkOptions(verify="none", explain=False))[1]
    assert result.grade is result.grade
    expected = ikde.verify(qiao, TARGETS[1], result.q, settings=QUICK)
    assert result.grade.closest_pair == expected.closest_pair
    assert result.grade.clearance_m == pytest.approx(expected.clearance_m, abs=1e-14)


def test_collision_is_judged_by_the_safe_distance(qiao):
    rows = solve_rows(problem_of(qiao, QUICK), TARGETS, seed=7)
    assert (rows.collision == (rows.clearance_m <= 0.0)).all()
    far = ikde.Detector(name="far", spheres="improved", pairs="formula_22", safe_distance_m=1.0)
    near = solve_rows(
        problem_of(qiao, SWIFT, collision=far), TARGETS, seed=7, bulk=BulkOptions(explain=False, verify="all")
    )
    assert near.collision.tolist() == [True] * 6
    assert not near.reached.any()


def test_without_a_detector_collision_is_not_checked(qiao):
    problem = problem_of(qiao, QUICK, collision="none")
    rows = solve_rows(problem, TARGETS, seed=7)
    assert rows.collision.tolist() == [result.collision for result in rows] == [None] * 6
    assert rows.reached.all()
    assert {result.reason.split(", ")[-1] for result in rows} == {"self-collision not checked"}


def test_another_way_to_verify_is_refused(problem):
    with pytest.raises(InputError, match="verify: expected one of all, sample, none, got 'some'"):
        solve_rows(problem, TARGETS[:1], seed=7, bulk=BulkOptions(verify="some"))


def test_without_probes_the_bound_still_proves_what_is_out_of_reach(problem):
    rows = solve_rows(
        problem, [ikde.Target((50.0, 0.0, 1.0)), TARGETS[0]], seed=0, bulk=BulkOptions(explain=False, verify="all")
    )
    assert rows.row(0).stop_reason == "out_of_reach"
    assert rows.row(0).reason.startswith("out of reach: at least 43.")
    assert rows.row(1).stop_reason != "out_of_reach"
    assert not rows.outcomes.explanations

"""The verdict is the graders': a kernel that lies is found out where plain numpy is asked; `verified` says where."""

from dataclasses import replace
from functools import partial

import numpy as np
import pytest

import ikde
from ikde.errors import VerificationError
from ikde.kernels.arrays import COUNTS, REACHED
from ikde.model.collision_model import CollisionModel
from ikde.model.target import Targets
from ikde.solver.engines.search_state import keep_pairs, make_search_state
from ikde.solver.forward import forward
from ikde.solver.grade import confirm, grade
from ikde.solver.metrics import AGREEMENT, compute_metrics
from ikde.solver.result import change_result
from ikde.solver.search import SearchState, search
from ikde.solver.settings import BulkOptions
from ikde.solver.verify import verify
from tests.flat_settings import flat_settings
from tests.problems import problem_of

QUICK = ikde.SolveSettings.for_method("auto").with_changes(restarts=4)
TARGETS = [ikde.Target((0.8, 0.1 * k, 1.0)) for k in range(3)]


def lie_about(substitute, figure, by, only=None):
    """Let the kernels' metrics be off; `only`: for this target alone."""

    def lying(collision, targets, Q, settings, limits):
        metrics = compute_metrics(collision, targets, Q, settings, limits)
        points = [tuple(target.p_world_tool) for target in targets]
        guilty = np.array([only is None or point == tuple(only.p_world_tool) for point in points])
        return replace(metrics, **{figure: getattr(metrics, figure) + np.where(guilty, by, 0.0)})

    substitute(compute_metrics, lying)


@pytest.mark.parametrize("by", [2e-11, -1e-3, np.nan, np.inf])
@pytest.mark.parametrize("figure", ["position_error_m", "orientation_error_rad", "clearance_m"])
def test_a_lie_about_any_figure_raises(qiao, substitute, figure, by):
    lie_about(substitute, figure, by)
    with pytest.raises(VerificationError, match="kernels and verify disagree"):
        ikde.solve_distinct(qiao, TARGETS[0], 1, QUICK)


def test_a_difference_below_the_agreement_is_no_lie(qiao, substitute):
    lie_about(substitute, "position_error_m", 0.5 * AGREEMENT)
    assert ikde.solve_distinct(qiao, TARGETS[0], 1, QUICK)[0].verified


def test_in_bulk_a_lie_is_recorded_and_the_run_goes_on(qiao, substitute):
    lie_about(substitute, "position_error_m", 1e-6, only=TARGETS[1])
    results = ikde.solve_many(qiao, TARGETS, QUICK, bulk=BulkOptions(verify="all"))
    assert [result.verified for result in results] == [True, False, True]
    assert [result.reached for result in results] == results.reached.tolist() == [True, False, True]
    assert results[1].stop_reason != "reached"


def test_what_plain_numpy_did_not_grade_is_not_called_verified(qiao, substitute):
    lie_about(substitute, "position_error_m", 1e-6, only=TARGETS[1])
    rows = ikde.solve_many(qiao, TARGETS, QUICK, bulk=BulkOptions(verify="none"))
    assert rows.reached.all()  # nobody was asked who could see the lie
    assert [result.verified for result in rows] == rows.verified.tolist() == [None, None, None]
    assert rows.verified.count() == 0


def test_of_a_sample_the_rest_is_not_checked(qiao):
    rows = ikde.solve_many(qiao, TARGETS[:1] * 4100, QUICK, bulk=BulkOptions(explain=False))
    assert rows.verified.tolist() == [True if 4096 - 64 <= k < 4096 else None for k in range(4100)]


def test_a_lie_in_bulk_never_claims_that_the_target_is_to_blame(qiao, substitute):
    lie_about(substitute, "position_error_m", 1e-6)
    result = ikde.solve_many(qiao, TARGETS[:1], QUICK, bulk=BulkOptions(verify="all"))[0]
    assert "disagree" in result.reason


def test_a_search_that_claims_too_much_is_not_believed(qiao, substitute):
    def boast(problem, targets, **options):
        counts = np.zeros((len(targets), COUNTS), dtype=np.int64)
        counts[:, REACHED] = 1
        q = np.tile(qiao.home, (len(targets), 1))
        nothing = np.zeros(len(targets))
        pair_counts = np.zeros((len(targets), 35), dtype=np.int64)
        engine = np.zeros(len(targets), dtype=np.int64)
        score = np.zeros((len(targets), 2))
        some = {"score": score, "excess_m": nothing, "excess_rad": nothing, "seconds": nothing, "engine": engine}
        some["ruled_out"] = np.full(len(targets), -1)
        some["metrics"] = compute_metrics(CollisionModel.of(qiao), targets, q, QUICK)
        return SearchState(q=q, counts=counts, pair_counts=keep_pairs(pair_counts), **some)

    substitute(search, boast)
    result = ikde.solve(qiao, TARGETS[0], flat_settings(QUICK, restarts=1, generations=3))
    assert not result.reached
    assert result.verified
    assert result.position_error_m > 0.1


@pytest.mark.parametrize("verify_rows", ["all", "sample"])
def test_a_grader_that_accepts_too_much_is_overruled(qiao, verify_rows):
    """Its metrics are true and its verdicts are not: those of plain numpy count as well."""
    problem, detector = problem_of(qiao, QUICK), CollisionModel.of(qiao).detector
    outside = qiao.home + np.where(qiao.is_prismatic, 0.0, 9.0)
    for q, asked in ((qiao.home, TARGETS[0]), (outside, ikde.Target(forward(qiao, outside)[qiao.tool][:3, 3]))):
        targets = Targets.of([asked])
        metrics = compute_metrics(CollisionModel(robot=qiao, detector=detector), targets, q[None], QUICK)
        found = replace(
            make_search_state(problem, 1), q=q[None], metrics=replace(metrics, accepted=np.ones(1, dtype=bool))
        )
        options = BulkOptions(explain=False, verify=verify_rows)
        graded = grade(problem, targets, found, options, seed=0, first_stream=4095, strict=False)
        assert graded.verified.all()
        assert not graded.reached.any()


def test_the_figures_are_of_exactly_the_returned_q(qiao):
    result = ikde.solve(qiao, TARGETS[0], QUICK)
    assert result.grade == verify(qiao, TARGETS[0], result.q, settings=QUICK)


def test_a_result_that_plain_numpy_does_not_confirm_raises(qiao):
    result = ikde.solve_many(qiao, TARGETS[:1], seed=7, bulk=BulkOptions(verify="none"))[0]
    assert (result.verified, confirm(qiao, result).verified) == (None, True)
    for name in ("position_error_m", "orientation_error_rad", "clearance_m"):
        with pytest.raises(VerificationError, match="disagree by"):
            confirm(qiao, change_result(result, **{name: getattr(result, name) + 1e-9}))
    with pytest.raises(VerificationError, match="disagree by"):
        confirm(qiao, change_result(result, q=result.q + 1e-3))


def test_a_result_that_rounding_takes_across_the_tolerance_is_not_reached_and_no_bug(qiao):
    result = ikde.solve_many(qiao, TARGETS[:1], seed=7, bulk=BulkOptions(verify="none"))[0]
    tolerance = np.nextafter(result.grade.position_error_m, 0.0)
    strict = partial(verify, qiao, settings=replace(result.settings, position_tolerance_m=tolerance))
    confirmed = confirm(qiao, change_result(result, verify=strict))
    assert (confirmed.reached, confirmed.verified, confirmed.stop_reason) == (False, True, "budget")
    assert "rounding" in confirmed.reason


def test_of_a_sample_each_unreached_row_is_graded_and_explained(qiao):
    targets = [*TARGETS, ikde.Target((50.0, 0.0, 1.0))]
    rows = ikde.solve_many(qiao, targets, QUICK, bulk=BulkOptions())
    assert rows.verified.mask.tolist() == [True, True, True, False]
    assert list(rows.outcomes.explanations) == [3]
    assert rows[3].hint

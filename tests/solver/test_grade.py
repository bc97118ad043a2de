"""The verdict is the independent check's: a kernel that lies is found out."""

from dataclasses import replace

import numpy as np
import pytest

import ikde
from ikde.errors import VerificationError
from ikde.kernels.arrays import COUNTS, REACHED
from ikde.solver import grade as module
from ikde.solver.figures import AGREEMENT
from ikde.solver.grade import confirm
from ikde.solver.search import Found
from ikde.solver.verify import verify

QUICK = ikde.SolveSettings.for_method("auto").with_changes(restarts=4)
TARGETS = [ikde.Target((0.8, 0.1 * k, 1.0)) for k in range(3)]


def lie_about(monkeypatch, figure, by, only=None):
    """Let the kernels' figures be off; `only`: for this target alone."""
    honest = module.compute_figures

    def lying(robot, detector, targets, Q, settings):
        figures = honest(robot, detector, targets, Q, settings)
        points = [tuple(target.p_world_tool) for target in targets]
        guilty = np.array([only is None or point == tuple(only.p_world_tool) for point in points])
        return replace(figures, **{figure: getattr(figures, figure) + np.where(guilty, by, 0.0)})

    monkeypatch.setattr(module, "compute_figures", lying)


@pytest.mark.parametrize("by", [2e-11, -1e-3, np.nan, np.inf])
@pytest.mark.parametrize("figure", ["position_error_m", "orientation_error_rad", "clearance_m"])
def test_a_lie_about_any_figure_raises(qiao, monkeypatch, figure, by):
    lie_about(monkeypatch, figure, by)
    with pytest.raises(VerificationError, match="kernels and verify disagree"):
        ikde.solve_distinct(qiao, TARGETS[0], 1, QUICK)


def test_a_difference_below_the_agreement_is_no_lie(qiao, monkeypatch):
    lie_about(monkeypatch, "position_error_m", 0.5 * AGREEMENT)
    assert ikde.solve_distinct(qiao, TARGETS[0], 1, QUICK)[0].verified


def test_in_bulk_a_lie_is_recorded_and_the_run_goes_on(qiao, monkeypatch):
    lie_about(monkeypatch, "position_error_m", 1e-6, only=TARGETS[1])
    results = ikde.solve_many(qiao, TARGETS, QUICK, verify="all")
    assert [result.verified for result in results] == [True, False, True]
    assert [result.reached for result in results] == [True, False, True]
    assert results[1].stop_reason != "reached"


def test_a_lie_in_bulk_never_claims_that_the_target_is_to_blame(qiao, monkeypatch):
    lie_about(monkeypatch, "position_error_m", 1e-6)
    result = ikde.solve_many(qiao, TARGETS[:1], QUICK)[0]
    assert "disagree" in result.reason


def test_a_search_that_claims_too_much_is_not_believed(qiao, monkeypatch):
    def boast(problem, targets, **options):
        counts = np.zeros((len(targets), COUNTS), dtype=np.int64)
        counts[:, REACHED] = 1
        q = np.tile(qiao.home, (len(targets), 1))
        nothing = np.zeros(len(targets))
        pair_counts = np.zeros((len(targets), 35), dtype=np.int64)
        engine = np.zeros(len(targets), dtype=np.int64)
        score = np.zeros((len(targets), 2))
        some = {"score": score, "excess_m": nothing, "seconds": nothing, "engine": engine}
        return Found(q=q, counts=counts, pair_counts=pair_counts, **some)

    monkeypatch.setattr("ikde.solver.rows.search", boast)
    result = ikde.solve(qiao, TARGETS[0], QUICK.with_changes(restarts=1, generations=3))
    assert not result.reached
    assert result.verified
    assert result.position_error_m > 0.1


def test_the_figures_are_of_exactly_the_returned_q(qiao):
    result = ikde.solve(qiao, TARGETS[0], QUICK)
    assert result.verification == verify(qiao, TARGETS[0], result.q, settings=QUICK)


def test_a_result_that_plain_numpy_does_not_confirm_raises(qiao):
    result = ikde.solve(qiao, TARGETS[0], seed=7)
    assert confirm(qiao, result) is result
    for name in ("position_error_m", "orientation_error_rad", "clearance_m"):
        with pytest.raises(VerificationError, match="disagree by"):
            confirm(qiao, replace(result, **{name: getattr(result, name) + 1e-9}))
    with pytest.raises(VerificationError, match="disagree by"):
        confirm(qiao, replace(result, q=result.q + 1e-3))

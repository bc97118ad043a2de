"""The verdict is the independent check's: a kernel that lies is found out."""

import numpy as np
import pytest

import ikde
from ikde.errors import VerificationError
from ikde.kernels.figures import CLEARANCE, ORIENTATION_ERROR, POSITION_ERROR
from ikde.kernels.lanes import COUNTS, REACHED
from ikde.solver import grade as module
from ikde.solver.grade import AGREEMENT, compute_disagreement
from ikde.solver.problem import make_problem
from ikde.solver.search import Found
from ikde.solver.verify import verify
from tests.conftest import random_q

QUICK = ikde.SolveSettings.for_method("auto").with_changes(restarts=4)
TARGETS = [ikde.Target((0.8, 0.1 * k, 1.0)) for k in range(3)]


def lie_about(monkeypatch, column, by, only=None):
    """Let the kernels' figures be off; `only`: for the target with this y alone."""
    honest = module.compute_figures

    def lying(robot, detector, target, index, q, out):
        honest(robot, detector, target, index, q, out)
        if only is None or target.T_world_tool[index, 1, 3] == only:
            out[column] += by

    monkeypatch.setattr(module, "compute_figures", lying)


@pytest.mark.parametrize("by", [2e-11, -1e-3, np.nan, np.inf])
@pytest.mark.parametrize("column", [POSITION_ERROR, ORIENTATION_ERROR, CLEARANCE])
def test_a_lie_about_any_figure_raises(qiao, monkeypatch, column, by):
    lie_about(monkeypatch, column, by)
    with pytest.raises(VerificationError, match="kernels and verify disagree"):
        ikde.solve(qiao, TARGETS[0], QUICK)


def test_a_difference_below_the_agreement_is_no_lie(qiao, monkeypatch):
    lie_about(monkeypatch, POSITION_ERROR, 0.5 * AGREEMENT)
    assert ikde.solve(qiao, TARGETS[0], QUICK).verified


def test_in_bulk_a_lie_is_recorded_and_the_run_goes_on(qiao, monkeypatch):
    lie_about(monkeypatch, POSITION_ERROR, 1e-6, only=TARGETS[1].p_world_tool[1])
    results = ikde.solve_many(qiao, TARGETS, QUICK)
    assert [result.verified for result in results] == [True, False, True]
    assert [result.reached for result in results] == [True, False, True]
    assert results[1].stop_reason != "reached"


def test_a_lie_in_bulk_never_claims_that_the_target_is_to_blame(qiao, monkeypatch):
    lie_about(monkeypatch, POSITION_ERROR, 1e-6)
    result = ikde.solve_many(qiao, TARGETS[:1], QUICK)[0]
    assert "disagree" in result.reason


def test_a_search_that_claims_too_much_is_not_believed(qiao, monkeypatch):
    def boast(problem, targets, **options):
        counts = np.zeros((len(targets), COUNTS), dtype=np.int64)
        counts[:, REACHED] = 1
        q = np.tile(qiao.home, (len(targets), 1))
        return Found(q=q, counts=counts, pair_counts=np.zeros((len(targets), 35), dtype=np.int64))

    monkeypatch.setattr("ikde.solver.solve.search", boast)
    result = ikde.solve(qiao, TARGETS[0], QUICK.with_changes(restarts=1, generations=3))
    assert not result.reached
    assert result.verified
    assert result.position_error_m > 0.1


def test_the_figures_are_of_exactly_the_returned_q(qiao):
    result = ikde.solve(qiao, TARGETS[0], QUICK)
    assert result.verification == verify(qiao, TARGETS[0], result.q, settings=QUICK)


def test_kernels_and_verify_agree_on_every_robot(any_robot, rng):
    problem = make_problem(any_robot, QUICK, detector=None, near=None, freeze=None)
    T = ikde.forward(any_robot, any_robot.home)[any_robot.tool]
    targets = [
        ikde.Target(T[:3, 3]),
        ikde.Target(T[:3, 3], axis_world_tool=T[:3, 2]),
        ikde.Target(T[:3, 3], R_world_tool=T[:3, :3]),
    ]
    for q in random_q(any_robot, rng, 20):
        for target in targets:
            graded = verify(any_robot, target, q, settings=QUICK)
            assert compute_disagreement(problem, target, q, graded) < 0.1 * AGREEMENT

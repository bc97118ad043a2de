"""Reached has one meaning: what an engine calls reached the grader accepts, or the search goes on."""

import numpy as np
import pytest

import ikde
from ikde.kernels.arrays import ATTEMPTS, REACHED
from ikde.model.collision_model import CollisionModel
from ikde.model.target import KINDS, Targets
from ikde.solver import referee as module
from ikde.solver.engines.search_state import make_search_state
from ikde.solver.metrics import compute_metrics
from ikde.solver.search import REFUSALS, search
from ikde.solver.settings import BulkOptions
from ikde.solver.verify import verify_many
from tests.conftest import random_q
from tests.problems import problem_of
from tests.targets import make_targets


def make(robot, **settings):
    return problem_of(robot, ikde.SolveSettings(**settings), collision="none")


@pytest.mark.parametrize("method", ["lm", "memetic"])
@pytest.mark.parametrize("kind", KINDS)
def test_for_any_tolerance_what_an_engine_calls_reached_is_accepted(kind, method, rng, monkeypatch):
    monkeypatch.setattr(module.Referee, "refuse", lambda self: np.empty(0, dtype=np.int64))
    robot = ikde.load_robot("panda")
    corners = [0.5 * np.pi, 0.5 * np.pi - 1e-9, 0.5 * np.pi + 1e-9, 3.12, np.pi]
    turns = [*10.0 ** rng.uniform(-9.0, 0.0, 5), *rng.uniform(1.0, np.pi, 6), *corners]
    for turn in turns:
        size = float(10.0 ** rng.uniform(-9.0, -0.5))
        problem = make(robot, method=method, position_tolerance_m=size, orientation_tolerance_rad=float(turn))
        targets = make_targets(robot, random_q(robot, rng, 40 if method == "lm" else 4), kind)
        found = search(problem, targets, seed=1, streams=range(len(targets)))
        accepted = verify_many(CollisionModel.of(robot, "none"), targets, found.q, problem.settings).accepted
        reached = found.counts[:, REACHED] == 1
        assert reached.any()
        assert accepted[reached].all()


def test_loose_tolerances_lose_no_target(rng):
    robot = ikde.load_robot("panda")
    settings = ikde.SolveSettings(position_tolerance_m=0.1, orientation_tolerance_rad=1.0)
    rows = ikde.solve_many(
        robot, make_targets(robot, random_q(robot, rng, 400), "pose"), settings, collision="none", method="lm"
    )
    assert rows.reached.all()


@pytest.mark.parametrize("turn", [np.pi + 1e-9, 4.0, np.inf, np.nan])
def test_no_orientation_is_farther_away_than_half_a_turn(turn):
    with pytest.raises(ikde.InputError, match="at most pi"):
        ikde.SolveSettings(orientation_tolerance_rad=turn)


def refuse(substitute, *rounds):
    """Let the grader refuse these rows, round after round."""
    left = [set(rows) for rows in rounds]

    def strict(collision, targets, Q, settings, limits):
        metrics = compute_metrics(collision, targets, Q, settings, limits)
        rows = left.pop(0) if left else set()
        for place, target in enumerate(targets):
            if round(10.0 * target.p_world_tool[1]) in rows:
                metrics.accepted[place] = False
        return metrics

    substitute(compute_metrics, strict)


TARGETS = [ikde.Target((0.8, 0.1 * k, 1.0)) for k in range(5)]


def test_a_refused_row_goes_on_with_its_next_attempt(qiao, substitute):
    problem = problem_of(qiao, ikde.SolveSettings(method="lm"))
    plain = search(problem, TARGETS, seed=7, streams=range(5))
    refuse(substitute, {1, 3}, {3})
    found = search(problem, TARGETS, seed=7, streams=range(5))
    assert found.counts[:, REACHED].all()
    assert (found.counts[:, ATTEMPTS] - plain.counts[:, ATTEMPTS] > 0).tolist() == [False, True, False, True, False]
    assert (found.q == plain.q).all(axis=1).tolist() == [True, False, True, False, True]
    after = search(problem, TARGETS[1:2], seed=7, streams=[1], first_attempt=int(plain.counts[1, ATTEMPTS]))
    assert found.q[1].tobytes() == after.q[0].tobytes()


def test_what_is_always_refused_is_not_reached_and_the_next_engine_tries(qiao, substitute):
    tried = []

    def strict(collision, targets, Q, settings, limits):
        metrics = compute_metrics(collision, targets, Q, settings, limits)
        metrics.accepted[:] = False
        tried.append(len(Q))
        return metrics

    substitute(compute_metrics, strict)
    found = search(make(qiao, restarts=2), TARGETS[:1], seed=7, streams=[0])
    assert found.counts[0, REACHED] == 0
    assert found.counts[0, ATTEMPTS] > REFUSALS
    assert np.isfinite(found.metrics.position_error_m).all()


def test_an_answer_at_the_limit_of_rounding_is_reached_or_not_but_never_wrongly(rng):
    robot = ikde.load_robot("panda")
    settings = ikde.SolveSettings(position_tolerance_m=1e-16, orientation_tolerance_rad=1e-16, restarts=40, method="lm")
    rows = ikde.solve_many(
        robot,
        make_targets(robot, random_q(robot, rng, 30), "pose"),
        settings,
        collision="none",
        bulk=BulkOptions(verify="all"),
    )
    assert 0 < rows.reached.sum() < 30
    plain = verify_many(CollisionModel.of(robot, "none"), rows.targets, rows.q, settings)
    assert plain.accepted[rows.reached].all()


def test_what_is_graded_is_what_is_returned_turned_back(rng, substitute):
    robot, graded = ikde.load_robot("ur5"), []

    def watch(collision, targets, Q, settings, limits):
        graded.append(Q.copy())
        return compute_metrics(collision, targets, Q, settings, limits)

    substitute(compute_metrics, watch)
    problem = make(robot, method="lm", restarts=1)
    targets = make_targets(robot, random_q(robot, rng, 200), "pose")
    found = search(problem, targets, seed=1, streams=range(200))
    assert graded[0].tobytes() == found.q.tobytes()
    assert (found.counts[:, REACHED] == 0).any()  # also the best of what is not reached
    wound = np.abs(found.q - robot.home) > np.pi
    assert not wound[:, [0, 1, 3, 4, 5]].any()  # the elbow has one turn only


def test_rows_with_new_attempts_are_graded_once_and_no_others(qiao, substitute):
    problem, graded = problem_of(qiao), []

    def watched(collision, targets, Q, settings, limits):
        graded.append([round(10.0 * target.p_world_tool[1]) for target in targets])
        return compute_metrics(collision, targets, Q, settings, limits)

    substitute(compute_metrics, watched)
    found = make_search_state(problem, 5)
    referee = module.Referee(problem, Targets.of(TARGETS), found)
    found.counts[[3, 4], ATTEMPTS] = 1
    referee.grade(slice(2, 5))
    referee.grade(slice(2, 5))
    assert graded == [[2, 3, 4]]  # also a row without any: it has metrics, too
    assert np.isfinite(found.metrics.position_error_m).tolist() == [False, False, True, True, True]
    found.counts[3, ATTEMPTS] = 2
    referee.grade(slice(2, 5))
    referee.refuse()
    assert graded[-2:] == [[3], [0, 1]]

"""With `near`, frozen joints or weights the quick way gives the bits of the long way, from call to call."""

import pickle

import numpy as np
import pytest

import ikde
from ikde.errors import InputError
from ikde.model.collision_model import CollisionModel
from ikde.model.target import KINDS
from ikde.solver.asker import Asker, set_ranges
from ikde.solver.problem import make_problem
from ikde.solver.quick import Quick
from ikde.solver.result import FIELDS
from ikde.solver.results import solve_rows
from ikde.solver.settings import SolveSettings
from tests.targets import free_q, make_target

AUTO = SolveSettings.for_method("auto")


@pytest.fixture
def written(monkeypatch):
    """Kernels written for a robot, as users run them; `solve_rows` goes the long way about few targets, too."""
    monkeypatch.delenv("IKDE_KERNELS", raising=False)
    monkeypatch.setattr("ikde.solver.search.answer_few", lambda *arguments, **options: None)


def ask(robot, **changes):
    return make_problem(robot, AUTO, collision=None, **{"near": None, "freeze": None, **changes})


def assert_same(quick, long):
    assert quick is not None
    own = {"q", "target", "near", "solve_seconds", "compile_seconds", "verify", "verified"}
    for name in set(FIELDS) - own:
        assert getattr(quick, name) == getattr(long, name), name
    assert quick.q.tobytes() == long.q.tobytes()
    assert quick.grade == long.grade


@pytest.mark.parametrize("kind", [KINDS[0], *(pytest.param(kind, marks=pytest.mark.slow) for kind in KINDS[1:])])
def test_every_call_has_a_near_of_its_own(written, qiao, rng, kind):
    way = Asker(CollisionModel.of(qiao), AUTO, kind)
    for stream in range(4):
        q = free_q(qiao, rng)
        target, near = make_target(qiao, q, kind), (q + rng.normal(0.0, 0.2, 9)).clip(qiao.lower, qiao.upper)
        problem = ask(qiao, near=near)
        quick = way.make(problem, Quick).solve(target, 5, stream, 0.0)
        assert_same(quick, solve_rows(problem, [target], seed=5, first_stream=stream).row(0))
        assert quick.near.tobytes() == near.tobytes()


@pytest.mark.parametrize("joints", [("d_x",), ("d_x", "q_z"), ("q2",), ("d_y", "q5")])
def test_every_call_has_frozen_values_of_its_own(written, qiao, rng, joints):
    way = Asker(CollisionModel.of(qiao), AUTO, "position")
    places = [qiao.joint_names.index(name) for name in joints]
    for stream in range(3):
        q = free_q(qiao, rng)
        target, problem = make_target(qiao, q, "position"), ask(qiao, freeze=dict(zip(joints, q[places], strict=True)))
        quick = way.make(problem, Quick).solve(target, 5, stream, 0.0)
        assert_same(quick, solve_rows(problem, [target], seed=5, first_stream=stream).row(0))
        assert quick.q[places].tobytes() == q[places].tobytes()


def test_near_and_frozen_joints_and_weights_go_together(written, qiao, rng):
    q = free_q(qiao, rng)
    problem = ask(qiao, near=q + 0.05, freeze={"d_x": q[0]}, weights={"q1": 7.0})
    target, way = make_target(qiao, q, "position"), Asker(problem.collision, AUTO, "position")
    assert_same(way.make(problem, Quick).solve(target, 5, 0, 0.0), solve_rows(problem, [target], seed=5).row(0))


def test_a_result_keeps_its_own_near(written, qiao, rng):
    """What is laid out once does not know which call it was used for last."""
    q = free_q(qiao, rng)
    target = make_target(qiao, q, "position")
    first, second = (ikde.solve(qiao, target, near=q + shift) for shift in (0.01, 0.02))
    assert (first.near == q + 0.01).all()
    assert (second.near == q + 0.02).all()
    assert pickle.loads(pickle.dumps(first)).motion == first.motion != second.motion


def test_what_is_out_of_reach_is_known_at_once(written, qiao):
    far = ikde.Target((0.0, 0.0, 9.0))
    for changes in ({"near": qiao.home}, {"freeze": {"d_x": 0.3}}, {"freeze": {"q2": 0.3}}):
        result = ikde.solve(qiao, far, **changes)
        assert result.stop_reason == "out_of_reach"
        assert result.verified is None
        assert "m too far" in result.reason


def test_where_nothing_may_move_there_is_no_quick_way(written, qiao):
    problem = ask(qiao, freeze=qiao.joint_names)
    way = Asker(problem.collision, AUTO, "position")
    assert way.make(problem, Quick) is None


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"near": [0.0] * 8}, "expected 9 joint values"),
        ({"near": [np.nan] * 9}, "expected finite joint values"),
        ({"freeze": {"q9": 0.0}}, "no joint 'q9'"),
        ({"freeze": {"q1": 1e3}}, "outside the limits"),
        ({"freeze": {"q1": np.nan}}, "expected finite joint values"),
        ({"weights": {"q1": -1.0}}, "expected a number from"),
    ],
)
def test_bad_input_is_said_in_a_line(written, qiao, changes, words):
    with pytest.raises(InputError, match=words):
        ikde.solve(qiao, ikde.Target((0.8, 0.5, 1.0)), **changes)


def test_near_of_a_result_cannot_be_changed(qiao, rng):
    q = free_q(qiao, rng)
    result = ikde.solve(qiao, make_target(qiao, q, "position"), near=q)
    with pytest.raises(ValueError, match="read-only"):
        result.near[0] = 9.0
    assert result.motion == 0.0


def test_ranges_of_the_search_those_of_turns_and_their_centre_are_written_in_their_places():
    ranges, centre = np.arange(6.0), np.array([8.0, 9.0])
    block = -np.ones(20)
    set_ranges(block, np.array([0, 16, 0]), ranges, centre)  # the grader's begin at 16
    assert block.tolist() == [-1.0, *ranges, *[-1.0] * 3, *ranges[:4], *centre, *[-1.0] * 4]

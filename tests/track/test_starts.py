"""Starts: at the first pose, free, all different; and given ones, moved a little or refused."""

from types import SimpleNamespace

import numpy as np
import pytest

from ikde.errors import InputError
from ikde.model.target import Target
from ikde.solver.forward import forward
from ikde.solver.result import StopReason
from ikde.solver.verify import verify
from ikde.track import starts as module
from ikde.track.starts import draw_starts, settle_start
from tests.track.paper_tasks import plan_of
from tests.track.tracks import TASKS, load_task, make_line, robot


def make(path, **changes):
    return plan_of(robot(), path, **changes)


@pytest.mark.parametrize("task", TASKS)
def test_drawn_starts_are_good_and_different(task):
    plan = make(load_task(task).path, seed=7)
    starts, first = draw_starts(plan)
    target = plan.path.targets()[0]
    assert first.reached
    assert len(starts) > 4
    for q in starts:
        grade = verify(robot(), target, q)
        assert grade.accepted
        assert max(grade.position_error_m, grade.orientation_error_rad) < 2e-9
    assert len(np.unique(starts.round(3), axis=0)) == len(starts)
    np.testing.assert_array_equal(draw_starts(plan)[0], starts)
    assert not np.array_equal(draw_starts(plan.with_changes(seed=8))[0][-1], starts[-1])


def test_frozen_joints_stand_where_they_must():
    plan = make(make_line([0.9, 0.2, 1.0], [0.9, 0.3, 1.0], 5), freeze={"d_x": 0.1, "q_z": -0.2})
    starts, _ = draw_starts(plan)
    assert len(starts)
    np.testing.assert_array_equal(starts[:, [0, 2]], np.tile([0.1, -0.2], (len(starts), 1)))


def test_no_start_comes_with_the_reason():
    starts, first = draw_starts(make(make_line([0.9, 0, 4.0], [0.9, 0, 1.0], 5)))
    assert (starts.shape, str(first.stop_reason)) == ((0, 9), "out_of_reach")


def test_starts_keep_the_tool_near_the_platform():
    path = load_task("task1").path
    near = make(path, max_distance_m=0.9, center="Oc")
    starts, _ = draw_starts(near)
    every, _ = draw_starts(make(path))
    frames = forward(robot(), every)
    is_near = np.linalg.norm(frames["tool"][:, :3, 3] - frames["Oc"][:, :3, 3], axis=1) <= 0.9
    np.testing.assert_array_equal(starts, every[is_near])
    with pytest.raises(InputError, match=r"farther than 0\.9 m from Oc"):
        settle_start(near, every[~is_near][0])


def test_a_start_within_the_tolerance_stays_one_near_it_moves_a_little():
    plan = make(load_task("task1").path)
    q = draw_starts(plan)[0][0]
    np.testing.assert_array_equal(settle_start(plan, q), q)
    near = q + 2e-4
    settled = settle_start(plan, near)
    assert verify(robot(), Target(plan.path.p_world_tool[0]), settled).position_error_m < 1e-8
    assert np.abs(settled - near).max() < 5e-3


def test_starts_that_are_refused():
    path = load_task("task1").path
    q = draw_starts(make(path))[0][0]
    outside, far = q.copy(), q.copy()
    outside[4], far[1] = 3.0, far[1] + 0.5
    folded = robot().home.copy()
    folded[4] = 2.5
    for start, freeze, words in (
        (outside, None, "q2 outside the limits"),
        (far, None, "500 mm"),
        (folded, None, "collide"),
        (q, {"q6": q[8] + 0.1}, "q6 is not where it is frozen"),
    ):
        with pytest.raises(InputError, match=words) as caught:
            settle_start(make(path, freeze=freeze), start)
        assert caught.value.where == ("start",)


@pytest.mark.parametrize("reason", StopReason)
def test_where_attempts_were_spent_other_random_numbers_are_tried(monkeypatch, reason):
    """A first answer that is none proves nothing if it is only what was tried."""
    none = SimpleNamespace(reached=False, stop_reason=reason)
    monkeypatch.setattr(module, "solve", lambda *_, **__: none)
    plan = make(make_line([0.9, 0.2, 1.0], [0.9, 0.3, 1.0], 5))
    starts, first = draw_starts(plan)
    assert first is none
    assert bool(len(starts)) == (reason in ("budget", "collision", "world"))


def test_where_those_find_nothing_either_no_further_are_tried(monkeypatch):
    none = SimpleNamespace(reached=False, stop_reason=StopReason.BUDGET)
    monkeypatch.setattr(module, "solve", lambda *_, **__: none)
    monkeypatch.setattr(module, "solve_many", lambda *_, **__: SimpleNamespace(reached=np.zeros(16, dtype=bool)))
    starts, first = draw_starts(make(make_line([0.9, 0.2, 1.0], [0.9, 0.3, 1.0], 5)))
    assert (starts.shape, first) == ((0, 9), none)

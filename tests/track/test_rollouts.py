"""The choice among rollouts, and the backtracking from where they end."""

from dataclasses import replace

import numpy as np
import pytest

from ikde.kernels.arrays import DRIFT
from ikde.track import rollouts
from ikde.track.follower import Rollout
from ikde.track.path import ToolPath
from ikde.track.rollouts import choose_rollout, find_farthest
from ikde.track.settings import NULLSPACE_WEIGHTS, ContinuationSettings
from ikde.track.starts import draw_starts
from tests.track.paper_tasks import follower_of
from tests.track.tracks import load_task, robot

USUAL = ContinuationSettings()


def make(path, seed=0):
    return follower_of(robot(), path, seed=seed)


def shorten(path, samples):
    """The first samples of a path."""
    R = path.R_world_tool[: samples + 1]
    return ToolPath(
        dt_s=path.dt_s, p_world_tool=path.p_world_tool[: samples + 1], orientation=path.orientation, R_world_tool=R
    )


def anything(sample):
    return True


def test_the_best_is_no_worse_than_any_other():
    follower = make(shorten(load_task("task2").path, 120), seed=3)
    starts, _ = draw_starts(follower.plan)
    best = choose_rollout(follower, starts, 120, anything, USUAL)
    each = [follower.begin(start, np.array(NULLSPACE_WEIGHTS[0])).resume(120) for start in starts]
    complete = [rollout for rollout in each if rollout.last == 120]
    assert best.last == 120
    assert len(complete) > 3
    assert rollouts._badness(best) == min(map(rollouts._badness, complete))


def test_clearance_counts_in_steps_and_motion_decides_between_equals():
    follower = make(shorten(load_task("task1").path, 60))
    starts, _ = draw_starts(follower.plan)
    rollout = follower.begin(starts[0], np.array(NULLSPACE_WEIGHTS[0])).resume()
    near, far, little = rollout.copy(), rollout.copy(), rollout.copy()
    near.spare_m[1:], far.spare_m[1:], little.spare_m[1:] = 0.011, 0.014, 0.004
    far.steps[1:] *= 0.9
    assert rollouts._badness(far) < rollouts._badness(near) < rollouts._badness(little)


def test_a_dead_end_is_left_by_backtracking():
    follower = make(load_task("task4_minus_x").path, seed=1)
    starts, _ = draw_starts(follower.plan)
    weights = (1.0, 0.3, 0.3)
    ends = [follower.begin(start, np.array(weights)).resume() for start in starts]
    stuck = [k for k, rollout in enumerate(ends) if 30 < rollout.last < 500]
    assert stuck
    only = ContinuationSettings(nullspace_weights=(weights,))
    further = [choose_rollout(follower, starts[[k]], 500, anything, only).last - ends[k].last for k in stuck[:3]]
    assert max(further) > 0


def test_backtracking_changes_what_comes_after_only():
    follower = make(shorten(load_task("task1").path, 60))
    starts, _ = draw_starts(follower.plan)
    rollout = follower.begin(starts[0], np.array(NULLSPACE_WEIGHTS[0])).resume()
    other = rollouts._rewind(rollout, 40, 8, np.random.default_rng(0), USUAL)
    assert (other.last, rollout.last) == (40, 60)
    np.testing.assert_array_equal(other.weights[:41], rollout.weights[:41])
    assert (other.weights[41:49, DRIFT:] != 0.0).all()
    assert (other.weights[49:, DRIFT:] == 0.0).all()
    assert (rollout.weights[:, DRIFT:] == 0.0).all()


def test_all_backtracks_are_made_however_short_the_rollout(monkeypatch):
    follower, rng = make(shorten(load_task("task1").path, 60)), np.random.default_rng(0)
    stuck = replace(follower.begin(robot().home, np.array(NULLSPACE_WEIGHTS[0])), last=5)
    begun = []
    monkeypatch.setattr(Rollout, "resume", lambda self, end: begun.append(self.last) or self)
    assert rollouts._backtrack(stuck, 60, 70, rng, USUAL) is stuck
    assert begun == [0] * 70


@pytest.mark.parametrize(("count", "each"), [(1000, [125] * 8), (11, [2, 2, 2, 1, 1, 1, 1, 1]), (0, [0] * 8)])
def test_rollouts_share_the_backtracks_equally(monkeypatch, count, each):
    follower, spent = make(shorten(load_task("task1").path, 60)), []
    starts = robot().home + np.arange(10.0)[:, None]
    monkeypatch.setattr(Rollout, "resume", lambda self, end: self)
    monkeypatch.setattr(rollouts, "_backtrack", lambda rollout, end, tries, *_: spent.append(tries) or rollout)
    choose_rollout(follower, starts, 60, anything, ContinuationSettings(max_backtracks=count))
    assert spent == each


def test_where_no_configuration_is_nothing_else_is_tried(monkeypatch):
    p = np.tile([0.9, 0.0, 1.0], (21, 1))
    p[10:, 2] = 3.0
    follower = make(ToolPath.through(p, dt_s=0.02))
    starts, _ = draw_starts(follower.plan)
    asked = []
    monkeypatch.setattr(rollouts, "_backtrack", None)
    rollout = choose_rollout(follower, starts, 20, lambda sample: asked.append(sample) or False, USUAL)
    assert (rollout.last, asked) == (9, [10])


def test_the_null_space_is_used_as_asked():
    follower = make(shorten(load_task("task2").path, 120), seed=3)
    starts, _ = draw_starts(follower.plan)
    still = ContinuationSettings(nullspace_weights=((0.0, 0.0, 0.0),))
    least, usual = (choose_rollout(follower, starts[:1], 120, anything, one) for one in (still, USUAL))
    assert (least.weights[1:, :DRIFT] == 0.0).all()
    assert least.motion < usual.motion


def test_the_farthest_is_the_first_of_equals():
    follower = make(shorten(load_task("task1").path, 10))
    begun = [follower.begin(robot().home, np.array(weights)) for weights in NULLSPACE_WEIGHTS[:2]]
    assert find_farthest(begun) is begun[0]

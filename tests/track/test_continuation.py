"""The search for one rollout: margins that grow, and what is cut off; and where the paper's methods begin."""

from dataclasses import replace

import numpy as np
import pytest

from ikde.model.collision_model import CollisionModel
from ikde.solver.solve import solve
from ikde.track.certify import bound_pairs
from ikde.track.continuation import Continuation, cut_at_doubt
from ikde.track.follower import MARGIN_M
from ikde.track.trajectory import TrackStop, TrackStopReason
from tests.track.paper_tasks import follower_of
from tests.track.tracks import follow_task, make_line, robot


def search(path, safe_m=0.0, **limits):
    detector = replace(CollisionModel.of(robot()).detector, safe_distance_m=safe_m)
    return Continuation(follower=follower_of(robot(), path, collision=detector, **limits))


def test_a_sample_is_solved_once(substitute):
    solved = []
    substitute(solve, lambda *a, **k: solved.append(1) or solve(*a, **k))
    one = search(make_line([0.9, 0, 1], [0.9, 0, 1.1], 5))
    assert one._is_possible(3)
    assert one._is_possible(3)
    assert len(solved) == 1


def test_nothing_to_find_is_a_stop():
    found = search(make_line([0.9, 0, 4.0], [0.9, 0, 1.0], 5)).find(None)
    assert (found.q.shape, found.stop.sample, found.stop.reason) == ((0, 9), 0, TrackStopReason.OUT_OF_REACH)
    assert found.time_steps().shape == (0,)


def test_a_first_pose_too_far_from_the_platform_is_a_stop():
    path = make_line([0.9, 0, 1.0], [0.9, 0, 1.1], 5)
    found = search(path, max_distance_m=0.1, center="Oc").find(None).stop
    assert (found.sample, found.reason, found.limit) == (0, TrackStopReason.DISTANCE_LIMIT, "Oc")


def test_what_may_touch_between_samples_is_cut_off(substitute):
    motion = follow_task("task1", "differential")
    follower = search(motion.path).follower
    rollout = follower.begin(motion.q[0], np.array([0.3, 0.3, 0.3])).resume(100)
    assert cut_at_doubt(rollout) is rollout
    pairs = follower.collision.pairs
    bounds = np.ones((100, len(pairs)))
    bounds[63, 5:7], bounds[70, 2] = (0.0, -0.1), -1.0
    substitute(bound_pairs, lambda *_: bounds)
    cut = cut_at_doubt(rollout)
    assert (cut.last, len(cut.q), cut.stop.sample) == (63, 64, 64)
    assert (cut.stop.reason, cut.stop.pair) == (TrackStopReason.COLLISION, pairs[6])


@pytest.mark.parametrize("safe_m", [0.0, 0.01])
def test_more_is_kept_above_the_safe_distance_then(substitute, safe_m):
    margins = []

    def cut(rollout):
        margins.append((rollout.follower.track.margin - safe_m) / MARGIN_M)
        stop = TrackStop(sample=4, reason=TrackStopReason.COLLISION, text="")
        return rollout if len(margins) == 2 else replace(rollout, stop=stop)

    substitute(cut_at_doubt, cut)
    found = search(make_line([0.9, 0, 1], [0.9, 0, 1.02], 5), safe_m=safe_m).find(None)
    assert [round(margin) for margin in margins] == [1, 8]
    assert found.last == 5

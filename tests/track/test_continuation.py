"""The search for one course: margins that grow, and what is cut off."""

from dataclasses import replace

import numpy as np
import pytest

from ikde.model.collision_model import CollisionModel
from ikde.solver.solve import solve
from ikde.track.certify import bound_pairs
from ikde.track.continuation import Continuation, Found, cut_at_doubt
from ikde.track.follower import MARGIN_M, make_follower
from ikde.track.limits import MotionLimits
from ikde.track.trajectory import TrackStop, TrackStopReason
from tests.track.tracks import follow_task, make_line, robot


def search(path, drive="differential", safe_m=0.0):
    detector = replace(CollisionModel.of(robot()).detector, safe_distance_m=safe_m)
    collision = CollisionModel(robot=robot(), detector=detector)
    follower = make_follower(collision, path, drive=drive, limits=MotionLimits.of(robot()))
    return Continuation(follower=follower, frozen={}, seed=0)


def test_a_sample_is_asked_about_once(substitute):
    asked = []
    substitute(solve, lambda *a, **k: asked.append(1) or solve(*a, **k))
    looking = search(make_line([0.9, 0, 1], [0.9, 0, 1.1], 5))
    assert looking._is_possible(3)
    assert looking._is_possible(3)
    assert len(asked) == 1


def test_nothing_to_find_is_a_stop():
    found = search(make_line([0.9, 0, 4.0], [0.9, 0, 1.0], 5)).find(None)
    assert (found.q.shape, found.stop.sample, found.stop.reason) == ((0, 9), 0, TrackStopReason.OUT_OF_REACH)
    assert found.follower.follow_timed(found.course).shape == (0,)


def test_a_first_pose_too_far_from_the_platform_is_a_stop():
    limits = MotionLimits.of(robot(), farthest_m=0.1, center="Oc")
    path = make_line([0.9, 0, 1.0], [0.9, 0, 1.1], 5)
    follower = make_follower(CollisionModel.of(robot()), path, limits=limits, drive="differential")
    found = Continuation(follower=follower, frozen={}, seed=0).find(None).stop
    assert (found.sample, found.reason, found.limit) == (0, TrackStopReason.DISTANCE_LIMIT, "Oc")


def test_what_may_touch_between_samples_is_cut_off(substitute):
    motion = follow_task("task1", "differential")
    looking = search(motion.path)
    course = looking.follower.follow(looking.follower.begin(motion.q[0], np.array([0.3, 0.3, 0.3])), 100)
    found = Found(course=course, follower=looking.follower, stop=None)
    assert cut_at_doubt(found) is found
    pairs = found.follower.collision.pairs
    bounds = np.ones((100, len(pairs)))
    bounds[63, 5:7], bounds[70, 2] = (0.0, -0.1), -1.0
    substitute(bound_pairs, lambda *_: bounds)
    cut = cut_at_doubt(found)
    assert (cut.course.last, len(cut.q), cut.stop.sample) == (63, 64, 64)
    assert (cut.stop.reason, cut.stop.pair) == (TrackStopReason.SELF_COLLISION, pairs[6])


@pytest.mark.parametrize("safe_m", [0.0, 0.01])
def test_more_is_kept_above_the_safe_distance_then(substitute, safe_m):
    margins = []

    def cut(found):
        margins.append((found.follower.track.margin - safe_m) / MARGIN_M)
        stop = TrackStop(sample=4, reason=TrackStopReason.SELF_COLLISION, text="")
        return found if len(margins) == 2 else Found(course=found.course, follower=found.follower, stop=stop)

    substitute(cut_at_doubt, cut)
    looking = search(make_line([0.9, 0, 1], [0.9, 0, 1.02], 5), safe_m=safe_m)
    found = looking.find(None)
    assert [round(margin) for margin in margins] == [1, 8]
    assert found.course.last == 5

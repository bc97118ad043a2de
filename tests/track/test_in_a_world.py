"""Tracks among obstacles: they slide along them, are certified, or name what is in the way."""

import numpy as np
import pytest

import ikde
from ikde.errors import InputError
from ikde.track.certify import certify
from ikde.track.certify_world import compute_room
from tests.track.shelf import SHELF, make_path, place


@pytest.fixture(scope="module")
def alone():
    return ikde.follow_path("qiao2021", make_path())


def test_a_path_through_a_shelf_is_followed_and_certified(alone):
    model = place(SHELF, 0.01)
    assert ikde.check_many("qiao2021", alone.q, model).collision.any()  # it needs another motion
    motion = ikde.follow_path("qiao2021", make_path(), collision=model)
    assert motion.reached
    assert motion.certificate.is_free
    assert (compute_room(model, motion.q) > 0.0).all()
    seen = ikde.check_many("qiao2021", motion.q, model)
    assert not seen.collision.any()
    np.testing.assert_allclose(motion.clearance_m, seen.clearance_m)


def test_a_world_alone_is_kept_from_without_a_margin():
    world = ikde.load_world({"obstacles": SHELF})
    motion = ikde.follow_path("qiao2021", make_path(), collision=world)
    again = ikde.follow_path("qiao2021", make_path(), collision=place(SHELF))
    np.testing.assert_array_equal(motion.q, again.q)
    assert motion.certificate.world_m.min() > 0.0


def test_a_world_that_is_far_changes_no_bit(alone):
    far = place({"ball": {"sphere": {"radius": 0.1}, "position": [0, 0, 50]}})
    np.testing.assert_array_equal(ikde.follow_path("qiao2021", make_path(), collision=far).q, alone.q)


def test_an_obstacle_on_the_path_is_named_with_its_sample(alone):
    ball = place({"ball": {"sphere": {"radius": 0.05}, "position": [0.9, 0.2, 0.9]}})
    motion = ikde.follow_path("qiao2021", make_path(), collision=ball)
    assert not motion.reached
    assert motion.stop.reason == "collision"
    assert motion.stop.pair[1] == "ball"
    assert motion.stop.sample == motion.reached_points + 1
    assert "ball" in motion.stop.line
    assert motion.certificate.is_free  # what was followed


def test_a_first_pose_in_an_obstacle_is_refused_with_what_would_help():
    ball = place({"ball": {"sphere": {"radius": 0.1}, "position": [0.9, 0.0, 0.9]}})
    motion = ikde.follow_path("qiao2021", make_path(), collision=ball)
    assert (motion.stop.sample, len(motion.q)) == (0, 0)
    assert "ball" in motion.stop.line


def test_verdicts_on_a_given_motion(alone):
    """The judge and the certificate see the world, whatever made the motion."""
    post = place({"post": {"sphere": {"radius": 0.1}, "position": [0.9, 0.1, 0.9]}})
    grade = ikde.track.verify_track.verify_track(post, make_path(), alone.q, drive="differential", limits=alone.limits)
    assert grade.violations.collision == int(ikde.check_many("qiao2021", alone.q, post).collision.sum()) > 0
    assert not grade.accepted
    assert grade.clearance_m == pytest.approx(ikde.check_many("qiao2021", alone.q, post).clearance_m.min())
    assert not certify(post, alone.q, "differential").is_free


def test_a_start_in_an_obstacle_is_named(alone):
    ball = place({"ball": {"sphere": {"radius": 0.1}, "position": [0.9, 0.0, 0.9]}})
    with pytest.raises(InputError, match=r"^start: .* and ball collide$"):
        ikde.follow_path("qiao2021", make_path(), collision=ball, start=alone.q[0])


def test_what_always_touches_is_refused():
    floor = {"floor": {"half_space": {}, "position": [0, 0, 0.05]}}
    with pytest.raises(InputError, match=r"ignore: \["):
        ikde.follow_path("qiao2021", make_path(), collision=place(floor))

"""One attempt along a path: it stops where it can't go on, is resumed where it stopped, and can be timed."""

import numpy as np
import pytest

from ikde.solver.plain import compute_frames
from ikde.track.follower import MARGIN_M, REACH_M
from ikde.track.limits import MotionLimits
from ikde.track.path import ToolPath
from tests.endless_robot import ENDLESS
from tests.robot_files import load_text
from tests.track.paper_tasks import follower_of
from tests.track.tracks import follow_task, make_line, robot

WEIGHTS = np.array([0.3, 0.3, 0.3])


@pytest.fixture(scope="module")
def start():
    """A configuration at the first pose of task 1, and its follower."""
    motion = follow_task("task1", "differential")
    return motion.q[0], follower_of(robot(), motion.path)


def test_it_is_resumed_where_it_stopped(start):
    q, follower = start
    whole = follower.begin(q, WEIGHTS).resume(100)
    parts = follower.begin(q, WEIGHTS).resume(37).resume(100)
    assert (whole.last, parts.last) == (100, 100)
    np.testing.assert_array_equal(whole.q[:101], parts.q[:101])


def test_it_can_be_timed_without_being_changed(start):
    q, follower = start
    rollout = follower.begin(q, WEIGHTS).resume(50)
    before = rollout.copy()
    seconds = rollout.time_steps()
    assert (seconds.shape, bool((seconds > 0.0).all())) == ((50,), True)
    np.testing.assert_array_equal(rollout.q, before.q)


def test_its_figures(start):
    q, follower = start
    rollout = follower.begin(q, WEIGHTS).resume(40)
    assert 0.0 < rollout.clearance_m <= REACH_M
    assert rollout.motion == pytest.approx((rollout.steps[:41] ** 2).sum())
    assert follower.begin(q, WEIGHTS).clearance_m == REACH_M


def test_it_stops_where_it_cannot_go_on(start):
    q, follower = start
    slow = follower.with_drive(largest=0.02 * follower.drive.largest)
    rollout = slow.begin(q, WEIGHTS).resume()
    assert rollout.last == 0
    assert np.abs(rollout.steps[1]).max() == 1.0


def test_what_is_packed_for_the_kernels():
    path = make_line([0.9, 0, 1], [0.9, 0.1, 1], 5)
    track = follower_of(robot(), path, drive="omnidirectional", position_error_m=1e-10).track
    assert (track.margin, track.reach) == (MARGIN_M, REACH_M)
    assert track.position_goal <= track.position_tolerance < 1e-10
    assert (track.ranges[0] > robot().lower).all()
    assert (track.ranges[1] < robot().upper).all()
    loose = follower_of(robot(), path, drive="omnidirectional", ranges=False).track
    assert np.abs(loose.ranges).min() > 1e4
    unchecked = follower_of(robot(), path, collision="none")
    assert (unchecked.track.reach, unchecked.size) == (-np.inf, 8)


def test_a_joint_without_limits_has_ranges_that_can_be_reckoned_with():
    endless, path = load_text(ENDLESS), make_line([0.5, 0, 0.5], [0.5, 0.1, 0.5], 5)
    for ranges in (True, False):
        track = follower_of(endless, path, drive="omnidirectional", ranges=ranges).track
        assert np.isfinite(track.ranges).all()
        assert (np.abs(track.ranges[:, [0, 5]]) > 1e4).all()


def test_a_twofold_singularity_is_passed():
    """Elbow straight, wrist nearly, base frozen: with the usual stiffness it would take 200 rounds."""
    speed = MotionLimits.of(robot()).speed.copy()
    speed[:3] = 0.0
    q = np.zeros((2, 9))
    q[0, 3:] = [0.445, -0.2991, 0.0, -0.8372, 0.0318, -0.2938]
    q[1, 3:] = [0.4634, -0.3129, 0.0146, -0.8374, 0.0192, -0.2959]
    T = compute_frames(robot(), q)["tool"]
    path = ToolPath.through(T[:, :3, 3], dt_s=0.02, R_world_tool=T[:, :3, :3])
    follower = follower_of(robot(), path, speed=speed, collision="none")
    assert follower.begin(q[0], np.zeros(3)).resume().last == 1

"""A trajectory is plain data: how far it came, when, and how fast."""

from dataclasses import replace

import numpy as np

from ikde.track.trajectory import TrackStop, TrackStopReason
from tests.track.motions import KEPT, make_motion


def test_a_whole_motion_is_reached():
    motion = make_motion()
    assert (motion.reached, motion.reached_points, motion.stop) == (True, 4, None)
    np.testing.assert_allclose(motion.times_s, [0, 0.02, 0.04, 0.06, 0.08])
    np.testing.assert_allclose(motion.joint_speeds[:, 3:], np.diff(motion.q[:, 3:], axis=0) / 0.02)


def test_it_introduces_itself_in_a_line():
    stop = TrackStop(sample=3, reason=TrackStopReason.COLLISION, text="")
    told = "continuation, differential, 2 of 4 points, stopped"
    assert repr(make_motion(reached=2, stop=stop)) == f"<Trajectory of made up: {told}>"


def test_a_stop_says_where_and_why():
    stop = TrackStop(sample=3, reason=TrackStopReason.COLLISION, text="(M, L2) touch", pair=("M", "L2"))
    motion = make_motion(reached=2, stop=stop)
    assert (motion.reached, motion.reached_points, len(motion.times_s)) == (False, 2, 3)
    assert (str(motion.stop.reason), motion.stop.limit) == ("collision", None)


def test_what_was_found_about_it_is_told_in_short():
    motion, graded = make_motion(), make_motion().grade
    np.testing.assert_array_equal(motion.error_m, graded.error_m)
    np.testing.assert_array_equal(motion.orientation_error_rad, graded.orientation_error_rad)
    assert (motion.clearance_m.tolist(), motion.certified_clearance_m) == ([0.05] * 5, 0.04)
    assert (len(motion.deviation_m), len(motion.deviation_rad)) == (4, 4)


def test_without_pairs_there_is_no_clearance():
    motion = make_motion(pairs=0)
    assert (motion.clearance_m, motion.certified_clearance_m, motion.certificate) == (None, None, None)
    assert make_motion(reached=-1).certified_clearance_m is None


def test_a_start_alone_has_the_clearance_of_its_sample():
    assert make_motion(reached=0).certified_clearance_m == 0.05


def test_what_was_not_checked_is_no_violation():
    motion = make_motion(pairs=0, violations=replace(KEPT, collision=None))
    assert (motion.reached, motion.violations.total) == (True, 0)
    assert make_motion(violations=replace(KEPT, collision=None, speed=2)).violations.total == 2


def test_a_broken_limit_is_no_success():
    motion = make_motion(violations=replace(KEPT, speed=2))
    assert (motion.stop, motion.reached, motion.violations.total) == (None, False, 2)


def test_nothing_reached_is_no_motion():
    stop = TrackStop(sample=0, reason=TrackStopReason.OUT_OF_REACH, text="too far")
    assert make_motion(reached=-1, stop=stop).reached_points == 0


def test_reasons_are_words():
    assert all(reason == reason.name.lower() for reason in TrackStopReason)

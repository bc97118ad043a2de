"""A trajectory is plain data: how far it came, when, and how fast."""

import numpy as np

from ikde.track.trajectory import TrackStop, TrackStopReason
from tests.track.motions import make_motion


def test_a_whole_motion_is_reached():
    motion = make_motion()
    assert (motion.reached, motion.reached_points, motion.stop) == (True, 4, None)
    np.testing.assert_allclose(motion.times_s, [0, 0.02, 0.04, 0.06, 0.08])
    np.testing.assert_allclose(motion.joint_speeds[:, 3:], np.diff(motion.q[:, 3:], axis=0) / 0.02)


def test_a_stop_says_where_and_why():
    stop = TrackStop(sample=3, reason=TrackStopReason.SELF_COLLISION, text="(M, L2) touch", pair=("M", "L2"))
    motion = make_motion(reached=2, stop=stop)
    assert (motion.reached, motion.reached_points, len(motion.times_s)) == (False, 2, 3)
    assert (str(motion.stop.reason), motion.stop.limit) == ("self_collision", None)


def test_nothing_reached_is_no_motion():
    stop = TrackStop(sample=0, reason=TrackStopReason.OUT_OF_REACH, text="too far")
    assert make_motion(reached=-1, stop=stop).reached_points == 0


def test_reasons_are_words():
    assert all(reason == reason.name.lower() for reason in TrackStopReason)

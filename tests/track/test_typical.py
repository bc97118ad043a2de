"""`typical`: it meets the samples, goes on to the end, and breaks what it does not look at."""

import numpy as np

from ikde.track.follow_path import follow_path
from ikde.track.typical import TypicalSettings, bound_sample, follow_typical
from tests.track.paper_tasks import follower_of, short_task, start_of


def test_it_meets_the_samples_and_jumps(qiao):
    start = start_of("qiao2021", 1)
    motion = follow_path(qiao, short_task(1), drive="omnidirectional", method="typical", start=start)
    assert motion.stop is None
    assert motion.reached_points == 10
    assert motion.breaches.speed > 10
    assert not motion.reached
    assert motion.certified_clearance_m < motion.clearance_m.min()
    assert motion.breaches.range == 0


def test_it_moves_every_joint_by_itself_whatever_the_base(qiao):
    settings = TypicalSettings(generations=5)
    told = {"method": "typical", "start": start_of("qiao2021", 1), "settings": settings}
    motion = follow_path(qiao, short_task(1), drive="differential", **told)
    assert (motion.drive, motion.wheel_speeds, motion.breaches.sideways) == ("omnidirectional", None, 0)
    np.testing.assert_allclose(motion.v * 0.02, np.diff(motion.q[:, :2], axis=0), atol=1e-12)


def test_the_base_stays_near_and_frozen_joints_where_they_are(qiao):
    start, settings = start_of("qiao2021", 1), TypicalSettings(base_range_m=0.1, generations=5)
    follower = follower_of(qiao, short_task(1), frozen=("q2",))
    lower, upper = bound_sample(follower, settings, start)
    np.testing.assert_allclose(upper[:2] - lower[:2], 0.2)
    assert lower[4] == upper[4] == start[4]
    np.testing.assert_array_equal((lower[5:], upper[5:]), (qiao.lower[5:], qiao.upper[5:]))
    q, seconds = follow_typical(follower, start, 0, settings)
    assert len(seconds) == 10
    assert np.abs(np.diff(q[:, :2], axis=0)).max() <= 0.1
    assert (q[:, 4] == start[4]).all()


def test_same_seed_same_bits(qiao):
    follower, settings = follower_of(qiao, short_task(1)), TypicalSettings(generations=5)
    first, again, other = (follow_typical(follower, start_of("qiao2021", 1), seed, settings)[0] for seed in (1, 1, 2))
    np.testing.assert_array_equal(first, again)
    assert (first[1:] != other[1:]).any()

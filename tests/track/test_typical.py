"""`typical`: it meets the samples, goes on to the end, and violates what it ignores."""

from dataclasses import replace

import numpy as np

from ikde.track.follow_path import follow_path
from ikde.track.settings import TypicalSettings
from ikde.track.typical import bound_sample, follow_typical
from tests.track.paper_tasks import follower_of, short_task, start_of


def test_it_meets_the_samples_and_jumps(qiao):
    start = start_of("qiao2021", 1)
    motion = follow_path(qiao, short_task(1), drive="omnidirectional", method="typical", start=start)
    assert motion.stop is None
    assert motion.reached_points == 10
    assert motion.violations.speed > 10
    assert not motion.reached
    assert motion.certified_clearance_m < motion.clearance_m.min()
    assert motion.violations.range == 0


def test_it_moves_every_joint_by_itself_whatever_the_base(qiao):
    settings = TypicalSettings(generations=5)
    options = {"method": "typical", "start": start_of("qiao2021", 1), "settings": settings}
    motion = follow_path(qiao, short_task(1), drive="differential", **options)
    assert (motion.drive, motion.wheel_speeds, motion.violations.sideways) == ("omnidirectional", None, 0)
    np.testing.assert_allclose(motion.v * 0.02, np.diff(motion.q[:, :2], axis=0), atol=1e-12)


def test_the_base_stays_near_and_frozen_joints_where_they_are(qiao):
    start, settings = start_of("qiao2021", 1), TypicalSettings(base_range_m=0.1, generations=5)
    follower = typical(qiao, settings, freeze=("q2",))
    lower, upper = bound_sample(follower, settings, start)
    np.testing.assert_allclose(upper[:2] - lower[:2], 0.2)
    assert lower[4] == upper[4] == start[4]
    np.testing.assert_array_equal((lower[5:], upper[5:]), (qiao.lower[5:], qiao.upper[5:]))
    followed = follow_typical(follower)
    assert len(followed.seconds) == 10
    assert np.abs(np.diff(followed.q[:, :2], axis=0)).max() <= 0.1
    assert (followed.q[:, 4] == start[4]).all()


def test_a_joint_without_limits_turns_half_a_turn_at_most_from_where_it_is(qiao):
    endless = replace(qiao.joints[8], kind="continuous", lower=-np.inf, upper=np.inf)
    follower = typical(replace(qiao, joints=(*qiao.joints[:8], endless)), TypicalSettings())
    lower, upper = bound_sample(follower, TypicalSettings(), np.full(9, 20.0))
    assert (lower[8], upper[8]) == (20.0 - np.pi, 20.0 + np.pi)


def test_same_seed_same_bits(qiao):
    settings = TypicalSettings(generations=5)
    first, again, other = (follow_typical(typical(qiao, settings, seed=seed)).q for seed in (1, 1, 2))
    np.testing.assert_array_equal(first, again)
    assert (first[1:] != other[1:]).any()


def typical(robot, settings, **changes):
    """A follower of this method along task 1, from its start."""
    start = start_of("qiao2021", 1)
    return follower_of(robot, short_task(1), method="typical", start=start, settings=settings, **changes)

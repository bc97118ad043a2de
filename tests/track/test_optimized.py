"""`optimized`: the limits at samples are kept, and what ends it is named."""

from dataclasses import replace

import numpy as np
import pytest

from ikde.model.collision_model import CollisionModel
from ikde.track.drive import pack_drive
from ikde.track.follow_path import follow_path
from ikde.track.limits import MotionLimits
from ikde.track.optimized import _evolve_samples, find_broken, follow_optimized
from ikde.track.path import ToolPath
from ikde.track.settings import OptimizedSettings
from tests.track.paper_tasks import follower_of, short_task, start_of

FEW = OptimizedSettings(generations=100, max_redraws=1)


def optimized(robot, path, **changes):
    """A follower of this method from task 1's start."""
    return follower_of(robot, path, method="optimized", start=start_of("qiao2021", 1), **changes)


@pytest.mark.parametrize("drive", ["differential", "omnidirectional"])
@pytest.mark.parametrize("number", [1, 2, 3, 4])
def test_the_tasks_begin_well(qiao, number, drive):
    path, start = short_task(number), start_of("qiao2021", number)
    motion = follow_path(qiao, path, drive=drive, method="optimized", start=start)
    assert motion.stop is None
    assert motion.reached
    assert motion.violations.total == 0
    assert np.abs(motion.error_m).max() <= 1e-6
    assert motion.orientation_error_rad.max() <= 1e-4
    assert motion.clearance_m.min() > 0.0
    assert motion.certified_clearance_m is not None
    np.testing.assert_array_equal(motion.q[0], start)


def test_same_seed_same_bits(qiao):
    options = {"method": "optimized", "start": start_of("qiao2021", 1)}
    first, again, other = (follow_path(qiao, short_task(1), seed=seed, **options) for seed in (1, 1, 2))
    np.testing.assert_array_equal(first.q, again.q)
    assert (first.q[1:] != other.q[1:]).any()


def test_a_frozen_joint_stays(qiao):
    start = start_of("qiao2021", 1)
    motion = follow_path(qiao, short_task(1), method="optimized", start=start, freeze=["q1"])
    assert (motion.q[:, 3] == start[3]).all()
    assert motion.reached


def test_an_acceleration_limit_is_kept_too(qiao):
    follower = optimized(qiao, short_task(1), acceleration=np.full(9, 5.0))
    followed = follow_optimized(follower)
    rates = np.diff(followed.q[:, 3:], axis=0) / 0.02
    assert followed.stop is None
    assert np.abs(np.diff(rates, axis=0) / 0.02).max() <= 5.0 * (1 + 1e-9)


def moved(shift, samples=2):
    """Task 1's first pose, and then as many shifted ones."""
    p = short_task(1).p_world_tool[0] + np.outer(np.arange(samples + 1), shift)
    return ToolPath(dt_s=0.02, p_world_tool=p)


def test_what_is_too_fast_names_the_limit(qiao):
    followed = follow_optimized(optimized(qiao, moved([0.0, 0.2, 0.0]), settings=FEW))
    assert followed.stop.sample == 1
    assert followed.stop.reason == "speed_limit"
    assert followed.stop.limit in ("the base", *qiao.joint_names)
    assert "mm away, with" in followed.stop.text
    assert len(followed.q) == 1


def test_what_is_out_of_reach_is_said_to_be(qiao):
    followed = follow_optimized(optimized(qiao, moved([0.0, 0.0, 2.0]), settings=FEW))
    assert followed.stop.reason == "out_of_reach"


def test_a_collision_names_its_pair(qiao):
    follower = optimized(qiao, short_task(1), settings=OptimizedSettings(max_redraws=1, generations=300))
    detector = replace(follower.collision.detector, safe_distance_m=1.0)
    tight = replace(follower.plan, collision=CollisionModel.of(qiao, detector))
    _, _, stop = _evolve_samples(replace(follower, plan=tight), follower.plan.start)
    assert stop.reason == "collision"
    assert stop.pair in tight.collision.pairs
    assert stop.text.startswith("sample 1 (0.02 s): ")


def test_a_wheel_limit_is_named(qiao):
    start = start_of("qiao2021", 1)
    drive = pack_drive(qiao, "differential", MotionLimits.of(qiao, wheel_speed_rad_s=0.5), 0.02)
    follower = replace(follower_of(qiao, moved([0.0, 0.004, 0.0])), drive=drive)
    fast = np.zeros(follower.size)
    fast[0] = 1.0
    assert find_broken(follower, start, fast)[::2] == ("wheel_limit", "wheels")
    assert find_broken(follower, start, 0.0 * fast)[0] == "joint_limit"

"""The figures of a motion, against what is known of one that was made up."""

from dataclasses import replace

import numpy as np
import pytest

from ikde.model.collision_model import CollisionModel
from tests.random_robots import make_frame, make_robot, with_ranges
from tests.track.measured import DT_S, make_measured, wave
from tests.track.worlds import TOUCHED, make_among, measure_apart


@pytest.fixture(scope="module")
def motion(qiao):
    return make_measured(qiao)


def test_it_meets_its_own_path(motion):
    assert motion.met_points == 20
    assert motion.largest_axis_errors_m.max() == 0.0
    assert motion.started
    assert [motion.robot.joint_names[k] for k in motion.arm] == ["q1", "q2", "q3", "q4", "q5", "q6"]


def test_the_base_counts_by_its_arc(motion):
    np.testing.assert_allclose(motion.grade.driven[:, :2], 0.2)
    np.testing.assert_allclose(motion.grade.driven[:, 2], 0.3)
    assert motion.largest_step("prismatic") == pytest.approx(0.2 * DT_S)
    assert motion.wheel_limit_rad_s == pytest.approx((0.5 + 0.259 * np.pi / 2) / 0.1)


def test_without_wheels_the_base_counts_by_its_arc_all_the_same(motion, unwheeled):
    bare = make_measured(unwheeled)
    np.testing.assert_array_equal(bare.grade.driven, motion.grade.driven)
    assert bare.trajectory.wheel_speeds is None
    assert bare.wheel_limit_rad_s == np.inf


def test_the_fastest_joint_is_named(qiao, motion):
    speeds = np.abs(np.diff(wave(qiao, 20, 0.05), axis=0)) / DT_S
    name, value, limit = motion.fastest
    assert (name, limit) == ("d_x", 0.5)
    assert value == pytest.approx(0.2)
    name, value, limit = make_measured(qiao, amplitude=0.2).fastest
    assert (name, limit) == ("q3", np.pi / 2)
    assert value == pytest.approx(4 * speeds[:, 5].max())


def test_the_rest_of_a_range_is_the_smallest(qiao, motion):
    name, left, end = motion.range_left
    assert name == "q1"
    assert end == pytest.approx(np.radians(169))
    assert left == pytest.approx(np.radians(169) - qiao.home[3] - 0.025)


BASE = [
    make_frame("x", "world", joint="d_x", axis=(1, 0, 0)),
    make_frame("y", "x", joint="d_y", axis=(0, 1, 0)),
    make_frame("z", "y", joint="q_z", axis=(0, 0, 1)),
]
SLIDES = {"d_x": "prismatic", "d_y": "prismatic"}


def test_a_lift_that_touches_its_end_is_named():
    kinds = {**SLIDES, "q_z": "revolute", "lift": "prismatic", "q1": "revolute"}
    up, arm = (
        make_frame("up", "z", joint="lift", axis=(0, 0, 1)),
        make_frame("arm", "up", joint="q1", axis=(0, 1, 0)),
    )
    robot = make_robot(kinds, [*BASE, up, arm, make_frame("tool", "arm", (1, 0, 0))])
    q = [[-1.0, 0, 0, 0.9, -0.9], [-1.0, 0, 0, 1.0, -0.9]]
    motion = make_measured(robot, q=q, detector="none", drive="omnidirectional")
    assert motion.trajectory.base_joints == ("d_x", "d_y", "q_z")
    assert motion.range_left == ("lift", 0.0, 1.0)


def test_what_is_left_counts_by_its_share(qiao, motion):
    assert with_q6_in(qiao, motion, 0.5).range_left[0] == "q1"
    name, left, end = with_q6_in(qiao, motion, 0.011).range_left
    assert (name, end) == ("q6", qiao.home[8] + 0.011)
    assert left == pytest.approx(0.011 - 0.05 * 0.2)


def by_robot(motion, robot):
    """The motion as if this robot had made it."""
    return replace(motion, collision=CollisionModel.of(robot))


def with_q6_in(robot, motion, half):
    """The motion with q6 kept so near home, rad."""
    return by_robot(motion, with_ranges(robot, {"q6": (robot.home[8] - half, robot.home[8] + half)}))


@pytest.mark.parametrize("ends", [(-np.inf, np.inf), (-10.0, np.inf), (None, None)])
def test_a_joint_without_a_range_does_not_count(qiao, motion, ends):
    home = dict(zip(qiao.joint_names, qiao.home, strict=True))
    still = replace(motion, trajectory=replace(motion.trajectory, q=np.tile(qiao.home, (3, 1))))
    free = {name: tuple(home[name] if end is None else end for end in ends) for name in qiao.joint_names}
    assert by_robot(still, with_ranges(qiao, free)).range_left is None
    assert by_robot(still, with_ranges(qiao, {**free, "q2": (-7.0, 7.0)})).range_left[0] == "q2"


def test_a_joint_beyond_its_range_is_named_before_all(qiao, motion):
    robot = with_ranges(qiao, {"q1": (-np.inf, qiao.home[3] - 0.01), "q2": (qiao.home[4] - 1.0, qiao.home[4] + 0.04)})
    name, left, _ = by_robot(motion, robot).range_left
    assert name == "q1"
    assert left < 0.0


def test_the_tools_distance_counts_where_it_is_limited(qiao, motion):
    assert motion.largest_distance_m is None
    near = make_measured(qiao, max_distance_m=5.0, center="Oc")
    assert near.largest_distance_m == near.grade.distance_m.max() > 0.0


def test_limits_that_are_off_have_no_worst(qiao):
    motion = make_measured(qiao, speed=None)
    assert motion.fastest is None
    assert motion.largest_acceleration is None
    assert motion.wheel_limit_rad_s == np.inf


def test_an_acceleration_is_named(qiao):
    motion = make_measured(qiao, acceleration=np.full(9, 10.0))
    name, value, limit = motion.largest_acceleration
    assert (name, limit) == ("q3", 10.0)
    assert value > 0.0


def test_what_collides_is_named(qiao):
    free, folded = make_measured(qiao), make_measured(qiao, amplitude=2.6)
    assert not any(free.colliding)
    assert any(folded.colliding)
    assert folded.grade.violations.collision == sum(map(bool, folded.colliding))
    worst = np.argmin(folded.grade.gaps_m.min(axis=1))
    assert set(folded.closest_pair) <= folded.colliding[worst]


def test_without_a_detector_nothing_is_said_of_collisions(qiao):
    motion = make_measured(qiao, detector="none")
    assert (motion.closest_pair, motion.certificate, motion.grade.violations.collision) == (None, None, None)
    assert not any(motion.colliding)


def test_the_least_room_of_a_world_has_its_sample_and_place(qiao):
    motion = make_among(qiao, obstacles={"ball": {"sphere": {"radius": 0.05}, "position": [0.74, -0.3, 0.96]}})
    sample, place = motion.closest_obstacle
    away = measure_apart(motion, "ball")
    assert sample == int(np.argmin(away))
    assert motion.collision.name_pair(place)[1] == "ball"
    assert motion.grade.gaps_m[sample, place] == pytest.approx(away.min())
    assert make_measured(qiao).closest_obstacle is None


def test_what_is_touched_of_a_world_is_named_by_sample(qiao):
    motion = make_among(qiao, obstacles=TOUCHED)
    away = measure_apart(motion, "ball")
    assert [names == {"ball"} for names in motion.touched] == (away <= 0.0).tolist()
    assert 0 < sum(map(len, motion.touched)) < 21
    assert all(touched <= names for touched, names in zip(motion.touched, motion.colliding, strict=True))

"""The bound on the tool's orientation is sound for any tree, and sharp where few joints turn the tool."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ikde.model.bounds import find_bounds
from ikde.model.rotation import rotation_from_rpy
from ikde.model.target import Target
from tests import reference
from tests.random_robots import make_frame, make_robot, random_robot
from tests.scara import make_scara

few = settings(max_examples=150)
HERE = (0.0, 0.0, 0.0)


def orientation_excess_rad(robot, target, lower, upper):
    return find_bounds(robot, lower, upper).orientation.excess_rad(target)


def miss_rad(robot, target, q):
    """By how much the tool's orientation misses the target at `q` [N]."""
    return reference.compute_orientation_error(reference.compute_frames(robot, q)[robot.tool], target)


def random_target(rng):
    if rng.random() < 0.5:
        return Target(HERE, axis_world_tool=rng.normal(size=3))
    return Target(HERE, rotation_from_rpy(rng.uniform(-np.pi, np.pi, 3)))


@few
@given(seed=st.integers(0, 10_000))
def test_no_random_robot_turns_its_tool_beyond_the_bound(seed):
    robot, rng = random_robot(seed), np.random.default_rng(seed)
    for _ in range(10):
        q = rng.uniform(-np.pi, np.pi, len(robot.joints))
        held, target = rng.random(len(q)) < 0.4, random_target(rng)
        lower, upper = np.where(held, q, robot.lower), np.where(held, q, robot.upper)
        assert orientation_excess_rad(robot, target, lower, upper) <= miss_rad(robot, target, q) + 1e-12


@few
@given(seed=st.integers(0, 10_000))
def test_an_orientation_that_the_tool_has_is_never_out_of_reach(seed):
    robot, rng = random_robot(seed), np.random.default_rng(seed)
    q = rng.uniform(-np.pi, np.pi, len(robot.joints))
    held, R = rng.random(len(q)) < 0.4, reference.compute_frames(robot, q)[robot.tool][:3, :3]
    lower, upper = np.where(held, q, robot.lower), np.where(held, q, robot.upper)
    for target in (Target(HERE, R), Target(HERE, axis_world_tool=R[:, 2]), Target(HERE)):
        assert orientation_excess_rad(robot, target, lower, upper) == 0.0


@pytest.mark.parametrize(("axis", "off"), [((0, 0, -1), 0.0), ((1, 0, -1), np.pi / 4), ((0, 0, 1), np.pi)])
def test_the_axis_of_a_scara_never_leaves_the_vertical(axis, off):
    robot = make_scara()
    target = Target((0.4, 0.0, -0.1), axis_world_tool=axis)
    assert orientation_excess_rad(robot, target, robot.lower, robot.upper) == pytest.approx(off, abs=1e-12)


@pytest.mark.parametrize("tilt", [0.0, 1e-3, 0.7])
def test_nor_does_its_tool_tilt(tilt):
    robot = make_scara()
    target = Target((0.4, 0.0, -0.1), rotation_from_rpy(np.array([np.pi - tilt, 0.0, 0.6])))
    assert orientation_excess_rad(robot, target, robot.lower, robot.upper) == pytest.approx(tilt, abs=1e-12)


def make_wrist(between, mounted):
    """Two joints whose axes are `between` rad apart, and a tool `mounted` rad off the second."""
    return make_robot(
        {"first": "revolute", "second": "revolute"},
        [
            make_frame("a", "world", joint="first", axis=(0, 0, 1)),
            make_frame("b", "a", rpy=(between, 0, 0), joint="second", axis=(0, 0, 1)),
            make_frame("tool", "b", (0, 0, 0.1), rpy=(mounted, 0, 0)),
        ],
    )


@pytest.mark.parametrize(
    ("between", "mounted", "low", "high"),
    [(0.5, 0.2, 0.3, 0.7), (0.2, 0.5, 0.3, 0.7), (2.0, 1.5, 0.5, 2 * np.pi - 3.5), (0.0, 0.4, 0.4, 0.4)],
)
def test_two_joints_point_the_tool_into_a_ring(between, mounted, low, high):
    """Which is all that they reach: from its edges on what is missing is the angle to them."""
    robot = make_wrist(between, mounted)
    for angle in np.linspace(0.0, np.pi, 30):
        target = Target(HERE, axis_world_tool=(np.sin(angle), 0.0, np.cos(angle)))
        off = max(0.0, low - angle, angle - high)
        assert orientation_excess_rad(robot, target, robot.lower, robot.upper) == pytest.approx(off, abs=1e-12)


def test_a_joint_that_is_held_turns_nothing():
    robot, target = make_wrist(0.5, 0.2), Target(HERE, axis_world_tool=(0, 0, 1))
    lower, upper = robot.lower, robot.upper
    assert orientation_excess_rad(robot, target, lower, upper) == pytest.approx(0.3)
    lower[1] = upper[1] = np.pi / 2
    held = orientation_excess_rad(robot, target, lower, upper)
    q = np.array([0.3, np.pi / 2])
    assert held == pytest.approx(miss_rad(robot, target, q))
    lower[0] = upper[0] = 0.3
    assert orientation_excess_rad(robot, target, lower, upper) == pytest.approx(miss_rad(robot, target, q))


def test_the_last_joint_keeps_its_direction_in_a_pose():
    """Two parallel joints: the tool turns about one axis, which stays where it is."""
    robot = make_wrist(0.0, 0.5)
    target = Target(HERE, rotation_from_rpy(np.array([0.5, 0.3, 0.0])))
    off = orientation_excess_rad(robot, target, robot.lower, robot.upper)
    axis = target.R_world_tool @ rotation_from_rpy(np.array([0.5, 0.0, 0.0])).T @ np.array([0.0, 0.0, 1.0])
    assert off == pytest.approx(np.arccos(axis[2]))


@pytest.mark.parametrize("about", [0, 1])
def test_the_worst_cone_is_the_one_that_proves_it(about):
    """Tilted about x the tool's x axis stays level, tilted about y its y axis does: neither is to blame."""
    robot, rpy = make_scara(), np.array([np.pi, 0.0, 0.0])
    rpy[about] += 0.3
    orientation, target = find_bounds(robot, robot.lower, robot.upper).orientation, Target(HERE, rotation_from_rpy(rpy))
    worst = orientation.find_worst(target)
    angle = np.arccos(target.R_world_tool @ worst.tool @ worst.world)
    excess = pytest.approx(orientation.excess_rad(target))
    assert max(worst.low - angle, angle - worst.high) == excess == pytest.approx(0.3)


def test_a_matrix_that_is_nearly_a_rotation_proves_nothing_beyond_its_digits():
    robot = make_scara()
    turn = rotation_from_rpy(np.array([np.pi, 0.0, 0.0]))
    askew = turn + 4e-7 * np.array([[0, 0, 0], [0, 0, 1], [0, 1, 0]])
    assert orientation_excess_rad(robot, Target(HERE, askew), robot.lower, robot.upper) == 0.0
    bent = replace(
        robot, frames=tuple(replace(f, R_parent_frame=askew) if f.name == "tool" else f for f in robot.frames)
    )
    assert orientation_excess_rad(bent, Target(HERE, turn), bent.lower, bent.upper) == 0.0

"""Generated frames, tool and Jacobian against numpy, run as they stand: straight-line Python."""

import re

import numpy as np
import pytest

from ikde.model.generate.kinematics import (
    ORIGIN,
    Pose,
    snap,
    write_bodies,
    write_cross,
    write_fixed,
    write_jacobian,
    write_point,
)
from ikde.model.generate.writer import Writer
from ikde.model.pack import frame_names, pack_robot
from tests import reference
from tests.conftest import random_q
from tests.random_robots import make_frame, make_robot, random_robot
from tests.uncompiled import evaluate, joint_names

SEEDS = range(25)
NEEDLESS = re.compile(r"e-1\d|(?<![\d.])[01]\.0(?!\d)")
EXACT = {"rtol": 0.0, "atol": 5e-14}


def flat(pose):
    return [value for row, p in zip(pose.R, pose.p, strict=True) for value in (*row, p)]


def matrices(writer, poses, q):
    """T [4, 4] of each pose."""
    values = evaluate(writer, [value for pose in poses for value in flat(pose)], **joint_names(q))
    return [reference.homogeneous(T) for T in np.reshape(values, (-1, 3, 4))]


def assert_bodies(robot, q):
    arrays, writer = pack_robot(robot), Writer()
    poses = write_bodies(writer, arrays)
    assert list(poses) == list(range(len(arrays.bodies)))
    np.testing.assert_allclose(matrices(writer, poses.values(), q), reference.compute_bodies(arrays, q), **EXACT)


def assert_frames(robot, q):
    arrays, writer, expected = pack_robot(robot), Writer(), reference.compute_frames(robot, q)
    bodies = write_bodies(writer, arrays)
    for k, name in enumerate(frame_names(robot)):
        pose = write_fixed(writer, f"frame{k}", bodies[int(arrays.frame_body[k])], arrays.T_body_frame[k])
        np.testing.assert_allclose(matrices(writer, [pose], q)[0], expected[name], **EXACT)


def assert_jacobian(robot, q):
    arrays, writer = pack_robot(robot), Writer()
    bodies = write_bodies(writer, arrays)
    tool = write_point(writer, "tool", bodies[int(arrays.frame_body[-1])], arrays.T_body_frame[-1, :, 3])
    columns = write_jacobian(writer, arrays, bodies, tool)
    jacobian = np.zeros((6, len(q)))
    for k, column in columns.items():
        jacobian[:, k] = evaluate(writer, column, **joint_names(q))
    np.testing.assert_allclose(jacobian, reference.compute_jacobian(robot, q), **EXACT)


@pytest.mark.parametrize("check", [assert_bodies, assert_frames, assert_jacobian])
def test_shipped_robots_are_those_of_numpy(any_robot, check, rng):
    for q in (*random_q(any_robot, rng, 3), any_robot.home, np.zeros(len(any_robot.joints))):
        check(any_robot, q)


@pytest.mark.parametrize("check", [assert_bodies, assert_frames, assert_jacobian])
@pytest.mark.parametrize("seed", SEEDS)
def test_random_robots_are_those_of_numpy(seed, check, rng):
    robot = random_robot(seed)
    for q in random_q(robot, rng, 2):
        check(robot, q)


@pytest.mark.parametrize("seed", SEEDS)
def test_from_any_body_only_what_it_carries_is_seen(seed, rng):
    robot = random_robot(seed)
    arrays, q = pack_robot(robot), random_q(robot, rng)
    T_world_body = reference.compute_bodies(arrays, q)
    for root in range(len(arrays.bodies)):
        writer, carried = Writer(), {root}
        for body in range(root + 1, len(arrays.bodies)):
            carried |= {body} if int(arrays.bodies[body, 0]) in carried else set()
        poses = write_bodies(writer, arrays, root)
        assert set(poses) == carried
        expected = [np.linalg.inv(T_world_body[root]) @ T_world_body[body] for body in poses]
        np.testing.assert_allclose(matrices(writer, poses.values(), q), expected, rtol=0.0, atol=1e-13)


def test_joints_that_do_not_move_the_tool_have_no_column():
    frames = [
        make_frame("f0", "world", joint="j0", axis=(0, 0, 1)),
        make_frame("aside", "f0", (0.1, 0, 0), joint="j1", axis=(0, 1, 0)),
        make_frame("tool", "f0", (0.3, 0, 0)),
    ]
    arrays, writer = pack_robot(make_robot({"j0": "revolute", "j1": "revolute"}, frames)), Writer()
    bodies = write_bodies(writer, arrays)
    assert list(write_jacobian(writer, arrays, bodies, (0.3, 0.0, 0.0))) == [0]


def test_quarter_turns_and_zeros_cost_nothing(any_robot):
    """No number that is rounding, and no product with 0 or 1, is left."""
    writer = Writer()
    poses = write_bodies(writer, pack_robot(any_robot))
    lines = writer.lines([value for pose in poses.values() for value in flat(pose)], set())
    assert not [line for line in lines if NEEDLESS.search(line)]


def test_numbers_are_snapped_only_within_rounding():
    values = np.array([1e-16, -1e-16, 1.0 + 2e-16, -1.0 - 2e-16, 1e-14, 2.0, 0.5, 3.0 + 4e-16, -0.0])
    snapped = snap(values)
    np.testing.assert_array_equal(snapped, [0.0, 0.0, 1.0, -1.0, 1e-14, 2.0, 0.5, 3.0 + 4e-16, 0.0])
    assert not np.signbit(snapped[[0, 1, 8]]).any()


def test_cross_products_are_those_of_numpy(rng):
    for _ in range(20):
        a, b = rng.normal(size=(2, 3)).tolist()
        known = {f"b{i}": value for i, value in enumerate(b)}
        writer = Writer()
        value = evaluate(writer, write_cross(writer, "x", tuple(a), ("b0", "b1", "b2")), **known)
        np.testing.assert_allclose(value, np.cross(a, b), rtol=0, atol=1e-14)


def test_columns_of_a_pose_are_its_axes():
    pose = Pose(R=(("a", "b", "c"), ("d", "e", "f"), ("g", "h", "i")), p=ORIGIN.p)
    assert [pose.column(k) for k in range(3)] == [("a", "d", "g"), ("b", "e", "h"), ("c", "f", "i")]

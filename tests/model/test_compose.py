"""An arm on a platform, and a tool at its end: frames, names, spheres and pairs of all of them."""

from dataclasses import replace

import numpy as np
import pytest

import ikde
from ikde.errors import InputError
from ikde.model.collision_model import CollisionModel
from ikde.model.compose import compose, freeze_all
from ikde.model.robot import Robot, SphereRow
from ikde.model.rotation import rotation_from_rpy
from ikde.model.tree import transform
from tests.model.drafts import make_frame, make_joint
from tests.robot_files import GOOD, load_text

PLATFORM = """\
name: platform
joints:
  x: {kind: prismatic, lower: -3, upper: 3}
  y: {kind: prismatic, lower: -3, upper: 3}
  yaw: {kind: continuous}
frames:
  a: {parent: world, joint: x, axis: [1, 0, 0]}
  b: {parent: a, joint: y, axis: [0, 1, 0]}
  body: {parent: b, joint: yaw, axis: [0, 0, 1]}
  tool: {parent: body, xyz: [0, 0, 0.5]}
tool: tool
spheres:
  s: [{component: body, from: body, radius: 0.3}]
drive: omnidirectional
wheels: {radius: 0.1, half_track: 0.2}
inertias:
  body: {mass: 50, inertia: [1, 1, 1, 0, 0, 0]}
"""
MOUNT = transform(rotation_from_rpy(np.array([0.1, 0.2, 0.3])), np.array([0.3, 0.0, 0.4]))


@pytest.fixture
def platform():
    return load_text(PLATFORM)


def make_gripper():
    """A rigid tool, as `load_part` gives one: not checked, without joints."""
    return Robot(
        name="gripper",
        title="",
        joints=(),
        frames=(make_frame("palm", "world", (0, 0, 0.05)), make_frame("tool", "palm", (0, 0, 0.1))),
        tool="tool",
        approximations={"s": (SphereRow(component="palm", start="palm", end="palm", radius_m=0.05),)},
        adjacent=(),
        pair_lists={},
        detectors={},
        default_detector="none",
        convention="own",
        conventions={},
        provenance={},
    )


def test_the_tool_is_where_all_parts_put_it(platform):
    arm = ikde.load_robot("ur5")
    robot = compose(platform, arm, MOUNT, make_gripper())
    assert robot.joint_names == ("x", "y", "yaw", *arm.joint_names)
    q = np.random.default_rng(0).uniform(-1, 1, 9)
    T = ikde.forward(platform, q[:3])["tool"] @ MOUNT @ ikde.forward(arm, q[3:])["tool"]
    frames = ikde.forward(robot, q)
    np.testing.assert_allclose(frames["arm_tool"], T, atol=1e-14)
    np.testing.assert_allclose(frames["tool"], T @ transform(np.eye(3), np.array([0, 0, 0.15])), atol=1e-14)
    assert (robot.tool, robot.drive, robot.wheels) == ("tool", "omnidirectional", platform.wheels)
    assert robot.inertias["body"].mass_kg == 50


def test_all_spheres_are_compared_but_for_neighbours(platform):
    arm = ikde.load_robot("ur5")
    collision = CollisionModel.of(compose(platform, arm, MOUNT, make_gripper()))
    pairs = {frozenset(pair) for pair in collision.pairs}
    assert {frozenset(pair) for pair in CollisionModel.of(arm).pairs} <= pairs
    assert frozenset(("body", "forearm")) in pairs
    assert frozenset(("palm", "body")) in pairs
    reasons = {frozenset((pair.a, pair.b)): pair.reason for pair in collision.left_out_pairs}
    assert reasons[frozenset(("body", "base"))] == "one body"
    assert reasons[frozenset(("body", "shoulder"))] == "joined by joint shoulder_pan_joint"
    assert reasons[frozenset(("palm", "wrist_3"))] == "one body"


def test_what_an_arm_leaves_out_stays_left_out_with_its_reason(platform, qiao):
    robot = compose(platform, qiao, np.eye(4))
    left_out = {(pair.a, pair.b): pair.reason for pair in CollisionModel.of(robot).left_out_pairs}
    arms_own = CollisionModel.of(qiao)
    for pair in arms_own.left_out_pairs:
        assert left_out[pair.a, pair.b] in (pair.reason, f"adjacent: {pair.reason}")
    assert not [pair for pair in robot.adjacent if pair.reason.startswith(("one body", "joined", "adjacent"))]
    assert {frozenset(pair) for pair in arms_own.pairs} <= {frozenset(p) for p in CollisionModel.of(robot).pairs}
    assert CollisionModel.of(robot).limit_m == arms_own.limit_m


def test_names_that_are_taken_get_the_part_before_them():
    one = load_text(GOOD)
    robot = compose(one, one, MOUNT, one)
    assert robot.joint_names == ("slide", "turn", "arm_slide", "arm_turn")
    assert robot.components("spheres") == ("box", "bar", "arm_box", "arm_bar", "tool_box", "tool_bar")
    assert robot.tool == "tool_tip"
    assert {frame.name for frame in robot.frames} >= {"rail", "arm_rail", "arm_mount", "tool_mount", "tool_rail"}
    third = compose(robot, one, MOUNT)
    assert "arm_slide_" in third.joint_names


def test_frozen_joints_stay_at_home():
    robot = load_text(GOOD)
    frozen = freeze_all(robot)
    assert frozen.joints == ()
    beside = replace(
        frozen,
        joints=(make_joint("extra"),),
        frames=(*frozen.frames, make_frame("extra", "world", joint="extra", axis=(0, 0, 1))),
    )
    at_home = ikde.forward(robot, robot.home)
    for name, T in ikde.forward(beside, [0.0]).items():
        if name not in ("extra", "tool"):
            np.testing.assert_allclose(T, at_home[name], atol=1e-15)


def test_parts_without_spheres_are_composed_and_checked_for_what_there_is(platform):
    bare = load_text(PLATFORM.split("spheres:", maxsplit=1)[0])
    assert compose(bare, bare, MOUNT).default_detector == "none"
    robot = compose(bare, ikde.load_robot("ur5"), MOUNT)
    assert len(CollisionModel.of(robot).pairs) == len(CollisionModel.of(ikde.load_robot("ur5")).pairs)


def test_wheels_stay_only_under_a_base_that_carries_all(platform):
    on_base = platform.approximations["s"][0]
    on_ground = replace(on_base, component="ground", start="world", end="world")
    held = replace(platform, approximations={"s": (on_base, on_ground)})
    with pytest.raises(InputError, match="wheels need a planar base"):
        compose(held, ikde.load_robot("ur5"), MOUNT)


def test_names_as_long_as_names_may_be_stay_apart(platform):
    frames = tuple(replace(own, name=100 * own.name[0], parent="world") for own in platform.frames[2:3])
    joints = {100 * "j": platform.joints[2]}
    long = replace(
        platform,
        joints=tuple(replace(own, name=name) for name, own in joints.items()),
        frames=tuple(replace(own, joint=100 * "j") for own in frames),
        tool=100 * "b",
        approximations={"s": (SphereRow(component=100 * "b", start=100 * "b", end=100 * "b", radius_m=0.1),)},
        detectors={},
        default_detector="none",
        wheels=None,
        drive=None,
        inertias={},
    )
    robot = compose(long, long, np.eye(4))
    assert robot.joint_names == (100 * "j", f"arm_{96 * 'j'}")
    assert robot.tool == f"arm_{96 * 'b'}"


@pytest.mark.parametrize("T", [None, "x", np.zeros(3), np.eye(3), np.zeros((4, 4)), 1j * np.eye(4), np.eye(4) + 1e9])
def test_what_is_no_pose_is_refused_by_its_argument(platform, T):
    with pytest.raises(InputError, match=r"^T_base_arm: expected "):
        compose(platform, "ur5", T)

"""UR-type arms are found by their geometry, whatever their frames look like, and nothing else is."""

import numpy as np
import pytest

import ikde
from ikde.model.closed_form import find_ur_arm, pack_ur_arm
from ikde.model.pack import pack_robot
from tests import reference
from tests.conftest import random_q
from tests.random_robots import make_frame, make_robot, random_robot
from tests.ur_robots import TWISTS, every_ur_robot, random_ur_robot


def carrier_pose(robot, arm, q):
    """T_world_carrier [4, 4] by the twin, from packed arrays."""
    return reference.compute_bodies(pack_robot(robot), q)[arm.carrier]


@every_ur_robot
def test_the_model_puts_the_tool_where_the_robot_does(robot, rng):
    arm = find_ur_arm(robot)
    for q in random_q(robot, rng, 20):
        T_world_tool = carrier_pose(robot, arm, q) @ arm.tool_pose(arm.angles(q))
        np.testing.assert_allclose(T_world_tool, reference.compute_frames(robot, q)[robot.tool], rtol=0, atol=1e-13)


@every_ur_robot
def test_lengths_are_told_with_the_signs_that_are_promised(robot):
    arm = find_ur_arm(robot)
    assert min(arm.a2, arm.a3) > 0.0
    assert min(arm.d4, arm.d5, arm.T_wrist_tool[2, 3]) >= -1e-9
    assert set(arm.signs) <= {-1.0, 1.0}


def test_the_published_lengths_are_found():
    arm = find_ur_arm(ikde.load_robot("ur5"))
    found = [arm.a1, arm.a2, arm.a3, arm.a4, arm.d4, arm.d5, arm.T_wrist_tool[2, 3], arm.T_carrier_base[2, 3]]
    np.testing.assert_allclose(found, [0, 0.425, 0.39225, 0, 0.10915, 0.09465, 0.0823, 0.089159], rtol=0, atol=1e-15)


def test_two_files_of_one_arm_differ_in_their_zeros_only():
    arm, dh = (find_ur_arm(ikde.load_robot(name)) for name in ("qiao2021", "qiao2021_dh"))
    np.testing.assert_allclose(dh.offsets - arm.offsets, [0, 0, 0, 0, np.pi, 0], rtol=0, atol=1e-12)
    np.testing.assert_allclose(dh.signs, arm.signs)
    np.testing.assert_allclose(pack_ur_arm(dh).lengths, pack_ur_arm(arm).lengths, rtol=0, atol=1e-12)


def test_only_what_comes_before_the_arm_is_left_to_others():
    robot = ikde.load_robot("qiao2021")
    arm = find_ur_arm(robot)
    assert [robot.joint_names[k] for k in arm.coordinates] == ["q1", "q2", "q3", "q4", "q5", "q6"]


@every_ur_robot
def test_packed_arrays_are_ordered_and_read_only(robot):
    shapes = {"coordinates": (6,), "transforms": (2, 3, 4), "lengths": (8,), "angles": (3, 6)}
    for name, array in pack_ur_arm(find_ur_arm(robot))._asdict().items():
        assert array.shape == shapes[name]
        assert array.flags.c_contiguous
        assert not array.flags.writeable
        assert array.dtype == (np.uint64 if name == "coordinates" else np.float64)


@pytest.mark.parametrize("seed", range(40))
def test_random_robots_have_no_such_arm(seed):
    assert find_ur_arm(random_robot(seed)) is None


def test_an_arm_with_another_wrist_is_none():
    assert find_ur_arm(ikde.load_robot("panda")) is None


def test_five_joints_are_too_few():
    frames = [
        make_frame(f"f{k}", f"f{k - 1}" if k else "world", (0.1, 0, 0.2), joint=f"j{k}", axis=(0, 0, 1))
        for k in range(5)
    ]
    kinds = {f"j{k}": "revolute" for k in range(5)}
    assert find_ur_arm(make_robot(kinds, [*frames, make_frame("tool", "f4", (0.1, 0, 0))])) is None


def test_six_parallel_axes_are_none():
    frames = [
        make_frame(f"f{k}", f"f{k - 1}" if k else "world", (0.1, 0, 0.2), joint=f"j{k}", axis=(0, 0, 1))
        for k in range(6)
    ]
    kinds = {f"j{k}": "revolute" for k in range(6)}
    assert find_ur_arm(make_robot(kinds, [*frames, make_frame("tool", "f5", (0.1, 0, 0))])) is None


def test_a_slide_among_the_last_six_is_none():
    robot = random_ur_robot(3)
    names = [robot.joint_names[k] for k in find_ur_arm(robot).coordinates]
    for name in names:
        kinds = {joint.name: "prismatic" if joint.name == name else joint.kind for joint in robot.joints}
        assert find_ur_arm(make_robot(kinds, robot.frames, lower=-np.pi, upper=np.pi)) is None


@pytest.mark.parametrize("joint", range(5))
@pytest.mark.parametrize("twist", [1e-6, 0.3])
def test_a_twisted_axis_is_none(joint, twist):
    twists = [angle + (twist if k == joint else 0.0) for k, angle in enumerate(TWISTS)]
    for seed in range(5):
        assert find_ur_arm(random_ur_robot(seed, twists=twists)) is None


@pytest.mark.parametrize("gap", [1e-6, -0.05])
def test_a_sixth_axis_beside_the_fifth_is_none(gap):
    for seed in range(5):
        assert find_ur_arm(random_ur_robot(seed, gap=gap)) is None


def test_rounded_right_angles_still_pass():
    twists = [np.round(angle, 10) for angle in TWISTS]
    assert all(find_ur_arm(random_ur_robot(seed, twists=twists)) is not None for seed in range(5))


def test_links_of_no_length_are_none():
    axes = [((0, 0, 1), (0, 0, 0.3)), ((0, 1, 0), (0, 0, 0)), ((0, 1, 0), (0, 0, 0)), ((0, 1, 0), (0, 0, 0.3))]
    axes += [((0, 0, 1), (0, 0.1, 0)), ((0, 1, 0), (0, 0, 0.1))]
    frames = [
        make_frame(f"f{k}", f"f{k - 1}" if k else "world", xyz, joint=f"j{k}", axis=axis)
        for k, (axis, xyz) in enumerate(axes)
    ]
    kinds = {f"j{k}": "revolute" for k in range(6)}
    assert find_ur_arm(make_robot(kinds, [*frames, make_frame("tool", "f5", (0, 0.1, 0))])) is None

"""What is unambiguous is taken as a robot or a target; the rest is refused by the name of its argument."""

from types import SimpleNamespace

import numpy as np
import pytest

import ikde
from ikde.errors import FileError, InputError
from ikde.io.robots import load_robot, robot_path
from ikde.model.arguments import read_robot, read_target, read_targets
from ikde.model.target import Target, Targets

P = (0.8, 0.5, 1.0)
T = np.array([[0.0, 0.0, 1.0, 0.8], [1.0, 0.0, 0.0, 0.5], [0.0, 1.0, 0.0, 1.0], [0.0, 0.0, 0.0, 1.0]])
POSE = Target(P, R_world_tool=T[:3, :3])
POSES = [SimpleNamespace(homogeneous=T), SimpleNamespace(A=T), SimpleNamespace(as_matrix=lambda: T)]


def test_a_robot_may_be_named_or_be_a_file():
    robot = load_robot("ur5")
    assert read_robot(robot) is robot
    assert read_robot("ur5") is robot
    assert read_robot(robot_path("ur5")) == robot


@pytest.mark.parametrize(
    ("given", "message"),
    [
        (3, "robot: expected a Robot"),
        ("ur6", "robot: no robot is called"),
        ("x" * 5000, "robot: no robot is called 'xxx"),
    ],
)
def test_what_is_no_robot_is_refused(given, message):
    with pytest.raises(InputError, match=f"^{message}"):
        read_robot(given)


def test_a_file_that_is_missing_is_named(tmp_path):
    with pytest.raises(FileError, match=r"none\.yaml"):
        read_robot(tmp_path / "none.yaml")


@pytest.mark.parametrize("given", [P, list(P), np.array(P), Target(P)], ids=["tuple", "list", "array", "target"])
def test_three_numbers_are_a_position(given):
    assert read_target(given) == Target(P)


@pytest.mark.parametrize("given", [T, T.tolist(), np.asfortranarray(T), *POSES])
def test_a_matrix_is_a_pose_also_that_of_another_library(given):
    assert read_target(given) == POSE
    assert list(read_targets(given)) == [POSE]


def test_a_pose_of_pinocchio_is_taken():
    pin = pytest.importorskip("pinocchio")
    assert read_target(pin.SE3(T[:3, :3], T[:3, 3])) == POSE


@pytest.mark.parametrize(
    "call",
    [
        ikde.format_urdf,
        ikde.format_mjcf,
        ikde.CollisionModel.of,
        lambda robot: ikde.check_surface(robot, [0.0] * 6),
        lambda robot: ikde.to_convention(robot, np.zeros(6), None).tolist(),
        lambda robot: ikde.from_convention(robot, np.zeros(6), None).tolist(),
        lambda robot: ikde.compose(robot, robot, np.eye(4), tool=robot),
    ],
)
def test_each_function_takes_a_robot_by_its_name(call):
    assert call("ur5") == call(load_robot("ur5"))
    with pytest.raises(InputError, match=r"(robot|base): expected a Robot, a robot's name or a path, got 3"):
        call(3)


def test_a_path_is_followed_by_a_robot_of_that_name():
    with pytest.raises(InputError, match="robot: no robot is called 'ur6'"):
        ikde.follow_path("ur6", ikde.ToolPath(p_world_tool=np.zeros((5, 3)), dt_s=0.1))


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ("x", "got 'x'"),
        (None, "got None"),
        (type("Pose", (), {"A": T}), "got <class"),
        ((1.0, 2.0), r"got shape \(2,\)"),
        (T[:3], r"a pose \[4, 4\], got shape \(3, 4\)"),
        (T[:3, :3], r"got shape \(3, 3\); rotations have no position: Target\(p, R_world_tool=R\)"),
        (SimpleNamespace(as_matrix=lambda: T[:3, :3]), r"got shape \(3, 3\); rotations have no position"),
        ((1.0, np.nan, 2.0), "expected finite numbers"),
        (2.0 * T, "expected the last row 0 0 0 1"),
        ([Target(P)], "got "),
        (SimpleNamespace(as_matrix=lambda: {}["x"]), "`.as_matrix` of .* raised KeyError: "),
        (Targets([P]), "solve_many takes many"),
    ],
)
def test_what_is_no_target_is_refused(given, message):
    with pytest.raises(InputError, match=f"^target: .*{message}"):
        read_target(given)


@pytest.mark.parametrize(
    ("given", "expected"),
    [
        (Targets([P, P]), [Target(P)] * 2),
        (POSE, [POSE]),
        (P, [Target(P)]),
        (np.array([P, P, P]), [Target(P)] * 3),
        ([P, list(P)], [Target(P)] * 2),
        (np.array([T, T]), [POSE] * 2),
        (SimpleNamespace(A=[T, T]), [POSE] * 2),
        ([P, T, *POSES, POSE], [Target(P), *[POSE] * 5]),
        ((one for one in [P, T]), [Target(P), POSE]),
        ([], []),
        (np.empty((0, 3)), []),
    ],
)
def test_many_targets_may_be_arrays_or_a_list_of_all_kinds(given, expected):
    assert list(read_targets(given)) == expected


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ([P, "x"], r"targets\[1\]: expected a Target.*got 'x'"),
        ([P, (1.0, 2.0)], r"targets\[1\]: .*shape \(2,\)"),
        ([P, (1.0, np.inf, 2.0)], r"targets\[1\]: expected finite numbers"),
        (np.zeros((3, 4)), r"targets: .*shape \(3, 4\)"),
        (SimpleNamespace(as_matrix=lambda: 1 / 0), "targets: `.as_matrix` .* raised ZeroDivisionError"),
        (["1", "2", "3"], r"targets\[0\]: .*got '1'"),
        ([None, None, None], r"targets\[0\]: .*got None"),
        (np.zeros((2, 4)), r"targets: .*shape \(2, 4\)"),
        ([T[:3, :3]] * 2, r"targets: .*rotations have no position"),
        (SimpleNamespace(A=T[:3, :3]), r"targets: .*rotations have no position"),
        ([P, np.ma.masked_array(P, mask=[0, 1, 0])], "targets: .*got "),
        ({1.0, 2.0, 3.0}, "targets: .*got {"),
        (3, "targets: .*got 3"),
        ({"a": 1}, "targets: .*got {'a': 1}"),
        ("abc", "targets: .*got 'abc'"),
    ],
)
def test_what_are_no_targets_is_refused_with_its_row(given, message):
    with pytest.raises(InputError, match=f"^{message}"):
        read_targets(given)


def test_what_another_library_raises_is_the_cause():
    with pytest.raises(InputError) as caught:
        read_target(SimpleNamespace(as_matrix=lambda: 1 / 0))
    assert isinstance(caught.value.__cause__, ZeroDivisionError)

"""Packed arrays: one layout and dtype, read-only, and in the order that `kernels/arrays.py` tells."""

import numpy as np
import pytest

import ikde
from ikde.kernels.arrays import BODY, FIRST, LAST, MOVES_TOOL, PARENT
from ikde.model.collision_model import CollisionModel
from ikde.model.pack import frame_names, pack_robot, pack_targets
from ikde.model.target import Target, Targets
from tests.random_robots import random_robot

ROBOTS = [ikde.load_robot("qiao2021"), *map(random_robot, range(6))]
SHAPES = {
    "bodies": 2, "T_parent_body": 3, "frame_body": 1, "T_body_frame": 3, "p_body_sphere": 2, "radius": 1,
    "components": 2, "bounds": 2, "pairs": 2, "rows": 2, "offset": 1, "kind": 1, "T_world_tool": 3, "world": 1,
}  # fmt: skip
INDICES = ("frame_body", "components", "pairs", "rows")  # without a sign
DTYPES = {"bodies": np.int64, "kind": np.int64} | dict.fromkeys(INDICES, np.uint64)


def packed_arrays(robot):
    targets = [
        Target([1, 2, 3]),
        Target([1, 2, 3], axis_world_tool=[0, 1, 1]),
        Target([1, 2, 3], R_world_tool=np.eye(3)),
    ]
    detectors = (CollisionModel.of(robot, "none").arrays, CollisionModel.of(robot).arrays)
    for packed in (pack_robot(robot), *detectors, pack_targets(targets)):
        yield from ((name, value) for name, value in packed._asdict().items() if name != "safe_distance")


@pytest.mark.parametrize("robot", ROBOTS, ids=lambda robot: robot.name)
def test_arrays_are_ordered_read_only_and_of_one_dtype(robot):
    for name, array in packed_arrays(robot):
        assert array.flags.c_contiguous, name
        assert array.flags.writeable == (name == "kind"), name  # as numba sees kinds elsewhere
        assert array.flags.owndata or not array.base.flags.writeable, name
        assert array.dtype == DTYPES.get(name, np.float64), name
        assert array.ndim == SHAPES[name], name


@pytest.mark.parametrize("robot", ROBOTS, ids=lambda robot: robot.name)
def test_spheres_and_rows_are_cut_without_gaps(robot):
    detector = CollisionModel.of(robot).arrays
    count = len(detector.radius)
    for table, first, last in ((detector.components, FIRST, LAST), (detector.rows, 2, 3)):
        assert table[0, first] == 0
        assert table[-1, last] == count
        np.testing.assert_array_equal(table[1:, first], table[:-1, last])
    assert detector.p_body_sphere.shape == (3, count)
    assert detector.offset.shape == (count,)
    assert detector.bounds.shape == (len(detector.components), 4)


@pytest.mark.parametrize("robot", ROBOTS, ids=lambda robot: robot.name)
def test_the_component_with_more_spheres_comes_first_in_a_pair(robot):
    detector = CollisionModel.of(robot).arrays
    sizes = detector.components[:, LAST] - detector.components[:, FIRST]
    assert np.all(sizes[detector.pairs[:, 0]] >= sizes[detector.pairs[:, 1]])
    assert len(detector.pairs) == len(robot.pair_lists[CollisionModel.of(robot).detector.pairs])
    assert set(detector.pairs.ravel()) == set(range(len(detector.components)))


@pytest.mark.parametrize("robot", ROBOTS, ids=lambda robot: robot.name)
def test_parents_come_first_and_the_tool_last(robot):
    packed, names = pack_robot(robot), frame_names(robot)
    assert np.all(packed.bodies[1:, PARENT] < np.arange(1, len(packed.bodies)))
    assert (names[0], names[-1]) == ("world", robot.tool)
    assert sorted(names) == sorted(["world", *(frame.name for frame in robot.frames)])
    assert packed.bodies[packed.frame_body[-1], MOVES_TOOL] == 1
    assert np.all(CollisionModel.of(robot).arrays.components[:, BODY] < len(packed.bodies))


@pytest.mark.parametrize("robot", ROBOTS, ids=lambda robot: robot.name)
def test_packed_rotations_are_rotations(robot):
    packed = pack_robot(robot)
    for R in (*packed.T_parent_body[:, :, :3], *packed.T_body_frame[:, :, :3]):
        np.testing.assert_allclose(R @ R.T, np.eye(3), rtol=0, atol=2e-15)


def test_bodies_of_the_paper_robot_keep_exact_right_angles():
    R = pack_robot(ROBOTS[0]).T_parent_body[:, :, :3]
    assert set(np.unique(R)) <= {-1.0, 0.0, 1.0}


def test_packing_twice_gives_the_same_arrays():
    robot = ROBOTS[0]
    assert pack_robot(robot) is pack_robot(robot)
    assert CollisionModel.of(robot, "typical").arrays is CollisionModel.of(robot, "typical").arrays


def test_no_detector_packs_to_nothing_to_look_at():
    detector = CollisionModel.of(ROBOTS[0], "none").arrays
    assert detector.pairs.shape == (0, 2)
    assert detector.p_body_sphere.shape == (3, 0)
    assert detector.safe_distance == 0.0


def test_components_in_no_pair_are_not_packed():
    robot = ROBOTS[0]
    detector = ikde.Detector(name="few", spheres="improved", pairs="platform_arm", safe_distance_m=0.01)
    packed = CollisionModel(robot=robot, detector=detector).arrays
    assert len(packed.components) == len({name for pair in robot.pair_lists["platform_arm"] for name in pair})
    assert packed.safe_distance == 0.01


def test_targets_keep_their_kind_and_pose():
    R = [[0, 0, 1], [1, 0, 0], [0, 1, 0]]
    packed = pack_targets(
        [Target([1, 2, 3], R_world_tool=R), Target([4, 5, 6]), Target([7, 8, 9], axis_world_tool=[2, 0, 0])]
    )
    np.testing.assert_array_equal(packed.kind, [2, 0, 1])
    np.testing.assert_array_equal(packed.T_world_tool[:, :, 3], [[1, 2, 3], [4, 5, 6], [7, 8, 9]])
    np.testing.assert_array_equal(packed.T_world_tool[0, :, :3], R)
    np.testing.assert_array_equal(packed.T_world_tool[2, :, 2], [1, 0, 0])


def test_targets_are_packed_already():
    targets = Targets(np.array([[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]))
    packed = pack_targets(targets)
    assert packed.kind.tolist() == targets.kind.tolist()
    assert packed.T_world_tool is targets.T_world_tool

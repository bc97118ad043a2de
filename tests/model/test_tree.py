"""Bodies behind the frames: fixed frames collapse onto the body that carries them."""

import numpy as np
import pytest

from ikde.model.tree import build_tree, transform
from tests import reference
from tests.conftest import random_q
from tests.random_robots import make_frame, make_robot, random_robot


def test_a_body_is_all_that_one_joint_moves():
    robot = make_robot(
        {"j": "revolute"},
        [
            make_frame("mount", "world", (1, 0, 0)),
            make_frame("arm", "mount", (0, 1, 0), joint="j", axis=(0, 1, 0)),
            make_frame("tool", "arm", (0, 0, 1)),
        ],
    )
    tree = build_tree(robot)
    assert tree.frame_body == {"world": 0, "mount": 0, "arm": 1, "tool": 1}
    np.testing.assert_array_equal(tree.bodies[1].T_parent_body[:3, 3], [1, 1, 0])
    np.testing.assert_array_equal(tree.T_body_frame["tool"][:3, 3], [0, 0, 1])
    np.testing.assert_array_equal(tree.T_body_frame["arm"], np.eye(4))
    assert (tree.bodies[0].joint, tree.bodies[1].joint) == (None, 0)


@pytest.mark.parametrize("seed", range(15))
def test_a_tree_has_a_body_per_joint_with_parents_first(seed):
    robot = random_robot(seed)
    tree = build_tree(robot)
    assert sorted(body.joint for body in tree.bodies[1:]) == list(range(len(robot.joints)))
    assert all(body.parent < index for index, body in enumerate(tree.bodies) if index > 0)
    assert set(tree.frame_body) == {"world", *(frame.name for frame in robot.frames)}


@pytest.mark.parametrize("seed", range(15))
def test_frames_stand_still_in_their_body(seed, rng):
    robot = random_robot(seed)
    tree = build_tree(robot)
    T_world = reference.compute_frames(robot, random_q(robot, rng))
    origin = {tree.frame_body[f.name]: f.name for f in robot.frames if f.joint is not None} | {0: "world"}
    for name, body in tree.frame_body.items():
        T_body_frame = np.linalg.inv(T_world[origin[body]]) @ T_world[name]
        np.testing.assert_allclose(T_body_frame, tree.T_body_frame[name], rtol=0, atol=1e-14)


def test_a_transform_is_rotation_and_translation():
    R, p = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]), np.array([1.0, 2.0, 3.0])
    np.testing.assert_array_equal(transform(R, p), [[0, -1, 0, 1], [1, 0, 0, 2], [0, 0, 1, 3], [0, 0, 0, 1]])

"""Sets of scenes and requests: which belong together, what is asked, and what is wrong with one."""

import numpy as np
import pytest

from ikde.errors import FileError
from ikde.io.scene_pairs import find_pairs, read_request, read_scene_state
from tests.scene_set import REQUEST, write_set


def test_a_scene_has_its_request_beside_it(tmp_path):
    families = find_pairs(write_set(tmp_path))
    assert {name: [pair.name for pair in pairs] for name, pairs in families.items()} == {
        "shelf": ["shelf/scene0001", "shelf/scene0002"],
        "table": ["table/scene0001"],
    }
    first, second = families["shelf"]
    assert first.request.name == "request0001.yaml"
    assert first.digest != second.digest
    before = first.digest
    first.request.write_text(REQUEST + "\n", encoding="utf-8")
    assert first.digest != before


def test_a_folder_of_one_family_is_called_like_it(tmp_path):
    write_set(tmp_path)
    assert list(find_pairs(tmp_path / "problems" / "table")) == ["table"]


def test_a_scene_without_its_request_is_named(tmp_path):
    (write_set(tmp_path) / "problems" / "table" / "request0001.yaml").unlink()
    with pytest.raises(FileError, match=r"table/scene0001.yaml: has no request0001.yaml beside it"):
        find_pairs(tmp_path)


def test_a_folder_without_scenes_is_refused(tmp_path):
    with pytest.raises(FileError, match=r"holds no scene"):
        find_pairs(tmp_path)
    with pytest.raises(FileError, match=r"expected a folder"):
        find_pairs(tmp_path / "none")


def test_a_request_is_read_by_name(tmp_path):
    path = tmp_path / "request.yaml"
    path.write_text(REQUEST, encoding="utf-8")
    request = read_request(path)
    assert request.start == {"reach": 0.1, "turn": 0.0, "shoulder": 0.0, "finger": 0.4}
    assert request.goal == {"reach": 0.25, "turn": 1.5, "shoulder": 0.7}


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            "position: 0.25",
            "position: much",
            r":5 → .*joint_constraints\[0\].position: expected a finite",
        ),
        ("joint_name: turn", "joint_name: reach", r":6 → .*\[1\].joint_name: 'reach' is asked twice"),
        ("[0.1, 0, 0, 0.4]", "[0.1, 0, 0]", r":2 → start_state.joint_state: 4 names, but 3 positions"),
        ("[reach, turn,", "[reach, reach,", r":2 → start_state.joint_state.name\[1\]: 'reach' is there twice"),
        ("  - joint_constraints:", "  - path_constraints:", r":4 → .*joint_constraints: expected the goal's joint"),
        (
            "  - joint_constraints:",
            "  - position_constraints: [{}]\n    joint_constraints:",
            r":4 → .*position_constraints: joint values and a pose at once are not read",
        ),
        (
            "start_state: {",
            "start_state: {multi_dof_joint_state: {transforms: [{translation: {x: 1, y: 0, z: 0}}]}, ",
            r":2 → .*transforms\[0\]: a robot that stands elsewhere is not read",
        ),
    ],
)
def test_what_is_wrong_has_its_line(tmp_path, old, new, message):
    path = tmp_path / "request.yaml"
    path.write_text(REQUEST.replace(old, new), encoding="utf-8")
    with pytest.raises(FileError, match=message):
        read_request(path)


POSE = """
start_state:
  is_diff: true
  attached_collision_objects:
    - {link_name: hand, touch_links: [hand], object: {id: cup, header: {frame_id: hand}, primitives: [
        {type: cylinder, dimensions: [0.1, 0.03]}]}}
goal_constraints:
  - position_constraints:
      - header: {frame_id: base}
        link_name: hand
        constraint_region:
          primitives: [{type: sphere, dimensions: [0.001]}]
          primitive_poses: [{position: {x: 0.1, y: 0.2, z: 0.3}, orientation: {x: 0, y: 0, z: 0, w: 1}}]
    orientation_constraints:
      - {header: {frame_id: base}, link_name: hand, orientation: {x: 1, y: 0, z: 0, w: 0}}
"""


def test_a_goal_may_be_the_pose_of_a_link_and_the_start_may_hold_something(tmp_path):
    path = tmp_path / "request.yaml"
    path.write_text(POSE, encoding="utf-8")
    request = read_request(path)
    assert (request.start, request.goal, request.attached[0].name) == ({}, {}, "cup")
    assert (request.pose.link, request.pose.frame, request.pose.p_frame_link.tolist()) == (
        "hand",
        "base",
        [0.1, 0.2, 0.3],
    )
    np.testing.assert_allclose(request.pose.R_frame_link, np.diag([1.0, -1.0, -1.0]), atol=1e-12)
    path.write_text(POSE.split("    orientation_constraints", maxsplit=1)[0], encoding="utf-8")
    pose = read_request(path).pose
    assert pose is not None
    assert pose.R_frame_link is None


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("link_name: hand, orientation", "link_name: arm, orientation", r"expected the link and the frame of the"),
        ("x: 1, y: 0, z: 0, w: 0", "x: 1, y: 1, z: 0, w: 0", r"orientation: expected a quaternion of length 1"),
        (
            "        link_name: hand\n",
            "        link_name: hand\n        target_point_offset: [0, 0, 1]\n",
            r"another point",
        ),
        ("primitive_poses: [", "primitive_poses: [{}, ", r"primitive_poses: expected one, got 2"),
    ],
)
def test_what_is_wrong_with_a_pose_is_named(tmp_path, old, new, message):
    path = tmp_path / "request.yaml"
    path.write_text(POSE.replace(old, new), encoding="utf-8")
    with pytest.raises(FileError, match=message):
        read_request(path)


def test_a_scene_may_tell_where_joints_are(tmp_path):
    path = tmp_path / "scene.yaml"
    path.write_text("robot_state: {joint_state: {name: [a, b], position: [1, 2.5]}}", encoding="utf-8")
    assert read_scene_state(path) == {"a": 1.0, "b": 2.5}
    path.write_text("world: {}", encoding="utf-8")
    assert read_scene_state(path) == {}

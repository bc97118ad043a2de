"""MoveIt's planning scenes: shapes, composed poses, frames, allowed touching; one line for what is not read."""

import copy
from pathlib import Path

import numpy as np
import pytest

from ikde.errors import InputError
from ikde.io.moveit_scene import is_moveit_scene, read_moveit_scene
from ikde.io.scene_values import Reading

HALF = float(np.sqrt(0.5))
QUARTER = [0, 0, HALF, HALF]  # about z
CAN = {
    "primitive_poses": [{"orientation": [0, 0, 0, 1], "position": [1, 0, 0]}],
    "id": "can",
    "primitives": [{"dimensions": [0.3, 0.05], "type": "cylinder"}],
}
MESH = {
    "vertices": [
        {"x": 0, "y": 0, "z": 0},
        {"z": 0, "x": 1, "y": 0},
        {"x": 0, "y": 1, "z": 0},
        {"x": 0, "y": 0, "z": 1},
    ],
    "triangles": [{"vertex_indices": face} for face in ([0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3])],
}


def scene(*objects, **more):
    return {"world": {"collision_objects": copy.deepcopy(list(objects))}, **more}


def read(data):
    reading = Reading(Path())
    return read_moveit_scene(data, reading), reading.notes


def change(**values):
    """A can with some keys changed, or gone if they are None."""
    return {key: value for key, value in {**copy.deepcopy(CAN), **values}.items() if value is not None}


def test_a_cylinder_is_height_then_radius():
    world, notes = read(scene(CAN))
    (solid,) = world["can"].solids
    assert (solid.kind, solid.size_m) == ("cylinder", (0.05, 0.3))
    assert (world["can"].frame, notes) == ("world", [])


def test_poses_compose_and_quaternions_have_w_last():
    world, _ = read(scene(change(pose={"position": [0, 0, 2], "orientation": QUARTER})))
    obstacle = world["can"]
    assert np.allclose(obstacle.T_world_obstacle, [[0, -1, 0, 0], [1, 0, 0, 0], [0, 0, 1, 2]])
    assert obstacle.solids[0].T_obstacle_solid[:, 3].tolist() == [1, 0, 0]


def test_a_pose_of_an_object_is_in_the_frame_of_its_header():
    held = change(
        id="held", header={"frame_id": "can"}, pose={"position": [1, 0, 0], "orientation": [HALF, 0, 0, HALF]}
    )
    can = change(pose={"position": [0, 0, 2], "orientation": QUARTER})
    obstacle = read(scene(held, can))[0]["held"]
    assert np.allclose(obstacle.T_world_obstacle, [[0, 0, 1, 0], [1, 0, 0, 1], [0, 1, 0, 2]])


def test_values_may_have_names_and_types_numbers():
    pose = {"position": {"z": 0.0, "y": 0.0, "x": 1.0}, "orientation": {"w": 1.0, "x": 0, "y": 0, "z": 0}}
    named = change(primitives=[{"type": 3, "dimensions": [0.3, 0.05]}], primitive_poses=[pose], operation=0)
    assert read(scene(named))[0].digest == read(scene(CAN))[0].digest
    assert read({"collision_objects": [CAN]})[0].digest == read(scene(CAN))[0].digest
    bare = change(primitive_poses=None)
    assert read(scene(bare))[0]["can"].solids[0].T_obstacle_solid[:, 3].tolist() == [0, 0, 0]


def test_every_shape():
    shapes = [("box", [1, 2, 3]), ("sphere", [0.5]), ("cylinder", [2, 1]), ("cone", [2, 1])]
    primitives = [{"type": kind, "dimensions": sizes} for kind, sizes in shapes]
    world, notes = read(
        scene(
            change(
                primitives=primitives,
                primitive_poses=[{}] * 4,
                planes=[{"coef": [0, 0, 2, -1]}],
                plane_poses=[{}],
                meshes=[MESH],
                mesh_poses=[{"position": [0, 0, 5]}],
            )
        )
    )
    box, ball, can, cone, plane, mesh = world["can"].solids
    assert [s.size_m for s in (box, ball, can, cone)] == [(1, 2, 3), (0.5,), (1, 2), (1, 2)]
    assert (cone.kind, plane.kind, mesh.kind) == ("cone", "half_space", "hull")
    assert plane.T_obstacle_solid[:, 2:].tolist() == [[0, 0], [0, 0], [1, 0.5]]
    assert (len(mesh.points), mesh.T_obstacle_solid[2, 3]) == (4, 5)
    assert notes == ["a plane is read as all that lies below it, where its normal does not point"]


def test_frames_of_the_robot_of_the_scene_and_of_objects():
    fixed = [
        {"header": {"frame_id": "base_link"}, "child_frame_id": "base_link", "transform": {"rotation": [0, 0, 0, 1]}},
        {
            "header": {"frame_id": "base_link"},
            "child_frame_id": "camera",
            "transform": {"translation": [0, 0, 1], "rotation": QUARTER},
        },
    ]
    objects = [
        change(id="on_robot", header={"frame_id": "base_link"}),
        change(id="seen", header={"frame_id": "/camera"}),
        change(id="on_seen", header={"frame_id": "seen"}, pose={"position": [0, 0, 3]}),
        change(id="free", header={"frame_id": ""}),
    ]
    world, _ = read(scene(*objects, fixed_frame_transforms=fixed))
    assert [o.frame for o in world.obstacles] == ["base_link", "base_link", "base_link", "world"]
    assert np.allclose(world["seen"].T_world_obstacle, [[0, -1, 0, 0], [1, 0, 0, 0], [0, 0, 1, 1]])
    assert np.allclose(world["on_seen"].T_world_obstacle[:, 3], [0, 0, 4])


def test_allowed_touching_is_ignored():
    names = ["can", "hand", "arm", "other"]
    values = [[0, 1, 0, 1], [1, 0, 1, 0], [0, 1, 0, 0], [1, 0, 0, 0]]
    rows = [[bool(value) for value in row] for row in values]
    for entries in (rows, [{"enabled": row} for row in rows]):
        matrix = {"entry_names": names, "entry_values": entries}
        world, _ = read(scene(CAN, change(id="other"), allowed_collision_matrix=matrix))
        assert (world["can"].ignore, world["other"].ignore) == (("hand",), ())


def test_what_is_a_scene():
    assert is_moveit_scene({"world": {}})
    assert is_moveit_scene({"collision_objects": []})
    assert not is_moveit_scene({"world": "kitchen.yaml"})
    assert len(read({"world": {"collision_objects": []}})[0]) == 0
    assert len(read({"world": {}, "name": ""})[0]) == 0


PLACE = r"world.collision_objects\[0\]"
ATTACHED = {"attached_collision_objects": [{"link_name": "hand"}]}


@pytest.mark.parametrize(
    ("data", "said"),
    [
        (scene(change(id=None)), PLACE + ".id: this key is missing"),
        (scene(CAN, CAN), r"collision_objects\[1\].id: two objects are called 'can'"),
        (scene(change(primitives=[{"type": "prism", "dimensions": [1]}])), "expected a type of box, .*, got 'prism'"),
        (scene(change(primitives=[{"type": 7, "dimensions": [1]}])), r"primitives\[0\].type: expected a type"),
        (scene(change(primitives=[{"type": "box", "dimensions": [1, 2]}])), r"dimensions: expected 3 numbers"),
        (scene(change(primitives=[{"type": "cone", "dimensions": [1, 0]}])), r"dimensions.radius: expected a size"),
        (scene(change(primitives=[{"type": "box"}])), r"primitives\[0\].dimensions: this key is missing"),
        (scene(change(primitives=CAN["primitives"] * 2)), "primitive_poses: expected 2 poses, one a shape, got 1"),
        (scene(change(primitives=[], primitive_poses=[])), "primitives: this object has no shape"),
        (scene(change(primitive_poses=[{"orientation": [0, 0, 0, 0]}])), r"poses\[0\].orientation: .*length 1, got"),
        (scene(change(primitive_poses=[{"orientation": [0, 0, 1, 1]}])), r"poses\[0\].orientation: .*length 1.414"),
        (scene(change(primitive_poses=[{"position": [0, 0, "1"]}])), r"position\[2\]: expected a finite number"),
        (scene(change(primitive_poses=[{"rotation": [0, 0, 0, 1]}])), r"rotation: unknown key"),
        (
            scene(change(meshes=[{"resource": "package://a/b.stl"}], mesh_poses=[{}])),
            r"meshes\[0\]: a mesh that another",
        ),
        (scene(change(planes=[{"coef": [0, 0, 0, 1]}])), r"planes\[0\].coef: expected a normal that is not zero"),
        (scene(change(operation=1)), "operation: expected an object that is added, got 1"),
        (scene(change(shape="box")), PLACE + ".shape: unknown key"),
        (scene(change(header={"frame_id": "can"})), "frame_id: frames are placed in each other: can -> can"),
        (scene(CAN, robot_state=ATTACHED), r"attached_collision_objects\[0\].object: this key is missing"),
        (scene(CAN, link_padding=[{"link_name": "a", "padding": 0.01}]), r"link_padding\[0\]: a link with a padding"),
        (scene(CAN, octomap={}), "octomap: unknown key"),
        ({"world": {"octomap": {"octomap": {"data": [1, 2]}}}}, "world.octomap: an octomap is not read"),
        ({"world": {"collision_objects": [5]}}, PLACE + ": expected keys with values, got 5"),
        (scene(CAN, allowed_collision_matrix={"entry_names": ["can"]}), "entry_values: expected 1 rows"),
        (
            scene(CAN, fixed_frame_transforms=[{"child_frame_id": "a"}]),
            r"transforms\[0\].transform: this key is missing",
        ),
    ],
)
def test_what_is_wrong_is_one_line(data, said):
    with pytest.raises(InputError, match=said):
        read(data)


def test_an_object_that_may_touch_everything_is_refused():
    matrix = {"default_entry_names": ["can"], "default_entry_values": [True]}
    with pytest.raises(InputError, match="may touch all by default is not read"):
        read(scene(CAN, allowed_collision_matrix=matrix))
    assert read(scene(CAN, allowed_collision_matrix={**matrix, "default_entry_values": [False]}))[0]["can"].ignore == ()


def held(**changes):
    return {"link_name": "hand", "object": {**CAN, "id": "held", "header": {"frame_id": "hand"}}, **changes}


def test_objects_that_a_link_holds_are_attached_to_it():
    state = {"attached_collision_objects": [held(touch_links=["hand", "finger"])]}
    world = read_moveit_scene(scene(CAN, robot_state=state), Reading(Path()))
    (thing,) = world.attached
    assert world.names == (CAN["id"],)
    assert (thing.name, thing.frame, thing.may_touch) == ("held", "hand", ("hand", "finger"))
    assert thing.protrusion_m > 0.0
    assert thing.obstacle.solids == world[CAN["id"]].solids
    elsewhere = {"attached_collision_objects": [held(object={**CAN, "id": "held", "header": {"frame_id": "base"}})]}
    with pytest.raises(InputError, match="expected poses in 'hand', which holds it, got them in 'base'"):
        read_moveit_scene(scene(CAN, robot_state=elsewhere), Reading(Path()))
    twice = {"attached_collision_objects": [held(), held()]}
    with pytest.raises(InputError, match=r"'held' is attached to hand, and another object has its name"):
        read_moveit_scene(scene(CAN, robot_state=twice), Reading(Path()))

"""CuRobo's scenes: every kind that is known, and one line for what is not."""

from pathlib import Path

import numpy as np
import pytest

from ikde.errors import InputError
from ikde.io.curobo_scene import is_curobo_scene, read_curobo_scene
from ikde.io.scene_values import Reading

HALF = float(np.sqrt(0.5))
TETRAHEDRON = {"vertices": [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], "faces": [0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3]}
SCENE = {
    "cuboid": {
        "table": {"pose": [1, 0, 0.4, HALF, 0, 0, HALF], "dims": [1.0, 2, 0.1], "color": [1, 0, 0, 1]},
        "plain": {"dims": [1, 1, 1]},
    },
    "sphere": {"ball": {"radius": 0.1, "position": [1, 2, 3]}, "other": {"pose": [3, 2, 1, 1, 0, 0, 0], "radius": 0.2}},
    "capsule": {"bar": {"radius": 0.05, "base": [0, 0, 0], "tip": [0.4, 0, 0], "pose": [0, 0, 1, 1, 0, 0, 0]}},
    "cylinder": {"can": {"height": 0.3, "radius": 0.03, "pose": [0, 1, 0, 1, 0, 0, 0], "scale": [1, 1, 1]}},
    "mesh": {"part": {**TETRAHEDRON, "scale": [2, 2, 2], "pose": [0, 0, 0, 1, 0, 0, 0]}},
}


def read(scene):
    reading = Reading(Path())
    return read_curobo_scene(scene, reading), reading.notes


def test_every_kind_of_obstacle():
    world, notes = read(SCENE)
    assert notes == []
    assert world.names == ("table", "plain", "ball", "other", "bar", "can", "part")
    assert np.allclose(world["table"].T_world_obstacle, [[0, -1, 0, 1], [1, 0, 0, 0], [0, 0, 1, 0.4]])
    (table,), (ball,), (can,), (part,) = (world[name].solids for name in ("table", "ball", "can", "part"))
    assert (table.kind, table.size_m) == ("box", (1, 2, 0.1))
    assert (ball.kind, world["ball"].T_world_obstacle[:, 3].tolist()) == ("sphere", [1, 2, 3])
    assert (can.kind, can.size_m) == ("cylinder", (0.03, 0.3))
    assert (part.kind, part.points.max()) == ("hull", 2.0)


def test_a_capsule_between_two_points():
    world, _ = read(SCENE)
    (bar,) = world["bar"].solids
    assert (bar.kind, bar.size_m) == ("capsule", (0.05, 0.4))
    assert np.allclose(bar.T_obstacle_solid[:, 2:], [[1, 0.2], [0, 0], [0, 0]])


def test_what_is_a_scene():
    assert is_curobo_scene({"cuboid": {}, "blocks": 1})
    assert not is_curobo_scene({"obstacles": {}})
    assert len(read({"cuboid": None, "sphere": {}})[0]) == 0


@pytest.mark.parametrize(
    ("scene", "said"),
    [
        ({"cuboids": {}, "cuboid": {}}, r"cuboids: this kind is not read \(did you mean 'cuboid'\?\)"),
        ({"blox": {"world": {}}}, "blox: this kind is not read; expected some of cuboid, sphere"),
        ({"cuboid": {"a": {"pose": [0, 0, 0, 1, 0, 0, 0]}}}, "cuboid.a.dims: this key is missing"),
        ({"cuboid": {"a": {"dims": [1, 2]}}}, r"cuboid.a.dims: expected 3 numbers \(x, y, z\), got \[1, 2\]"),
        ({"cuboid": {"a": {"dims": [1, 2, -1]}}}, "cuboid.a.dims.z: expected a size"),
        ({"cuboid": {"a": {"dims": [1, 2, 3], "radius": 1}}}, "cuboid.a.radius: unknown key"),
        ({"cuboid": {"a": {"dims": [1, 2, 3], "scale": [2, 1, 1]}}}, "cuboid.a.scale: only meshes are scaled"),
        ({"cuboid": {"a": {"dims": [1, 2, 3], "pose": [0, 0, 0]}}}, "cuboid.a.pose: expected 7 numbers"),
        ({"sphere": {"a": {"radius": 1, "pose": [0, 0, 0, 0, 0, 0, 0]}}}, "sphere.a.pose: .* of length 1, got one of"),
        ({"sphere": {"a": {"radius": 1, "pose": [0, 0, 0, 1, 1, 0, 0]}}}, "sphere.a.pose: .*length 1.41421"),
        ({"sphere": {"a": {"radius": 0}}}, "sphere.a.radius: expected a size"),
        ({"sphere": {"a": {"radius": "1"}}}, r"sphere.a.radius: expected a finite number, got '1'"),
        ({"sphere": {"a": {}}}, "sphere.a.radius: this key is missing"),
        (
            {"sphere": {"a": {"radius": 1}}, "cuboid": {"a": {"dims": [1, 1, 1]}}},
            "cuboid.a: two obstacles are",
        ),
        ({"capsule": {"a": {"radius": 1, "base": [0, 0, 0], "tip": [0, 0, 0]}}}, "capsule.a.tip: expected a tip"),
        ({"capsule": {"a": {"radius": 1, "base": [0, 0, 0]}}}, "capsule.a.tip: this key is missing"),
        ({"mesh": {"a": {}}}, "mesh.a: expected one of file_path and vertices"),
        ({"mesh": {"a": {"file_path": "../a.stl"}}}, "mesh.a.file_path: expected a file inside the folder"),
        ({"mesh": {"a": {"file_path": 3}}}, "mesh.a.file_path: expected the path of a mesh, got 3"),
        ({"mesh": {"a": {"vertices": [[0, 0, 0]]}}}, "mesh.a.vertices.points: .* lie in a plane"),
        ({"sphere": {"\u202e": {"radius": 1}}}, "name: expected a name of printable characters"),
        ({"sphere": [1]}, r"sphere: expected keys with values, got \[1\]"),
    ],
)
def test_what_is_wrong_is_one_line(scene, said):
    with pytest.raises(InputError, match=said):
        read(scene)

"""Worlds as scenes of MoveIt and cuRobo: what is read back stands in the same place, what is lost is listed."""

import numpy as np
import pytest
import yaml

from ikde.io.scene_values import compose
from ikde.io.scene_writers import FORMATS, format_curobo_scene, format_moveit_scene
from ikde.io.world_file import load_world, read_world
from ikde.model.solids import make_solid
from ikde.model.world import World, make_obstacle, make_world
from tests.world_files import write_good


@pytest.fixture
def world(tmp_path):
    return load_world(write_good(tmp_path / "a"))


def places(world):
    """Kind, size and pose of every solid."""
    return {
        (o.frame, s.kind, s.size_m, tuple(compose(o.T_world_obstacle, s.T_obstacle_solid).round(9).ravel() + 0.0))
        for o in world.active
        for s in o.solids
    }


def read_back(text, folder, name):
    (folder / "b.yaml").write_text(text, encoding="utf-8")
    found = read_world(folder / "b.yaml")
    assert found.format == name
    return found.world


def test_a_planning_scene_holds_what_moveit_has(world, tmp_path):
    written = format_moveit_scene(world)
    back = read_back(written.text, tmp_path, "MoveIt")
    assert places(back) == {row for row in places(world) if row[1] not in ("capsule", "cloud")}
    assert written.lost == (
        "can: left out, group loose is off",
        "scan: left out, group loose is off",
        "ball: its margin of 5 mm",
        "top: what ignores it (base, wheels)",
        "bar: MoveIt has no capsule",
        "wall: a half-space is a plane in MoveIt, with room below it",
        "dust: MoveIt has no cloud of points",
    )


def test_cylinders_are_written_height_first():
    world = make_world([make_obstacle("can", [make_solid("cylinder", [0.1, 0.5])])])
    (entry,) = yaml.safe_load(format_moveit_scene(world).text)["world"]["collision_objects"]
    assert entry["primitives"] == [{"type": "cylinder", "dimensions": [0.5, 0.1]}]
    assert entry["pose"]["orientation"] == [0, 0, 0, 1]


def test_a_curobo_scene_holds_what_curobo_has(world, tmp_path):
    written = format_curobo_scene(world)
    back = read_back(written.text, tmp_path, "cuRobo")
    kinds = ("sphere", "box", "cylinder", "capsule", "hull")
    assert places(back) == {row for row in places(world) if row[1] in kinds and row[0] == "world"}
    assert {"rack_1", "rack_2", "ground_1", "ball"} <= set(back.names)
    assert written.lost[4:] == (
        "bar: left out, its frame flange is one of the robot",
        "tip: cuRobo has no cone",
        "wall: cuRobo has no half-space",
        "dust: cuRobo has no cloud of points",
    )


def test_numbered_names_are_free_ones():
    parts = [make_solid("sphere", [0.1]), make_solid("sphere", [0.2])]
    world = make_world([make_obstacle("a", parts), make_obstacle("a_1", parts[:1])])
    assert set(yaml.safe_load(format_curobo_scene(world).text)["sphere"]) == {"a_2", "a_3", "a_1"}


@pytest.mark.parametrize("name", ["moveit", "curobo"])
def test_an_empty_scene(name, tmp_path):
    written = FORMATS[name](World(), "stem", ())
    assert len(read_back(written.text, tmp_path, {"moveit": "MoveIt", "curobo": "cuRobo"}[name])) == 0
    assert not written.lost


def test_hulls_are_closed_meshes(world, tmp_path):
    for text, name in ((format_moveit_scene(world).text, "MoveIt"), (format_curobo_scene(world).text, "cuRobo")):
        (tmp_path / "b.yaml").write_text(text, encoding="utf-8")
        found = read_world(tmp_path / "b.yaml")
        assert found.format == name
        assert not [note for note in found.notes if "hull" in note]
        assert np.array_equal(found.world["block"].solids[0].points, world["block"].solids[0].points)

"""Worlds as ikde's own files: what is read back is the same to the bit, clouds included."""

import numpy as np
import pytest

from ikde.errors import FileError, InputError
from ikde.io.moveit_scene import read_moveit_scene
from ikde.io.scene_values import Reading
from ikde.io.world_file import load_world
from ikde.io.world_writer import format_world_file, write_world
from ikde.model.rotation import rotation_from_quat_wxyz
from ikde.model.solids import make_solid
from ikde.model.world import World, make_obstacle, make_world
from tests.hostile_names import PRINTABLE
from tests.world_files import assert_same, write_good


def test_a_world_is_the_same_to_the_bit(tmp_path):
    world = load_world(write_good(tmp_path / "a"))
    files = write_world(world, tmp_path / "b.yaml", ["a note", "line\nbreak"])
    assert files == (tmp_path / "b_cloud_1.npy", tmp_path / "b.yaml")
    assert_same(load_world(tmp_path / "b.yaml"), world)
    assert (tmp_path / "b.yaml").read_text().startswith("# a note\n# line\\nbreak\nobstacles:\n")


def test_and_once_more(tmp_path):
    world = load_world(write_good(tmp_path / "a"))
    first = format_world_file(world, "c")
    write_world(world, tmp_path / "c.yaml")
    again = format_world_file(load_world(tmp_path / "c.yaml"), "c")
    assert (again.text, again.files) == (first.text, first.files)


@pytest.mark.parametrize("seed", range(20))
def test_random_numbers_come_back(tmp_path, seed):
    rng = np.random.default_rng(seed)

    def pose():
        T = np.eye(4)[:3]
        T[:, :3], T[:, 3] = rotation_from_quat_wxyz(rng.normal(size=4)), 10.0 ** rng.uniform(-9, 3, 3)
        return T

    solids = [
        make_solid("box", 10.0 ** rng.uniform(-6, 3, 3), pose()),
        make_solid("hull", (), pose(), rng.normal(size=(30, 3))),
    ]
    solids += [make_solid("cloud", [rng.random()], pose(), rng.normal(size=(5, 3)).astype(np.float32))]
    world = make_world(
        [make_obstacle(f"o{k}", [solid], pose(), margin_m=rng.random()) for k, solid in enumerate(solids)]
    )
    write_world(world, tmp_path / "a.yaml")
    assert_same(load_world(tmp_path / "a.yaml"), world)


def test_names_of_others_are_text(tmp_path):
    ball = make_solid("sphere", [1.0])
    names = [*PRINTABLE, "1.0", "yes", "a: b", "# c", "[x]", "é🙂"]
    world = make_world(
        [make_obstacle(name, [ball], ignore=[name], frame=name, group=name) for name in names], names[:1]
    )
    write_world(world, tmp_path / "a.yaml")
    assert_same(load_world(tmp_path / "a.yaml"), world)


def test_a_scene_becomes_a_file(tmp_path):
    can = {"id": "can", "primitives": [{"type": "cylinder", "dimensions": [0.3, 0.05]}]}
    can |= {
        "primitive_poses": [{"position": [1, 0, 0], "orientation": [0.6, 0, 0, 0.8]}],
        "header": {"frame_id": "base"},
    }
    world = read_moveit_scene({"world": {"collision_objects": [can]}}, Reading(tmp_path))
    write_world(world, tmp_path / "a.yaml")
    assert_same(load_world(tmp_path / "a.yaml"), world)


def test_an_empty_world(tmp_path):
    write_world(World(), tmp_path / "a.yaml")
    assert len(load_world(tmp_path / "a.yaml")) == 0


def test_nothing_is_written_where_nothing_can_be(tmp_path):
    world = load_world(write_good(tmp_path / "a"))
    with pytest.raises(FileError, match="cannot be written"):
        write_world(world, tmp_path / "no" / "b.yaml")
    (tmp_path / "b.yaml").mkdir()
    with pytest.raises(FileError, match="cannot be written"):
        write_world(world, tmp_path / "b.yaml")
    with pytest.raises(FileError, match="expected the name of a file"):
        write_world(world, "")


def test_what_is_no_world_is_refused(tmp_path):
    with pytest.raises(InputError, match="world: expected a World, got 3"):
        write_world(3, tmp_path / "a.yaml")
    assert list(tmp_path.iterdir()) == []

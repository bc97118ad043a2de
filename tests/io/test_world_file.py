"""World files: three formats by their keys, and every error with file, line and key."""

import re

import pytest

from ikde.errors import FileError, InputError
from ikde.io.world_file import load_world, read_world
from tests.world_files import GOOD, write_good


def test_a_good_file_is_read(tmp_path):
    found = read_world(write_good(tmp_path))
    assert found.format == "ikde"
    assert len(found.world) == 11
    assert found.notes == ("1 of 1,202 points are not finite and left out",)
    assert load_world(str(tmp_path / "world.yaml")).digest == found.world.digest


def test_the_format_is_found_by_its_keys(tmp_path):
    ball = {"radius": 1, "pose": [0, 0, 0, 1, 0, 0, 0]}
    assert read_world({"sphere": {"a": ball}}).format == "cuRobo"
    assert read_world({"world": {"collision_objects": []}}).format == "MoveIt"
    assert read_world({"obstacles": {}}).format == "ikde"
    (tmp_path / "scene.json").write_text('{"sphere": {"a": {"radius": 1}}}')
    assert load_world(tmp_path / "scene.json").names == ("a",)


@pytest.mark.parametrize(
    ("old", "new", "line", "said"),
    [
        ("sphere: {radius: 50}", "torus: {radius: 50}", 6, r"obstacles.ball.torus: unknown key"),
        ("sphere: {radius: 50}", "spere: {radius: 50}", 6, r"unknown key \(did you mean 'sphere'\?\)"),
        ("{radius: 50}", "{radius: 0}", 6, "obstacles.ball.sphere.radius: expected a size from"),
        ("{radius: 50}", "{radius: -1}", 6, "expected a size from .* m, got -0.001"),
        ("{radius: 50}", "{radius: .nan}", 6, "obstacles.ball.sphere.radius: expected a finite number"),
        ("{radius: 50}", "{}", 6, "obstacles.ball.sphere.radius: this key is missing"),
        ("[800, 600, 30]", "[800, 600]", 7, "obstacles.top.box: expected 3 values, got 2"),
        ("[800, 600, 30]", "[800, 0, 30]", 7, "obstacles.top.box.y: expected a size from"),
        ("box: [800, 600, 30], ", "", 7, "obstacles.top: expected one of sphere, .*, parts, got none"),
        ("box: [800, 600, 30], ", "box: [8, 6, 3], half_space: {}, ", 7, "expected one of .*, got box and half_space"),
        ("margin: 5", "margin: -5", 6, "obstacles.ball.margin: expected a margin of at least 0 m, got -0.005"),
        (
            "[0.70710678, 0, 0, 0.70710678]",
            "[0, 0, 0, 0]",
            4,
            "frames.tray.quat_wxyz: .* length 1, got one of length 0",
        ),
        ("[0.70710678, 0, 0, 0.70710678]", "[1, 0, 0, 1]", 4, "frames.tray.quat_wxyz: .* of length 1.41421"),
        (
            "rpy: [0, 90, 0]",
            "rpy: [0, 90, 0], quat_wxyz: [1, 0, 0, 0]",
            9,
            "rpy and quat_wxyz both give an orientation",
        ),
        ("[[1, 0, 0], [0, 0, -1], [0, 1, 0]]", "[[1, 0, 0], [0, 0, 1], [0, 1, 0]]", 10, "not a rotation matrix"),
        ("[-1, 0, 0]", "[0, 0, 0]", 11, "obstacles.wall.half_space.normal: expected a direction"),
        ("[0, 0, 100], [10, 10, 10]", "[1, 1, 0]", 12, "block.hull.points: expected points that enclose a volume"),
        ("[10, 0, 0.1]", "[10, 0, .inf]", 13, "dust.cloud.points"),
        ("points: [[0, 0, 0], [10, 0, 0.1]]", "points: []", 13, "dust.cloud.points: expected points"),
        (
            "drop_invalid: true",
            "drop_invalid: false",
            14,
            "scan.cloud: 1 of 1,202 points are not finite, the first is number 2;",
        ),
        ("clouds/scan.csv", "../scan.csv", 14, "scan.cloud.path: expected a file inside the folder of this one"),
        ("clouds/scan.csv", "/etc/hosts", 14, "scan.cloud.path: expected a file inside the folder"),
        ("clouds/scan.csv", "scan.txt", 14, "scan.cloud.path: expected a file that ends in .npz"),
        ("path: clouds/scan.csv, ", "", 14, "scan.cloud: expected one of path, points, got none"),
        ("[10, 0]]", "[10]]", 15, "ground.columns.heights: expected rows of one length"),
        ("cell: 200", "cell: 0", 15, "ground.columns.cell: expected a size"),
        ("base: -5", "base: 50", 15, "obstacles.ground.columns: this obstacle has no solid"),
        ("{radius: 5}", "{radius: 0}", 21, r"obstacles.rack.parts\[1\].sphere.radius: expected a size"),
        ("  table: {", "  world: {", 3, "frames.world: this name is that of what all frames are placed in"),
        (
            "switched_off: [loose]",
            "switched_off: [lose]",
            22,
            r"switched_off: no group .* \(did you mean 'loose'\?\)",
        ),
        ("table: {pos", "table: {frame: tray, pos", 3, "frames.table.frame: .* table -> tray -> table"),
        ("table: {pos", "table: {frame: table, pos", 3, "frames.table.frame: .* each other: table -> table"),
        ("  top: {", "  ball: {", 7, "obstacles.ball: this key is given twice"),
        ("  top: {", '  "to\\tp": {', 7, "printable"),
        ("units: {length: mm", "units: {length: cm", 1, "units.length: expected 'm' or 'mm', got 'cm'"),
    ],
)
def test_what_is_wrong_is_one_line_with_its_place(tmp_path, old, new, line, said):
    path = write_good(tmp_path)
    assert old in GOOD
    path.write_text(GOOD.replace(old, new, 1), encoding="utf-8")
    with pytest.raises(FileError, match=said) as error:
        load_world(path)
    assert f"world.yaml:{line} " in str(error.value)
    assert len(str(error.value).splitlines()) == 1


def test_several_errors_are_listed_together(tmp_path):
    path = write_good(tmp_path)
    path.write_text(re.sub("radius: [0-9]+", "radius: big", GOOD), encoding="utf-8")
    with pytest.raises(FileError) as error:
        load_world(path)
    assert len(error.value.__notes__) == 6


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "the file is empty"),
        ("[1, 2]", "expected keys with values"),
        ("blocks: {}", "unknown key; expected one of units, frames, obstacles"),
        ("obstacles: {a: &a {parts: [*a]}}", "stands for nothing before it, or contains itself"),
        ("<robot/>", "this is a URDF"),
        ("obstacles: {a: {box: !!python/name:os.system x}}", "tag"),
    ],
)
def test_what_is_no_world(tmp_path, text, said):
    (tmp_path / "a.yaml").write_text(text)
    with pytest.raises(FileError, match=said):
        load_world(tmp_path / "a.yaml")


def test_what_is_no_file(tmp_path):
    with pytest.raises(FileError, match="no such file"):
        load_world(tmp_path / "no.yaml")
    with pytest.raises(InputError, match="expected the path of a world file or a mapping, got 3"):
        load_world(3)


def test_a_scene_of_others_has_lines_too(tmp_path):
    (tmp_path / "a.yaml").write_text("cuboid:\n  a:\n    pose: [0, 0, 0, 1, 0, 0, 0]\n    dims: [1, 0, 1]\n")
    with pytest.raises(FileError, match=r"a.yaml:4 → cuboid.a.dims.y: expected a size"):
        load_world(tmp_path / "a.yaml")


SCENES = {
    "ikde": "obstacles:\n  a: {box: [1, 1, 1]}\n  b: {box: [1, 1, 1]}\n",
    "MoveIt": """world:
  collision_objects:
    - {id: a, primitives: [{type: box, dimensions: [1, 1, 1]}], primitive_poses: [{position: [0, 0, 0]}]}
    - id: b
      header: {frame_id: shelf}
      primitives: [{type: box, dimensions: [1, 1, 1]}]
      primitive_poses: [{position: [0, 0, 0]}]
""",
    "cuRobo": """cuboid:
  a: {dims: [1, 1, 1], pose: [0, 0, 0, 1, 0, 0, 0]}
  b: {dims: [1, 1, 1], pose: [0, 0, 0, 1, 0, 0, 0]}
""",
}
PLACES = {
    "ikde": "3 → obstacles.b",
    "MoveIt": "5 → world.collision_objects[1].header.frame_id",
    "cuRobo": "3 → cuboid.b",
}


@pytest.mark.parametrize("kind", SCENES)
def test_what_a_robot_does_not_fit_has_its_line(tmp_path, kind):
    path = tmp_path / "scene.yaml"
    path.write_text(SCENES[kind], encoding="utf-8")
    found = read_world(path)
    assert found.format == kind
    message = re.escape(f"scene.yaml:{PLACES[kind]}")
    with pytest.raises(FileError, match=rf"{message}(\.frame)?: no such frame$"), found.errors():
        raise InputError("no such frame", ("obstacles", "b", "frame"))
    with pytest.raises(InputError, match=r"^margin: elsewhere$"), found.errors():
        raise InputError("elsewhere", ("margin",))

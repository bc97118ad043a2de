"""Commands among obstacles: notes, pictures, and what is refused in one line."""

import numpy as np
import pytest

import ikde
from tests.three_joints import FILE

CRATE = """# vtx
v 0 0 0
v 1 0 0
v 0 1 0
v 0 0 1
v 0.1 0.1 0.1
f 1 3 5
f 3 2 5
f 2 1 5
f 1 2 4
f 2 3 4
f 3 1 4
"""
FREE = "obstacles: {wall: {box: [0.1, 2, 2], position: [2, 0, 1]}}\n"
INSIDE = "obstacles: {blob: {sphere: {radius: 0.3}, position: [0, 0, 1], ignore: [post]}}\n"


@pytest.fixture
def write(tmp_path):
    def call(text, name="world.yaml"):
        (tmp_path / name).write_text(text, encoding="utf-8")
        return name

    return call


def test_what_was_decided_in_reading_is_said_on_stderr(cli, write, tmp_path):
    write(CRATE, "crate.obj")
    write("obstacles: {crate: {mesh: {path: crate.obj}, position: [2, 2, 0]}}")
    outcome = cli("check", "--robot", FILE, "--world", tmp_path / "world.yaml", "--json")
    assert outcome.code == 0
    assert outcome.err.startswith("ikde: crate.obj is not convex: its convex hull is taken")
    assert outcome.data["obstacles"][0]["obstacle"] == "crate"


@pytest.mark.parametrize(("text", "code"), [(FREE, 0), (INSIDE, 1)], ids=["free", "colliding"])
def test_a_check_is_drawn_with_its_world(cli, write, tmp_path, text, code):
    write(text)
    picture = tmp_path / "a.png"
    outcome = cli("check", "--robot", FILE, "--world", tmp_path / "world.yaml", "--plot", picture)
    assert outcome.code == code
    assert outcome.out.endswith(f"wrote {picture}\n")
    assert picture.read_bytes().startswith(b"\x89PNG")


def test_an_answer_is_drawn_with_its_world(cli, write, tmp_path):
    write(FREE)
    picture = tmp_path / "a.png"
    place = "--position", "0.3", "0.2", "0.8", "--world", tmp_path / "world.yaml"
    outcome = cli("solve", "--robot", FILE, *place, "--plot", picture)
    assert outcome.code == 0, outcome
    assert picture.read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("obstacles: {wall: {box: [1, 0, 1]}}", "world.yaml:1 → obstacles.wall.box.y: expected"),
        (
            "obstacles: {wall: {box: [1, 1, 1], frame: column}}",
            "obstacles.wall.frame: no frame that stays",
        ),
        (
            "obstacles: {wall: {box: [1, 1, 1], ignore: [hnad]}}",
            "obstacles.wall.ignore[0]: no component is called 'hnad'",
        ),
        ("obstacles: {wall: {box: [9, 9, 9]}}", "world.yaml:1 → obstacles.wall: floor is "),
        ("- nothing\n", "world.yaml"),
    ],
)
@pytest.mark.parametrize("command", [("check",), ("solve", "--position", "0", "0", "1")], ids=["check", "solve"])
def test_a_world_that_does_not_fit_is_one_line(refuse, write, command, text, message):
    error = refuse(*command, "--robot", FILE, "--world", write(text))
    assert message in error
    assert error.count("\n") == 1


@pytest.mark.parametrize(
    ("margin", "message"),
    [
        ("ten", "margin: expected a distance or component=distance, got 'ten'"),
        ("nan", "margin: expected a distance of at least 0 m, got nan"),
        ("-1", "margin: expected a distance of at least 0 m, got -1.0"),
        ("hnad=1", "margin.hnad: no component is called 'hnad'"),
        ("1,,hand=2", "margin: expected a distance or component=distance, got ''"),
        ("1,hand==2", "margin.hand=: no component is called 'hand='"),
    ],
)
def test_a_margin_that_is_none_is_one_line(refuse, write, margin, message):
    error = refuse("check", "--robot", FILE, "--world", write(FREE), f"--margin={margin}")
    assert message in error
    assert error.count("\n") == 1


def test_no_file_and_a_margin_alone_are_one_line(refuse):
    assert refuse("check", "--world", "never.yaml") == "ikde: never.yaml: no such file\n"
    assert refuse("check", "--margin", "1") == "ikde: margin: a margin needs a --world to be kept from\n"


@pytest.mark.parametrize("command", [("batch", "a.yaml", "--out", "b")])
def test_batches_take_no_such_option(refuse, write, command):
    error = refuse(*command, "--world", write(FREE))
    assert "--world" in error
    assert error.count("\n") == 1


@pytest.mark.parametrize("command", ["show", "validate", "convert"])
def test_files_say_what_is_held(cli, write, tmp_path, command):
    write("obstacles: {}\nattached: {cup: {frame: tip, sphere: {radius: 0.03}, position: [0, 0, 0.1]}}\n")
    path = tmp_path / "world.yaml"
    outcome = cli("worlds", command, path, *(["--robot", FILE] if command == "validate" else []))
    assert outcome.code == 0
    assert "attached" in outcome.out
    assert "cup" in outcome.out
    pairs = cli("check", "--robot", FILE, "--world", path, "--json").data["pairs"]
    assert {pair["a"] for pair in pairs if pair["b"] == "cup"} == {"floor", "post", "arm"}


HELD = """obstacles:
  cup: {sphere: {radius: 0.03}, position: [0.45, 0, 0.9]}
  wall: {box: [0.1, 2, 2], position: [2, 0, 1]}
"""


def test_what_the_robot_holds_is_picked_up_where_it_is_and_compared(cli, write, tmp_path):
    write(HELD)
    known = "--robot", FILE, "--world", tmp_path / "world.yaml"
    outcome = cli("check", *known, "--attach", "cup=tip", "--json")
    robot = ikde.load_robot(FILE)
    away_mm = 1e3 * (np.linalg.norm(ikde.forward(robot, robot.home)["tip"][:3, 3] - [0.45, 0, 0.9]) - 0.03)
    said = f"ikde: tip holds cup, {away_mm:.3g} mm away at the joint values given: 1 sphere, up to 0 mm beyond it\n"
    assert (outcome.code, outcome.err) == (0, said)
    assert {"floor", "post", "arm"} == {pair["a"] for pair in outcome.data["pairs"] if pair["b"] == "cup"}
    assert [row["obstacle"] for row in outcome.data["obstacles"]] == ["wall"]
    place = "--position", "0.3", "0.2", "0.8", "--near", "turn=0.1 shoulder=0.5 reach=0.2"
    assert cli("solve", *known, *place, "--attach", "cup=tip:wall").code == 0
    assert cli("solve", *known, *place, "--attach", "cup=tip", "--margin", "0.01,cup=0").code == 0


@pytest.mark.parametrize(
    ("attach", "message"),
    [
        ("cap=tip", "attach.cap: no obstacle is called 'cap' (did you mean 'cup'?)"),
        ("cup=tup", "attach.cup: three_joints has no frame 'tup'"),
        ("cup=tip,cup=tip", "'cup' is attached to tip already: detach it first"),
        ("cup=tip:wal", "attach.cup: no component and no obstacle is called 'wal' (did you mean 'wall'?)"),
        ("cup", "expected OBJECT=FRAME or OBJECT=FRAME:T+T, got 'cup'"),
    ],
)
def test_what_cannot_be_held_is_refused_in_one_line(cli, write, tmp_path, attach, message):
    write(HELD)
    outcome = cli("check", "--robot", FILE, "--world", tmp_path / "world.yaml", "--attach", attach)
    assert (outcome.code, outcome.err.count("\n")) == (2, 1)
    assert message in outcome.err
    assert cli("check", "--robot", FILE, "--attach", attach).err.endswith("attach: expected a --world to pick from\n")

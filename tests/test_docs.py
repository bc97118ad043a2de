"""The examples of the documentation, loaded and run as their readers would."""

import re
import shlex
from pathlib import Path

import numpy as np
import pytest
import yaml

import ikde
from ikde.cli.app import run

ROOT = Path(__file__).parent.parent
PAGES = {page.name: page.read_text(encoding="utf-8") for page in [ROOT / "README.md", *(ROOT / "docs").glob("*.md")]}
BLOCK = re.compile(r"^```(\w*)\n(.*?)^```$", flags=re.DOTALL | re.MULTILINE)
LEAST = {
    "robot": "qiao2021",
    "dt_s": 0.02,
    "path": {"waypoints": [{"position": [1, 0, 0.9]}, {"position": [1, 0.1, 0.9]}]},
}
HALL = "obstacles: {cart: {box: [0.3, 0.5, 0.2]}, wall: {box: [0.1, 9, 2], position: [5, 0, 1]}}"
WELD = "x,y,z,qw,qx,qy,qz\n900,0,900,0,1,0,0\n900,100,900,0,1,0,0\n900,200,1000,0,1,0,0\n"


def find_blocks(page, language, having=""):
    """The blocks of a language in a page that match, each called by its line."""
    text = PAGES[page]
    return [
        pytest.param(block[2], id=f"{page}:{text.count(chr(10), 0, block.start()) + 1}")
        for block in BLOCK.finditer(text)
        if block[1] == language and re.search(having, block[2], flags=re.MULTILINE)
    ]


TRACKS = find_blocks("track.md", "yaml")
RUNS = find_blocks("batch.md", "yaml", having="^targets:")
ROBOTS = find_blocks("robot_file.md", "yaml", having="^joints:")
WORLDS = find_blocks("worlds.md", "yaml", having="^obstacles:")
PYTHON = {page: find_blocks(page, "python") for page in sorted(PAGES)}


def load_track(text, folder):
    """The plan of a track file, or of a part of one with the least that is missing."""
    missing = {key: value for key, value in LEAST.items() if key not in yaml.safe_load(text)}
    file = folder / "example.yaml"
    file.write_text(text + (yaml.safe_dump(missing) if missing else ""), encoding="utf-8")
    (folder / "weld.csv").write_text(WELD, encoding="utf-8")
    (folder / "hall.yaml").write_text(HALL, encoding="utf-8")
    return ikde.load_track(file)


def test_examples_are_found():
    assert len(TRACKS) >= 7
    assert len(PYTHON["track.md"]) >= 2
    assert RUNS
    assert ROBOTS
    assert WORLDS
    assert PYTHON["README.md"]


@pytest.mark.parametrize("text", TRACKS)
def test_a_track_example_loads(text, tmp_path):
    plan, asked = load_track(text, tmp_path), yaml.safe_load(text)
    assert plan.path.samples == asked.get("samples", plan.path.samples)


def test_the_first_track_example_is_a_whole_file():
    text = TRACKS[0].values[0]
    assert set(LEAST) <= set(yaml.safe_load(text))


def test_the_curve_is_as_the_page_says(tmp_path):
    """A line to rest, an arc that goes on in its direction and turns left, a circle, and back to the beginning."""
    (example,) = find_blocks("track.md", "yaml", having="curve:")
    p = load_track(example.values[0], tmp_path).path.p_world_tool
    line, arc, circle, spline = p[:101], p[100:151] - [0.9, 0.4, 0.9], p[150:301], p[300:]
    assert len(p) == 451
    assert np.allclose(line[[0, -1]], [[1, 0, 0.9], [1, 0.4, 0.9]])
    assert np.linalg.norm(line[-1] - line[-2]) < 1e-5
    assert np.allclose(np.linalg.norm(arc, axis=1), 0.1)
    assert np.allclose(np.arctan2(arc[:, 1], arc[:, 0]), np.linspace(0.0, 1.5, 51))
    assert np.linalg.norm(circle - [1.2, 0.0, 1.0], axis=1).min() < 0.005
    assert np.allclose(circle[-1], [1, 0, 1.1])
    assert np.linalg.norm(spline - [1.1, 0.0, 1.0], axis=1).min() < 0.005
    assert np.allclose(spline[-1], line[0])


@pytest.mark.parametrize("text", RUNS)
def test_a_run_example_loads(text, tmp_path):
    file = tmp_path / "example.yaml"
    file.write_text(text, encoding="utf-8")
    assert ikde.load_batch(file).name == "example"


@pytest.mark.parametrize("text", ROBOTS)
def test_a_robot_example_loads(text, tmp_path):
    file = tmp_path / "example.yaml"
    file.write_text(text, encoding="utf-8")
    robot = ikde.load_robot(file)
    assert robot.tool in ikde.forward(robot, robot.home)


@pytest.mark.parametrize("text", WORLDS)
def test_a_world_example_loads(text, tmp_path):
    file = tmp_path / "example.yaml"
    file.write_text(text, encoding="utf-8")
    assert ikde.load_world(file)["shelf"].frame == "world"


def test_the_world_of_configs_has_every_kind_of_solid():
    world = ikde.load_world(ROOT / "configs" / "worlds" / "kitchen.yaml")
    kinds = {solid.kind for obstacle in world.obstacles for solid in obstacle.solids}
    assert kinds == {"sphere", "box", "cylinder", "capsule", "cone", "half_space", "hull", "cloud"}


def test_a_python_example_of_a_world_writes_it(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    names = {"ikde": ikde}
    exec(compile(PYTHON["worlds.md"][0].values[0], "example", "exec"), names)
    assert ikde.load_world("ball.yaml").digest == names["world"].digest


def test_the_example_of_a_world_is_solved_and_blocked(capsys):
    names = {}
    exec(compile(PYTHON["worlds.md"][1].values[0], "example", "exec"), names)
    assert names["result"].reached
    assert ikde.check("ur5", names["result"].q, names["model"]).collision is False
    assert (names["blocked"].reached, names["blocked"].stop_reason) == (False, "world")
    assert names["blocked"].hint.startswith("without can")
    assert capsys.readouterr().out.endswith("True\n")


def test_the_commands_of_a_world_run_in_its_first_example(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    Path("world.yaml").write_text(WORLDS[0].values[0], encoding="utf-8")
    blocks = find_blocks("worlds.md", "bash", having="--world")
    for line in [line for block in blocks for line in block.values[0].splitlines()]:
        assert run(shlex.split(line)[1:]) == 0, capsys.readouterr()
    assert Path("answer.png").exists()


@pytest.mark.parametrize("text", [block for blocks in PYTHON.values() for block in blocks])
def test_a_python_example_is_python(text):
    compile(text, "example", "exec")


@pytest.mark.parametrize("text", PYTHON["track.md"])
def test_a_python_example_of_a_track_follows_its_path(text, tmp_path, monkeypatch):
    (tmp_path / "configs").symlink_to(ROOT / "configs")
    monkeypatch.chdir(tmp_path)
    names = {"ikde": ikde}
    exec(compile(text, "example", "exec"), names)
    assert names["motion"].reached


def test_the_example_of_a_servo_is_held_by_its_wall():
    names = {}
    exec(compile(PYTHON["servo.md"][0].values[0], "example", "exec"), names)
    step = names["step"]
    assert (step.held_by.kind, step.held_by.names[1], step.stop_is_free) == ("object", "wall", True)
    assert 0.0 < step.clearance_m < 1e-3


def test_the_example_of_a_urdf_is_imported_solved_and_saved(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (urdf,), (text,) = find_blocks("your_robot.md", "xml"), PYTHON["your_robot.md"]
    Path("arm.urdf").write_text(urdf.values[0], encoding="utf-8")
    names = {"ikde": ikde}
    exec(compile(text.values[0], "example", "exec"), names)
    assert names["result"].reached
    assert names["result"].collision is False
    assert ikde.load_robot("arm.yaml").joints == names["robot"].joints


def test_every_defence_names_tests_that_are_there():
    defences = PAGES["security.md"].partition("## Defences")[2]
    rows = [line for line in defences.splitlines() if re.match(r"\| (?!against)\w", line)]
    named = [re.findall(r"`(tests/[\w/]+\.py)`", row.rsplit("|", 2)[1]) for row in rows]
    assert len(rows) > 10
    assert all(named)
    assert [path for paths in named for path in paths if not (ROOT / path).is_file()] == []

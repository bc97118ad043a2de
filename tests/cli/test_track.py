"""`ikde track`: files that are whole, a stop that says why, and words for what is wrong."""

import json
import math
import re

import pytest

from ikde.io.robots import robot_path
from tests.cli.short_track import SPEC
from tests.report.pages import leave_out_figures

FILES = [
    *("base.json", "base.yaml", "joint_trajectory.json", "joint_trajectory.yaml"),
    *("report.html", "summary.json", "trajectory.csv", "trajectory.parquet"),
]


@pytest.fixture
def spec(tmp_path):
    path = tmp_path / "short.yaml"
    path.write_text(SPEC)
    return path


def names(folder):
    return sorted(path.name for path in folder.iterdir())


def test_a_robot_without_a_detector_is_told_once(cli, spec):
    spec.write_text(SPEC.replace("qiao2021", "qiao2021_dh"))
    outcome = cli("track", spec, "--no-plot")
    assert (outcome.code, outcome.err) == (0, "ikde: self-collision is not checked: qiao2021_dh has no spheres\n")


def test_a_path_is_followed_into_a_folder(cli, spec, tmp_path):
    out = tmp_path / "runs" / "a"
    outcome = cli("track", spec, "--out", out)
    assert outcome.code == 0, outcome
    assert outcome.out.startswith("followed: 6 of 6 points of short by qiao2021, 0.12 s, differential\n")
    assert [f"wrote {out / name}" in outcome.out for name in ("report.html", "summary.json", "base.yaml")] == [True] * 3
    assert names(out) == FILES
    page = (out / "report.html").read_text(encoding="utf-8")
    assert "</html>" in page
    assert json.loads((out / "summary.json").read_text())["reached_points"] == 6


def test_without_a_folder_nothing_is_written(cli, spec, tmp_path):
    outcome = cli("track", spec, "--drive", "omnidirectional", "--json")
    assert (outcome.code, outcome.err) == (0, "")
    assert (outcome.data["drive"], outcome.data["reached"], outcome.data["files"]) == ("omnidirectional", True, [])
    assert names(tmp_path) == ["short.yaml"]


def test_without_figures_and_from_a_start(cli, spec, tmp_path, monkeypatch):
    leave_out_figures(monkeypatch)
    chosen = cli("track", spec, "--out", tmp_path / "a", "--no-plot", "--json").data
    assert "report.html" not in names(tmp_path / "a")
    start = ",".join(f"{name}={value}" for name, value in chosen["start"].items())
    again = cli("track", spec, "--start", start, "--seed", "5", "--out", tmp_path / "b", "--json").data
    assert (again["seed"], again["asked_start"], chosen["asked_start"]) == (5, chosen["start"], None)
    assert f"--seed 5 --start {start} --out FOLDER" in (tmp_path / "b" / "report.html").read_text(encoding="utf-8")
    assert again["start"] == pytest.approx(chosen["start"])


def test_in_a_world_obstacles_are_kept_away_from(cli, spec, tmp_path):
    world = tmp_path / "world.yaml"
    world.write_text("obstacles: {ball: {sphere: {radius: 0.05}, position: [0.9, 0.2, 1.3]}}")
    outcome = cli("track", spec, "--world", world, "--margin", "10", "--unit", "mm", "--json")
    assert outcome.code == 0, outcome
    kept = outcome.data["world"]
    assert (kept["margin_m"], len(kept["digest"]), kept["certified_room_m"] > 0.0) == (0.01, 64, True)
    world.write_text("obstacles: {ball: {sphere: {radius: 0.05}, position: [0.9, 0.2, 0.9]}}")
    outcome = cli("track", spec, "--world", world, "--no-plot")
    assert outcome.code == 1
    assert re.search(r"ball .*without ball", " ".join(outcome.out.split()[:60]))
    assert cli("track", spec, "--margin", "1").code == 2


def test_options_replace_the_world_and_the_margin_of_the_file(cli, spec, tmp_path):
    (tmp_path / "far.yaml").write_text("obstacles: {ball: {sphere: {radius: 0.05}, position: [0.9, 0.2, 1.3]}}")
    (tmp_path / "other.yaml").write_text("obstacles: {can: {sphere: {radius: 0.05}, position: [0.9, 0.2, 2.3]}}")
    spec.write_text(SPEC + "world: far.yaml\nmargin: 0.02,hand=0\n".replace("hand", "LT"))
    kept = cli("track", spec, "--json").data["world"]
    assert (kept["file"], kept["margin_m"], kept["margins_m"]) == ("far.yaml", 0.02, {"LT": 0.0})
    less = cli("track", spec, "--margin", "3", "--unit", "mm", "--json").data["world"]
    assert (less["digest"], less["margin_m"], less["margins_m"]) == (kept["digest"], 0.003, {})
    other = cli("track", spec, "--world", tmp_path / "other.yaml", "--json").data["world"]
    assert other["digest"] != kept["digest"]
    assert (other["file"], other["margin_m"]) == (str(tmp_path / "other.yaml"), 0.02)


def test_the_summary_and_the_page_name_what_moves(cli, spec, tmp_path):
    (tmp_path / "far.yaml").write_text("obstacles: {ball: {sphere: {radius: 0.05}}, can: {sphere: {radius: 0.05}}}")
    ways = {name: {"times_s": [0, 1], "poses": [[x, 0, 1], [x, 1, 1]]} for name, x in (("ball", 2), ("can", 3))}
    spec.write_text(f"{SPEC}world: far.yaml\nmoving: {json.dumps(ways)}\n")
    outcome = cli("track", spec, "--out", tmp_path / "a", "--json")
    assert outcome.code == 0, outcome
    assert outcome.data["world"]["moving"] == ["ball", "can"]
    page = (tmp_path / "a" / "report.html").read_text(encoding="utf-8")
    assert "those that move are drawn where they are at each moment" in page
    assert "ball, can" in page


@pytest.mark.parametrize(
    ("options", "line"),
    [
        (("--world", "other.yaml"), "moving.ball: no obstacle that counts is called 'ball'"),
        (("--method", "typical"), "moving: obstacles that move need the method continuation, typical does not know"),
    ],
)
def test_what_moves_and_does_not_fit_options_is_named_in_the_file(refuse, spec, tmp_path, monkeypatch, options, line):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "far.yaml").write_text("obstacles: {ball: {sphere: {radius: 0.05}, position: [9, 0, 0]}}")
    (tmp_path / "other.yaml").write_text("obstacles: {can: {sphere: {radius: 0.05}, position: [9, 0, 0]}}")
    moves = "{ball: {times_s: [0, 1], poses: [[9, 0, 0], [9, 1, 0]]}}"
    spec.write_text(f"{SPEC}world: far.yaml\nmoving: {moves}\n")
    number = spec.read_text().splitlines().index(f"moving: {moves}") + 1
    assert f"{spec}:{number} → {line}" in refuse("track", spec, *options)


def test_what_the_file_picks_up_is_said_with_its_distance(cli, spec, tmp_path):
    (tmp_path / "far.yaml").write_text("obstacles: {ball: {sphere: {radius: 0.05}, position: [9, 0, 0]}}")
    spec.write_text(f"{SPEC}world: far.yaml\nattached: {{ball: tool}}\n")
    assert re.search(r"ikde: tool holds ball, 8.17e.03 mm away at home: 1 sphere, up to ", cli("track", spec).err)


def test_a_margin_that_makes_it_always_touch_is_refused(refuse, spec, tmp_path):
    (tmp_path / "floor.yaml").write_text("obstacles: {floor: {half_space: {}, position: [0, 0, -0.1]}}")
    spec.write_text(SPEC + "world: floor.yaml\n")
    assert "ignore: [" in refuse("track", spec, "--margin", "500", "--unit", "mm")


@pytest.fixture
def cart(spec):
    """A robot file like the paper's but for its wheels, and the track file that names it."""
    lines = robot_path("qiao2021").read_text().splitlines()
    (spec.parent / "cart.yaml").write_text("\n".join(line for line in lines if not line.startswith("wheels:")))
    spec.write_text(SPEC.replace("qiao2021", "cart.yaml"))
    return spec


def test_a_robot_of_ones_own_needs_no_wheels(cli, cart, tmp_path):
    outcome = cli("track", cart, "--out", tmp_path / "a")
    assert outcome.code == 0, outcome
    assert outcome.out.startswith("followed: 6 of 6 points of short by qiao2021, 0.12 s, differential\n")
    assert "wheel" not in outcome.out
    assert names(tmp_path / "a") == FILES
    for file in ("base.yaml", "trajectory.csv"):
        assert "wheel" not in (tmp_path / "a" / file).read_text()
    assert json.loads((tmp_path / "a" / "summary.json").read_text())["largest_wheel_speed_rad_s"] is None


def test_wheels_without_geometry_have_no_limit(cart, refuse):
    cart.write_text(cart.read_text() + "limits: {wheel_speed: 5}\n")
    told = refuse("track", cart)
    assert "short.yaml:7 → limits.wheel_speed: qiao2021 has no wheels: its file has no `wheels`" in told


def test_a_path_that_ends_early_says_where_and_exits_with_1(cli, spec, tmp_path, monkeypatch):
    leave_out_figures(monkeypatch)
    spec.write_text(SPEC.replace("0.002*k", "(0 if k < 4 else 0.5)"))
    outcome = cli("track", spec, "--out", tmp_path / "a")
    assert outcome.code == 1
    first, second = outcome.out.splitlines()[:2]
    assert first == "stopped after 3 of 6 points of short by qiao2021"
    assert second.startswith("sample 4 (0.08 s): ")
    assert names(tmp_path / "a") == FILES
    assert len((tmp_path / "a" / "trajectory.csv").read_text().splitlines()) == 5
    assert "not followed to its end" in (tmp_path / "a" / "report.html").read_text(encoding="utf-8")


def test_a_first_pose_out_of_reach_leaves_a_page_without_a_motion(cli, spec, tmp_path):
    spec.write_text(SPEC.replace("z: 0.9", "z: 9"))
    outcome = cli("track", spec, "--out", tmp_path / "a")
    assert outcome.code == 1
    assert outcome.out.startswith("stopped after 0 of 6 points of short by qiao2021\nsample 0 (0 s): at least ")
    assert names(tmp_path / "a") == ["report.html", "summary.json"]


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("robot: qiao2022\n", "short.yaml, line 2: robot"),
        (SPEC.replace("0.2,", "sin(,"), "line 6: path.expressions.y"),
        (SPEC + "drive: sideways\n", "line 7: drive"),
    ],
)
def test_a_wrong_file_is_one_line_and_nothing_is_written(refuse, spec, text, line):
    spec.write_text(text)
    refuse("track", spec, "--out", "run")


def test_what_the_file_says_is_placed_there_and_what_options_say_is_not(refuse, spec):
    spec.write_text(SPEC + "start: {q1: 0.1}\n")
    assert "short.yaml:7 → start: expected" in refuse("track", spec)
    spec.write_text(SPEC)
    assert "short.yaml" not in refuse("track", spec, "--start", "q1=0.1")
    spec.write_text(SPEC + "limits: {wheel_speed: 5}\n")
    words = refuse("track", spec, "--drive", "omnidirectional")
    assert "drive: an omnidirectional drive has no wheels, but short limits their speed" in words


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--method", "magic"], "method: expected one of"),
        (["--drive", "sideways"], "drive: expected one of"),
        (["--start", "q9=1"], "q9"),
        (["--start", "q1=0"], "start"),
        (["--seed", "-1"], "seed"),
    ],
)
def test_a_wrong_option_is_one_line_and_nothing_is_written(refuse, spec, options, words):
    assert words in refuse("track", spec, "--out", "run", *options)


def test_a_file_that_is_not_there(refuse):
    assert "nowhere.yaml" in refuse("track", "nowhere.yaml", "--out", "run")


def test_units_are_those_of_the_start(cli, spec, tmp_path, monkeypatch):
    leave_out_figures(monkeypatch)
    text = " ".join(cli("track", "--help").out.replace("│", " ").split())
    for words in (
        "Unit of lengths in --start and --margin.",
        "Unit of angles in --start.",
        "joint values in --start (default",
    ):
        assert words in text
    assert "in and out" not in text
    assert "in and out" in cli("fk", "--help").out
    chosen = cli("track", spec, "--json").data["start"]
    start = ",".join(f"{name}={value}" for name, value in zip(chosen, _in_mm_and_deg(chosen), strict=True))
    given = ["--start", start, "--unit", "mm", "--angles", "deg"]
    again = cli("track", spec, *given, "--out", tmp_path / "run", "--json").data
    assert again["start"] == pytest.approx(chosen)
    assert f"{' '.join(given)} --out FOLDER" in (tmp_path / "run" / "report.html").read_text(encoding="utf-8")


def _in_mm_and_deg(joints):
    return [value * (1e3 if name in ("d_x", "d_y") else math.degrees(1.0)) for name, value in joints.items()]

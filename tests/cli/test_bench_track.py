"""`ikde bench track`: a page and its data, and words for what is wrong."""

import json

import pytest

from ikde.errors import InputError
from ikde.track import comparison as tracks
from tests.cli.short_track import SPEC


@pytest.fixture
def spec(tmp_path):
    path = tmp_path / "short.yaml"
    path.write_text(SPEC)
    return path


def test_methods_are_compared_on_a_page(cli, spec, tmp_path, monkeypatch):
    monkeypatch.setattr(tracks, "QUICK", tracks.TrackBudget(seeds=1, starts=1))
    out = tmp_path / "page"
    told = ("--quick", "--methods", "continuation", "--drive", "omnidirectional")
    outcome = cli("bench", "track", spec, *told, "--out", out)
    assert outcome.code == 0, outcome
    assert outcome.out == f"wrote {out / 'results.json'}\nwrote {out / 'report.html'}\n"
    assert "computing: short: continuation" in outcome.err
    data = json.loads((out / "results.json").read_text(encoding="utf-8"))
    run = data["tracks"][0]["runs"][0]
    assert (run["reached_points"], run["drive"]) == (6, "omnidirectional")
    page = (out / "report.html").read_text(encoding="utf-8")
    assert "--methods continuation --drive omnidirectional --quick --out FOLDER" in page


def test_a_robot_without_a_detector_is_told_once(cli, spec, tmp_path, monkeypatch):
    def stop(*_):
        raise InputError("enough")

    monkeypatch.setattr(tracks, "compare_methods", stop)
    spec.write_text(SPEC.replace("qiao2021", "qiao2021_dh"))
    outcome = cli("bench", "track", spec, spec, "--out", tmp_path / "page")
    assert outcome.err.splitlines()[0] == "ikde: self-collision is not checked: qiao2021_dh has no spheres"
    assert outcome.err.count("not checked") == 1


@pytest.mark.parametrize("methods", ["magic", "", "continuation,magic"])
def test_an_unknown_method_is_refused(refuse, spec, methods):
    assert "expected some of" in refuse("bench", "track", spec, "--methods", methods)


def test_a_wrong_file_is_found_before_anything_runs(refuse, spec):
    spec.write_text(SPEC + "drive: sideways\n")
    assert "drive" in refuse("bench", "track", spec, "--out", "page")


def test_an_unknown_drive_is_refused(refuse, spec):
    assert "expected one of differential, omnidirectional" in refuse("bench", "track", spec, "--drive", "sideways")


def test_nothing_is_left_of_a_path_that_fails(cli, spec, tmp_path):
    spec.write_text(SPEC + "start: {q1: 0.1}\n")
    outcome = cli("bench", "track", spec, "--quick", "--out", tmp_path / "page")
    assert outcome.code == 2
    assert "short.yaml:7 → start: expected" in outcome.err
    assert [path.name for path in tmp_path.iterdir()] == ["short.yaml"]


def test_a_drive_without_wheels_has_no_limit_of_theirs(refuse, spec):
    spec.write_text(SPEC + "limits: {wheel_speed: 5}\n")
    words = refuse("bench", "track", spec, "--drive", "omnidirectional")
    assert "drive: an omnidirectional drive has no wheels, but short limits their speed" in words


def test_methods_are_compared_in_a_world(cli, spec, tmp_path, monkeypatch):
    monkeypatch.setattr(tracks, "QUICK", tracks.TrackBudget(seeds=1, starts=1))
    world, out = tmp_path / "world.yaml", tmp_path / "page"
    world.write_text("obstacles: {ball: {sphere: {radius: 0.05}, position: [0.9, 0.2, 1.3]}}")
    told = ("--quick", "--methods", "continuation", "--world", world, "--margin", "5", "--unit", "mm")
    outcome = cli("bench", "track", spec, *told, "--out", out)
    assert outcome.code == 0, outcome
    (track,) = json.loads((out / "results.json").read_text(encoding="utf-8"))["tracks"]
    kept = track["world"]
    assert (kept["file"], kept["margin_m"], len(kept["digest"])) == (str(world), 0.005, 64)
    page = (out / "report.html").read_text(encoding="utf-8")
    assert f"In a world of 1 obstacle, digest <code>{kept['digest'][:12]}</code>, margin of 5 mm." in page
    assert f"--world {world} --margin 5 --unit mm --quick --out FOLDER" in page


def test_a_margin_without_a_world_is_refused(refuse, spec):
    assert "a margin needs a --world" in refuse("bench", "track", spec, "--margin", "1")


def test_obstacles_that_move_are_for_continuation_alone_and_told_before_anything_runs(refuse, spec, tmp_path):
    (tmp_path / "world.yaml").write_text("obstacles: {ball: {sphere: {radius: 0.05}, position: [0.9, 0.2, 1.6]}}")
    moves = "world: world.yaml\nmoving: {ball: {times_s: [0, 1], poses: [[0.9, 0.2, 1.6], [0.9, 0.3, 1.6]]}}\n"
    (tmp_path / "moved.yaml").write_text(SPEC.replace("short", "moved") + moves)
    words = refuse("bench", "track", spec, tmp_path / "moved.yaml", "--out", tmp_path / "page")
    assert words == "ikde: --methods: obstacles move in moved, which continuation alone knows: --methods continuation\n"

"""`ikde bench scenes`: a page and its data, a set that goes on, and words for what is wrong."""

import json

import pytest

from ikde.cli import bench_scenes as module
from tests.scene_set import write_set
from tests.three_joints import FILE


@pytest.fixture
def problems(tmp_path):
    return write_set(tmp_path / "set")


def read(out):
    return json.loads((out / "results.json").read_text(encoding="utf-8"))


def test_a_set_is_answered_on_a_page(cli, problems, tmp_path):
    out = tmp_path / "page"
    outcome = cli("bench", "scenes", problems, "--robot", FILE, "--margin", "0.005,hand=0", "--out", out)
    assert outcome.code == 0, outcome
    assert outcome.out == f"wrote {out / 'results.json'}\nwrote {out / 'report.html'}\n"
    assert "computing: shelf\ncomputing: table" in outcome.err
    data = read(out)
    assert data["finished"]
    assert (data["all"]["problems"], data["all"]["reached"]) == (3, 3)
    assert (data["asked"]["all_m"], data["asked"]["of_m"]) == (0.005, {"hand": 0.0})
    assert [family["name"] for family in data["families"]] == ["shelf", "table"]
    page = (out / "report.html").read_text(encoding="utf-8")
    assert "3 of 3" in page
    assert "--margin 0.005,hand=0 --unit m --out FOLDER" in page
    again = cli("bench", "scenes", problems, "--robot", FILE, "--margin", "0.005,hand=0", "--out", out)
    assert "3 of 3 problems are answered in" in again.err
    assert read(out)["problems"] == data["problems"]
    other = cli("bench", "scenes", problems, "--robot", FILE, "--first", "1", "--out", out)
    assert "answered in" not in other.err
    assert list(read(out)["problems"]) == ["shelf/scene0001", "table/scene0001"]


def test_a_set_that_is_stopped_goes_on(cli, problems, tmp_path, monkeypatch):
    out, real = tmp_path / "page", module._ask

    def stop_at_the_table(run, pair):
        if pair.family == "table":
            raise KeyboardInterrupt
        return real(run, pair)

    monkeypatch.setattr(module, "_ask", stop_at_the_table)
    outcome = cli("bench", "scenes", problems, "--robot", FILE, "--out", out)
    assert outcome.code == 130
    assert "the same command goes on" in outcome.err
    data = read(out)
    assert (data["finished"], len(data["problems"])) == (False, 2)
    assert not (out / "report.html").exists()
    monkeypatch.setattr(module, "_ask", real)
    outcome = cli("bench", "scenes", problems, "--robot", FILE, "--out", out)
    assert "2 of 3 problems are answered" in outcome.err
    assert read(out)["finished"]


def test_a_problem_that_cannot_be_asked_is_a_row(cli, problems, tmp_path):
    scene = problems / "problems" / "table" / "scene0001.yaml"
    scene.write_text(scene.read_text().replace("- id: can", "- id: can\n      header: {frame_id: nowhere}"))
    outcome = cli("bench", "scenes", problems, "--robot", FILE, "--out", tmp_path / "page", "--json")
    assert outcome.code == 1
    row = outcome.data["problems"]["table/scene0001"]
    assert row["stop_reason"] == "refused"
    assert (
        "scene0001.yaml:5 → world.collision_objects[0].header.frame_id: no frame that stays in its place"
        in row["reason"]
    )


def test_what_is_wrong_is_found_before_anything_runs(refuse, problems):
    assert "expected a folder of scenes" in refuse("bench", "scenes", problems / "chair", "--robot", FILE)
    assert "no component is called 'hnad'" in refuse("bench", "scenes", problems, "--robot", FILE, "--margin", "hnad=1")

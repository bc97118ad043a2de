"""`ikde bench track`: a page and its data, and words for what is wrong."""

import json

import pytest

from ikde.bench import tracks
from tests.cli.test_track import SPEC


@pytest.fixture
def spec(tmp_path):
    path = tmp_path / "short.yaml"
    path.write_text(SPEC)
    return path


def test_methods_are_compared_on_a_page(cli, spec, tmp_path, monkeypatch):
    monkeypatch.setattr(tracks, "QUICK", tracks.TrackBudget(seeds=1, starts=1))
    out = tmp_path / "page"
    outcome = cli("bench", "track", spec, "--quick", "--methods", "continuation", "--out", out)
    assert outcome.code == 0, outcome
    assert outcome.out == f"{out / 'report.html'}  (results.json beside it)\n"
    assert "computing: short: continuation" in outcome.err
    data = json.loads((out / "results.json").read_text(encoding="utf-8"))
    assert data["tracks"][0]["runs"][0]["reached_points"] == 6
    page = (out / "report.html").read_text(encoding="utf-8")
    assert "--methods continuation --quick --out FOLDER" in page


@pytest.mark.parametrize("methods", ["magic", "", "continuation,magic"])
def test_an_unknown_method_is_refused(refuse, spec, methods):
    assert "expected some of" in refuse("bench", "track", spec, "--methods", methods)


def test_a_wrong_file_is_found_before_anything_runs(refuse, spec):
    spec.write_text(SPEC + "drive: sideways\n")
    assert "drive" in refuse("bench", "track", spec, "--out", "page")


def test_the_drive_replaces_that_of_the_files(cli, refuse, spec, tmp_path, monkeypatch):
    monkeypatch.setattr(tracks, "QUICK", tracks.TrackBudget(seeds=1, starts=0))
    told = ("--quick", "--methods", "continuation", "--json", "--out", tmp_path / "page")
    outcome = cli("bench", "track", spec, "--drive", "omnidirectional", *told)
    assert outcome.data["tracks"][0]["runs"][0]["drive"] == "omnidirectional"
    assert "expected one of differential, omnidirectional" in refuse("bench", "track", spec, "--drive", "sideways")

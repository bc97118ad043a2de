"""A followed track in its folder: all of it, nothing of an earlier one, or nothing."""

import json

import pytest

from ikde.errors import FileError
from ikde.io.track_folder import write_track
from tests.track.motions import make_motion

MOTION = [
    *("base.json", "base.yaml", "joint_trajectory.json", "joint_trajectory.yaml"),
    *("trajectory.csv", "trajectory.parquet"),
]


def names(folder):
    return sorted(path.name for path in folder.iterdir())


def test_everything_is_written_and_the_page_comes_first(tmp_path):
    files = write_track(tmp_path, make_motion(), {"points": 4}, "<html>")
    assert files[0] == tmp_path / "report.html"
    assert names(tmp_path) == sorted([*MOTION, "report.html", "summary.json"])
    assert json.loads((tmp_path / "summary.json").read_text()) == {"points": 4}


def test_what_an_earlier_one_left_is_taken_away(tmp_path):
    (tmp_path / "notes.txt").write_text("mine")
    write_track(tmp_path, make_motion(), {}, "<html>")
    write_track(tmp_path, make_motion(base=False), {})
    still = [name for name in MOTION if not name.startswith("base")]
    assert names(tmp_path) == sorted([*still, "notes.txt", "summary.json"])
    write_track(tmp_path, make_motion(reached=-1), {})
    assert names(tmp_path) == ["notes.txt", "summary.json"]


def test_a_name_that_is_taken_is_one_line(tmp_path):
    (tmp_path / "trajectory.csv").mkdir()
    with pytest.raises(FileError, match="cannot be written") as caught:
        write_track(tmp_path, make_motion(), {})
    assert "\n" not in str(caught.value)

"""Motions as files: every number comes back, ROS's shapes are kept, and files are whole or not there."""

import csv
import json
import os
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pyarrow.csv as pa_csv
import pyarrow.parquet as pq
import pytest
import yaml

from ikde.errors import FileError, InputError
from ikde.io.trajectory_files import base_motion, joint_trajectory, trajectory_table, write_track, write_trajectory
from tests.track.motions import NAMES, make_motion

DOCUMENTATION = (Path(__file__).parents[2] / "docs" / "track.md").read_text(encoding="utf-8")
FILES = ["base.json", "base.yaml", "joint_trajectory.json", "joint_trajectory.yaml"]
TABLES = ["trajectory.csv", "trajectory.parquet"]


def names_in(folder):
    return sorted(path.name for path in folder.iterdir())


def test_a_folder_holds_every_format(tmp_path):
    paths = write_trajectory(tmp_path / "runs" / "a", make_motion())
    assert sorted(path.name for path in paths) == sorted(FILES + TABLES)
    assert names_in(tmp_path / "runs" / "a") == sorted(FILES + TABLES)


def test_csv_and_parquet_give_the_same_bits_back(tmp_path):
    motion = make_motion()
    write_trajectory(tmp_path, motion, ["csv", "parquet"])
    assert names_in(tmp_path) == TABLES
    csv, parquet = pa_csv.read_csv(tmp_path / TABLES[0]), pq.read_table(tmp_path / TABLES[1])
    assert csv.column_names == parquet.column_names
    for table in (csv, parquet):
        q = np.column_stack([table[f"q_{name}"].to_numpy() for name in NAMES])
        np.testing.assert_array_equal(q, motion.q)


def test_a_row_is_a_sample_and_its_speeds_last_until_the_next():
    table = trajectory_table(make_motion()).to_pydict()
    assert table["sample"] == [0, 1, 2, 3, 4]
    np.testing.assert_allclose(table["speed_q1"], [0.5, 0.5, 0.5, 0.5, 0.0])
    np.testing.assert_allclose(table["v_m_s"], [1.5, 1.5, 1.5, 1.5, 0.0])
    assert table["wheel_left_rad_s"][3:] == [0.5, 0.0]
    assert (table["path_x_m"][2], table["error_z_m"][2], table["clearance_m"][2]) == (0.02, 1e-9, 0.05)


def test_columns_are_in_the_order_that_the_documentation_has():
    names = trajectory_table(make_motion(orientation="axis")).column_names
    told = re.search(r"a row a sample: (.*?)\njoint_trajectory", DOCUMENTATION, flags=re.DOTALL)
    joints = {
        "q_<joint> ...": [f"q_{name}" for name in NAMES],
        "speed_<joint> ...": [f"speed_{name}" for name in NAMES],
    }
    axes = {f"{kind}_x_m ... {kind}_z_m": [f"{kind}_{axis}_m" for axis in "xyz"] for kind in ("path", "error")}
    columns = [(joints | axes).get(name, [name]) for name in re.split(r",\s+", told[1])]
    assert names == [name for part in columns for name in part]


def test_columns_without_numbers_are_left_out():
    free, turned = trajectory_table(make_motion()), trajectory_table(make_motion(orientation="axis", pairs=0))
    assert set(free.column_names) - set(turned.column_names) == {"clearance_m"}
    assert set(turned.column_names) - set(free.column_names) == {"orientation_error_rad"}
    still = trajectory_table(make_motion(base=False)).column_names
    assert not {"v_m_s", "omega_rad_s", "wheel_left_rad_s"} & set(still)
    omni = trajectory_table(make_motion(drive="omnidirectional")).column_names
    assert {"world_v_x_m_s", "world_v_y_m_s", "omega_rad_s"} < set(omni)
    assert "v_m_s" not in omni


def test_a_base_on_arcs_without_wheels_has_a_twist_alone(tmp_path):
    bare = make_motion(wheel_speeds=None)
    with_wheels = trajectory_table(make_motion()).column_names
    assert trajectory_table(bare).column_names == [name for name in with_wheels if not name.startswith("wheel")]
    write_trajectory(tmp_path, bare)
    base = json.loads((tmp_path / "base.json").read_text())
    assert list(base) == ["drive", "t_s", "x_m", "y_m", "heading_rad", "v_m_s", "omega_rad_s"]
    assert (base["drive"], base["v_m_s"]) == ("differential", [1.5, 1.5, 1.5, 1.5, 0.0])


def test_the_arm_is_a_ros_message():
    message = joint_trajectory(make_motion())
    assert list(message) == ["header", "joint_names", "points"]
    assert message["joint_names"] == ["q1", "q2"]
    keys = ["positions", "velocities", "accelerations", "effort", "time_from_start"]
    assert [list(point) for point in message["points"]] == [keys] * 5
    assert message["points"][3]["time_from_start"] == {"sec": 0, "nanosec": 60_000_000}
    assert message["header"]["frame_id"] == "world"
    assert message["points"][0]["velocities"][0] == pytest.approx(0.5)
    assert message["points"][-1]["velocities"] == [0.0, 0.0]
    assert {tuple(point["accelerations"]) for point in message["points"]} == {()}
    assert joint_trajectory(make_motion(), velocities=False)["points"][1]["velocities"] == []


def test_a_velocity_is_the_mean_of_the_steps_around_it():
    motion = make_motion()
    q = motion.q.copy()
    q[:, motion.joint_names.index("q1")] = [0.0, 0.02, 0.06, 0.06, 0.08]
    points = joint_trajectory(replace(motion, q=q))["points"]
    assert [point["velocities"][0] for point in points] == pytest.approx([1.0, 1.5, 1.0, 0.5, 0.0])


@pytest.mark.parametrize("dt_s", [0.02, 1 / 3, 0.7, 1e-3])
def test_times_are_whole_nanoseconds(dt_s):
    for k, point in enumerate(joint_trajectory(make_motion(dt_s=dt_s))["points"]):
        time = point["time_from_start"]
        assert 0 <= time["nanosec"] < 10**9
        assert abs(time["sec"] * 10**9 + time["nanosec"] - k * dt_s * 1e9) <= 0.5


def test_the_base_stands_beside_it():
    base = base_motion(make_motion())
    assert list(base) == [
        *("drive", "t_s", "x_m", "y_m", "heading_rad"),
        *("v_m_s", "omega_rad_s", "wheel_left_rad_s", "wheel_right_rad_s"),
    ]
    assert {len(column) for name, column in base.items() if name != "drive"} == {5}
    np.testing.assert_allclose(base["heading_rad"], [0, 0.1, 0.2, 0.3, 0.4])


@pytest.mark.parametrize("drive", ["differential", "omnidirectional"])
def test_yaml_and_json_say_the_same_with_the_same_bits(tmp_path, drive):
    motion = make_motion(drive=drive)
    write_trajectory(tmp_path, motion, ["yaml", "json"])
    for name, data in {"base": base_motion(motion), "joint_trajectory": joint_trajectory(motion)}.items():
        assert json.loads((tmp_path / f"{name}.json").read_text()) == data
        assert yaml.safe_load((tmp_path / f"{name}.yaml").read_text()) == data


def test_a_robot_that_stands_still_has_no_base(tmp_path):
    write_trajectory(tmp_path, make_motion(base=False), ["json"])
    assert names_in(tmp_path) == ["joint_trajectory.json"]
    assert json.loads((tmp_path / "joint_trajectory.json").read_text())["joint_names"] == list(NAMES)


def test_nothing_of_an_earlier_motion_stays_beside_another(tmp_path):
    write_trajectory(str(tmp_path), make_motion())
    write_trajectory(str(tmp_path), make_motion(base=False), ["csv", "json"])
    assert names_in(tmp_path) == sorted({*FILES, *TABLES} - {"base.json"})


def test_what_was_reached_is_written(tmp_path):
    write_trajectory(tmp_path, make_motion(reached=0), ["csv", "json"])
    assert len(json.loads((tmp_path / "joint_trajectory.json").read_text())["points"]) == 1
    with pytest.raises(InputError, match="this motion has no samples"):
        write_trajectory(tmp_path / "none", make_motion(reached=-1))
    assert not (tmp_path / "none").exists()


def test_formats_can_be_written_one_after_the_other(tmp_path):
    for name in ("csv", "parquet"):
        write_trajectory(tmp_path, make_motion(), [name])
    assert names_in(tmp_path) == TABLES
    with pytest.raises(InputError, match="formats: expected one of"):
        write_trajectory(tmp_path, make_motion(), [])


def test_an_unknown_format_is_refused_before_anything_is_made(tmp_path):
    with pytest.raises(InputError, match="formats: expected one of csv, parquet, yaml, json, got 'xml'"):
        write_trajectory(tmp_path / "a", make_motion(), ["csv", "xml"])
    assert names_in(tmp_path) == []


def test_files_are_whole_or_as_they_were(tmp_path, monkeypatch):
    write_trajectory(tmp_path, make_motion(), ["csv"])
    before = (tmp_path / "trajectory.csv").read_bytes()

    def full(descriptor):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(FileError, match=r"trajectory.csv: cannot be written: No space left on device"):
        write_trajectory(tmp_path, make_motion(reached=2), ["csv", "parquet"])
    assert names_in(tmp_path) == ["trajectory.csv"]
    assert (tmp_path / "trajectory.csv").read_bytes() == before


def test_a_file_is_no_folder(tmp_path):
    (tmp_path / "a").write_text("")
    with pytest.raises(FileError, match="this is a file; expected a folder"):
        write_trajectory(tmp_path / "a", make_motion())


@pytest.mark.parametrize("name", ["a,b", 'say "x"', "=1+1", "{a: [*b]}", "[red] <b>", "手臂"])
def test_a_joint_of_any_name_comes_back_by_its_name(tmp_path, name):
    motion = make_motion()
    names = (*motion.joint_names[:-1], name)
    write_trajectory(tmp_path, replace(motion, joint_names=names))
    with (tmp_path / "trajectory.csv").open(encoding="utf-8", newline="") as file:
        assert f"q_{name}" in next(csv.reader(file))
    assert f"q_{name}" in pq.read_table(tmp_path / "trajectory.parquet").column_names
    for kind, load in (("yaml", yaml.safe_load), ("json", json.loads)):
        assert load((tmp_path / f"joint_trajectory.{kind}").read_text(encoding="utf-8"))["joint_names"][-1] == name


def test_everything_is_written_and_the_page_comes_first(tmp_path):
    files = write_track(tmp_path, make_motion(), {"points": 4}, "<html>")
    message = json.loads((tmp_path / "joint_trajectory.json").read_text())
    assert all(len(point["velocities"]) == 2 for point in message["points"])
    assert files[0] == tmp_path / "report.html"
    assert names_in(tmp_path) == sorted([*FILES, *TABLES, "report.html", "summary.json"])
    assert json.loads((tmp_path / "summary.json").read_text()) == {"points": 4}


def test_what_an_earlier_one_left_is_taken_away(tmp_path):
    (tmp_path / "notes.txt").write_text("mine")
    write_track(tmp_path, make_motion(), {}, "<html>")
    write_track(tmp_path, make_motion(base=False), {})
    still = [name for name in (*FILES, *TABLES) if not name.startswith("base")]
    assert names_in(tmp_path) == sorted([*still, "notes.txt", "summary.json"])
    write_track(tmp_path, make_motion(reached=-1), {})
    assert names_in(tmp_path) == ["notes.txt", "summary.json"]


def test_a_name_in_a_tracks_folder_that_is_taken_is_one_line(tmp_path):
    (tmp_path / "trajectory.csv").mkdir()
    with pytest.raises(FileError, match="cannot be written") as caught:
        write_track(tmp_path, make_motion(), {})
    assert "\n" not in str(caught.value)

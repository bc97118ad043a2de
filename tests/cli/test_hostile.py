"""Names and files of strangers at the command line: text is text, an error is one line, nothing else is touched."""

import json
import os

import numpy as np
import pytest

from ikde.errors import printable
from tests.hostile_names import EVERYTHING, INTERPRETED, ORDERS

ROBOT = """
name: {name}
title: {title}
sources: {{s: {{kind: derived, text: {title}}}}}
joints: {{{name}: {{kind: revolute, lower: -1, upper: 1, source: s}}}}
frames:
  {name}: {{parent: world, joint: {name}, axis: [0, 0, 1], source: s}}
  end: {{parent: {name}, xyz: [0.5, 0, 0]}}
tool: end
spheres: {{{name}: [{{component: {name}, from: {name}, radius: 0.1}}, {{component: b, from: end, radius: 0.1}}]}}
pairs: {{all: {{pairs: {{{name}: [b]}}}}}}
detectors: {{{name}: {{spheres: {name}, pairs: all}}}}
default_detector: {name}
"""
RUN = """
robot: qiao2021
targets: {file: {path: points.npz, columns: {name: n, position: p}}}
solve: {detector: none, method: de, settings: {restarts: 1, de: {population: 6, generations: 1}}}
"""

REACHED = ("--position", 0.5, 0, 0)


def write_robot(folder, name, title):
    path = folder / "robot.yaml"
    path.write_text(ROBOT.format(name=json.dumps(name), title=json.dumps(title)))
    return path


def assert_plain(outcome):
    assert outcome.code in (0, 1, 2)
    assert all(line.isprintable() for line in (outcome.out + outcome.err).split("\n"))
    assert outcome.code != 2 or 1 <= outcome.err.count("\n") <= 11  # a line a fault


@pytest.mark.parametrize("name", INTERPRETED)
def test_a_robot_of_any_name_is_shown_by_its_name(cli, tmp_path, name):
    path = write_robot(tmp_path, name, name)
    for command in (["robots", "show", path], ["check", "--robot", path], ["solve", "--robot", path, *REACHED]):
        outcome = cli(*command)
        assert_plain(outcome)
        assert outcome.code == 0
        assert printable(name).split()[0][:8] in outcome.out  # long names are folded
    assert printable(name) in cli("robots", "validate", path).out


@pytest.mark.parametrize("title", ORDERS)
def test_a_title_gives_no_orders(cli, tmp_path, title):
    outcome = cli("robots", "show", write_robot(tmp_path, "a", title))
    assert_plain(outcome)
    assert printable(title) in outcome.out


def test_names_of_files_and_commands_give_no_orders(cli, tmp_path):
    path = write_robot(tmp_path, "a", "a").rename(tmp_path / "\x1b[31m.yaml")
    valid = cli("robots", "validate", path)
    assert valid.code == 0
    assert r"\x1b[31m.yaml: valid" in valid.out
    for arguments in (
        ["\x1b[31m"],
        ["solve", "--\x1b[31m"],
        ["check", "--q", "\x1b[31m"],
        ["robots", "show", "\x1b[31m"],
    ):
        outcome = cli(*arguments)
        assert_plain(outcome)
        assert r"\x1b" in outcome.err


@pytest.mark.parametrize("name", ORDERS)
def test_a_robot_whose_name_gives_orders_is_refused_or_shown_in_letters(cli, tmp_path, name):
    path = write_robot(tmp_path, name, "a")
    for command in (["robots", "show", path], ["fk", "--robot", path]):
        assert_plain(cli(*command))


@pytest.mark.parametrize("text", EVERYTHING)
def test_an_error_about_a_file_is_one_line_of_letters(cli, tmp_path, text):
    path = tmp_path / "robot.yaml"
    for content in (json.dumps({text: text}), text * 1000):
        path.write_text(content)
        outcome = cli("robots", "validate", path)
        assert_plain(outcome)
        assert all(len(line) <= 410 for line in outcome.err.splitlines())
    assert_plain(cli("robots", "validate", tmp_path / text.replace("/", "-")))


def test_the_targets_of_a_table_are_shown_by_their_names(cli, tmp_path):
    names = [name for name in EVERYTHING if not name.endswith("\0")]
    np.savez(tmp_path / "points.npz", n=names, p=np.full((len(names), 3), 9.0))
    (tmp_path / "run.yaml").write_text(RUN)
    outcome = cli("batch", tmp_path / "run.yaml", "--out", tmp_path / "run")
    assert_plain(outcome)
    assert outcome.code == 1
    for number, name in enumerate(names[:20]):
        assert f"target {number} {printable(name)}"[:60] in outcome.out
    assert cli("report", tmp_path / "run").code == 0
    for page in ("report.html", "report.md"):
        text = (tmp_path / "run" / "report" / page).read_text(encoding="utf-8")
        assert all(line.isprintable() for line in text.split("\n"))
        assert "<script>alert" not in text
        assert "<svg onload" not in text


PLACES = (
    *("../../etc/passwd", "/etc/passwd", "/etc/passwd.csv", "/dev/zero", "zero.csv", "pipe.npz", "folder.parquet"),
    *("~/x.csv", "x\0.csv", "-x.csv", "file:///etc/passwd", "http://127.0.0.1:9/x.csv", "a" * 5000 + ".csv"),
)


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize("key", ["robot", "table"])
def test_a_run_file_may_name_any_path_and_learns_nothing_of_what_is_there(cli, tmp_path, place, key):
    (tmp_path / "zero.csv").symlink_to("/dev/zero")
    os.mkfifo(tmp_path / "pipe.npz")
    (tmp_path / "folder.parquet").mkdir()
    table = {"file": {"path": place, "columns": {"position": ["x", "y", "z"]}}}
    run = {"robot": "./" + place, "targets": {"inline": [{"position": [0, 0, 1]}]}}
    if key == "table":
        run = {"robot": "qiao2021", "targets": table}
    (tmp_path / "run.yaml").write_text(json.dumps(run))
    before = sorted(tmp_path.iterdir())
    outcome = cli("batch", tmp_path / "run.yaml", "--out", tmp_path / "out")
    assert_plain(outcome)
    assert outcome.code == 2
    assert "root:" not in outcome.err
    assert sorted(tmp_path.iterdir()) == before


@pytest.mark.parametrize("secret", ["just a secret", "[secret, secret]", "secret: secret", "secret, x\nsecret, y"])
def test_a_file_that_is_something_else_is_not_quoted_at_length(cli, tmp_path, secret):
    (tmp_path / "key").write_text(secret)
    (tmp_path / "run.yaml").write_text("robot: ./key\ntargets: {inline: [{position: [0, 0, 1]}]}\n")
    outcome = cli("batch", tmp_path / "run.yaml", "--out", tmp_path / "out")
    assert outcome.code == 2
    assert outcome.err.count("secret") <= 1  # the name of a key that is not known

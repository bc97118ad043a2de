"""`ikde worlds`: show, validate, convert; what is wrong with a file is one line and writes nothing."""

import pytest

from ikde.io.world_file import load_world
from tests.three_joints import FILE
from tests.world_files import GOOD, assert_same, write_good


@pytest.fixture
def file(tmp_path):
    return write_good(tmp_path)


def test_a_world_is_shown(cli, file, monkeypatch):
    monkeypatch.setenv("COLUMNS", "60")
    outcome = cli("worlds", "show", str(file))
    assert (outcome.code, outcome.err) == (0, "")
    assert max(map(len, outcome.out.splitlines())) <= 60
    assert "note: 1 of 1,202 points are not finite and left out" in outcome.out


def test_a_world_as_json(cli, file):
    data = cli("worlds", "show", str(file), "--json").data
    assert (data["format"], len(data["obstacles"]), len(data["notes"])) == ("ikde", 11, 1)


def test_a_picture(cli, file, tmp_path):
    outcome = cli("worlds", "show", str(file), "--plot", str(tmp_path / "a.png"))
    assert outcome.out.endswith(f"wrote {tmp_path / 'a.png'}\n")
    assert (tmp_path / "a.png").read_bytes().startswith(b"\x89PNG")


def test_a_valid_world(cli, file):
    assert cli("worlds", "validate", str(file)).out.startswith(f"{file}: valid, ikde, 11 obstacles of 14 solids")
    data = cli("worlds", "validate", str(file), "--json").data
    assert (data["valid"], data["obstacles"], data["digest"]) == (True, 11, load_world(file).digest)


def test_a_world_is_converted(cli, file, tmp_path):
    outcome = cli("worlds", "convert", str(file), "--out", str(tmp_path / "b.yaml"))
    assert outcome.out == f"wrote {tmp_path / 'b_cloud_1.npy'}\nwrote {tmp_path / 'b.yaml'}\n"
    assert outcome.err == "ikde: 1 of 1,202 points are not finite and left out\n"
    assert_same(load_world(tmp_path / "b.yaml"), load_world(file))


def test_what_a_scene_cannot_hold_is_listed(cli, file, tmp_path):
    outcome = cli("worlds", "convert", str(file), "--to", "moveit")
    assert "ikde: not held by moveit: bar: MoveIt has no capsule\n" in outcome.err
    (tmp_path / "c.yaml").write_text(outcome.out, encoding="utf-8")
    assert "block" in load_world(tmp_path / "c.yaml").names


def test_clouds_need_a_place(refuse, file):
    assert "expected --out FILE" in refuse("worlds", "convert", str(file))


@pytest.mark.parametrize("command", [("show",), ("validate",), ("convert", "--out", "never.yaml")])
def test_a_bad_file_is_one_line(refuse, file, tmp_path, monkeypatch, command):
    monkeypatch.chdir(tmp_path)
    file.write_text(GOOD.replace("radius: 50", "radius: 0"), encoding="utf-8")
    assert "world.yaml:6 → obstacles.ball.sphere.radius: expected a size" in refuse("worlds", *command, str(file))
    assert not (tmp_path / "never.yaml").exists()


def test_a_picture_of_no_kind(refuse, file):
    assert "cannot be drawn" in refuse("worlds", "show", str(file), "--plot", "a.docx")


def test_a_world_is_not_written_over_what_it_is_read_from(refuse, file):
    before = file.read_bytes()
    assert "is what is read; expected another file" in refuse("worlds", "convert", str(file), "--out", str(file))
    assert file.read_bytes() == before


def test_a_world_is_checked_against_a_robot(cli, refuse, tmp_path):
    path = tmp_path / "near.yaml"
    path.write_text("obstacles: {d: {half_space: {}, position: [0, 0, -0.21]}}", encoding="utf-8")
    outcome = cli("worlds", "validate", path, "--robot", FILE)
    assert outcome.code == 0, outcome
    assert f"; fits {FILE}: nothing touches in every configuration\n" in outcome.out
    assert outcome.out.endswith("in every configuration: floor - d 10 mm\n")
    data = cli("worlds", "validate", path, "--robot", FILE, "--json").data
    assert [(pair["component"], pair["obstacle"]) for pair in data["standing"]] == [("floor", "d")]
    path.write_text("obstacles:\n  d:\n    sphere: {radius: 1}\n    ignore: [hnad]\n", encoding="utf-8")
    said = refuse("worlds", "validate", path, "--robot", FILE)
    assert "near.yaml:4 → obstacles.d.ignore[0]: no component is called 'hnad' (did you mean 'hand'?)" in said

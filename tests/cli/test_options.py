"""Options that commands share: units, joint values, detectors, frozen joints, and what is refused."""

import json
import os
import sys
from shutil import get_terminal_size

import pytest
import typer

import ikde
from ikde.cli.options import (
    AngleUnit,
    LengthUnit,
    check_drawable,
    draw,
    note_unchecked,
    read_choices,
    read_collision,
    read_de,
    read_freeze,
    read_q,
    repeat_command,
)
from ikde.cli.output import page_width
from ikde.errors import FileError, InputError
from ikde.model.collision_model import CollisionModel

SOLVE = ("solve", "--position", "0.8", "0.5", "1")
EVERY_COMMAND = [SOLVE, ("fk",), ("check",)]
every_command = pytest.mark.parametrize("command", EVERY_COMMAND, ids=["solve", "fk", "check"])
q_commands = pytest.mark.parametrize("command", [("fk",), ("check",)], ids=["fk", "check"])


@every_command
@pytest.mark.parametrize(
    ("options", "words"),
    [
        ("--robot qiao", "did you mean 'qiao2021'"),
        ("--robot nope.yaml", "nope.yaml: no such file"),
        ("--robot .", "no robot is called '.'"),
        ("--robot ./", "this is a folder"),
        ("--detector improv", "no detector 'improv'"),
        ("--unit cm", "'cm' is not one of 'm', 'mm'"),
        ("--angles grad", "'grad' is not one of 'rad', 'deg'"),
        ("--convention dh", "no convention 'dh'"),
        ("--colour", "No such option: --colour"),
        ("extra", "extra"),
        ("--robot", "requires an argument"),
        ("--plot nowhere/a.png", "folder that exists"),
        ("--plot a.xyz", "ends in .png, .svg, .pdf"),
        ("--plot .", "cannot be drawn"),
    ],
)
def test_what_every_command_refuses(refuse, command, options, words):
    assert words in refuse(*command, *options.split())


@q_commands
@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "expected 9 joint values"),
        ("1 2 3", "expected 9 joint values"),
        ("1 2 3 4 5 6 7 8 x", "expected a number, got 'x'"),
        ("nan 0 0 0 0 0 0 0 0", "finite"),
        ("0 0 0 0 0 0 0 0 inf", "finite"),
        ("q1=nan", "finite"),
        ("q1=inf", "finite"),
        ("q9=1", "no joint is called 'q9'"),
        ("q1=1 q1=2", "given twice"),
        ("nowhere.json", "no such file"),
        ("folder.yaml", "this is a folder"),
        ("bad.yaml", "bad.yaml:"),
    ],
)
def test_bad_joint_values_are_refused(refuse, tmp_path, command, text, words):
    (tmp_path / "folder.yaml").mkdir()
    (tmp_path / "bad.yaml").write_text("q1: 1\nq2: [\n")
    assert words in refuse(*command, "--q", text)


@pytest.mark.parametrize("command", [SOLVE, ("check",)], ids=["solve", "check"])
@pytest.mark.parametrize(
    ("options", "words"),
    [
        ("--pairs non_adj", "no pair list is called 'non_adj'"),
        ("--robot qiao2021_dh --pairs non_adj", "pair"),
        ("--detector none --pairs non_adj", "pair"),
        ("--safe-distance -1", "at least 0"),
        ("--safe-distance nan", "at least 0"),
        ("--safe-distance inf", "at least 0"),
        ("--safe-distance far", "--safe-distance"),
    ],
)
def test_bad_detector_options_are_refused(refuse, command, options, words):
    assert words in refuse(*command, *options.split())


def test_without_text_the_joints_are_home(qiao):
    assert read_q(qiao, None, LengthUnit.m, AngleUnit.rad, None).tolist() == qiao.home.tolist()


def test_joints_that_are_not_named_stay_at_home(qiao):
    q = read_q(qiao, "d_x=250 q2=90", LengthUnit.mm, AngleUnit.deg, None)
    assert q == pytest.approx([0.25, 0, 0, 1.5707963267948966, 1.5707963267948966, 0, 0, 0, 0])


def test_a_convention_counts_the_named_joints_only(qiao):
    q = read_q(qiao, "q5=180", LengthUnit.m, AngleUnit.deg, "classical")
    assert q == pytest.approx(qiao.home)


@pytest.mark.parametrize("content", [{"q1": 0.5}, [0, 0, 0, 0.5, 0, 0, 0, 0, 0]])
def test_joints_may_stand_in_a_file(qiao, tmp_path, content):
    path = tmp_path / "q.json"
    path.write_text(json.dumps(content))
    assert read_q(qiao, str(path), LengthUnit.m, AngleUnit.rad, None).tolist() == [0, 0, 0, 0.5, 0, 0, 0, 0, 0]


def test_a_detector_is_read_with_its_changes(qiao):
    plain = read_collision(qiao, None, None, None, LengthUnit.m)
    assert plain.detector == qiao.detectors["improved"]
    changed = read_collision(qiao, "typical", "arm_arm", 25.0, LengthUnit.mm).detector
    assert (changed.spheres, changed.pairs) == ("typical", "arm_arm")
    assert changed.safe_distance_m == pytest.approx(0.025)


def test_no_detector_is_called_none(qiao):
    assert read_collision(qiao, "none", None, None, LengthUnit.m).pairs == ()


@pytest.mark.parametrize(("columns", "width"), [(20, 60), (80, 80), (300, 120)])
def test_a_page_is_as_wide_as_the_terminal_within_reason(monkeypatch, substitute, columns, width):
    substitute(get_terminal_size, lambda: os.terminal_size((columns, 24)))
    assert page_width() == 100
    monkeypatch.setattr(sys.stdout, "isatty", lambda: True)
    assert page_width() == width


@pytest.mark.parametrize(("name", "err"), [("qiao2021_dh", "has no spheres\n"), ("qiao2021", "")])
def test_a_robot_without_a_detector_is_told_once_on_stderr(name, err, capsys):
    note_unchecked(ikde.load_robot(name))
    captured = capsys.readouterr()
    assert (captured.out, captured.err[-len(err) :] if err else captured.err) == ("", err)
    assert captured.err.count("\n") == bool(err)


def test_frozen_joints_are_read_in_the_users_units_and_convention(qiao):
    frozen = read_freeze(qiao, "d_x=200,q_z,q5=180", LengthUnit.mm, AngleUnit.deg, "classical")
    assert frozen == {"d_x": pytest.approx(0.2), "q_z": None, "q5": pytest.approx(0.0)}
    assert read_freeze(qiao, None, LengthUnit.m, AngleUnit.rad, None) is None


@pytest.mark.parametrize("text", ["d_z", "d_x=a", "d_x=", "d_x=1=2", "d_x=nan", "d_x=inf", "d_x=1,d_x=2"])
def test_a_bad_freeze_is_refused(qiao, text):
    with pytest.raises(InputError):
        read_freeze(qiao, text, LengthUnit.m, AngleUnit.rad, None)


@pytest.mark.parametrize("name", ["a.png", "a.SVG", "a.pdf"])
def test_a_name_that_can_be_drawn_is_accepted(tmp_path, name):
    check_drawable(tmp_path / name)
    check_drawable(None)


@pytest.mark.parametrize("name", ["a.bmp", "a", "folder.png", "nowhere/a.png"])
def test_a_name_that_cannot_be_drawn_is_refused(tmp_path, name):
    (tmp_path / "folder.png").mkdir()
    with pytest.raises(FileError):
        check_drawable(tmp_path / name)


def test_nothing_is_drawn_without_a_path(qiao, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    draw(None, qiao, qiao.home, None)
    assert list(tmp_path.iterdir()) == []


def test_drawing_writes_the_file(qiao, tmp_path):
    draw(tmp_path / "a.png", CollisionModel.of(qiao, "none"), qiao.home)
    assert (tmp_path / "a.png").read_bytes().startswith(b"\x89PNG")


def test_settings_of_the_de_are_read_by_their_kind():
    text = "population=80, strategy=best/1 weight=1,crossover=.5"
    assert read_de(text) == {"population": 80, "strategy": "best/1", "weight": 1.0, "crossover": 0.5}
    assert read_de(None) == read_de("") == {}


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("populaton=8", "--de: unknown key 'populaton' (did you mean 'population'?); expected strategy, population, "),
        ("best/1", "--de: unknown key 'best/1'; expected strategy, population, start_share, weight, crossover, "),
        ("population=8.5", "--de population: expected population=a whole number, got 'population=8.5'"),
        ("population", "--de population: expected population=a whole number, got 'population'"),
        ("weight=much", "--de weight: expected weight=a number, got 'weight=much'"),
        ("weight=1,weight=2", "--de weight: this key is given twice"),
    ],
)
def test_what_is_no_setting_of_the_de_is_refused(text, words):
    with pytest.raises(InputError) as caught:
        read_de(text)
    assert str(caught.value).startswith(words)


def test_names_are_read_in_their_order_and_all_if_nothing_is_said():
    known = ("a", "b", "c")
    assert read_choices("c,a", known, "--only") == ("c", "a")
    assert read_choices(None, known, "--only") == known


@pytest.mark.parametrize("text", ["", ",", "a,d"])
def test_names_that_are_none_are_refused(text):
    with pytest.raises(typer.BadParameter, match="expected some of a, b"):
        read_choices(text, ("a", "b"), "--only")


def test_the_environment_names_the_robot_where_the_command_does_not(cli, monkeypatch):
    monkeypatch.setenv("IKDE_ROBOT", "ur5")
    assert cli("fk").out.startswith("robot ur5\n")
    assert cli("check").out.startswith("free of self-collision: robot ur5, ")
    assert cli("robots", "show").out.startswith("ur5: ")
    assert cli("fk", "--robot", "panda").out.startswith("robot panda\n")


def test_a_robot_that_the_environment_names_wrongly_is_refused_by_its_name(refuse, monkeypatch):
    monkeypatch.setenv("IKDE_ROBOT", "ur6")
    assert refuse("fk").startswith("ikde: $IKDE_ROBOT: no robot is called 'ur6'")
    assert refuse("fk", "--robot", "ur7").startswith("ikde: no robot is called 'ur7'")


@pytest.mark.parametrize(
    "command",
    [SOLVE, ("fk",), ("check",), ("robots",), ("robots", "list"), ("schema", "track"), ("doctor",), ("warmup",)],
)
def test_a_wrong_word_about_compiling_is_refused_by_every_command(refuse, monkeypatch, command):
    monkeypatch.setenv("IKDE_COMPILE", "foo")
    assert refuse(*command) == "ikde: $IKDE_COMPILE: expected background, wait, never, got 'foo'\n"
    monkeypatch.setenv("IKDE_COMPILE", "")
    monkeypatch.setenv("IKDE_KERNELS", "junk")
    assert refuse(*command) == "ikde: $IKDE_KERNELS: expected written or tables, got 'junk'\n"


def test_weights_of_a_joint_that_is_none_name_the_joints(refuse):
    assert "joints are d_x, d_y, q_z, q1" in refuse(*SOLVE, "--weights", "foo=2")


def test_a_command_is_repeated_with_what_was_said():
    said = {"seed": 0, "drive": None, "start": "q1=1 q2=2", "quick": True}
    assert repeat_command(["track", "a b.yaml"], said) == (
        "ikde track 'a b.yaml' --seed 0 --start 'q1=1 q2=2' --quick --out FOLDER"
    )

"""`ikde robots`: list, show, validate; what is wrong with a file is one line."""

import re

import pytest

import ikde
from ikde.io.robots import robot_path
from tests.bare_robot import BARE
from tests.hostile_names import PRINTABLE, rename_in_file
from tests.robot_files import GOOD, NAMES
from tests.urdf_texts import ARM, write


@pytest.mark.parametrize("command", [("robots",), ("robots", "list")])
def test_every_robot_is_listed(cli, command):
    outcome = cli(*command)
    assert (outcome.code, outcome.err) == (0, "")
    for name in ikde.robot_names():
        assert name in outcome.out


def test_the_list_as_json(cli):
    data = cli("robots", "list", "--json").data
    assert [entry["name"] for entry in data] == list(ikde.robot_names())
    assert {frozenset(entry) for entry in data} == {frozenset({"name", "title", "joints", "detectors", "source"})}


def test_a_robot_is_shown_with_its_sources(cli, any_robot):
    outcome = cli("robots", "show", any_robot.name)
    assert (outcome.code, outcome.err) == (0, "")
    for name in any_robot.joint_names:
        assert name in outcome.out
    assert "where the numbers come from" in outcome.out


def test_a_robot_as_json_is_in_metres_and_radians(cli, any_robot):
    data = cli("robots", "show", any_robot.name, "--json").data
    assert data["name"] == any_robot.name
    assert [joint["upper"] for joint in data["joints"]] == any_robot.upper.tolist()
    assert data["default_detector"] == any_robot.default_detector


def test_the_kernels_of_a_robot_are_shown_as_source_or_inside_json(cli):
    asked = ("robots", "show", "ur5", "--kernels", "--kind", "position", "--detector", "none")
    source = cli(*asked).out
    compile(source, "ur5", "exec")
    assert cli(*asked, "--json").data == {"robot": "ur5", "kind": "position", "source": source}
    assert "expected one of" in cli(*asked[:4], "--kind", "poses", "--json").err


@pytest.mark.parametrize("template", PRINTABLE.values(), ids=PRINTABLE)
def test_whatever_a_robot_is_called_it_is_checked_shown_and_exported(cli, tmp_path, monkeypatch, template):
    path = tmp_path / "two.yaml"
    path.write_text(rename_in_file(GOOD, template.format, NAMES))
    monkeypatch.chdir(tmp_path)
    robot = ("--robot", path)
    asked = (
        ("robots", "validate", path),
        ("robots", "show", path),
        ("robots", "show", path, "--kernels"),
        ("robots", "export", path, "--urdf"),
        ("robots", "export", path, "--mjcf", "--out", "two.xml"),
        ("check", *robot, f"--pairs={template.format('all')}"),
        ("solve", *robot, "--position", "0.1", "0", "0.7505", "--json"),
    )
    for command in asked:
        outcome = cli(*command)
        assert outcome.code == 0, (command, outcome)
        assert outcome.err == "" or outcome.err.startswith(("compiling the kernels", "ikde: URDF", "ikde: MJCF"))
    assert sorted(tmp_path.rglob("*")) == [tmp_path / "two.xml", path]


def test_the_kernels_that_are_shown_hold_no_name(cli, tmp_path):
    path = tmp_path / "two.yaml"
    shown = []
    for template in ("{}", PRINTABLE["quotes"]):
        path.write_text(rename_in_file(GOOD, template.format, NAMES))
        shown.append(cli("robots", "show", path, "--kernels").out)
    assert shown[0] == shown[1]


def test_a_good_file_is_valid(cli, tmp_path):
    path = tmp_path / "two.yaml"
    path.write_text(GOOD)
    outcome = cli("robots", "validate", path)
    assert (outcome.code, outcome.err) == (0, "")
    first, second, *_ = outcome.out.splitlines()
    assert first == f"{path}: valid, robot two with 2 joints and 3 frames"
    assert second == "collision: detector coarse compares 1 pair, 0 left out"
    data = cli("robots", "validate", path, "--json").data
    assert {key: data[key] for key in ("valid", "name", "joints", "frames")} == {
        "valid": True,
        "name": "two",
        "joints": 2,
        "frames": 3,
    }
    (pair,) = data["collision"]["compared"]
    assert pair.pop("clearance_at_home_m") == pytest.approx(0.28)
    assert pair == {"a": "box", "b": "bar", "touches": "never", "is_proved": True}


def test_a_robot_is_shown_with_the_number_of_its_pairs_and_how_to_see_them(cli):
    text = cli("robots", "show", "qiao2021").out
    assert "compares 35 pairs, 20 left out\nikde robots show --pairs names them all" in text
    assert "M - G" not in text
    listed = cli("robots", "show", "qiao2021", "--pairs").out
    assert listed.startswith("robot qiao2021\ncollision: detector improved compares 35 pairs, 20 left out\n")
    assert re.search(r"^ M - G +one body$", listed, re.MULTILINE)
    assert "joints, " not in listed
    assert set(cli("robots", "show", "qiao2021", "--pairs", "--json").data) == {"robot", "collision"}
    assert "--kernels and --pairs" in cli("robots", "show", "qiao2021", "--pairs", "--kernels").err


@pytest.mark.parametrize(("command", "options"), [("show", ()), ("show", ("--pairs",)), ("validate", ())])
def test_pairs_are_those_of_the_detector_asked_for(cli, command, options):
    path = robot_path("qiao2021")
    for name in ("improved", "typical"):
        asked = ("robots", command, path, *options, *(("--detector", name) if name != "improved" else ()))
        assert f"collision: detector {name} compares 35 pairs, 20 left out" in cli(*asked).out
        assert cli(*asked, "--json").data["collision"]["detector"] == name
    assert cli("robots", command, path, "--detector", "none", "--json").data["collision"] is None
    assert "not checked" in cli("robots", command, path, "--detector", "none").out


def test_pairs_that_always_touch_are_named_with_a_line_that_loads(cli, tmp_path):
    path = tmp_path / "fat.yaml"
    path.write_text(BARE.replace("radius: 0.35", "radius: 0.9"))
    lines = cli("robots", "validate", path).out.splitlines()
    assert "platform - upper_arm touches in each of 1,000 random configurations" in lines
    (line,) = (line for line in lines if line.startswith("adjacent:"))
    path.write_text(f"{path.read_text()}{line}\n")
    mended = cli("robots", "validate", path)
    assert mended.code == 0
    assert "touches" not in mended.out
    assert "platform - upper_arm   adjacent: why they may touch" in mended.out


@pytest.mark.parametrize(
    ("old", "new", "place", "words"),
    [
        ("radius: 200", "radius: -200", ":15 → spheres.coarse[0].radius", "above 0"),
        ("radius: 200", "radius: 0", ":15 → spheres.coarse[0].radius", "above 0"),
        ("lower: -90, upper: 90", "lower: 90, upper: -90", ":7 → joints.turn.upper", "upper limit is below"),
        ("parent: rail", "parent: tip", ":10 → frames.arm.parent", "a cycle"),
        ("{box: [bar]}", "{box: [baz]}", ":18 → pairs.all.pairs.box", "did you mean 'bar'"),
        ("home: 10", "hoem: 10", ":7 → joints.turn.hoem", "did you mean 'home'"),
        ("tool: tip", "tol: tip", ":12 → tol", "did you mean 'tool'"),
        ("[0, 0, 500]", "[0, 500]", ":10 → frames.arm.xyz", "expected 3 values, got 2"),
        ("[0, 0, 500]", "[0, 0, .nan]", ":10 → frames.arm.xyz[2]", "finite"),
        ("upper: 1e3", "upper: .inf", ":6 → joints.slide.upper", "finite"),
        ("axis: [0, 1, 0]", "axis: [0, 0, 0]", ":10 → frames.arm.axis", "not zero"),
        ("[0, 0, 500]", "[0, 0, 500", ":10", "not YAML"),
        ("name: two", "name: 2", ":1 → name", "text"),
    ],
)
def test_what_is_wrong_with_a_file_is_one_line(refuse, tmp_path, old, new, place, words):
    assert old in GOOD
    path = tmp_path / "bad.yaml"
    path.write_text(GOOD.replace(old, new, 1))
    line = refuse("robots", "validate", path)
    assert line.startswith(f"ikde: {path}{place}")
    assert words in line


@pytest.mark.parametrize("text", ["", "just words", "[1, 2]", "{name: a, joints: {}, frames: {}}"])
def test_a_file_that_is_no_robot_is_refused(refuse, tmp_path, text):
    path = tmp_path / "bad.yaml"
    path.write_text(text)
    assert str(path) in refuse("robots", "validate", path)


def test_errors_of_a_file_are_a_line_each(cli, tmp_path):
    path = tmp_path / "bad.yaml"
    path.write_text("{}")
    outcome = cli("robots", "validate", path)
    keys = ("name", "joints", "frames", "tool")
    assert (outcome.code, outcome.out) == (2, "")
    assert outcome.err == "".join(f"ikde: {path}:1 → {key}: this key is missing\n" for key in keys)


def test_a_file_that_is_there_is_no_unknown_robot(refuse, tmp_path):
    (tmp_path / "arm.txt").write_text("<robot/>")
    assert refuse("robots", "show", "arm.txt").startswith("ikde: arm.txt: this is a URDF; expected YAML")


@pytest.mark.parametrize(
    ("command", "words"),
    [
        ("validate nope.yaml", "no such file"),
        ("validate .", "this is a folder"),
        ("validate", "Missing argument"),
        ("show", "Missing argument"),
        ("show ur", "did you mean 'ur5'"),
        ("shwo ur5", "Did you mean 'show'"),
        ("show ur5 --unit cm", "'cm' is not one of"),
        ("list extra", "extra"),
    ],
)
def test_what_robots_refuses(refuse, command, words):
    assert words in refuse("robots", *command.split())


@pytest.mark.parametrize(("option", "function"), [("--urdf", ikde.format_urdf), ("--mjcf", ikde.format_mjcf)])
def test_a_robot_is_exported(cli, tmp_path, any_robot, option, function):
    printed = cli("robots", "export", any_robot.name, option)
    assert printed.code == 0
    assert f"ikde: {option[2:].upper()} does not hold: " in printed.err
    assert printed.out == function(any_robot)
    path = tmp_path / "robot.xml"
    written = cli("robots", "export", any_robot.name, option, "--detector", "none", "--out", path)
    assert (written.code, written.out) == (0, f"wrote {path}\n")
    assert path.read_text(encoding="utf-8") == function(any_robot, collision="none")


@pytest.mark.parametrize("option", ["--curobo", "--xrdf"])
def test_a_urdf_goes_beside_and_none_of_the_users_own_is_written_over(cli, refuse, tmp_path, option):
    path, urdf = tmp_path / "arm.yml", tmp_path / "arm.urdf"
    assert cli("robots", "export", "ur5", option, "--out", path).out == f"wrote {path}\nwrote {urdf}\n"
    assert urdf.read_text(encoding="utf-8") == ikde.format_urdf("ur5")
    assert cli("robots", "export", "ur5", option, "--out", path).code == 0  # the same once more
    urdf.write_text("<robot/>")
    assert "arm.urdf is there already, and is not written over" in refuse(
        "robots", "export", "ur5", option, "--out", path
    )
    named = cli("robots", "export", "ur5", option, "--out", path, "--urdf-path", "mine.urdf")
    assert named.code == 0
    assert ("urdf_path: mine.urdf" in path.read_text(encoding="utf-8")) == (option == "--curobo")
    assert urdf.read_text() == "<robot/>"
    assert "the URDF: name it (--urdf-path FILE)" in cli("robots", "export", "ur5", option).err


def test_a_robot_file_is_exported(cli, tmp_path):
    path = tmp_path / "two.yaml"
    path.write_text(GOOD)
    assert cli("robots", "export", path, "--urdf").out == ikde.format_urdf(ikde.load_robot(path))


@pytest.mark.parametrize("option", ["--urdf", "--srdf", "--mjcf", "--curobo", "--xrdf"])
def test_nothing_is_exported_over_what_it_is_made_of(refuse, tmp_path, option):
    for path, text in ((tmp_path / "two.yaml", GOOD), (write(tmp_path, ARM), ARM)):
        path.write_text(text)
        (tmp_path / "link").unlink(missing_ok=True)
        (tmp_path / "link").symlink_to(path)
        for out in (path, tmp_path / "link"):
            assert "is what is read; expected another file to write" in refuse(
                "robots", "export", path, option, "--out", out
            )
        assert path.read_text() == text


@pytest.mark.parametrize(
    ("command", "words"),
    [
        ("ur5", "expected one of --urdf, --srdf, --mjcf, --curobo and --xrdf, got none"),
        ("ur5 --urdf --urdf-path ur5.urdf", "only --curobo and --xrdf go with a URDF"),
        ("ur5 --urdf --mjcf", "expected one of --urdf, --srdf, --mjcf, --curobo and --xrdf, got 2"),
        ("ur --urdf", "did you mean 'ur5'"),
        ("nope.yaml --urdf", "no such file"),
        ("--urdf", "Missing argument"),
        ("ur5 --urdf --detector coarse", "no detector 'coarse'"),
        ("ur5 --urdf --out .", "cannot be written"),
        ("ur5 --mjcf --out missing/ur5.xml", "its folder does not exist"),
        ("ur5 --urdf --out /dev/null", "no ordinary file"),
        ("ur5 --urdf --out", "requires an argument"),
        ("ur5 --curobo --out .", "cannot be written: expected the name of a file"),
        ("ur5 --xrdf --out arm.urdf", "arm.urdf is where the URDF goes; expected another name"),
        (f"ur5 --xrdf --out {'x' * 300}", "cannot be written: File name too long"),
    ],
)
def test_what_export_refuses(refuse, command, words):
    assert words in refuse("robots", "export", *command.split())

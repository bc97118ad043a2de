"""What an import made of a URDF, as text and as JSON."""

import json

import pytest

from ikde.io.urdf_import.options import ImportOptions
from ikde.io.urdf_import.read_urdf import read_urdf
from ikde.report.numbers import Units
from ikde.report.robot_import import format_import, import_json
from tests.urdf_texts import ARM, FINGERS, extend, joint, write

FAR = '<link name="far"><collision><geometry><sphere radius="0.1"/></geometry></collision></link>'
TEXT = extend(FINGERS + FAR + joint("wall", "fixed", "base_link", "far", '<origin xyz="9 0 0"/>'))
SRDF = '<robot name="arm"><disable_collisions link1="base_link" link2="fore" reason="Never"/></robot>'


@pytest.fixture
def imported(tmp_path):
    text = TEXT.replace('lower="-1.5" upper="2"', 'lower="-1e9" upper="1e9"')
    options = ImportOptions(tool="tip", base="omni", srdf=write(tmp_path, SRDF, "arm.srdf"))
    return read_urdf(write(tmp_path, text), options)


def rows(text, title):
    """Words of each line of the table under a title."""
    lines = text.split(title)[1].split("\n\n")[1].splitlines()
    return [line.split() for line in lines[2:]]


def test_every_decision_is_listed(imported):
    text = format_import(imported, Units("mm", "deg"), width=140)
    assert text.splitlines()[0] == f"arm from {imported.file}: tool tip"
    listed = rows(text, "joints that move the tool")
    assert listed[0] == ["base_x", "prismatic", "-100000", "0", "100000", "mm"]
    assert listed[2] == ["base_yaw", "continuous", "none", "0", "none", "deg"]
    assert listed[3][:7] == ["shoulder", "continuous", "none", "0", "none", "deg", "68.75/s"]
    assert " ".join(listed[3][7:]) == "no limits in the file: continuous"
    assert listed[4] == ["slide", "prismatic", "100", "250", "400", "mm"]
    assert rows(text, "frozen: 2 joints")[1][:4] == ["grip_mimic", "prismatic", "-17", "mm"]
    assert rows(text, "spheres: 4 on 4 links")[0] == ["base_link", "1", "sphere", "1", "as", "they", "are"]
    assert rows(text, "left out beside neighbours") == [["base_link", "-", "fore", "SRDF:", "Never"]]
    assert "pairs: 6 in all: 2 compared, of which 2 never touch (proved); 4 left out, of which 3 are neighbours" in text
    assert "home: 0, or mid-range where 0 is outside the limits; free" in text


def test_names_are_whole_in_a_narrow_terminal(tmp_path):
    long = ARM.replace("shoulder", "the_joint_of_the_left_arm")
    text = format_import(read_urdf(write(tmp_path, long)), Units("mm", "deg"), width=60)
    assert rows(text, "joints that move the tool")[0] == [
        "the_joint_of_the_left_arm",
        "-85.9437",
        "0",
        "114.592",
        "deg",
    ]


def test_json_holds_the_same_in_metres_and_radians(imported):
    data = json.loads(json.dumps(import_json(imported), allow_nan=False))
    assert (data["name"], data["tool"], data["drive"], data["tool_was_chosen"]) == (
        "arm",
        "tip",
        "omnidirectional",
        False,
    )
    assert data["joints"][3]["note"] == "no limits in the file: continuous"
    assert (data["joints"][3]["lower"], data["joints"][4]["lower"]) == (None, 0.1)
    assert data["frozen"][1] | {"value": 0} == {
        "name": "grip_mimic",
        "kind": "prismatic",
        "value": 0,
        "reason": "off the chain to the tool, mimics grip",
    }
    assert len(data["spheres"]) == 4
    assert [pair["touches"] for pair in data["collision"]["compared"]] == ["never", "never"]
    assert sorted(data["never_touching"]) == [["fore", "far"], ["upper", "far"]]
    assert data["home_is_free"] is True


def test_what_is_not_there_has_no_table(tmp_path):
    text = format_import(read_urdf(write(tmp_path, ARM), ImportOptions(spheres=False)), Units(), width=200)
    assert "tool tip, the only end that a joint moves" in text
    for title in ("frozen", "stand out", "pairs left out"):
        assert title not in text
    assert "pairs: none, self-collision is not checked" in text
    assert "home: 0, or mid-range where 0 is outside the limits; not checked" in text
    assert "warning: no link has spheres: self-collision is not checked" in text


def test_names_are_text_not_markup(tmp_path):
    imported = read_urdf(write(tmp_path, ARM.replace('"shoulder"', '"[red]x[/]"').replace('"fore"', '"[b]"')))
    text = format_import(imported, Units(), width=120)
    assert "[red]x[/]" in text
    assert "[b]" in text


def test_the_chain_is_told_and_how_a_gripper_is_left_out(tmp_path):
    path = write(tmp_path, ARM)
    text = format_import(read_urdf(path), Units("mm", "deg"), width=140)
    assert "chain: shoulder moves upper, slide moves fore, the tool tip is fixed to it" in text
    assert "tool: if slide opens a gripper, --tool upper names a link before it" in text
    named = read_urdf(path, ImportOptions(tool="fore"))
    assert "opens a gripper" not in format_import(named, Units("mm", "deg"))
    assert import_json(named)["chain"] == [{"joint": "shoulder", "link": "upper"}, {"joint": "slide", "link": "fore"}]

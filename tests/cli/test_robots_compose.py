"""`ikde robots compose`: parts as files, one robot file."""

import pytest

import ikde
from tests.robot_files import GOOD

TOOL = """\
name: gripper
joints: {}
frames:
  palm: {parent: world, xyz: [0, 0, 0.05]}
  tool: {parent: palm, xyz: [0, 0, 0.1]}
tool: tool
spheres: {s: [{component: palm, from: palm, radius: 0.05}]}
"""


@pytest.fixture
def parts(tmp_path):
    platform, tool = tmp_path / "platform.yaml", tmp_path / "gripper.yaml"
    platform.write_text(GOOD, encoding="utf-8")
    tool.write_text(TOOL, encoding="utf-8")
    return platform, tool


def test_parts_become_a_robot_file(cli, parts, tmp_path):
    platform, tool = parts
    out = tmp_path / "robot.yaml"
    asked = ("robots", "compose", "--base", platform, "--arm", "ur5", "--mount", "0.3 0 0.4 0 0 1.5", "--tool", tool)
    outcome = cli(*asked, "-o", out)
    assert (outcome.code, outcome.err) == (0, "")
    assert outcome.out.endswith(f"wrote {out}\n")
    robot = ikde.load_robot(out)
    assert robot.joint_names[:3] == ("slide", "turn", "shoulder_pan_joint")
    assert (robot.tool, robot.name) == ("tool", "two_ur5_gripper")
    assert "palm" in robot.components("spheres")
    mount = next(frame for frame in robot.frames if frame.name == "arm_mount")
    assert mount.p_parent_frame.tolist() == [0.3, 0.0, 0.4]
    assert mount.R_parent_frame[1, 0] == pytest.approx(0.9974949866)
    assert out.read_text().startswith(f"# Composed of {platform}, ur5 at 0.3 0 0.4 0 0 1.5, {tool}; m and rad.\n")
    shown = cli(*asked, "--json")
    assert (shown.data["tool"], shown.err) == ("tool", "ikde: nothing is written without -o FILE\n")


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        (("--mount", "1 2"), "mount: expected 'X Y Z' or 'X Y Z R P Y', in m and rad, got '1 2'"),
        (("--mount", "1 2 nan"), "mount: expected"),
        (("--mount", "1 2 x"), "mount: expected"),
        (("--arm", "ur6"), "no robot is called 'ur6' (did you mean 'ur5'?)"),
        (("--tool", "none.yaml"), "none.yaml: no such file"),
    ],
)
def test_what_is_wrong_is_one_line(refuse, parts, changes, message):
    asked = {"--base": parts[0], "--arm": "ur5"} | dict([changes])
    assert message in refuse("robots", "compose", *[word for pair in asked.items() for word in pair], "-o", "out.yaml")


def test_a_tool_without_joints_is_checked_as_any_robot(refuse, parts):
    parts[1].write_text(TOOL.replace("parent: palm", "parent: plam"), encoding="utf-8")
    said = refuse("robots", "compose", "--base", parts[0], "--arm", "ur5", "--tool", parts[1])
    assert f"{parts[1]}:5 → frames.tool.parent: no frame is called 'plam' (did you mean 'palm'?)" in said


def test_a_part_is_not_written_over(refuse, parts):
    platform, tool = parts
    before = tool.read_bytes()
    said = refuse("robots", "compose", "--base", platform, "--arm", "ur5", "--tool", tool, "-o", tool)
    assert f"{tool} is what is read; expected another file to write" in said
    assert tool.read_bytes() == before

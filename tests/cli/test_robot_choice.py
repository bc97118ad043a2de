"""`--tool`: which of a robot's tools, what is held then, and what is refused."""

import pytest

import ikde
from tests.dual_arm import DUAL
from tests.urdf_texts import write

TARGET = ("--position", "0.5", "0.1", "0.4")


@pytest.fixture
def dual(cli, tmp_path):
    path = tmp_path / "dual.yaml"
    asked = ("--tool", "left=left_hand", "--tool", "right=right_hand")
    outcome = cli("robots", "import", write(tmp_path, DUAL), *asked, "-o", path)
    assert outcome.code == 0
    assert "tools: left, right; the first one unless another is chosen" in outcome.out
    return path


@pytest.mark.parametrize("tool", ["left", "right"])
def test_one_arm_moves_and_the_other_is_held(cli, dual, tool):
    outcome = cli("solve", *TARGET, "--robot", dual, "--tool", tool, "--json")
    other = {"left": "right", "right": "left"}[tool]
    assert outcome.code == 0
    assert f"ikde: tool {tool}; held, as they do not move it: {other}_shoulder, {other}_elbow\n" in outcome.err
    q = outcome.data["q"]
    assert (q[f"{other}_shoulder"], q[f"{other}_elbow"]) == (0.0, 0.0)


def test_the_files_tool_is_the_default_and_near_says_where_the_other_arm_stands(cli, dual):
    outcome = cli("solve", *TARGET, "--robot", dual, "--near", "right_shoulder=-0.5,left_shoulder=0.3", "--json")
    assert "ikde: tool left; held" in outcome.err
    q = outcome.data["q"]
    assert (q["right_shoulder"], q["right_elbow"]) == (-0.5, 0.0)


def test_check_and_fk_take_all_joints(cli, dual):
    q = ("--q", "right_shoulder=-0.5,left_shoulder=0.3", "--robot", dual)
    assert cli("check", *q, "--tool", "right").code == 0
    left, right = (cli("fk", *q, "--tool", tool, "--json") for tool in ("left", "right"))
    assert left.err == right.err == ""
    frames = left.data["frames"]
    assert frames["tool"] == frames["left_hand"]
    assert right.data["frames"]["tool"] == frames["right_hand"]


def test_an_unknown_tool_is_refused_with_the_nearest(refuse, dual):
    for command in (("solve", *TARGET), ("check",), ("fk",), ("warmup",)):
        message = refuse(*command, "--robot", dual, "--tool", "rigt")
        assert "tool: no tool and no frame of dual is called 'rigt' (did you mean 'right'?)" in message
    message = refuse("robots", "import", dual.with_name("arm.urdf"), "--tool", "left_hand", "--tool", "right_hand")
    assert "tool: expected NAME=LINK, each name once, got 'left_hand'" in message
    message = refuse("robots", "import", dual.with_name("arm.urdf"), "--tool", "left=left_hnd")
    assert "no link is called 'left_hnd' (did you mean 'left_hand'?)" in message


def test_all_joints_are_shown_and_exported(cli, dual):
    shown = cli("robots", "show", dual)
    assert "tool: left_hand; tools by name: left (left_hand), right (right_hand)" in shown.out
    assert cli("robots", "show", dual, "--json").data["tools"] == {"left": "left_hand", "right": "right_hand"}
    outcome = cli("robots", "export", dual, "--urdf")
    assert 'name="right_elbow" type="continuous"' in outcome.out
    assert "tools by name: left, right" in outcome.err
    assert outcome.out == ikde.format_urdf(dual)

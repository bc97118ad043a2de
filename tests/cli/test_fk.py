"""`ikde fk`."""

import numpy as np
import pytest

import ikde
from tests.cli.paper_row import ROW, ROW_OPTIONS

FRAMES = ("Ob", "O1", "Oc12", "O2", "Oc23", "O3", "O4", "O5", "O6", "tool")


def test_json_has_every_frame_by_name(cli, qiao):
    data = cli("fk", "--json").data
    assert set(data) == {"robot", "convention", "q", "outside_limits", "frames"}
    assert set(FRAMES) <= set(data["frames"])
    assert data["q"] == dict(zip(qiao.joint_names, qiao.home.tolist(), strict=True))
    for name, T in ikde.forward(qiao, qiao.home).items():
        assert set(data["frames"][name]) == {"p_world", "R_world"}
        assert data["frames"][name]["p_world"] == T[:3, 3].tolist()
        assert data["frames"][name]["R_world"] == T[:3, :3].tolist()


def test_a_row_of_the_paper_is_pasted(cli):
    outcome = cli("fk", "--q", ROW, *ROW_OPTIONS, "--json")
    assert outcome.code == 0
    assert outcome.data["frames"]["tool"]["p_world"] == pytest.approx([0.8, 0.5, 1.0], abs=1e-4)


def test_text_shows_the_tool_in_the_unit_asked_for(cli):
    outcome = cli("fk", "--q", ROW, *ROW_OPTIONS)
    assert (outcome.code, outcome.err) == (0, "")
    assert outcome.out.splitlines()[-1].split()[:4] == ["tool", "800.0", "500.0", "1000.0"]
    assert "[mm]" in outcome.out


def test_units_do_not_change_json(cli):
    metres = cli("fk", "--q", "d_x=0.5 q1=0.25", "--json")
    millimetres = cli(
        "fk", "--q", f"d_x=500 q1={float(np.degrees(0.25))!r}", "--unit", "mm", "--angles", "deg", "--json"
    )
    tools = [outcome.data["frames"]["tool"]["p_world"] for outcome in (metres, millimetres)]
    assert tools[0] == pytest.approx(tools[1], abs=1e-15)


def test_values_outside_the_limits_are_accepted_and_named(cli):
    outcome = cli("fk", "--q", "d_x=6 q2=3", "--json")
    assert outcome.code == 0
    assert outcome.data["outside_limits"] == ["d_x", "q2"]
    assert "outside the limits: d_x, q2" in cli("fk", "--q", "d_x=6 q2=3").out


def test_a_figure_is_written(cli, tmp_path):
    outcome = cli("fk", "--plot", tmp_path / "pose.png")
    assert (outcome.code, outcome.err) == (0, "")
    assert (tmp_path / "pose.png").stat().st_size > 10_000


def test_a_figure_without_spheres_is_written(cli, tmp_path):
    outcome = cli("fk", "--robot", "qiao2021_dh", "--plot", tmp_path / "pose.png")
    assert (outcome.code, outcome.err) == (0, "")


def test_every_robot_has_frames(cli, any_robot):
    outcome = cli("fk", "--robot", any_robot.name, "--json")
    assert outcome.code == 0
    assert any_robot.tool in outcome.data["frames"]


@pytest.mark.parametrize("value", ["1e308", "-1e200"])
def test_absurd_values_never_print_what_is_no_number(cli, value):
    outcome = cli("fk", "--q", f"d_x={value}", "--json")
    assert outcome.code in (0, 2)
    assert "NaN" not in outcome.out

"""`ikde solve`."""

import json
import os
import subprocess
import sys
from collections import Counter
from dataclasses import asdict, fields
from pathlib import Path

import numpy as np
import pytest
from typer.main import get_command

import ikde
from ikde.cli.app import app
from ikde.solver.engine_table import ENGINES
from ikde.solver.settings import DeSettings
from tests.problems import are_apart

PAPER = ikde.SolveSettings.for_method("de").de
GOLDEN = Path(__file__).parent / "golden_solve.json"
PROMISED = {
    "reached",
    "stop_reason",
    "q",
    "position_error_m",
    "orientation_error_rad",
    "clearance_m",
    "closest_pair",
    "nearest_obstacle",
    "collision",
    "method",
    "detector",
    "seed",
    "evaluations",
    "solve_seconds",
    "compile_seconds",
    "verified",
}
BEYOND = {
    "reason",
    "hint",
    "robot",
    "convention",
    "nearest_obstacle",
    "outside_limits",
    "attempts",
    "motion",
    "rejected",
    "blocking_pairs",
    "settings",
    "family",
}
SOLVE = ("solve", "--position", "0.8", "0.5", "1")
SOLVE_MM = ("solve", "--position", "800", "500", "1000", "--unit", "mm")


def error_m(robot, data):
    tool = ikde.forward(robot, data["q"], data["convention"])[robot.tool]
    return np.linalg.norm(tool[:3, 3] - [0.8, 0.5, 1.0])


def test_json_has_the_promised_keys(cli, qiao):
    outcome = cli(*SOLVE, "--seed", 7, "--json")
    assert outcome.code == 0
    data = outcome.data
    assert set(data) == PROMISED | BEYOND
    assert tuple(data["q"]) == qiao.joint_names
    assert (data["reached"], data["stop_reason"], data["collision"]) == (True, "reached", False)
    assert (data["detector"], data["seed"], data["verified"]) == ("improved", 7, True)
    assert data["clearance_m"] == pytest.approx(ikde.check(qiao, data["q"]).clearance_m, abs=1e-11)
    assert data["position_error_m"] == pytest.approx(error_m(qiao, data), abs=1e-11)  # the grader's, and plain numpy's
    assert data["position_error_m"] <= 1e-5


def test_the_answer_is_the_golden_one_bit_for_bit():
    """The bits are promised to be the same everywhere; a change of kernels or defaults means a new golden file."""
    kernels = {name: value for name, value in os.environ.items() if name != "IKDE_KERNELS"}
    command = [sys.executable, "-m", "ikde", *SOLVE_MM, "--json", "--seed", "7"]
    found = subprocess.run(command, env=kernels, capture_output=True, text=True, check=True)
    assert json.loads(found.stdout)["q"] == json.loads(GOLDEN.read_text())


def test_units_change_the_last_bits_at_most(cli):
    metres, millimetres = (cli(*command, "--json").data["q"] for command in (SOLVE, SOLVE_MM))
    assert metres == pytest.approx(millimetres, abs=1e-9)


def test_the_same_seed_gives_the_same_answer_and_another_another(cli):
    first, again, other = (cli(*SOLVE, "--json", "--seed", seed).data["q"] for seed in (3, 3, 4))
    assert first == again != other


def test_text_shows_verdict_joints_and_figures(cli, qiao):
    outcome = cli(*SOLVE_MM, "--angles", "deg")
    assert (outcome.code, outcome.err) == (0, "")
    assert outcome.out.startswith("reached by qiao2021: within tolerance")
    for words in (*qiao.joint_names, "position error", "clearance", "mm", "deg", "seed 0"):
        assert words in outcome.out
    assert "\x1b" not in outcome.out


def test_the_classical_answer_goes_back_through_fk(cli):
    solved = cli(*SOLVE, "--convention", "classical", "--json").data
    text = " ".join(repr(value) for value in solved["q"].values())
    frames = cli("fk", "--q", text, "--convention", "classical", "--json").data["frames"]
    error = np.linalg.norm(np.array(frames["tool"]["p_world"]) - [0.8, 0.5, 1.0])
    assert solved["convention"] == "classical"
    assert error == pytest.approx(solved["position_error_m"], abs=1e-12)


def test_the_convention_moves_q5_only(cli):
    own, classical = (cli(*SOLVE, "--json", *options).data["q"] for options in ((), ("--convention", "classical")))
    assert {name for name in own if own[name] != classical[name]} == {"q5"}


@pytest.mark.parametrize(
    ("options", "rotation"),
    [
        ("--quat-wxyz 0 2 0 0", np.diag([1, -1, -1])),
        ("--rpy 180 0 0 --angles deg", np.diag([1, -1, -1])),
        ("--rpy 0 0 1.5707963267948966", [[0, -1, 0], [1, 0, 0], [0, 0, 1]]),
    ],
)
def test_a_pose_is_met(cli, qiao, options, rotation):
    outcome = cli(*SOLVE, *options.split(), "--json")
    assert outcome.code == 0
    assert outcome.data["orientation_error_rad"] <= 1e-4
    tool = ikde.forward(qiao, outcome.data["q"])["tool"]
    assert tool[:3, :3] == pytest.approx(np.array(rotation), abs=2e-4)


def test_an_axis_is_met(cli, qiao):
    outcome = cli(*SOLVE, "--axis", 0, 0, -3, "--json")
    assert outcome.code == 0
    assert ikde.forward(qiao, outcome.data["q"])["tool"][:3, 2] == pytest.approx([0, 0, -1], abs=2e-4)


def test_settings_of_the_de_are_laid_over_its_own_defaults(cli):
    data = cli(*SOLVE, "--method", "de", "--de", "population=40,strategy=best/1", "--json").data
    assert data["method"] == "de"
    assert data["settings"]["de"] == asdict(PAPER) | {"population": 40, "strategy": "best/1"}
    assert data["settings"]["position_tolerance_m"] == 5e-5


@pytest.mark.parametrize("method", ["lm", "auto"])
def test_other_methods_refuse_settings_of_the_de(cli, method):
    refused = cli(*SOLVE, "--de", "population=40", "--method", method)
    assert (refused.code, refused.out) == (2, "")
    told = f"ikde: --de population: `population` is a setting of the method de; {method} does not use it"
    assert refused.err.startswith(told)
    assert refused.err.count("\n") == 1


def test_options_are_few_and_stand_under_headings():
    options = [p for p in get_command(app).commands["solve"].params if p.name != "help"]
    headings = Counter(option.rich_help_panel for option in options)
    assert [*headings] == ["Target", "Freedom of the target", "Robot", "Collision", "Search", "Units and output"]
    assert max(headings.values()) <= 8


def test_help_names_every_method_and_every_setting_of_the_de(cli):
    words = " ".join(cli("solve", "--help").out.replace("│", " ").split())
    for row in ENGINES.values():
        assert row.brief in words
    assert ", ".join(field.name for field in fields(DeSettings)) in words


def test_a_timeout_ends_the_search(cli):
    endless = (*SOLVE, "--detector", "single", "--restarts", 10**6, "--timeout", 1e-9)
    outcome = cli(*endless, "--json")
    assert (outcome.code, outcome.data["stop_reason"]) == (1, "timed_out")
    assert outcome.data["settings"]["timeout_s"] == 1e-9
    assert "what would help: a longer timeout" in cli(*endless).out
    assert "--timeout: expected a finite number above 0, got 0" in cli(*SOLVE, "--timeout", 0).err


def test_tolerances_are_in_the_units_asked_for(cli):
    options = ("--tolerance", "2", "--orientation-tolerance", "1", "--angles", "deg", "--axis", "0", "0", "1")
    data = cli(*SOLVE_MM, *options, "--json").data
    assert data["reached"]
    assert data["settings"]["position_tolerance_m"] == pytest.approx(2e-3)
    assert data["settings"]["orientation_tolerance_rad"] == pytest.approx(np.radians(1))


def test_several_solutions_are_distinct_and_numbered(cli, qiao):
    outcome = cli(*SOLVE, "--count", 3, "--json")
    assert outcome.code == 0
    solutions = [list(entry["q"].values()) for entry in outcome.data["solutions"]]
    assert len(solutions) == 3
    assert solutions[0] == list(outcome.data["q"].values())
    for i, q in enumerate(solutions):
        assert all(are_apart(qiao, q, other) for other in solutions[:i])
    assert outcome.data["solve_seconds"] > 0.0
    assert not any({"solve_seconds", "compile_seconds"} & set(entry) for entry in outcome.data["solutions"])
    text = cli(*SOLVE, "--count", 3).out
    assert "solution 3 of 3" in text
    assert text.splitlines()[-1].startswith("together ")
    assert text.count("together ") == 1


def test_fewer_solutions_than_asked_for_exit_with_1(cli, qiao):
    frozen = ",".join(qiao.joint_names)
    tool = ikde.forward(qiao, qiao.home)["tool"][:3, 3]
    outcome = cli("solve", "--position", *tool, "--freeze", frozen, "--count", 2, "--restarts", 2, "--json")
    assert outcome.code == 1
    assert outcome.err == "found 1 distinct solutions of 2; no joint may move\n"
    assert outcome.data["reached"] is True
    assert len(outcome.data["solutions"]) == 1
    narrow = ("--freeze", "d_x,d_y,q_z,q1,q2,q3,q4,q5", "--restarts", 2)
    outcome = cli("solve", "--position", *tool, *narrow, "--count", 99)
    assert (outcome.code, outcome.err.endswith("; more --restarts may find more\n")) == (1, True)


def test_where_no_joint_may_move_the_answer_says_so(cli, qiao):
    outcome = cli(*SOLVE, "--freeze", ",".join(qiao.joint_names))
    assert outcome.code == 1
    assert outcome.out.startswith(
        "not reached by qiao2021: no joint may move: the tool stays 0.703 m off\nwhat would help: free "
    )
    assert "none: no joint may move" in outcome.out
    data = cli(*SOLVE, "--freeze", ",".join(qiao.joint_names), "--json").data
    assert (data["method"], data["attempts"], data["evaluations"]) == ("none", 1, 1)
    assert data["verified"] is True


def test_frozen_joints_keep_their_values(cli):
    data = cli(*SOLVE_MM, "--freeze", "d_x=200,q_z=10", "--angles", "deg", "--json").data
    assert data["reached"] is True
    assert data["q"]["d_x"] == 0.2
    assert data["q"]["q_z"] == np.radians(10)


def test_near_keeps_the_answer_close(cli):
    start = cli(*SOLVE, "--seed", 5, "--json").data["q"]
    text = " ".join(f"{name}={value!r}" for name, value in start.items())
    near = cli(*SOLVE, "--near", text, "--json").data["q"]
    far = cli(*SOLVE, "--json").data["q"]
    distances = [max(abs(q[name] - start[name]) for name in start) for q in (near, far)]
    assert distances[0] < 0.5 * distances[1]


def test_an_unreachable_target_exits_with_1_and_says_why(cli):
    outcome = cli("solve", "--position", 0, 0, 5, "--json")
    assert outcome.code == 1
    assert outcome.err == ""
    assert (outcome.data["reached"], outcome.data["stop_reason"]) == (False, "out_of_reach")
    assert outcome.data["hint"]
    text = cli("solve", "--position", 0, 0, 5)
    assert text.code == 1
    assert text.out.startswith("not reached by qiao2021: out of reach")
    assert "what would help" in text.out


def test_a_target_at_the_end_of_the_world_is_not_a_bug(cli):
    assert cli("solve", "--position", "1e300", 0, 0, "--restarts", 1).code in (1, 2)


def test_the_papers_method_is_recorded(cli):
    data = cli(*SOLVE, "--method", "de", "--json").data
    assert (data["reached"], data["method"]) == (True, "de")
    assert data["position_error_m"] <= 5e-5


@pytest.mark.parametrize("method", ["auto", "de"])
def test_the_same_command_with_the_seed_that_the_text_names_repeats_the_answer(cli, method):
    def joints(*options):
        lines = cli(*SOLVE, "--method", method, *options).out.splitlines()
        return [line for line in lines if line.lstrip().startswith(("d_", "q"))], lines[-1]

    first, line = joints("--seed", "7")
    assert line.split()[:2] == ["repeat", "with"]
    again, _ = joints("--seed", line.partition("seed ")[2].partition(":")[0])
    assert again == first


def test_without_a_detector_collision_is_not_checked(cli):
    data = cli(*SOLVE, "--detector", "none", "--json").data
    assert (data["detector"], data["clearance_m"], data["closest_pair"]) == ("none", None, None)
    assert (data["collision"], data["verified"]) == (None, True)
    assert "self-collision not checked" in " ".join(cli(*SOLVE, "--detector", "none").out.split())


@pytest.mark.parametrize("options", [(), ("--json",), ("--count", 2)])
def test_a_robot_without_a_detector_is_told_once(cli, options):
    outcome = cli(*SOLVE, "--robot", "qiao2021_dh", *options)
    assert (outcome.code, outcome.err) == (0, "ikde: self-collision is not checked: qiao2021_dh has no spheres\n")


def test_a_detector_that_is_switched_off_is_not_missed(cli):
    assert cli(*SOLVE, "--detector", "none").err == ""
    assert cli(*SOLVE, "--robot", "qiao2021_dh", "--detector", "none").err == ""


def test_the_safe_distance_is_kept(cli):
    data = cli(*SOLVE_MM, "--safe-distance", 30, "--json").data
    assert data["reached"] is True
    assert data["clearance_m"] > 0.03


def test_a_figure_is_written(cli, tmp_path):
    outcome = cli(*SOLVE, "--plot", tmp_path / "pose.png")
    assert (outcome.code, outcome.err) == (0, "")
    assert (tmp_path / "pose.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ("--position nan 0 0", "finite"),
        ("--position 0 0 inf", "finite"),
        ("--position 1e400 0 0", "finite"),
        ("--position a 0 0", "--position"),
        ("--position 1 2", "requires 3 arguments"),
        ("--tolerance 0", "--tolerance: expected a finite number above 0"),
        ("--tolerance -1", "--tolerance: expected a finite number above 0"),
        ("--tolerance nan", "--tolerance: expected a finite number above 0"),
        ("--tolerance inf", "--tolerance: expected a finite number above 0"),
        ("--orientation-tolerance 0", "--orientation-tolerance: expected a finite number above 0"),
        ("--orientation-tolerance nan", "--orientation-tolerance: expected a finite number above 0"),
        ("--orientation-tolerance 3.2", "--orientation-tolerance: expected at most 3.14159, half a turn, got 3.2"),
        ("--orientation-tolerance 200 --angles deg", "expected at most 180, half a turn, got 200"),
        ("--quat-wxyz 0 0 0 0", "length 0"),
        ("--quat-wxyz nan 0 0 0", "finite"),
        ("--quat-wxyz 1 0 0", "requires 4 arguments"),
        ("--axis 0 0 0", "length 0"),
        ("--rpy inf 0 0", "finite"),
        ("--rpy 0 0 0 --axis 0 0 1", "--rpy and --axis"),
        ("--rpy 0 0 0 --quat-wxyz 1 0 0 0", "--quat-wxyz and --rpy"),
        ("--seed -1", "seed"),
        ("--seed 18446744073709551616", "seed"),
        ("--seed 1.5", "--seed"),
        ("--count 0", "count"),
        ("--count -2", "count"),
        ("--method ga", "method"),
        ("--restarts 0", "settings.restarts"),
        ("--method de --de collision=no", "--de collision: expected one of reject, feasibility, got 'no'"),
        ("--method de --de strategy=rand/9", "--de strategy"),
        ("--method de --de bounds=wrap", "--de bounds"),
        ("--method de --de update=never", "--de update"),
        ("--method de --de population=5", "--de population: expected a whole number of at least 6"),
        ("--method de --de generations=0", "--de generations"),
        ("--method de --de weight=nan", "--de weight"),
        ("--method de --de crossover=1.5", "--de crossover: expected 0 to 1, got 1.5"),
        ("--method de --de start_share=0", "--de start_share"),
        ("--freeze d_z", "did you mean 'q_z'"),
        ("--freeze d_x=a", "freeze.d_x"),
        ("--freeze d_x=9", "outside the limits"),
        ("--freeze d_x=nan", "finite"),
        ("--freeze d_x=1,d_x=2", "d_x"),
        ("--near 1,2,3", "expected 9 joint values"),
        ("--weights 1,2", "weights: expected name=value"),
        ("--weights q9=1", "no joint is called 'q9'; joints are d_x, d_y, q_z, q1"),
        ("--weights q1=0", "weights.q1: expected a number from 1e-06 to 1e+06, got 0.0"),
        ("--weights q1=x", "weights.q1: expected a number, got 'x'"),
        ("--near q9=1", "no joint is called 'q9'"),
        ("--near q1=nan", "finite"),
    ],
)
def test_what_solve_refuses(refuse, options, words):
    assert words in refuse(*SOLVE, *options.split())


def test_a_position_is_needed(refuse):
    assert "--position" in refuse("solve")


def test_a_figure_that_cannot_be_written_is_refused_before_the_search(refuse, monkeypatch):
    monkeypatch.setattr("ikde.solver.distinct.solve_distinct", None)  # would be a bug if it were called
    refuse(*SOLVE, "--plot", "nowhere/a.png")


def test_an_unknown_convention_is_refused_before_the_search(refuse, monkeypatch):
    monkeypatch.setattr("ikde.solver.distinct.solve_distinct", None)
    refuse(*SOLVE, "--convention", "dh")


def test_weights_decide_what_moves_and_the_motion_is_stated(cli, qiao):
    near = dict(zip(qiao.joint_names, [0.4, 0.3, 0.1, 0.2, 0.5, 0.4, 0.3, 0.2, 0.1], strict=True))
    text = ",".join(f"{name}={value}" for name, value in near.items())
    weights = {"d_x": 50.0, "d_y": 50.0}
    data = cli(*SOLVE, "--near", text, "--weights", "d_x=50,d_y=50", "--json").data
    own = [weights.get(joint.name, 1.0 / (joint.upper - joint.lower)) for joint in qiao.joints]
    moved = [data["q"][name] - near[name] for name in qiao.joint_names]
    assert data["motion"] == pytest.approx(sum((w * d) ** 2 for w, d in zip(own, moved, strict=True)) ** 0.5)
    light = cli(*SOLVE, "--near", text, "--json").data
    assert abs(moved[0]) < abs(light["q"]["d_x"] - near["d_x"])
    assert f"{light['motion']:.6g} from near" in cli(*SOLVE, "--near", text).out
    assert "from home, weighted" in cli(*SOLVE).out


def test_an_order_that_is_none_is_refused_also_of_one_solution(refuse):
    expected = "rank: expected one of motion, clearance, limits, manipulability, found, got 'nonsense'"
    assert expected in refuse(*SOLVE, "--rank", "nonsense")

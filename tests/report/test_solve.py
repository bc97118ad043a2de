"""A result as text and as JSON: nothing is lost, units and convention are the user's."""

import json
import re
from dataclasses import asdict, replace

import numpy as np
import pytest

import ikde
from ikde.report.numbers import Units, count_of
from ikde.report.solve import BAR, Spent, format_solutions, format_solve, solutions_json, solve_json
from ikde.solver.preferred import Preferred
from ikde.solver.result import change_result
from tests.endless_robot import ENDLESS
from tests.flat_settings import flat_settings
from tests.robot_files import load_text

TARGET = ikde.Target((0.8, 0.5, 1.0))
MM_DEG = Units("mm", "deg")


@pytest.fixture(scope="module")
def result(qiao):
    return ikde.solve(qiao, TARGET, seed=7)


@pytest.fixture(scope="module")
def blocked(qiao):
    """A target inside the platform, which stands still."""
    settings = flat_settings(restarts=2, generations=500)
    return ikde.solve(qiao, ikde.Target((0.34, 0, 0.2)), settings, freeze={"d_x": 0, "d_y": 0, "q_z": 0})


def bars(text):
    return [word for word in text.split() if "●" in word]


def test_json_holds_the_figures_to_the_last_bit(qiao, result):
    data = json.loads(json.dumps(solve_json(qiao, result), allow_nan=False))
    assert list(data["q"].values()) == result.q.tolist()
    assert list(data["q"]) == list(qiao.joint_names)
    for name in ("position_error_m", "orientation_error_rad", "clearance_m", "seed", "evaluations", "verified"):
        assert data[name] == getattr(result, name)
    assert data["closest_pair"] == list(result.closest_pair)


def test_json_is_in_the_convention_asked_for(qiao, result):
    data = solve_json(qiao, result, "classical")
    assert data["convention"] == "classical"
    assert ikde.from_convention(qiao, np.array(list(data["q"].values())), "classical") == pytest.approx(result.q)
    assert solve_json(qiao, result)["convention"] == "key_point"


def test_json_of_a_failure_names_reason_hint_and_pairs(qiao, blocked):
    data = json.loads(json.dumps(solve_json(qiao, blocked), allow_nan=False))
    assert (data["reached"], data["stop_reason"]) == (False, "collision")
    assert data["reason"] == blocked.reason
    assert data["hint"] == blocked.hint
    first = next(iter(blocked.blocking_pairs.items()))
    assert data["blocking_pairs"][0] == {"a": first[0][0], "b": first[0][1], "count": first[1]}


def test_json_without_a_detector_has_nulls(qiao):
    data = solve_json(qiao, ikde.solve(qiao, TARGET, collision="none"))
    assert (data["clearance_m"], data["closest_pair"], data["collision"]) == (None, None, None)
    assert '"collision": null' in json.dumps(data)


def test_without_a_detector_the_text_says_that_nothing_was_checked(qiao):
    text = format_solve(qiao, ikde.solve(qiao, TARGET, collision="none"), Units())
    assert text.splitlines()[0].endswith("inside the limits, self-collision not checked")
    for name in ("clearance", "self-collision"):
        assert "not checked" in next(line for line in text.splitlines() if line.strip().startswith(name))
    assert "free of" not in text


@pytest.mark.parametrize(
    ("verified", "words"),
    [
        (True, "by the kernels, and again by separate code in numpy"),
        (False, "by the kernels; separate code in numpy disagrees"),
        (None, "by the kernels alone"),
    ],
)
def test_what_graded_is_said_as_it_was(qiao, result, verified, words):
    shown = change_result(result, verified=verified)
    lines = [line.split() for line in format_solve(qiao, shown, Units()).splitlines()]
    assert ["graded", *words.split()] in lines
    assert solve_json(qiao, shown)["verified"] is verified


def test_text_says_the_verdict_first(qiao, result, blocked):
    assert format_solve(qiao, result, Units()).startswith("reached by qiao2021: ")
    text = format_solve(qiao, blocked, Units())
    assert text.startswith("not reached by qiao2021: only colliding solutions")
    helped, helpless = (
        format_solve(qiao, change_result(blocked, hint=hint), Units()) for hint in ("free d_x: so", None)
    )
    assert "what would help: free d_x: so" in helped
    assert "what would help" not in helpless


def test_text_shows_every_joint_in_its_unit(qiao, result):
    lines = {line.split()[0]: line.split() for line in format_solve(qiao, result, MM_DEG).splitlines() if line.strip()}
    for joint, value in zip(qiao.joints, result.q, strict=True):
        shown = lines[joint.name]
        assert float(shown[1]) == pytest.approx(MM_DEG.joint_value(joint, value), abs=1e-6)
        assert shown[2] == ("mm" if joint.kind == "prismatic" else "deg")
        assert float(shown[3]) == pytest.approx(MM_DEG.joint_value(joint, joint.lower), rel=1e-3)
        assert float(shown[5]) == pytest.approx(MM_DEG.joint_value(joint, joint.upper), rel=1e-3)


def test_a_bar_shows_where_a_joint_stands(qiao, result):
    for q, place in ((qiao.lower, 0), (qiao.upper, BAR - 1), (0.5 * (qiao.lower + qiao.upper), (BAR - 1) // 2)):
        drawn = bars(format_solve(qiao, change_result(result, q=q), Units()))
        assert [bar.index("●") for bar in drawn] == [place] * 9
        assert {len(bar) for bar in drawn} == {BAR}


def test_a_joint_without_limits_stands_in_no_bar():
    robot = load_text(ENDLESS)
    result = ikde.solve(robot, ikde.Target((-0.5, 0.0, 0.5)))
    text = format_solve(robot, result, MM_DEG)
    assert next(line.split()[2:] for line in text.splitlines() if " pan " in line) == ["deg", "none", "none"]
    assert len(bars(text)) == 4
    json.dumps(solve_json(robot, result), allow_nan=False)


def test_text_in_another_convention_shifts_value_and_limits(qiao, result):
    text = format_solve(qiao, result, MM_DEG, convention="classical")
    row = next(line.split() for line in text.splitlines() if line.strip().startswith("q5"))
    shown = ikde.to_convention(qiao, result.q, "classical")[7]
    assert "classical convention" in text
    assert float(row[1]) == pytest.approx(np.degrees(shown), abs=1e-6)


@pytest.mark.parametrize("q5", [-1.0, 1.0])
def test_no_limits_are_shown_that_the_value_shown_is_not_between(qiao, result, q5):
    q = result.q.copy()
    q[7] = q5
    text = format_solve(qiao, change_result(result, q=q), MM_DEG, convention="classical")
    row = next(line.split() for line in text.splitlines() if line.strip().startswith("q5"))
    limits = [float(word) for word in row[3:] if "●" not in word]
    assert limits == [] or limits[0] <= float(row[1]) <= limits[1]


def test_text_shows_the_graded_figures(qiao, result):
    text = format_solve(qiao, result, MM_DEG)
    a, b = result.closest_pair
    assert f"{result.clearance_m * 1e3:.6g} mm between {a} and {b}, detector improved" in text
    assert f"{result.position_error_m * 1e3:.3g} mm" in text
    assert "seed 7" in text
    assert "1 attempt\n" in text


def test_a_compilation_is_on_its_own_line(qiao, result):
    assert "compiled first" not in format_solve(qiao, change_result(result, compile_seconds=0.0), Units())
    text = format_solve(qiao, change_result(result, compile_seconds=12.34), Units())
    assert "12.3 s" in next(line for line in text.splitlines() if "compiled first" in line)


def test_several_solutions_tell_once_what_they_took_together(qiao, result):
    results, spent = [change_result(result, compile_seconds=3.0)] * 3, Spent(solve_seconds=0.0123, compile_seconds=3.0)
    text = format_solutions(qiao, results, Units(), spent)
    assert [line for line in text.splitlines() if line.startswith("solution ")] == [
        f"solution {k} of 3, robot qiao2021" for k in (1, 2, 3)
    ]
    assert text.endswith("\n\ntogether 12.3 ms, with loading and grading, after 3 s of compiling")
    assert "compiled first" not in text
    counted = f"{count_of(result.evaluations, 'evaluation')} in {count_of(result.attempts, 'attempt')}"
    assert re.findall(r"^ cost +(.*)$", text, re.MULTILINE) == [counted] * 3
    assert format_solutions(qiao, results, Units(), replace(spent, compile_seconds=0.0)).endswith("loading and grading")
    data = json.loads(json.dumps(solutions_json(qiao, results, spent), allow_nan=False))
    assert (data["solve_seconds"], data["compile_seconds"]) == (0.0123, 3.0)
    assert [row["q"] for row in data["solutions"]] == [solve_json(qiao, result)["q"]] * 3
    assert not any({"solve_seconds", "compile_seconds"} & set(row) for row in data["solutions"])


def test_rejected_attempts_are_counted(qiao, result):
    assert "3 attempts, 2 rejected for collision" in format_solve(
        qiao, change_result(result, attempts=3, rejected=2), Units()
    )


def test_a_reason_with_brackets_is_shown_as_it_is(qiao, result):
    assert "see [1]" in format_solve(qiao, change_result(result, reason="see [1] and [/]"), Units())


@pytest.mark.parametrize(
    ("what", "words"),
    [
        ("manipulability", "manipulability 0.100 -> 0.250 in 3 steps, a local optimum"),
        ("clearance", "room beyond what is asked for 100 mm -> 250 mm in 3 steps, a local optimum"),
        ("limits", "room to the joint limits 10 % of a range -> 25 % of a range in 3 steps, a local optimum"),
        ("motion", "motion 0.100 -> 0.250 in 3 steps, a local optimum"),
    ],
)
def test_what_was_preferred_is_told_before_and_after(qiao, result, what, words):
    preferred = Preferred(what=what, before=0.1, after=0.25, steps=3, settled=True)
    moved = change_result(result, preferred=preferred)
    assert words in " ".join(format_solve(qiao, moved, MM_DEG, width=200).split())
    assert solve_json(qiao, moved)["preferred"] == asdict(preferred)
    stopped = change_result(result, preferred=replace(preferred, steps=0, settled=False))
    assert "local optimum" not in format_solve(qiao, stopped, MM_DEG, width=200)

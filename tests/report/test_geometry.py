"""Frames and clearances as text and as JSON."""

import json

import numpy as np
import pytest

import ikde
from ikde.report.geometry import check_json, format_check, format_forward, forward_json
from ikde.report.numbers import Units

M_RAD, MM_DEG = Units(), Units("mm", "deg")


def frames_text(robot, q, units, outside=()):
    return format_forward(robot, ikde.forward(robot, q), outside, units)


def rows(text):
    """The words of each line by its first word."""
    return {line.split()[0]: line.split() for line in text.splitlines() if line.strip()}


def test_frames_as_json_are_exact(qiao):
    frames = ikde.forward(qiao, qiao.home)
    data = json.loads(json.dumps(forward_json(qiao, qiao.home, frames, ("q1",)), allow_nan=False))
    assert data["outside_limits"] == ["q1"]
    assert list(data["frames"]) == list(frames)
    for name, T in frames.items():
        assert data["frames"][name] == {"p_world": T[:3, 3].tolist(), "R_world": T[:3, :3].tolist()}


@pytest.mark.parametrize(("units", "scale", "digits"), [(M_RAD, 1.0, 4), (MM_DEG, 1e3, 1)])
def test_frames_as_text_have_origins_in_the_unit(qiao, units, scale, digits):
    shown = rows(frames_text(qiao, qiao.home, units))
    for name, T in ikde.forward(qiao, qiao.home).items():
        printed = [float(word) for word in shown[name][1:4]]
        assert printed == pytest.approx(T[:3, 3] * scale, abs=0.51 * 10**-digits)


def test_frames_as_text_have_the_directions_of_x_and_z(qiao):
    T = ikde.forward(qiao, qiao.home)["tool"]
    printed = [float(word) for word in rows(frames_text(qiao, qiao.home, M_RAD))["tool"][4:]]
    assert printed == pytest.approx(np.concatenate([T[:3, 0], T[:3, 2]]), abs=6e-4)


def test_there_is_no_minus_zero(any_robot):
    words = frames_text(any_robot, any_robot.home, MM_DEG).split()
    assert not {"-0.0", "-0.000", "-0.0000"} & set(words)


@pytest.mark.parametrize("units", [M_RAD, MM_DEG])
def test_headers_name_the_unit(qiao, units):
    assert f"x [{units.length}]" in frames_text(qiao, qiao.home, units)
    assert f"clearance [{units.length}]" in format_check(qiao, ikde.check(qiao, qiao.home), units)


def test_joints_outside_are_named(qiao):
    q = qiao.home
    q[0] = 6.0
    assert "outside the limits: d_x" in frames_text(qiao, q, M_RAD, ("d_x",))
    assert "outside the limits: d_x" in format_check(qiao, ikde.check(qiao, q), M_RAD)
    assert "outside the limits: d_x" in format_check(qiao, ikde.check(qiao, q, "none"), M_RAD)


def test_a_tool_of_another_name_is_called_tool():
    robot = ikde.load_robot("panda")
    assert robot.tool == "flange"
    assert "tool" in rows(frames_text(robot, robot.home, M_RAD))


def test_a_check_as_json_is_exact(qiao):
    result = ikde.check(qiao, qiao.home)
    data = json.loads(json.dumps(check_json(qiao, result), allow_nan=False))
    assert data["clearance_m"] == result.clearance_m
    assert [pair["clearance_m"] for pair in data["pairs"]] == [pair.clearance_m for pair in result.pairs]
    assert [pair["collides"] for pair in data["pairs"]] == [False] * len(result.pairs)


def test_a_check_without_a_detector_has_nulls(qiao):
    data = check_json(qiao, ikde.check(qiao, qiao.home, "none"))
    assert (data["clearance_m"], data["pairs"], data["detector"], data["collision"]) == (None, [], "none", None)


def test_every_pair_is_a_line_worst_first(qiao):
    result = ikde.check(qiao, qiao.home)
    lines = [line.split() for line in format_check(qiao, result, MM_DEG).splitlines() if " - " in line]
    assert [(words[0], words[2]) for words in lines] == [(pair.a, pair.b) for pair in result.pairs]
    assert [float(words[3]) for words in lines] == pytest.approx(
        [pair.clearance_m * 1e3 for pair in result.pairs], abs=0.0051
    )


def test_the_verdict_comes_first(qiao):
    free = format_check(qiao, ikde.check(qiao, qiao.home), MM_DEG)
    assert free.startswith("free of self-collision: robot qiao2021, clearance ")
    q = qiao.home
    q[4:6] = 2.6, 2.6
    colliding = format_check(qiao, ikde.check(qiao, q), MM_DEG)
    assert colliding.startswith("self-collision: robot qiao2021, clearance -")
    assert "collides" in colliding
    assert "collides" not in free


def test_a_safe_distance_is_named(qiao):
    judge = ikde.Detector(name="mine", spheres="typical", pairs="arm_arm", safe_distance_m=0.025)
    assert "safe distance 25 mm" in format_check(qiao, ikde.check(qiao, qiao.home, judge), MM_DEG)


def test_no_detector_is_not_called_free(qiao):
    text = format_check(qiao, ikde.check(qiao, qiao.home, "none"), M_RAD)
    assert text == "self-collision not checked: robot qiao2021, detector none"

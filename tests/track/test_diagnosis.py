"""Why a rollout ends: each limit, standing in the way by itself, is named with what it would take."""

import re
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import ikde
from ikde.model.bounds import find_bounds
from ikde.model.collision_model import CollisionModel
from ikde.solver.result import StopReason
from ikde.track import diagnosis
from ikde.track.diagnosis import CHECKS, explain_stop, first_out_of_reach, tell_static
from ikde.track.follow_path import follow_path
from ikde.track.path import ToolPath
from ikde.track.trajectory import TrackStopReason
from tests.track.paper_tasks import follower_of
from tests.track.tracks import make_line, robot

Q = np.array([0.0, 0.0, 0.0, 0.3, 0.5, 0.8, 0.3, 0.4, 0.0])
P = ikde.forward(robot(), Q)["tool"][:3, 3]


def follow(steps, *, q=Q, frozen=(), weights=(0.0, 0.0, 0.0), **changes):
    """A rollout from `q` by `steps` [K, 3] of the tool."""
    p = ikde.forward(robot(), q)["tool"][:3, 3] + np.cumsum([np.zeros(3), *steps], axis=0)
    path = ToolPath.through(p, dt_s=0.02)
    return follower_of(robot(), path, freeze=frozen, **changes).begin(q, np.array(weights)).resume()


def explain(steps, **changes):
    """The stop of such a rollout."""
    rollout = follow(steps, **changes)
    follower = rollout.follower
    assert rollout.last < follower.path.samples
    static = ikde.solve(robot(), follower.path.targets()[rollout.last + 1], collision=follower.collision)
    return explain_stop(rollout, static)


def test_speed_with_what_is_needed():
    stop = explain([[0, 0.002, 0]] * 3 + [[0, 0.25, 0]])
    assert (stop.sample, stop.reason) == (4, TrackStopReason.SPEED_LIMIT)
    assert stop.limit in (*robot().joint_names, "the base")
    assert stop.text.startswith("sample 4 (0.08 s): ")
    assert "its limit is" in stop.text


def test_acceleration_from_rest():
    stop = explain([[0, 0, 0]] * 3 + [[0, 0.01, 0]], acceleration=np.full(9, 0.1))
    assert (stop.sample, stop.reason) == (4, TrackStopReason.ACCELERATION_LIMIT)


def test_wheels():
    stop = explain(
        [[0.002, 0, 0]] * 2 + [[0.009, 0, 0]] * 3, wheel_speed_rad_s=1.5, frozen=("q1", "q2", "q3", "q4", "q5", "q6")
    )
    assert (stop.sample, stop.reason, stop.limit) == (3, TrackStopReason.WHEEL_LIMIT, "wheels")
    assert stop.text == "sample 3 (0.06 s): a wheel rotates at 4.5 rad/s in the step that was found, its limit is 1.5"


def test_distance_from_the_platform():
    frozen = ("d_x", "d_y", "q_z")
    centre = ikde.forward(robot(), Q)["Oc"][:3, 3]
    distance = float(np.linalg.norm(P - centre))
    away = 0.004 * (P - centre) / distance
    stop = explain([away] * 10, max_distance_m=distance + 0.01, center="Oc", frozen=frozen)
    assert (stop.sample, stop.reason, stop.limit) == (3, TrackStopReason.DISTANCE_LIMIT, "Oc")


def test_range_of_a_joint():
    q = Q.copy()
    q[3] = robot().upper[3] - 1e-6
    frozen = tuple(name for name in robot().joint_names if name != "q1")
    T = [ikde.forward(robot(), q + np.eye(9)[3] * k * 0.01)["tool"][:3, 3] for k in range(3)]
    stop = explain(np.diff(T, axis=0), q=q, frozen=frozen, collision="none")
    assert (stop.sample, stop.reason, stop.limit) == (1, TrackStopReason.JOINT_LIMIT, "q1")


def test_the_pair_that_would_touch():
    q = robot().home.copy()
    frozen = tuple(name for name in robot().joint_names if name != "q2")
    T = ikde.forward(robot(), q + np.outer(np.arange(200) * 0.02, np.eye(9)[4]))["tool"][:, :3, 3]
    stop = explain(np.diff(T, axis=0), q=q, frozen=frozen)
    pairs = CollisionModel.of(robot()).pairs
    assert (stop.reason, stop.pair in pairs) == (TrackStopReason.COLLISION, True)
    assert "overlap" in stop.text
    gap = ikde.check(robot(), q + (stop.sample - 1) * 0.02 * np.eye(9)[4]).clearance_m
    assert 0.0 < gap < 0.02


def test_out_of_reach_is_proved_or_told_by_the_solver():
    path = make_line([0.9, 0, 1.0], [0.9, 0, 3.0], 20)
    follower = follower_of(robot(), path, collision="none")
    sample, excess = first_out_of_reach(follower, robot().lower, robot().upper)
    assert path.p_world_tool[sample - 1, 2] < 1.75 < path.p_world_tool[sample, 2]
    assert 0.0 < excess < 0.1
    result = ikde.solve(robot(), ikde.Target([0.9, 0, 1.69]), collision="none")
    stop = tell_static(follower, 7, result)
    assert (stop.sample, stop.reason) == (7, TrackStopReason.BUDGET)
    assert f"no configuration was found in {result.attempts} attempts; the best is off by" in stop.text
    result = ikde.solve(robot(), ikde.Target([0.9, 0, 1.79]), collision="none")
    stop = tell_static(follower, 7, result)
    assert (stop.sample, stop.reason) == (7, TrackStopReason.OUT_OF_REACH)


def test_what_an_error_along_each_axis_may_make_up_for_is_no_proof():
    path = make_line([0.9, 0, 1.0], [0.9, 0, 3.0], 20)
    excess = find_bounds(robot(), robot().lower, robot().upper).reach.excess_of_many_m(path.p_world_tool)
    first = int(np.flatnonzero(excess)[0])
    for share, sample in ((0.6, first + 1), (0.55, first)):
        follower = follower_of(robot(), path, position_error_m=share * excess[first], collision="none")
        assert first_out_of_reach(follower, robot().lower, robot().upper)[0] == sample


@pytest.mark.parametrize("drive", ["differential", "omnidirectional"])
def test_texts_are_one_line(drive):
    stop = explain([[0, 0.3, 0]], drive=drive)
    assert "\n" not in stop.text
    assert stop.sample == 1


def test_an_acceleration_has_units():
    stop = explain([[0, 0, 0]] * 3 + [[0, 0.01, 0]], acceleration=np.full(9, 0.1))
    assert stop.text.endswith(("its limit is 0.1 m/s²", "its limit is 0.1 rad/s²"))


def test_what_may_not_move_is_named():
    stop = explain([[0, 0.001, 0]] * 3, speed=np.zeros(9))
    assert (stop.sample, stop.reason) == (1, TrackStopReason.SPEED_LIMIT)
    assert stop.text == f"sample 1 (0.02 s): {stop.limit} is frozen but moves in the step that was found"


def test_a_step_that_is_too_long_is_not_blamed_on_a_limit_that_was_not_asked_for():
    stop = explain([[3.0, 0, 0]] * 2, speed=None)
    assert stop.reason is TrackStopReason.SPEED_LIMIT
    assert stop.text.endswith("in the shortest step that was found, at most 0.5 m a sample are tried")


def test_a_pose_at_the_rim_that_was_not_met_is_not_called_proved():
    height = 1.6841  # of what can be reached at x = 0.9: 1.6841947
    p = np.array([[0.9, 0.0, height + 2e-5 * k] for k in range(8)])
    motion = follow_path(robot(), ToolPath.through(p, dt_s=0.02))
    assert (motion.stop.sample, motion.stop.reason) == (5, TrackStopReason.BUDGET)
    assert "no configuration was found in" in motion.stop.text


def turn_of(joint, by, samples, q=Q):
    """Steps of the tool if one joint turns by so much a sample, and all others but it."""
    names = list(robot().joint_names)
    ways = q + np.outer(np.arange(samples + 1) * by, np.eye(9)[names.index(joint)])
    steps = np.diff(ikde.forward(robot(), ways)["tool"][:, :3, 3], axis=0)
    return {"steps": steps, "q": q, "frozen": tuple(name for name in names if name != joint)}


def at_its_end(joint, left=0.015):
    q = Q.copy()
    k = robot().joint_names.index(joint)
    q[k] = robot().upper[k] - left
    return q


LIFTED = {
    TrackStopReason.SPEED_LIMIT: {"speed": None},
    TrackStopReason.ACCELERATION_LIMIT: {"acceleration": None},
    TrackStopReason.WHEEL_LIMIT: {"wheel_speed_rad_s": None},
    TrackStopReason.JOINT_LIMIT: {"ranges": False},
    TrackStopReason.DISTANCE_LIMIT: {"max_distance_m": None, "center": None},
    TrackStopReason.COLLISION: {"collision": "none"},
}
CASES = [
    {"steps": [[0, 0.002, 0]] * 3 + [[0, 0.25, 0]]},
    {"steps": [[0, 0, 0]] * 3 + [[0, 0.01, 0]], "acceleration": np.full(9, 0.1)},
    {"steps": [[0.002, 0, 0]] * 2 + [[0.009, 0, 0]] * 3, "wheel_speed_rad_s": 1.5, "frozen": robot().joint_names[3:]},
    {"steps": [[0.004, 0, 0]] * 10, "max_distance_m": 1.12, "center": "Oc", "frozen": robot().joint_names[:3]},
    {**turn_of("q1", 0.01, 4, at_its_end("q1")), "collision": "none"},
    {**turn_of("q2", 0.02, 100, robot().home)},
    {**turn_of("q1", 0.02, 6, at_its_end("q1", 0.105)), "collision": "none", "acceleration": np.full(9, 30.0)},
]


@pytest.mark.parametrize(("case", "figures"), [*zip(CASES, [1, 1, 1, 0, 0, 0, 0], strict=True)], ids=range(len(CASES)))
def test_without_the_limit_that_is_named_the_rollout_goes_on(case, figures):
    """Which is what the stop was found by; its figure is beyond the limit."""
    stop = explain(**case)
    assert "was found" in stop.text
    assert follow(**{**case, **LIFTED[stop.reason]}).last >= stop.sample
    found = re.findall(r" ([\d.e-]+) (?:m|rad)/s(?:²)?\b.*its limit is ([\d.e-]+)", stop.text)
    assert len(found) == figures
    assert all(float(needed) >= float(limit) for needed, limit in found)


def test_a_joint_that_could_not_brake_in_time_is_told_so():
    stop = explain(**CASES[-1])
    assert (stop.sample, stop.reason) == (5, TrackStopReason.ACCELERATION_LIMIT)
    assert "only without acceleration limits; with them every joint must be able to brake" in stop.text


@pytest.mark.parametrize("check", [check for check in CHECKS if check.__name__ != "_without_acceleration"])
def test_a_step_that_keeps_a_limit_does_not_blame_it(monkeypatch, check):
    """It may be found by luck where a limit was taken away, and does not need that."""
    limits = {"wheel_speed_rad_s": 4.0, "max_distance_m": 2.0, "center": "Oc"}
    rollout = follow([[0, 0.002, 0]] * 3, frozen=("q6",), **limits)
    monkeypatch.setattr(diagnosis, "_try", lambda *_: (rollout.q[2], rollout.steps[2]))
    assert check(replace(rollout, last=1)) is None


def test_a_best_answer_that_collides_names_the_pair_and_one_that_is_off_by_how_much():
    follower = follower_of(robot(), make_line([0.9, 0, 1.0], [0.9, 0, 3.0], 20))
    known = {"stop_reason": StopReason.BUDGET, "blocking_pairs": {}, "attempts": 320, "orientation_error_rad": 0.0}
    known |= {"collision": True, "closest_pair": ("M", "L2"), "hint": None, "reason": None}
    stop = tell_static(follower, 7, SimpleNamespace(**known, position_error_m=0.0))
    assert stop.text.endswith("no configuration was found in 320 attempts; in the best of them M and L2 collide")
    assert stop.pair == ("M", "L2")
    for changes in ({"position_error_m": 0.1}, {"position_error_m": 0.0, "collision": None}):
        stop = tell_static(follower, 7, SimpleNamespace(**{**known, **changes}))
        assert "the best is off by" in stop.text
        assert stop.pair is None

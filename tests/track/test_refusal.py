"""Why a course ends: each limit, standing in the way by itself, is named with what it would take."""

import numpy as np
import pytest

import ikde
from ikde.track.follow_path import follow_path
from ikde.track.follower import make_follower
from ikde.track.limits import MotionLimits
from ikde.track.path import ToolPath
from ikde.track.refusal import explain_stop, first_out_of_reach, tell_static
from ikde.track.trajectory import TrackStopReason
from tests.track.tracks import make_line, robot

Q = np.array([0.0, 0.0, 0.0, 0.3, 0.5, 0.8, 0.3, 0.4, 0.0])
P = ikde.forward(robot(), Q)["tool"][:3, 3]


def explain(steps, *, drive="differential", q=Q, detector=None, frozen=(), use=(0.0, 0.0, 0.0), **told):
    """The stop of a follower that goes from `q` by `steps` [K, 3] of the tool."""
    p = ikde.forward(robot(), q)["tool"][:3, 3] + np.cumsum([np.zeros(3), *steps], axis=0)
    path = ToolPath.through(p, dt_s=0.02)
    chosen = robot().detector(detector)
    limits = MotionLimits.of(robot(), **told)
    follower = make_follower(robot(), path, drive=drive, limits=limits, detector=chosen, frozen=frozen)
    course = follower.follow(follower.begin(q, np.array(use)))
    assert course.last < path.samples
    static = ikde.solve(robot(), path.targets()[course.last + 1], detector=chosen or "none")
    return explain_stop(follower, course, static)


def test_speed_with_what_is_needed():
    stop = explain([[0, 0.002, 0]] * 3 + [[0, 0.25, 0]])
    assert (stop.sample, stop.reason) == (4, TrackStopReason.SPEED_LIMIT)
    assert stop.limit in (*robot().joint_names, "the base")
    assert stop.text.startswith("sample 4 (0.08 s): ")
    assert "its limit is" in stop.text


def test_acceleration_of_who_was_at_rest():
    stop = explain([[0, 0, 0]] * 3 + [[0, 0.01, 0]], acceleration=np.full(9, 0.1))
    assert (stop.sample, stop.reason) == (4, TrackStopReason.ACCELERATION_LIMIT)


def test_wheels():
    stop = explain(
        [[0.002, 0, 0]] * 2 + [[0.009, 0, 0]] * 3, wheel_speed_rad_s=1.5, frozen=("q1", "q2", "q3", "q4", "q5", "q6")
    )
    assert (stop.sample, stop.reason, stop.limit) == (3, TrackStopReason.WHEEL_LIMIT, "wheels")
    assert "4.5 rad/s, its limit is 1.5" in stop.text


def test_distance_from_the_platform():
    frozen = ("d_x", "d_y", "q_z")
    centre = ikde.forward(robot(), Q)["Oc"][:3, 3]
    distance = float(np.linalg.norm(P - centre))
    away = 0.004 * (P - centre) / distance
    stop = explain([away] * 10, farthest_m=distance + 0.01, center="Oc", frozen=frozen)
    assert (stop.sample, stop.reason, stop.limit) == (3, TrackStopReason.DISTANCE_LIMIT, "Oc")


def test_range_of_a_joint():
    q = Q.copy()
    q[3] = robot().upper[3] - 1e-6
    frozen = tuple(name for name in robot().joint_names if name != "q1")
    T = [ikde.forward(robot(), q + np.eye(9)[3] * k * 0.01)["tool"][:3, 3] for k in range(3)]
    stop = explain(np.diff(T, axis=0), q=q, frozen=frozen, detector="none")
    assert (stop.sample, stop.reason, stop.limit) == (1, TrackStopReason.JOINT_LIMIT, "q1")


def test_the_pair_that_would_touch():
    q = robot().home.copy()
    frozen = tuple(name for name in robot().joint_names if name != "q2")
    T = ikde.forward(robot(), q + np.outer(np.arange(200) * 0.02, np.eye(9)[4]))["tool"][:, :3, 3]
    stop = explain(np.diff(T, axis=0), q=q, frozen=frozen)
    pairs = robot().pairs(robot().detector(None))
    assert (stop.reason, stop.pair in pairs) == (TrackStopReason.SELF_COLLISION, True)
    assert "overlap" in stop.text
    gap = ikde.check(robot(), q + (stop.sample - 1) * 0.02 * np.eye(9)[4]).clearance_m
    assert 0.0 < gap < 0.02


def test_out_of_reach_is_proved_or_told_by_the_solver():
    path = make_line([0.9, 0, 1.0], [0.9, 0, 3.0], 20)
    told = {"limits": MotionLimits.of(robot()), "detector": None}
    follower = make_follower(robot(), path, drive="differential", **told)
    sample, excess = first_out_of_reach(follower, robot().lower, robot().upper)
    assert path.p_world_tool[sample - 1, 2] < 1.75 < path.p_world_tool[sample, 2]
    assert 0.0 < excess < 0.1
    result = ikde.solve(robot(), ikde.Target([0.9, 0, 1.69]), detector="none")
    stop = tell_static(follower, 7, result)
    assert (stop.sample, stop.reason) == (7, TrackStopReason.OUT_OF_REACH)


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
    assert stop.text == f"sample 1 (0.02 s): {stop.limit} would have to move, and may not"


def test_a_step_that_is_too_long_is_not_blamed_on_a_limit_that_nobody_asked_for():
    stop = explain([[3.0, 0, 0]] * 2, speed=None)
    assert stop.reason is TrackStopReason.SPEED_LIMIT
    assert "shorter samples would help" in stop.text


def test_leaving_the_workspace_slowly_is_out_of_reach():
    height = 1.6841  # of what can be reached at x = 0.9: 1.6841947
    p = np.array([[0.9, 0.0, height + 2e-5 * k] for k in range(8)])
    motion = follow_path(robot(), ToolPath.through(p, dt_s=0.02))
    assert (motion.stop.sample, motion.stop.reason) == (5, TrackStopReason.OUT_OF_REACH)

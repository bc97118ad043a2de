"""What a stop at an obstacle says would help is true: what it says is done, and the motion goes on from there."""

import re
from dataclasses import replace

import numpy as np
import pytest

import ikde
from ikde.track.follower import make_follower
from ikde.track.plan import TrackPlan
from ikde.track.remedies import advise
from ikde.track.trajectory import TrackStop, TrackStopReason
from tests.track.shelf import SHELF, make_path, place

CAN = {"can": {"cylinder": {"radius": 0.033, "height": 0.12}, "position": [1.0, 0.15, 0.876]}}
MARGIN_M = 0.03


@pytest.fixture(scope="module")
def stopped():
    motion = ikde.follow_path("qiao2021", make_path(), collision=place({**SHELF, **CAN}, MARGIN_M))
    assert motion.stop.pair[1] == "can"
    return motion


def go_on(motion, obstacles, margin_m):
    """The rest of the path from where a motion stopped, among other obstacles."""
    p = make_path().p_world_tool[motion.reached_points :]
    rest, model = ikde.ToolPath.through(p, dt_s=0.02), place(obstacles, margin_m)
    return ikde.follow_path("qiao2021", rest, collision=model, start=motion.q[-1])


def test_sample_time_component_and_obstacle_are_named_with_what_helps(stopped):
    stop = stopped.stop
    sample = stopped.reached_points + 1
    assert stop.text.startswith(f"sample {sample} ({0.02 * sample:.4g} s): {stop.pair[0]} and can are ")
    assert re.fullmatch(
        r"without can it goes on to the end; with [\d.]+ mm less margin it goes on to the end", stop.hint
    )
    assert stop.line == f"{stop.text}; {stop.hint}"


def test_without_the_obstacle_it_does_go_on(stopped):
    assert go_on(stopped, SHELF, MARGIN_M).reached


def test_with_so_much_less_margin_it_does_go_on_and_with_a_millimetre_more_it_does_not(stopped):
    less_m = 1e-3 * float(re.search(r"with ([\d.]+) mm", stopped.stop.hint)[1])
    assert 0.0 < less_m < MARGIN_M
    motion = go_on(stopped, {**SHELF, **CAN}, MARGIN_M - less_m)
    assert motion.reached
    assert motion.certificate.is_free
    assert not follow_on(stopped, less_m - 1e-3)
    assert follow_on(stopped, less_m)


def follow_on(motion, less_m):
    """Whether steps alone lead on to the end with less margin."""
    rollout = make_rollout(motion, place({**SHELF, **CAN}, MARGIN_M - less_m))
    return rollout.resume().last == make_path().samples


def make_rollout(motion, model):
    """A rollout that stands where a motion stopped, as the search left it."""
    plan = TrackPlan.of(model.robot, make_path(), collision=model)
    rollout = make_follower(plan).begin(motion.q[0], np.full(3, 0.3))
    rollout.rows[: len(motion.q)] = motion.q
    steps = rollout.follower.begin(motion.q[0], np.full(3, 0.3)).steps
    return replace(rollout, steps=steps, last=motion.reached_points)


def test_what_is_certified_no_farther_is_said_to_go_no_farther(stopped, monkeypatch):
    from ikde.track import remedies

    rollout = make_rollout(stopped, place({**SHELF, **CAN}, MARGIN_M))
    samples, first = make_path().samples, stopped.reached_points
    assert "to the end" in advise(rollout, stopped.stop, samples).hint
    with monkeypatch.context() as patch:
        patch.setattr(
            remedies,
            "bound_all",
            lambda model, q, drive, around: np.where(np.arange(len(q) - 1) < 2, 1.0, 0.0)[:, None],
        )
        assert f"without can it goes on to sample {first + 2}" in advise(rollout, stopped.stop, samples).hint
        patch.setattr(remedies, "bound_all", lambda model, q, drive, around: np.zeros((len(q) - 1, 1)))
        assert advise(rollout, stopped.stop, samples) is stopped.stop


def test_nothing_is_tried_where_no_obstacle_is_in_the_way(stopped):
    rollout = make_rollout(stopped, place({**SHELF, **CAN}, MARGIN_M))
    for pair in (None, ("M", "L2")):
        stop = TrackStop(sample=3, reason=TrackStopReason.COLLISION, text="", pair=pair)
        assert advise(rollout, stop, make_path().samples) is stop


def test_without_margins_none_is_lowered():
    ball = {"ball": {"sphere": {"radius": 0.05}, "position": [0.9, 0.2, 0.9]}}
    motion = ikde.follow_path("qiao2021", make_path(), collision=place(ball))
    assert motion.stop.hint == "without ball it goes on to the end"

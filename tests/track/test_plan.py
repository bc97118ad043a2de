"""Plans: what fits together, and what is wanted otherwise than a file says."""

from dataclasses import replace

import numpy as np
import pytest

import ikde
from ikde.errors import InputError
from ikde.model.collision_model import CollisionModel
from ikde.track.limits import MotionLimits
from ikde.track.plan import TrackPlan
from ikde.track.settings import ContinuationSettings, OptimizedSettings
from tests.track.tracks import make_line

PATH = make_line([0.9, 0, 1.0], [0.9, 0.1, 1.0], 1)


def test_it_introduces_itself_in_a_line(qiao):
    assert repr(TrackPlan.of(qiao, PATH)) == "<TrackPlan path: qiao2021, continuation, differential, 1 points>"


def test_joints_are_frozen_where_the_start_has_them(qiao):
    start = qiao.home + 0.01
    frozen = TrackPlan.of(qiao, PATH, start=start, freeze={"q1": None, "q2": 0.5}).frozen
    assert frozen == {"q1": start[3], "q2": 0.5}
    assert TrackPlan.of(qiao, PATH, freeze=["q1"]).frozen == {"q1": qiao.home[3]}


def test_a_world_comes_with_the_plan(qiao):
    wall = ikde.load_world({"obstacles": {"wall": {"box": [0.1, 2, 2], "position": [5, 0, 1]}}})
    assert TrackPlan.of(qiao, PATH, collision=wall).collision.world == wall
    model = CollisionModel.of(qiao).in_world(wall, 0.02)
    assert TrackPlan.of(qiao, PATH, collision=model).collision == model


def test_typical_ignores_the_drive(qiao):
    plan = TrackPlan.of(qiao, PATH, method="typical", drive="differential")
    assert (plan.drive, plan.base_drive) == ("differential", "omnidirectional")
    assert plan.with_changes(method="optimized").base_drive == "differential"


def test_settings_are_the_plans_own_or_the_usual_ones(qiao):
    own = OptimizedSettings(max_redraws=3)
    plan = TrackPlan.of(qiao, PATH, method="optimized", settings=own)
    assert plan.settings_of(OptimizedSettings) is own
    assert plan.settings_of(ContinuationSettings) == ContinuationSettings()


def test_what_is_wanted_otherwise_replaces_what_was(qiao):
    made = TrackPlan.of(qiao, PATH, drive="omnidirectional", seed=7)
    changed = made.with_changes(seed=0, start=qiao.home).with_changes(method="typical")
    assert (changed.seed, changed.method, changed.drive) == (0, "typical", "omnidirectional")
    np.testing.assert_array_equal(changed.start, qiao.home)
    assert (made.seed, made.start) == (7, None)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"method": "magic"}, "method: expected one of continuation, optimized, typical, got 'magic'"),
        ({"drive": "legs"}, "drive: expected one of differential, omnidirectional, mecanum, got 'legs'"),
        ({"seed": -1}, "seed: expected a whole number"),
        ({"start": [0.0]}, "start: expected"),
    ],
)
def test_changes_that_do_not_fit_are_refused(qiao, changes, words):
    with pytest.raises(InputError) as caught:
        TrackPlan.of(qiao, PATH).with_changes(**changes)
    assert str(caught.value).startswith(words)


def test_limits_must_fit_the_robot(qiao):
    with pytest.raises(InputError, match=r"^limits\.speed: expected 9 numbers, one a joint, got 3"):
        replace(TrackPlan.of(qiao, PATH), limits=MotionLimits(speed=np.ones(3)))


def test_a_drive_without_wheels_has_no_limit_of_theirs(qiao):
    made = TrackPlan.of(qiao, PATH, limits=MotionLimits.of(qiao, wheel_speed_rad_s=2.0))
    with pytest.raises(
        InputError, match=r"^drive: an omnidirectional drive has no wheels, but path limits their speed$"
    ):
        made.with_changes(drive="omnidirectional")
    assert made.with_changes(drive="differential").drive == "differential"
    assert made.with_changes(method="typical", drive="omnidirectional").drive == "omnidirectional"


def test_mecanum_wheels_keep_no_limit_on_a_track():
    robot = ikde.load_robot("ur5e_mecanum")
    assert TrackPlan.of(robot, PATH).base_drive == "mecanum"
    with pytest.raises(
        InputError, match=r"^limits.wheel_speed_rad_s: a track limits the wheel speed of a differential"
    ):
        TrackPlan.of(robot, PATH, limits=MotionLimits.of(robot, wheel_speed_rad_s=2.0))

"""What holds a step, in words and numbers."""

import numpy as np
import pytest

from ikde.kernels.servo_room import (
    ACCELERATION,
    BASE_ROW,
    BOX,
    CODES,
    DISTANCE_ROW,
    HELD,
    HELD_BY,
    HELD_SIDE,
    HELD_WHY,
    NOTHING,
    NUMBERS,
    RANGE,
    REACH,
    ROW,
    SPEED,
)
from ikde.model.collision_model import CollisionModel
from ikde.track.held import Holding, no_target, tell_held
from ikde.track.limits import MotionLimits
from ikde.track.servo_plan import ServoPlan, list_entries


def tell(robot, codes, is_there=False):
    limits = MotionLimits.of(robot, acceleration=np.full(len(robot.joints), 2.0))
    model = CollisionModel.of(robot)
    plan = ServoPlan.of(model, limits, "differential")
    entries, row = list_entries(robot, plan.base), np.zeros(CODES, dtype=np.int64)
    for place, value in codes.items():
        row[place] = value
    numbers, speeds, q = np.full(NUMBERS, 0.25), np.full(len(entries), 0.125), robot.home
    return tell_held(Holding(model, entries, limits, plan, numbers, row, speeds, q, 0.01), is_there)


@pytest.mark.parametrize(
    ("why", "kind", "text"),
    [(SPEED, "speed", "the speed of v: 0.125 of 0.5 m/s"), (ACCELERATION, "acceleration", "2 m/s^2 at most")],
)
def test_an_entry_is_named_with_its_limit(qiao, why, kind, text):
    held = tell(qiao, {HELD: BOX, HELD_BY: 0, HELD_SIDE: 1, HELD_WHY: why})
    assert (held.kind, held.names) == (kind, ("v",))
    assert text in str(held)


def test_a_range_says_where_the_joint_is_and_where_it_ends(qiao):
    held = tell(qiao, {HELD: BOX, HELD_BY: 2, HELD_SIDE: 0, HELD_WHY: RANGE})
    assert (held.kind, held.names, held.limit) == ("range", (qiao.joint_names[3],), qiao.lower[3])
    assert held.value == qiao.home[3]


def test_a_pair_says_how_near_it_is(qiao):
    held = tell(qiao, {HELD: ROW, HELD_BY: 0})
    assert (held.kind, held.names, held.value) == ("pair", CollisionModel.of(qiao).pairs[0], 0.25)


@pytest.mark.parametrize(("row", "kind"), [(BASE_ROW, "base"), (DISTANCE_ROW, "distance")])
def test_other_rows_have_their_kind(qiao, row, kind):
    assert tell(qiao, {HELD: ROW, HELD_BY: row}).kind == kind


def test_the_reach_says_what_error_stays(qiao):
    held = tell(qiao, {HELD: REACH})
    assert (held.kind, held.value) == ("reach", 0.25)
    assert "250 mm" in held.text


def test_what_is_met_is_held_by_nothing(qiao):
    assert tell(qiao, {HELD: REACH}, is_there=True) is None
    assert tell(qiao, {HELD: NOTHING}) is None
    assert no_target(None) is None
    assert no_target("it is NaN").text == "no target: it is NaN"

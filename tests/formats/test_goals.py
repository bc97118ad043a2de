"""Goals of files: the same regions as Python makes, and what is wrong at its key."""

import numpy as np
import pytest

from ikde.errors import InputError
from ikde.formats.entries import UnitsEntry
from ikde.formats.goal_entries import FreedomEntry, NamedGoalEntry
from ikde.formats.goals import make_freedom, make_named_goal
from ikde.model.region import Region
from ikde.model.target import Target

MM = UnitsEntry(length="mm", angle="deg")
POINT, DOWN = [400.0, 200.0, 300.0], [0.0, 0.0, -1.0]
POSE = Target.from_rpy((0.4, 0.2, 0.3), (0.0, 0.0, 0.5 * np.pi))
CORNERS = [[0.0, 0.0], [2000.0, 0.0], [2000.0, 2000.0]]
FLOOR = np.array(CORNERS) / 1e3


def named(**keys):
    return make_named_goal(NamedGoalEntry.model_validate(keys), MM)


def loosen(target, **keys):
    return make_freedom(FreedomEntry.model_validate(keys), MM)(target)


def test_a_goal_of_a_run_is_what_python_makes():
    axis = Target((0.4, 0.2, 0.3), axis_world_tool=DOWN)
    assert named(position=POINT, name="a") == Target((0.4, 0.2, 0.3))
    assert named(position=POINT, axis=DOWN, cone=10, box=5) == Region.cone(axis, np.radians(10.0), 0.005)
    known = {"any_of": [{"position": POINT}, {"position": POINT, "box": 5}], "take": "best"}
    assert named(**known) == Region.any_of([Target((0.4, 0.2, 0.3)), Region.box((0.4, 0.2, 0.3), 0.005)], "best")
    assert named(position=POINT, base={"corners": CORNERS}) == Region.of((0.4, 0.2, 0.3)).with_base(FLOOR)


def test_the_same_freedom_for_any_target():
    turned = Region.turn(POSE, angle_rad=np.radians([-30.0, 60.0]), position_m=0.002)
    assert loosen(POSE, turn={"angles": [-30, 60]}, box=2) == turned
    assert loosen(POSE, rotation=[0, 0, 30]) == Region.box(POSE, 0.0, [0.0, 0.0, np.radians(30.0)])
    assert loosen(POSE, base={"corners": CORNERS}) == Region.of(POSE).with_base(FLOOR)
    assert loosen(POSE, box=2, base={"corners": CORNERS}) == Region.box(POSE, 0.002).with_base(FLOOR)


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ({"position": POINT, "any_of": [{"position": POINT}]}, "^position: `any_of` says all of a goal"),
        ({"position": POINT, "take": "best"}, "^take: only alternatives in `any_of` have one that is taken$"),
        ({"any_of": [{"position": POINT}, {"position": POINT, "box": -1}]}, r"^any_of\[1\].box: inside out"),
        ({"position": POINT, "base": {"corners": CORNERS[:2]}}, "^base.corners: expected at least 3"),
        ({"name": "a"}, "^a goal has a `position`, or `look_at`$"),
        ({"look_at": {"point": POINT, "distance": [1, 2]}, "cone": 1, "turn": {}}, "^cone: expected one of rotation"),
    ],
)
def test_what_is_wrong_with_a_goal_is_named(keys, message):
    with pytest.raises(InputError, match=message):
        named(**keys)


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ({}, "^expected what targets may be off by: box, rotation, turn, cone, or where a base may stand$"),
        ({"frame": "world"}, "^expected what targets may be off by"),
        ({"turn": {}}, "^turn: a turn is about an axis of a full pose"),
        ({"cone": 1}, "^cone: a cone needs a direction"),
        ({"rotation": 1}, "^rotation: only a full pose has rotations"),
        ({"cone": 1, "turn": {}}, "^cone: expected one of rotation, turn, cone, got turn and cone$"),
        ({"box": 0}, "^a region of zero size"),
        ({"base": {"corners": [*CORNERS, [0.0, 0.0]]}}, "^base.corners: corner 3 stands where the next one does"),
    ],
)
def test_what_is_wrong_with_a_freedom_is_named(keys, message):
    with pytest.raises(InputError, match=message):
        loosen(Target((0.4, 0.2, 0.3)), **keys)

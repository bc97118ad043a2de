"""What a robot carries is one more component, behind its own."""

import numpy as np
import pytest

from ikde.errors import InputError
from ikde.model.carried import carry, find_carrier
from ikde.model.solids import make_solid
from ikde.model.world import make_obstacle, make_world
from tests.attached import OWN, STICK, hold, place
from tests.three_joints import ROBOT

WORLD = make_world([make_obstacle("wall", [make_solid("box", (0.1, 1.0, 1.0))], place(0.9))])


def held(**options):
    return hold(WORLD, **options).attached


def test_pairs_stand_behind_the_robots_own():
    robot = carry(ROBOT, OWN.detector, held())
    own = ROBOT.pair_lists["apart"]
    assert robot.pair_lists["apart"][: len(own)] == own
    assert robot.pair_lists["apart"][len(own) :] == (
        ("floor", "stick"),
        ("post", "stick"),
        ("arm", "stick"),
        ("post", "ball"),
        ("hand", "ball"),
        ("stick", "ball"),
    )
    assert robot.components("balls") == (*ROBOT.components("balls"), "stick", "ball")


def test_what_is_left_out_has_a_reason():
    reasons = {(pair.a, pair.b): pair.reason for pair in OWN.in_world(hold(WORLD)).left_out_pairs}
    assert reasons["hand", "stick"] == "one body"
    assert reasons["arm", "ball"] == "one body"
    assert reasons["floor", "ball"] == "may touch"


def test_spheres_stand_in_the_frame_that_holds_them():
    row = carry(ROBOT, OWN.detector, held(ball=False)).approximations["balls"][-1]
    assert (row.component, row.frame) == ("stick", "tip")
    assert np.allclose(row.spheres, np.array(STICK) + np.array([0.01, 0.0, 0.04, 0.0]), atol=1e-15)


def test_what_does_not_fit_the_robot():
    for frame, message in (("tup", "no frame 'tup' \\(did you mean '"), ("world", "no joint moves 'world'")):
        with pytest.raises(InputError, match=message):
            find_carrier(ROBOT, frame, ("to",))
    world = WORLD.add(make_obstacle("hand", [make_solid("sphere", (0.1,))])).attach(
        "hand", "tip", T_frame_object=place()
    )
    with pytest.raises(InputError, match=r"^attached\.hand: three_joints has a component of this name"):
        OWN.in_world(world)


def test_what_is_too_much_to_compare():
    spheres = np.tile([0.0, 0.0, 0.0, 0.01], (2000, 1))
    world = WORLD.add(*(make_obstacle(name, [make_solid("sphere", (0.1,))]) for name in "ab"))
    world = world.attach("a", "tip", T_frame_object=place(), spheres=spheres)
    world = world.attach("b", "sleeve", T_frame_object=place(), spheres=spheres)
    with pytest.raises(InputError, match="at most 2,000,000 pairs of spheres to compare"):
        OWN.in_world(world)

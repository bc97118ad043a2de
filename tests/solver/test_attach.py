"""Picking up and letting go: from an obstacle to a part of the robot, and back; each refusal in a line."""

import copy
import pickle
from dataclasses import replace

import numpy as np
import pytest

import ikde
from ikde.errors import InputError
from ikde.model.collision_model import CollisionModel
from ikde.model.solids import make_solid
from ikde.model.world import Attached, World, make_obstacle, make_world
from tests.attached import STICK, place
from tests.three_joints import ROBOT

Q = np.array([0.3, 0.9, 0.3])
TABLE = make_obstacle("table", [make_solid("box", (0.5, 0.5, 0.02))], place(1.2, 0.0, -0.5))


@pytest.fixture
def world():
    """A cup where the tool is at `Q`, and what may be around."""
    T = ikde.forward(ROBOT, Q)["tip"].copy()
    T[:3, 3] += T[:3, :3] @ (0.0, 0.0, 0.06)
    cup = make_obstacle("cup", [make_solid("cylinder", (0.02, 0.06))], T, ignore=("hand",), group="cups", margin_m=0.01)
    return make_world([TABLE, cup])


def test_it_is_held_where_it_was_picked_up(world):
    held = world.attach("cup", "tip", robot=ROBOT, q=Q)
    thing = held.attached[0]
    assert held.names == ("table",)
    assert "cup" not in held
    assert np.allclose(thing.T_frame_object, place(0.0, 0.0, 0.06)[:3], atol=1e-12)
    assert (thing.name, thing.frame, thing.may_touch) == ("cup", "tip", ("hand",))
    assert thing.obstacle == world["cup"]
    assert held.groups == ()
    assert held == world.attach("cup", robot=ROBOT, q=dict(zip(ROBOT.joint_names, Q, strict=True)))
    assert held == world.attach("cup", "tip", T_frame_object=thing.T_frame_object)


def test_a_line_says_what_is_held_and_how_far_its_spheres_stand_out(world):
    held = world.attach("cup", "tip", robot=ROBOT, q=Q)
    assert repr(held) == "<World of 1 obstacle, attached: cup to tip>"
    count, out_mm = len(held.attached[0].spheres), 1e3 * held.attached[0].protrusion_m
    assert 5.0 < out_mm <= 7.5
    words = f"<Attached cup to tip: {count} spheres, {out_mm:.3g} mm beyond it at most, may touch hand>"
    assert repr(held.attached[0]) == words
    given = world.attach("cup", "tip", robot=ROBOT, q=Q, spheres=STICK).attached[0]
    assert repr(given) == "<Attached cup to tip: 3 spheres, given, may touch hand>"


def test_worlds_are_equal_by_what_is_held(world):
    held, again = (world.attach("cup", "tip", robot=ROBOT, q=Q) for _ in range(2))
    other = world.attach("cup", "tip", robot=ROBOT, q=Q, may_touch=["table"])
    assert held == again == pickle.loads(pickle.dumps(held)) == copy.deepcopy(held)
    assert hash(held) == hash(again)
    assert held.digest == again.digest
    assert len({w.digest for w in (world, held, other, world.remove("cup"))}) == 4
    assert held not in (world, other)
    model, twin = (CollisionModel.of(ROBOT).in_world(w) for w in (held, pickle.loads(pickle.dumps(held))))
    assert model == twin == pickle.loads(pickle.dumps(model))
    assert not held.attached[0].spheres.flags.writeable


def test_it_is_put_down_where_the_robot_holds_it(world):
    held, there = world.attach("cup", "tip", robot=ROBOT, q=Q), np.array([-1.0, 0.5, 0.1])
    down = held.detach("cup", robot=ROBOT, q=there)
    assert down.names == ("table", "cup")
    assert down.attached == ()
    expected = ikde.forward(ROBOT, there)["tip"] @ place(0.0, 0.0, 0.06)
    assert np.allclose(down["cup"].T_world_obstacle, expected[:3], atol=1e-12)
    assert (down["cup"].ignore, down["cup"].group, down["cup"].margin_m) == (("hand",), "cups", 0.01)
    assert held.detach("cup")["cup"] == world["cup"]
    assert held.detach("cup", place(1.0))["cup"].T_world_obstacle[0, 3] == 1.0
    back = held.detach("cup", robot=ROBOT, q=Q)["cup"]
    assert np.allclose(back.T_world_obstacle, world["cup"].T_world_obstacle, atol=1e-12)


def test_it_is_put_back_among_the_obstacles_where_it_stood(world):
    ball = [make_solid("sphere", (0.1,))]
    world = make_world(make_obstacle(name, ball, place(5.0 + k)) for k, name in enumerate("abcdef"))
    known = {"T_frame_object": place(), "spheres": STICK}
    held = world
    for name in "dba":
        held = held.attach(name, "tip", **known)
    assert held.names == ("c", "e", "f")
    for order in ("dba", "abd", "bda", "adb"):
        back = held
        for name in order:
            back = back.detach(name)
        assert back.names == tuple("abcdef")
        assert back == world
    assert held.detach("b").names == tuple("bcef")
    less = held.remove("c", "f").detach("d").attach("e", "tip", **known).detach("a")
    assert less.names == ("a", "d")
    assert less.detach("e").detach("b").names == tuple("abde")
    assert held.add(make_obstacle("g", ball)).detach("d").names == tuple("cdefg")
    last = replace(held.attached[0], place=None)
    assert make_world(held.obstacles, (), [last]).detach("d").names == tuple("cefd")
    assert last == held.attached[0]


def test_what_touches_where_it_is_picked_up_is_said_by_the_detector_that_is_given(world):
    moved = world.move("cup", ikde.forward(ROBOT, Q)["mouth"])
    detector = CollisionModel.of(ROBOT).detector
    near = CollisionModel(robot=ROBOT, detector=replace(detector, safe_distance_m=-1.0))
    assert moved.attach("cup", "tip", robot=near, q=Q).attached[0].name == "cup"
    wide = CollisionModel(robot=ROBOT, detector=replace(detector, safe_distance_m=1.0)).in_world(moved)
    with pytest.raises(InputError, match=r"^attach.cup: cup is .* where it is picked up"):
        world.attach("cup", "tip", robot=wide, q=Q)


def test_other_changes_keep_what_is_held(world):
    held = world.attach("cup", "tip", robot=ROBOT, q=Q, may_touch=("table",))
    more = held.add(make_obstacle("box", [make_solid("sphere", (0.1,))], place(3)))
    assert more.attached == held.attached == more.move("box", place(4)).attached
    gone = held.remove("table")
    assert gone.attached[0].may_touch == ("hand",)
    assert CollisionModel.of(ROBOT).in_world(gone).is_in_world
    with pytest.raises(InputError, match="'cup' is attached to tip, and another object has its name"):
        held.add(world["cup"])
    with pytest.raises(InputError, match="'cup' is no obstacle now: it is attached to tip"):
        held.move("cup", place())


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"name": "cap"}, r"^obstacle: no obstacle is called 'cap' \(did you mean 'cup'\?\)$"),
        ({"to": "tup"}, r"^to: three_joints has no frame 'tup' \(did you mean '"),
        ({"to": "world"}, "^to: no joint moves 'world': what is fixed there is an obstacle$"),
        ({"robot": None, "to": None}, "^to: expected the frame that holds it, or a robot"),
        ({"robot": None}, "^robot: joint values are those of a robot"),
        ({"robot": None, "q": None}, "^attach.cup: expected `robot` and `q`, where it is picked up, or its pose"),
        ({"q": [0.0]}, "^q: expected 3 joint values"),
        ({"may_touch": "hand"}, "^may_touch: expected a list of names, got 'hand'$"),
        (
            {"may_touch": ["tabel"]},
            r"^may_touch\[0\]: no component and no obstacle is called 'tabel' \(did you mean 'tab",
        ),
        ({"spheres": [[0, 0, 0]]}, r"^spheres: expected up to 2,000 spheres \[n, 4\]"),
        ({"spheres": [[0, 0, 0, -1.0]]}, r"^spheres\[0\]: expected finite numbers and a radius of at least 1e-06 m"),
        ({"spheres": [[0, 0, np.inf, 1.0]]}, r"^spheres\[0\]: expected finite numbers"),
        ({"protrusion_m": 0.0}, "^protrusion_m: expected a length of at least 0.0001 m, got 0.0$"),
        ({"T_frame_object": np.zeros((4, 4))}, "^T_frame_object: expected a rotation"),
    ],
)
def test_what_is_wrong_is_said_in_a_line(world, given, message):
    known = {"to": "tip", "robot": ROBOT, "q": Q, **given}
    name = known.pop("name", "cup")
    with pytest.raises(InputError, match=message):
        world.attach(name, **known)


def test_what_cannot_be_held(world):
    cloud = make_obstacle("dust", [make_solid("cloud", (0.01,), None, [[0, 0, 0]])])
    floor = make_obstacle("floor", [make_solid("half_space")])
    for obstacle, message in ((cloud, "a cloud has no inside"), (floor, "a half-space has no end")):
        with pytest.raises(InputError, match=message):
            world.add(obstacle).attach(obstacle.name, "tip", robot=ROBOT, q=Q)
    held = world.attach("cup", "tip", robot=ROBOT, q=Q)
    with pytest.raises(InputError, match=r"^attach.cup: 'cup' is attached to tip already: detach it first$"):
        held.attach("cup", "tip", robot=ROBOT, q=Q)
    with pytest.raises(InputError, match=r"^attach.cup: 'cup' is switched off with its group cups$"):
        world.switch(cups=False).attach("cup", "tip", robot=ROBOT, q=Q)
    with pytest.raises(InputError, match=r"^attached: expected what World.attach makes"):
        World(attached=("cup",))


def test_what_cannot_be_let_go(world):
    held = world.attach("cup", "tip", robot=ROBOT, q=Q)
    for name, options, message in (
        ("cap", {}, r"nothing that is attached is called 'cap' \(did you mean 'cup'\?\)"),
        ("mug", {}, "nothing that is attached is called 'mug'; attached: cup"),
        ("cup", {"q": Q}, "where it is let go is said by `robot` and `q` together"),
        ("cup", {"robot": ROBOT}, "by `robot` and `q` together"),
    ):
        with pytest.raises(InputError, match=message):
            held.detach(name, **options)
    with pytest.raises(InputError, match=r"nothing that is attached is called 'cup'$"):
        world.detach("cup")


def test_what_it_touches_of_the_robot_where_it_is_picked_up_is_refused_with_the_line_to_add(world):
    line = (
        r"^attach.cup: cup is -[\d.]+ mm from arm where it is picked up, its spheres stand out by up to .* mm; if that"
    )
    with pytest.raises(InputError, match=line + r" is meant, write may_touch: \[hand, arm\]$"):
        world.move("cup", ikde.forward(ROBOT, Q)["mouth"]).attach("cup", "tip", robot=ROBOT, q=Q)
    moved = world.move("cup", ikde.forward(ROBOT, Q)["mouth"])
    assert moved.attach("cup", "tip", robot=ROBOT, q=Q, may_touch=["hand", "arm"]).attached[0].may_touch == (
        "hand",
        "arm",
    )


def test_what_is_held_is_no_obstacle(world):
    thing = world.attach("cup", "tip", robot=ROBOT, q=Q).attached[0]
    assert isinstance(thing, Attached)
    assert thing != thing.obstacle

"""Worlds: obstacles by name, switched by group; a digest of what counts."""

import copy
import pickle
from dataclasses import fields
from types import SimpleNamespace

import numpy as np
import pytest

from ikde.errors import InputError
from ikde.model.solids import make_solid
from ikde.model.world import World, make_obstacle, make_world

BALL = make_solid("sphere", [0.1])
BOX = make_solid("box", [0.1, 0.2, 0.3])


def place(x):
    T = np.eye(4)
    T[0, 3] = x
    return T


@pytest.fixture
def world():
    return make_world([make_obstacle("ball", [BALL], place(1)), make_obstacle("box", [BOX, BALL], group="tools")])


def test_obstacles_by_name(world):
    assert len(world) == 2
    assert world.names == ("ball", "box")
    assert world["box"].solids == (BOX, BALL)
    with pytest.raises(InputError, match="no obstacle is called 'bal' \\(did you mean 'ball'\\?\\)"):
        world["bal"]
    with pytest.raises(InputError, match="two obstacles are called 'ball'"):
        world.add(make_obstacle("ball", [BOX]))


def test_another_world_comes_of_every_change(world):
    assert world.add(make_obstacle("new", [BOX])).names == ("ball", "box", "new")
    assert world.remove("ball").names == ("box",)
    assert world.move("box", place(2))["box"].T_world_obstacle[0, 3] == 2
    assert world.names == ("ball", "box")
    assert not world["box"].T_world_obstacle[0, 3]


def test_groups_are_switched(world):
    off = world.switch(tools=False)
    assert [o.name for o in off.active] == ["ball"]
    assert off.switch(tools=True).active == world.active
    assert make_world([make_obstacle("a", [BALL], group="self")], ["self"]).active == ()
    with pytest.raises(InputError, match="no group is called 'tool'"):
        world.switch(tool=False)


def test_a_digest_is_of_what_counts(world):
    again = make_world([make_obstacle("ball", [BALL], place(1)), make_obstacle("box", [BOX, BALL], group="others")])
    assert again.digest == world.digest
    assert world.remove("box").digest == world.switch(tools=False).digest
    minus_zero = np.where(place(1) == 0.0, -0.0, place(1))
    assert world.move("ball", minus_zero).digest == world.digest
    others = [
        world.move("ball", place(1 + 1e-15)),
        world.remove("box"),
        make_world([world["box"], world["ball"]]),
        make_world([make_obstacle("ball", [BALL], place(1), margin_m=1e-3), world["box"]]),
        make_world([make_obstacle("ball", [BALL], place(1), ignore=["arm"]), world["box"]]),
        make_world([make_obstacle("ball", [BALL], place(1), frame="base"), world["box"]]),
        make_world([make_obstacle("ball", [make_solid("sphere", [0.2])], place(1)), world["box"]]),
        World(),
    ]
    assert len({w.digest for w in (world, *others)}) == len(others) + 1


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"name": "a\n"}, "printable"),
        ({"solids": []}, "'a' has no solid"),
        ({"margin_m": -0.1}, "margin: expected a margin of at least 0 m, got -0.1"),
        ({"margin_m": np.nan}, "margin"),
        ({"ignore": "arm"}, "ignore: expected a list of components, got 'arm'"),
        ({"ignore": ["arm", ""]}, r"ignore\[1\]: expected a name"),
        ({"frame": ""}, "frame: expected a name"),
        ({"group": 3}, "group: expected a name"),
        ({"T_world_obstacle": 2 * np.eye(4)}, "expected a rotation"),
    ],
)
def test_an_obstacle_that_is_none(given, said):
    with pytest.raises(InputError, match=said):
        make_obstacle(**{"name": "a", "solids": [BALL]} | given)


def test_a_world_whose_obstacle_has_moved_is_one_that_was_made_so(world):
    moved, made = world.move("ball", place(2)), make_world([make_obstacle("ball", [BALL], place(2)), world["box"]])
    assert (moved, moved.digest, hash(moved)) == (made, made.digest, hash(made))
    assert moved.switch(tools=False).move("ball", place(1)).active == (world["ball"],)
    assert pickle.loads(pickle.dumps(moved)) == copy.deepcopy(moved) == made


def test_worlds_are_equal_by_value_also_those_that_travelled(world):
    hull = make_obstacle("hull", [make_solid("hull", points=[[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])])
    before, world = world, world.add(hull)
    for other in (before.add(hull), pickle.loads(pickle.dumps(world)), copy.deepcopy(world), copy.copy(world)):
        assert (world == other, hash(world) == hash(other)) == (True, True)
        assert not other["hull"].T_world_obstacle.flags.writeable
        assert not other["hull"].solids[0].points.flags.writeable
    bigger = make_obstacle("hull", [make_solid("hull", points=[[0, 0, 0], [2, 0, 0], [0, 1, 0], [0, 0, 1]])])
    grouped = make_obstacle("hull", hull.solids, group="tools")
    others = [
        before.add(grouped),
        world.remove("hull"),
        before.add(bigger),
        world.move("hull", place(1)),
        world.switch(tools=False),
    ]
    assert all(world != other for other in others)
    assert before.add(bigger).digest != world.digest
    assert world != 3


def test_a_group_of_which_nothing_is_left_is_forgotten():
    ball = make_obstacle("ball", [BALL], group="tools")
    world = make_world([ball, make_obstacle("other", [BALL])]).switch(tools=False)
    left = world.remove("ball")
    assert (left.switched_off, left.add(ball).active[-1].name) == (frozenset(), "ball")


def test_a_world_is_walked_through_and_searched_by_name(world):
    assert [obstacle.name for obstacle in world] == list(world.names)
    assert (world.names[0] in world, "none" in world, 0 in world) == (True, False, False)
    assert len(repr(list(world))) < 200


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        (lambda w: w.add("x"), r"obstacles\[2\]: expected an obstacle of a World, got 'x'"),
        (lambda w: World(obstacles=["x"]), r"obstacles\[0\]: expected an obstacle of a World"),
        (lambda w: World(obstacles=(w["ball"], w["ball"])), "two obstacles are called 'ball'"),
        (lambda w: World(obstacles=3), "^obstacles: expected obstacles in a sequence, got 3$"),
        (lambda w: World(obstacles="ball"), "^obstacles: expected obstacles in a sequence, got 'ball'$"),
        (lambda w: World(obstacles=w.obstacles, switched_off="tools"), "^switched_off: expected names of groups in"),
        (
            lambda w: World(obstacles=w.obstacles, switched_off={"tool"}),
            "^switched_off: no group is .*tools",
        ),
        (lambda w: World(obstacles=w.obstacles, switched_off=[3]), "^switched_off: no group is called 3$"),
        (lambda w: w.switch(tools="off"), "groups.tools: expected True or False, got 'off'"),
        (lambda w: w.move("ball", np.diag([1, 1, 1, 5.0])), "T_world_obstacle: expected the last row 0 0 0 1"),
        (lambda w: w.move("ball", SimpleNamespace(as_matrix=lambda: 1 / 0)), "T_world_obstacle: .*ZeroDivisionError"),
    ],
)
def test_what_a_world_refuses(world, wrong, said):
    with pytest.raises(InputError, match=said):
        wrong(world)


def test_an_obstacle_moves_to_a_pose_of_another_library(world):
    assert world.move("box", SimpleNamespace(homogeneous=place(1))) == world.move("box", place(1))


def test_what_is_held_stays_held_when_an_obstacle_moves():
    three = [make_obstacle(name, [make_solid("sphere", (0.1,))], group=name) for name in ("rod", "can", "off")]
    spheres = [[0.0, 0.0, 0.0, 0.1]]
    world = make_world(three, ["off"]).attach("rod", "hand", T_frame_object=np.eye(4), spheres=spheres)
    moved = world.move("can", np.eye(4))
    assert moved == world
    for field in fields(World):
        assert getattr(moved, field.name) == getattr(world, field.name), field.name
    assert [thing.name for thing in moved.attached] == ["rod"]

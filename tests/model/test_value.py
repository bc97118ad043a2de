"""Robots, targets and worlds are equal by value, through pickle and copies, and are hashed once."""

import copy
import pickle
from dataclasses import replace

import numpy as np
import pytest

from ikde.io.robots import load_robot
from ikde.model.collision_model import CollisionModel
from ikde.model.pack import pack_robot
from ikde.model.robot import Frame
from ikde.model.solids import make_solid
from ikde.model.target import Target, Targets
from ikde.model.value import FEW
from ikde.model.world import make_obstacle, make_world

THROUGH = [lambda value: pickle.loads(pickle.dumps(value)), copy.copy, copy.deepcopy]
POINTS = np.random.default_rng(3).uniform(1.0, 2.0, (FEW, 3))


def cloud(points=POINTS, off=()):
    """A world of a box and a cloud of points."""
    solids = [make_solid("box", [0.1, 0.2, 0.3]), make_solid("cloud", [0.01], points=points)]
    return make_world([make_obstacle("crumbs", solids, group="guests"), make_obstacle("box", solids[:1])], off)


WORLD = cloud()
VALUES = [
    load_robot("ur5"),
    load_robot("ur5").frames[0],
    Target((1.0, 2.0, 3.0)),
    Targets([(1.0, 2.0, 3.0)]),
    WORLD,
    WORLD["crumbs"],
    WORLD["crumbs"].solids[1],
    CollisionModel.of(load_robot("ur5")).in_world(WORLD, 0.01, {"base": 0.0}),
]


@pytest.mark.parametrize("value", VALUES, ids=lambda value: type(value).__name__)
@pytest.mark.parametrize("travel", THROUGH, ids=["pickle", "copy", "deepcopy"])
def test_a_copy_is_equal_and_finds_the_same_key(value, travel):
    hash(value)
    other = travel(value)
    assert other is not value
    assert other == value
    assert {value: "found"}[other] == "found"


@pytest.mark.parametrize("travel", [lambda value: value, *THROUGH], ids=["same", "pickle", "copy", "deepcopy"])
def test_nothing_writes_to_a_robot_whose_kernels_are_kept(travel):
    frame = travel(load_robot("ur5")).frames[3]
    for array in (frame.p_parent_frame, frame.R_parent_frame, frame.axis):
        with pytest.raises(ValueError, match="read-only"):
            array[...] = 0.0


@pytest.mark.parametrize("travel", [lambda value: value, *THROUGH], ids=["same", "pickle", "copy", "deepcopy"])
@pytest.mark.parametrize("name", ["detectors", "pair_lists", "approximations", "conventions", "provenance"])
def test_nothing_is_added_to_what_robots_share(travel, name):
    robot = travel(load_robot("qiao2021"))
    with pytest.raises(TypeError, match="does not support item assignment"):
        getattr(robot, name)["x"] = None
    for inner in robot.conventions.values():
        with pytest.raises(TypeError, match="does not support item assignment"):
            inner["q1"] = 1.0
    assert robot.conventions


def test_a_frame_does_not_share_the_array_it_was_made_of():
    place = np.array([0.0, 0.0, 1.0])
    frame = Frame(name="a", parent="world", p_parent_frame=place, R_parent_frame=np.eye(3))
    place[2] = 5.0
    assert frame.p_parent_frame.tolist() == [0.0, 0.0, 1.0]


def test_an_equal_robot_shares_what_was_prepared_for_the_first():
    robot = load_robot("ur5")
    assert pack_robot(pickle.loads(pickle.dumps(robot))) is pack_robot(robot)


def test_robots_that_differ_in_one_number_are_not_equal():
    robot = load_robot("ur5")
    moved = replace(robot.frames[0], p_parent_frame=robot.frames[0].p_parent_frame + 1e-15)
    assert replace(robot, frames=(moved, *robot.frames[1:])) != robot
    assert replace(robot, title="another") != robot
    assert replace(robot) == robot


def test_targets_are_equal_if_they_ask_for_the_same():
    assert Target([1, 2, 3]) == Target((1.0, 2.0, 3.0))
    assert Target([1, 2, 3]) != Target([1, 2, 3], R_world_tool=np.eye(3))
    assert Target([1, 2, 3]) != Target([1, 2, 4])
    assert Target([1, 2, 3]) != Targets([[1, 2, 3]])
    assert Target([1, 2, 3]) != "target"


def test_a_hash_is_computed_once(monkeypatch):
    target = Target([1, 2, 3])
    first = hash(target)
    monkeypatch.setattr("ikde.model.value.encode", None)
    assert hash(target) == first


@pytest.mark.parametrize("travel", [lambda value: value, *THROUGH], ids=["same", "pickle", "copy", "deepcopy"])
def test_nothing_writes_to_a_world(travel):
    crumbs = travel(WORLD)["crumbs"]
    for array in (crumbs.T_world_obstacle, crumbs.solids[1].points, crumbs.solids[0].T_obstacle_solid):
        with pytest.raises(ValueError, match="read-only"):
            array[...] = 0.0


def test_worlds_are_equal_if_all_of_them_is():
    moved = POINTS.copy()
    moved[FEW // 2, 1] += 1e-15
    others = [
        cloud(moved),
        cloud(POINTS[1:]),
        cloud(off=["guests"]),
        WORLD.remove("box"),
        WORLD.move("box", np.eye(4)[:, [1, 2, 0, 3]]),
    ]
    assert cloud(POINTS.copy()) == WORLD != "crumbs"
    assert all(other != WORLD for other in others)
    as_columns = cloud(np.asfortranarray(POINTS))
    assert as_columns == WORLD
    assert hash(as_columns) == hash(WORLD)
    assert WORLD.remove("box").add(WORLD["box"]) == WORLD

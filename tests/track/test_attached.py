"""Tracks of a robot that holds something: it is kept clear of what is around, between samples too, or named."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

import ikde
from ikde.track.certify import bound_all, certify
from tests.attached import OWN, hold, is_free, list_gaps
from tests.solids import random_world
from tests.three_joints import free_q

Y = np.linspace(0.0, 0.2, 21)
ROD = [[0.0, 0.0, 0.03 * k, 0.02] for k in range(8)]
SHELF = {
    "rod": {"cylinder": {"radius": 0.02, "height": 0.2}},
    "board": {"box": [0.6, 2.0, 0.03], "position": [1.0, 0.2, 0.8]},
    "back": {"box": [0.03, 2.0, 2.0], "position": [1.45, 0.2, 1.0]},
}


def make_path():
    return ikde.ToolPath.through(np.column_stack([np.full_like(Y, 0.9), Y, np.full_like(Y, 1.1)]), dt_s=0.02)


def carry(**more):
    world = ikde.load_world({"obstacles": {**SHELF, **more}})
    return world.attach("rod", "tool", T_frame_object=np.eye(4), spheres=ROD)


def test_a_rod_is_carried_and_certified():
    model = ikde.CollisionModel.of("qiao2021").in_world(carry(), 0.005)
    alone = ikde.follow_path(
        "qiao2021", make_path(), collision=carry().remove("board", "back").detach("rod").remove("rod")
    )
    motion = ikde.follow_path("qiao2021", make_path(), collision=model)
    assert alone.reached
    assert motion.reached, motion.stop
    assert motion.certificate.is_free
    dense = np.concatenate([np.linspace(a, b, 8) for a, b in zip(motion.q[:3], motion.q[1:4], strict=True)])
    assert ikde.check_many("qiao2021", motion.q, model).clearance_m.min() >= motion.certificate.clearance_m - 1e-12
    assert not ikde.check_many("qiao2021", dense, model).collision.any()


def test_what_the_rod_meets_is_named():
    tool = ikde.forward("qiao2021", ikde.follow_path("qiao2021", make_path()).q[12])["tool"]
    middle = (tool[:3, 3] + 0.15 * tool[:3, 2]).tolist()
    world = carry(wall={"box": [4.0, 0.02, 4.0], "position": [middle[0], 0.13, middle[2]]}).remove("board", "back")
    motion = ikde.follow_path("qiao2021", make_path(), collision=world)
    assert not motion.reached
    assert motion.stop.reason == "collision"
    assert "wall" in motion.stop.pair
    assert motion.stop.hint == "without wall it goes on to the end"  # the arm, too, would touch it


def test_what_is_held_may_touch_what_it_meets():
    p, ahead = make_path().p_world_tool, np.tile([1.0, 0.0, 0.0], (21, 1))
    wall = {"box": [0.05, 0.02, 0.4], "position": [1.11, 0.13, 1.1]}
    world, path = carry(wall=wall).remove("board", "back"), ikde.ToolPath.through(p, dt_s=0.02, axis_world_tool=ahead)
    motion = ikde.follow_path("qiao2021", path, collision=world)
    assert motion.stop.pair == ("rod", "wall")
    assert motion.stop.hint.endswith("; if rod may touch wall it goes on to the end")
    allowed, first = replace(world, attached=(replace(world.attached[0], may_touch=("wall",)),)), motion.reached_points
    rest = ikde.ToolPath.through(p[first:], dt_s=0.02, axis_world_tool=ahead[first:])
    assert ikde.follow_path("qiao2021", rest, collision=allowed, start=motion.q[-1]).reached


@pytest.mark.parametrize("count", [0, 3])
def test_no_moment_is_nearer_than_the_bounds(count, rng):
    kinds = ("box", "cylinder", "hull")
    world = hold(random_world(rng, count, kinds=kinds, far=1.2, ignore=("floor", "post")), margin_m=0.01)
    model, q = OWN.in_world(world, 0.01), free_q(3)
    room = bound_all(model, q, "omnidirectional")
    certificate = certify(model, q)
    assert room.shape == (2, len(model.all_pairs))
    for segment, (a, b) in enumerate(pairwise(q)):
        for share in np.linspace(0.0, 1.0, 9):
            found = list_gaps(model, a + share * (b - a))
            for pair, (gap, asked) in found.items():
                kept = 0.0 if pair in model.pairs else asked
                assert gap - kept >= room[segment, model.all_pairs.index(pair)] - 1e-9
                assert gap >= certificate.clearance_m - 1e-9
    if certificate.is_free:
        assert all(is_free(model, row) for row in q)

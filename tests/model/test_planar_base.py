"""Bases: which robots drive in the plane, turn, and carry all that can collide."""

from dataclasses import replace

import ikde
from ikde.model.planar_base import NO_BASE, find_planar_base
from ikde.model.robot import SphereRow
from tests.random_robots import make_frame, make_robot


def make_base(*, axes=((1, 0, 0), (0, 1, 0), (0, 0, 1)), shift=(0, 0, 0.1), kinds=("prismatic",) * 2 + ("revolute",)):
    """Three joints in a row with a mast on top."""
    frames = [
        make_frame("along", "world", joint="x", axis=axes[0]),
        make_frame("across", "along", joint="y", axis=axes[1]),
        make_frame("platform", "across", shift, joint="turn", axis=axes[2]),
        make_frame("tool", "platform", (0.2, 0, 1.0)),
    ]
    return make_robot(dict(zip(("x", "y", "turn"), kinds, strict=True)), frames)


def test_robots_with_a_base_and_without(qiao):
    for robot in (qiao, ikde.load_robot("qiao2021_dh"), make_base()):
        assert find_planar_base(robot).tolist() == [0, 1, 2]
    for name in ("ur5", "panda"):
        assert find_planar_base(ikde.load_robot(name)).tolist() == NO_BASE.tolist() == [-1, -1, -1]


def test_how_far_it_may_go_does_not_matter(qiao):
    joints = tuple(replace(joint, lower=joint.home, upper=joint.home) for joint in qiao.joints[:3])
    assert find_planar_base(replace(qiao, joints=(*joints, *qiao.joints[3:]))).tolist() == [0, 1, 2]


def test_axes_kinds_and_places_must_be_those_of_a_plane():
    for wrong in (
        {"axes": ((1, 0, 0), (0, 0, 1), (0, 1, 0))},
        {"axes": ((0, 1, 0), (1, 0, 0), (0, 0, 1))},
        {"axes": ((1, 0, 0), (0, 1, 0), (0, 0, -1))},
        {"kinds": ("prismatic", "revolute", "revolute")},
        {"shift": (0.3, 0, 0.1)},
    ):
        assert find_planar_base(make_base(**wrong)).tolist() == [-1, -1, -1]


def test_it_carries_all_that_can_collide(qiao):
    post = SphereRow(component="post", start="world", end="world", radius_m=0.1)
    spheres = {"improved": (*qiao.approximations["improved"], post)}
    told = {"approximations": spheres, "detectors": {"improved": qiao.detectors["improved"]}}
    unseen = replace(qiao, **told)
    assert find_planar_base(unseen).tolist() == [0, 1, 2]
    seen = {"formula_22": (*qiao.pair_lists["formula_22"], ("post", "LT"))}
    assert find_planar_base(replace(unseen, pair_lists=seen)).tolist() == [-1, -1, -1]

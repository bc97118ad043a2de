"""What a format cannot hold is listed if the robot has it, and not otherwise."""

from dataclasses import replace

import pytest

import ikde
from ikde.io.mjcf import format_mjcf
from ikde.io.sphere_writers import format_curobo, format_xrdf
from ikde.io.srdf_writer import format_srdf
from ikde.io.unheld import describe_unheld, list_unheld
from ikde.io.urdf import format_urdf
from ikde.model.collision_model import CollisionModel

WRITERS = {"URDF": format_urdf, "SRDF": format_srdf, "MJCF": format_mjcf, "cuRobo": format_curobo, "XRDF": format_xrdf}


@pytest.mark.parametrize("kind", WRITERS)
def test_what_a_robot_has_and_a_format_has_not_is_listed_and_on_top_of_the_file(qiao, kind):
    listed = list_unheld(CollisionModel.of(qiao), kind)
    for what in ("conventions: classical", "the other detectors: single, typical", "where numbers come from"):
        assert what in listed
    assert any("wheels of the base" in what for what in listed)
    text = WRITERS[kind](qiao)
    assert all(f"* {what}\n" in text for what in listed)


def test_speeds_and_accelerations_are_in_urdf_and_not_in_mjcf():
    panda = CollisionModel.of("panda")
    assert {"speeds", "accelerations"} <= set(list_unheld(panda, "MJCF"))
    assert not {"speeds", "accelerations"} & set(list_unheld(panda, "URDF"))


def test_accelerations_are_lost_only_where_some_joints_have_one():
    lost = "accelerations, as not all joints have one"
    panda, ur5 = ikde.load_robot("panda"), ikde.load_robot("ur5")
    assert panda.joints[0].max_acceleration
    some = replace(panda, joints=(replace(panda.joints[0], max_acceleration=None), *panda.joints[1:]))
    for robot, is_lost in ((panda, False), (some, True), (ur5, any(own.max_acceleration for own in ur5.joints))):
        assert (lost in list_unheld(CollisionModel.of(robot), "XRDF")) == is_lost
    assert not any(own.max_acceleration for own in ur5.joints)


def test_reasons_are_in_the_srdf_and_safe_distances_that_are_none_are_not_missed():
    ur5 = CollisionModel.of("ur5")
    assert ur5.left_out_pairs
    for kind, has_reasons in (("URDF", True), ("SRDF", True), ("MJCF", False), ("cuRobo", False)):
        assert ("reasons of pairs that are left out" in list_unheld(ur5, kind)) != has_reasons
    detector = replace(ur5.detector, safe_distance_m=0.0)
    assert "the safe distance" not in list_unheld(CollisionModel.of(ur5.robot, detector), "MJCF")


def test_without_a_detector_all_of_them_are_other_ones(qiao):
    listed = list_unheld(CollisionModel.of(qiao, "none"), "URDF")
    assert f"the other detectors: {', '.join(qiao.detectors)}" in listed


def test_a_base_without_wheels_is_a_base_as_well(qiao):
    bare = CollisionModel.of(replace(qiao, wheels=None, drive=None))
    assert any("wheels of the base" in what for what in list_unheld(bare, "URDF"))
    assert not any("wheels of the base" in what for what in list_unheld(CollisionModel.of("ur5"), "URDF"))


def test_the_safe_distance_is_in_the_urdf_alone(qiao):
    name = qiao.default_detector
    wide = replace(qiao, detectors=qiao.detectors | {name: replace(qiao.detectors[name], safe_distance_m=0.02)})
    assert "the safe distance" in list_unheld(CollisionModel.of(wide), "MJCF")
    assert "the safe distance: it is in the URDF" in list_unheld(CollisionModel.of(wide), "SRDF")
    assert not any("safe distance" in what for what in list_unheld(CollisionModel.of(wide), "URDF"))


def test_a_file_that_holds_all_lists_nothing():
    assert describe_unheld(()) == ()
    assert describe_unheld(("this",)) == ("Not held:", "* this")

"""What a format cannot hold is listed if the robot has it, and not otherwise."""

from dataclasses import replace

import pytest

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


def test_the_safe_distance_is_in_the_urdf_alone(qiao):
    name = qiao.default_detector
    wide = replace(qiao, detectors=qiao.detectors | {name: replace(qiao.detectors[name], safe_distance_m=0.02)})
    assert "the safe distance" in list_unheld(CollisionModel.of(wide), "MJCF")
    assert "the safe distance: it is in the URDF" in list_unheld(CollisionModel.of(wide), "SRDF")
    assert not any("safe distance" in what for what in list_unheld(CollisionModel.of(wide), "URDF"))


def test_a_file_that_holds_all_lists_nothing():
    assert describe_unheld(()) == ()
    assert describe_unheld(("this",)) == ("Not held:", "* this")

"""Spheres for other programs: what is written is read back, pairs are those that are left out, the rest is listed."""

from dataclasses import replace

import pytest
import yaml

import ikde
from ikde.io.sphere_files import read_spheres
from ikde.io.sphere_writers import format_curobo, format_xrdf
from ikde.io.srdf_writer import format_srdf
from ikde.io.unheld import list_unheld
from ikde.model.collision_model import CollisionModel
from tests.urdf_texts import ARM, write

FORMATS = {"curobo.yml": format_curobo, "arm.xrdf": format_xrdf, "arm.srdf": format_srdf}
written = pytest.mark.parametrize("name", FORMATS)


def read_back(folder, name, robot):
    (folder / name).write_text(FORMATS[name](robot), encoding="utf-8")
    return read_spheres(folder / name)


@written
def test_an_imported_robot_has_the_same_spheres_with_what_was_written_of_it(tmp_path, name):
    path = write(tmp_path, ARM)
    robot = ikde.import_urdf(path)
    assert read_back(tmp_path, name, robot).notes == ()
    again = ikde.import_urdf(path, spheres=tmp_path / name)
    assert again.approximations == robot.approximations
    assert again.pair_lists == robot.pair_lists


@written
def test_rows_are_written_in_the_links_of_the_urdf_that_goes_with_them(tmp_path, name):
    robot = ikde.load_robot("ur5")
    model = CollisionModel.of(robot)
    found = read_back(tmp_path, name, robot).spheres
    assert list(found) == [f"component_{own}" for own in robot.components(next(iter(robot.approximations)))]
    assert sum(map(len, found.values())) == len(model.spheres)


def test_pairs_home_and_the_safe_distance_are_in_both_files(qiao):
    curobo = yaml.safe_load(format_curobo(qiao))["robot_cfg"]["kinematics"]
    xrdf = yaml.safe_load(format_xrdf(qiao))
    pairs = {(f"component_{p.a}", f"component_{p.b}") for p in CollisionModel.of(qiao).left_out_pairs}
    for ignored in (curobo["self_collision_ignore"], xrdf["self_collision"]["ignore"]):
        assert {(a, b) for a, others in ignored.items() for b in others} == pairs
    assert curobo["cspace"]["retract_config"] == qiao.home.tolist()
    assert list(xrdf["default_joint_positions"].values()) == qiao.home.tolist()
    assert (curobo["ee_link"], curobo["base_link"], xrdf["tool_frames"]) == (qiao.tool, "world", [qiao.tool])


def test_half_of_the_safe_distance_is_the_buffer_of_a_link(qiao):
    name = qiao.default_detector
    wide = replace(qiao, detectors=qiao.detectors | {name: replace(qiao.detectors[name], safe_distance_m=0.02)})
    assert set(yaml.safe_load(format_xrdf(wide))["self_collision"]["buffer_distance"].values()) == {0.01}


def test_without_a_detector_there_are_joints_alone(qiao):
    assert "geometry" not in yaml.safe_load(format_xrdf(qiao, collision="none"))
    assert yaml.safe_load(format_curobo(qiao, collision="none"))["robot_cfg"]["kinematics"]["collision_spheres"] == {}


def test_what_is_not_held_is_listed_in_the_file(qiao):
    listed = list_unheld(CollisionModel.of(qiao), "cuRobo")
    assert "conventions: classical" in listed
    assert any(what.startswith("the drive and the wheels of the base") for what in listed)
    text = format_curobo(qiao)
    assert all(f"# * {what}\n" in text for what in listed)


def test_accelerations_are_written_if_all_are_known(qiao):
    known = replace(qiao, joints=tuple(replace(joint, max_acceleration=2.0) for joint in qiao.joints))
    assert yaml.safe_load(format_xrdf(known))["cspace"]["acceleration_limits"] == [2.0] * len(qiao.joints)
    some = replace(qiao, joints=(replace(qiao.joints[0], max_acceleration=2.0), *qiao.joints[1:]))
    assert "acceleration_limits" not in yaml.safe_load(format_xrdf(some))["cspace"]
    assert "accelerations, as not all joints have one" in list_unheld(CollisionModel.of(some), "XRDF")

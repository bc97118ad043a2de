"""leobot, the tracked manipulator of Dong and Zhao: their equations as a rigid chain, every number with its source."""

from dataclasses import replace

import numpy as np
import pytest

import ikde
from ikde.io.robots import robot_path
from ikde.io.yaml_file import read_yaml
from ikde.model.base_motion import find_base_frame, find_planar_base, usual_drive
from ikde.paper.manipulability import read_arm
from ikde.paper.tracked_arm import compute_end, compute_jacobian
from tests.conftest import random_q


@pytest.fixture(scope="module")
def leobot():
    return ikde.load_robot("leobot")


def test_e_is_where_the_rigid_chain_puts_it(leobot, rng):
    arm = read_arm(leobot)
    still = replace(arm, links_m=(0.0, 0.0, 0.0))
    for q in random_q(leobot, rng, 20):
        frames = ikde.forward(leobot, q)
        np.testing.assert_allclose(frames["E"][:3, 3], compute_end(arm, q[:3], q[3:]), rtol=0, atol=1e-12)
        np.testing.assert_allclose(frames["M"][:3, 3], compute_end(still, q[:3], q[3:]), rtol=0, atol=1e-12)


def test_the_papers_jacobian_is_the_robots_by_its_tracks_and_joints(leobot, rng):
    """J2 has the right track first, and speeds in m/s where ikde has those of wheels in rad/s."""
    arm = read_arm(leobot)
    for q in random_q(leobot, rng, 20):
        left, right, *joints = ikde.jacobian(leobot, q, by="actuators")[:3].T
        J2 = np.column_stack([right / leobot.wheels.radius_m, left / leobot.wheels.radius_m, *joints])
        np.testing.assert_allclose(J2, compute_jacobian(arm, q[3:], q[2]), rtol=0, atol=1e-12)


def test_its_base_is_one_that_drives(leobot):
    assert find_planar_base(leobot).tolist() == [0, 1, 2]
    assert (find_base_frame(leobot), usual_drive(leobot)) == ("P", "differential")
    assert (leobot.wheels.radius_m, leobot.wheels.half_track_m) == (0.1, 0.2)
    assert leobot.detectors == {}


def test_every_number_has_its_source(leobot):
    where, data = leobot.provenance, read_yaml(robot_path("leobot")).data
    assert all(any(place[:2] == ("frames", name) for place in where) for name in data["frames"])
    assert {where[place].kind for place in [("frames", "link_2", "xyz"), ("frames", "M"), ("wheels",)]} == {
        "calibrated"
    }
    assert {source.kind for source in where.values()} == {"published", "derived", "calibrated"}

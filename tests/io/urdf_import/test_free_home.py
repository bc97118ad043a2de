"""The nearest free configuration that is found near a home."""

from dataclasses import replace

import numpy as np
import pytest

import ikde
from ikde.io.urdf_import.free_home import find_free_home
from ikde.model.collision_model import CollisionModel
from ikde.solver.check import check

COLLIDES = {"shoulder_lift_joint": -1.57, "elbow_joint": 3.1}


def test_a_free_home_stays():
    robot = ikde.load_robot("ur5")
    found = find_free_home(CollisionModel.of(robot), robot.home)
    assert found.tolist() == robot.home.tolist()


@pytest.mark.parametrize("elbow", [2.8, 3.1])
def test_one_that_collides_moves_until_it_is_free_and_no_farther(elbow):
    robot = ikde.load_robot("ur5")
    home = np.array([0.0, -1.57, elbow, 0.0, 0.0, 0.0])
    collision = CollisionModel.of(robot)
    assert check(robot, home).collision
    found = find_free_home(collision, home)
    assert not check(robot, found).collision
    assert find_free_home(collision, home).tolist() == found.tolist()
    assert np.flatnonzero(found != home).tolist() == [2]  # the elbow alone
    assert np.abs(found - home).max() < 0.5
    assert check(robot, found).clearance_m == pytest.approx(1e-3, abs=1e-4)
    assert np.all((found >= robot.lower) & (found <= robot.upper))


def test_where_nothing_is_free_none_is_found():
    robot = ikde.load_robot("ur5")
    detector = replace(CollisionModel.of(robot).detector, safe_distance_m=5.0)
    assert find_free_home(CollisionModel.of(robot, detector), robot.home) is None


def test_a_home_that_is_moved_stays_within_limits_of_many_digits():
    robot = ikde.load_robot("ur5")
    pan = replace(robot.joints[0], lower=0.10003, upper=0.10004, home=0.100035)
    narrow = replace(robot, joints=(pan, *robot.joints[1:]))
    found = find_free_home(CollisionModel.of(narrow), np.array([0.100035, -1.57, 3.1, 0.0, 0.0, 0.0]))
    assert found[0] == 0.100035
    assert not check(narrow, found).collision

"""Robots as plain data come back as they were."""

import json
from dataclasses import replace

import numpy as np
import pytest

import ikde
from ikde.model.plain_data import decode, encode
from ikde.model.robot import Detector, Inertia, Robot


def through_json(kind, value):
    return decode(kind, json.loads(json.dumps(encode(value))))


def test_every_robot_comes_back(any_robot):
    again = through_json(Robot, any_robot)
    assert encode(again) == encode(any_robot)
    assert (again.joints, again.provenance, again.neighbours) == (
        any_robot.joints,
        any_robot.provenance,
        any_robot.neighbours,
    )
    for frame, other in zip(again.frames, any_robot.frames, strict=True):
        assert frame.R_parent_frame.tobytes() == other.R_parent_frame.tobytes()
        assert (frame.axis is None) == (other.axis is None)


@pytest.mark.parametrize("value", [-np.inf, 0.1 + 0.2, -0.0, 5e-324])
def test_numbers_come_back_to_the_bit(value):
    robot = ikde.load_robot("ur5")
    joint = replace(robot.joints[0], home=value)
    again = through_json(Robot, replace(robot, joints=(joint, *robot.joints[1:])))
    assert np.float64(again.joints[0].home).tobytes() == np.float64(value).tobytes()


def test_what_may_be_missing_comes_back_missing():
    assert through_json(Detector | None, None) is None
    detector = Detector(name="own", spheres="fine", pairs="all", safe_distance_m=0.01)
    assert through_json(Detector | None, detector) == detector


def test_anything_else_is_an_error():
    with pytest.raises((KeyError, TypeError)):
        decode(Robot, {"name": "ur5"})


def test_masses_efforts_and_drives_come_back():
    inertia = Inertia(mass_kg=2.0, p_frame_com=np.array([0.1, 0.2, 0.3]), I_com_frame=np.diag([1.0, 2.0, 3.0]))
    robot = ikde.load_robot("ur5")
    joint = replace(robot.joints[0], max_effort=150.0)
    heavy = replace(robot, joints=(joint, *robot.joints[1:]), inertias={"forearm": inertia}, drive="omnidirectional")
    again = through_json(Robot, heavy)
    assert (again.drive, again.joints[0].max_effort) == ("omnidirectional", 150.0)
    assert encode(again.inertias["forearm"]) == encode(inertia)
    assert again.inertias["forearm"].I_com_frame.shape == (3, 3)

"""What speeds of actuators do to the joints of each kind of base, and what they are called."""

from dataclasses import replace

import numpy as np
import pytest

import ikde
from ikde.errors import InputError
from ikde.model.actuators import actuator_names, speeds_by
from ikde.model.base_motion import find_planar_base, move_base
from ikde.model.wheels import DIFFERENTIAL, MECANUM, twist_by_wheels
from tests.conftest import random_q

ARM = ("q1", "q2", "q3", "q4", "q5", "q6")


@pytest.fixture
def mecanum():
    """The UR5e on a platform with mecanum wheels."""
    return ikde.load_robot("ur5e_mecanum")


def test_names(qiao, mecanum):
    panda = ikde.load_robot("panda")
    for by in ("joints", "twist", "actuators"):
        assert actuator_names(panda, by) == panda.joint_names
    assert actuator_names(qiao, "joints") == qiao.joint_names
    assert actuator_names(qiao, "twist") == ("base_forward", "base_turn", *ARM)
    assert actuator_names(qiao, "actuators") == (*DIFFERENTIAL, *ARM)
    slides = replace(qiao, drive="omnidirectional")
    assert actuator_names(slides, "actuators") == ("base_forward", "base_left", "base_turn", *ARM)
    assert actuator_names(mecanum, "twist")[:4] == (*actuator_names(slides, "twist")[:3], "shoulder_pan_joint")
    assert actuator_names(mecanum, "actuators") == (*MECANUM, *mecanum.joint_names[3:])


def test_what_is_not_known_is_refused(qiao, unwheeled):
    with pytest.raises(InputError, match=r"^by: qiao2021 has a differential base without `wheels` in its file"):
        speeds_by(unwheeled, qiao.home, "actuators")
    with pytest.raises(InputError, match=r"^by: expected one of joints, twist, actuators, got 'wheels'"):
        actuator_names(qiao, "wheels")


@pytest.mark.parametrize("name", ["qiao2021", "ur5e_mecanum", "omnidirectional"])
def test_they_move_the_base_along_its_arc(name, rng):
    robot = ikde.load_robot("qiao2021" if name == "omnidirectional" else name)
    robot = replace(robot, drive=name) if name == "omnidirectional" else robot
    wheels, base, step = robot.wheels, find_planar_base(robot), 1e-5
    for q in random_q(robot, rng, 5):
        speeds = rng.uniform(-1, 1, len(actuator_names(robot, "actuators")))
        count = len(speeds) - len(q) + 3
        twist = speeds[:3] if name == "omnidirectional" else twist_by_wheels(wheels) @ speeds[:count]
        ahead, behind = (move_base(q[base], twist, sign * step) for sign in (1.0, -1.0))
        moved = speeds_by(robot, q, "actuators") @ speeds
        np.testing.assert_allclose(moved[base], (ahead - behind) / (2.0 * step), rtol=0, atol=1e-9)
        np.testing.assert_array_equal(moved[3:], speeds[count:])


def test_many_configurations_are_one_after_the_other(qiao, rng):
    q = random_q(qiao, rng, 6).reshape(2, 3, 9)
    for by in ("joints", "twist", "actuators"):
        matrices = speeds_by(qiao, q, by)
        assert matrices.shape == (2, 3, 9, len(actuator_names(qiao, by)))
        np.testing.assert_array_equal(matrices[1, 2], speeds_by(qiao, q[1, 2], by))

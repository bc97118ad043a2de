"""`analyze`: all measures of a configuration, what each column adds, and the room to the limits."""

import numpy as np
import pytest

import ikde
from ikde.errors import InputError
from ikde.solver.analysis import split_jacobian
from ikde.solver.measures import MeasureChoice, measure


def test_all_parts_are_measured(qiao):
    found = ikde.analyze("qiao2021", qiao.home, by="actuators", length_m=0.3)
    assert list(found.scaled) == list(found.raw) == ["whole", "arm", "base"]
    for part, kinds in found.scaled.items():
        for rows, own in kinds.items():
            choice = MeasureChoice(part=part, rows=rows, by="actuators", length_m=0.3)
            np.testing.assert_array_equal(own.singular_values, measure(qiao, qiao.home, choice).singular_values)
    assert found.names[:2] == ("wheel_left", "wheel_right")
    assert "from singular" in repr(found)
    parts = split_jacobian(found)
    assert {name: J.shape for name, J in parts.items()} == {"whole": (6, 8), "arm": (6, 6), "base": (6, 2)}
    raw, J = found.raw["whole"]["pose"], ikde.jacobian(qiao, qiao.home, by="actuators")
    np.testing.assert_allclose(raw.singular_values, np.linalg.svd(J, compute_uv=False), rtol=0, atol=1e-14)


def test_a_fixed_robot_has_no_base(rng):
    robot = ikde.load_robot("panda")
    found = ikde.analyze(robot, robot.home)
    assert list(found.scaled) == ["whole", "arm"]
    assert set(split_jacobian(found)) == {"whole"}  # its arm is that, and drawn once
    q = robot.home.copy()
    q[0] = robot.upper[0]
    assert ikde.analyze(robot, q).limit_margin == 0.0


def test_what_a_joint_adds():
    """A wrist that turns about the tool's own axis moves it nowhere; an arm of six joints needs all for a pose."""
    robot = ikde.load_robot("ur5")
    added = {own.name: own for own in ikde.analyze(robot, robot.home).additions}
    assert added["wrist_3_joint"].translation == pytest.approx(0.0, abs=1e-12)
    assert all(own.pose == 1.0 for own in added.values())
    stretched = ikde.analyze(robot, [0.0, -1.2, 0.0, -1.0, 1.0, 0.0])
    assert {own.pose for own in stretched.additions} == {None}
    assert stretched.scaled["whole"]["pose"].smallest < 1e-9


def test_limits_and_what_is_outside_them(qiao):
    q = qiao.home.copy()
    q[4] = qiao.upper[4] + 0.1
    found = ikde.analyze(qiao, q)
    assert found.outside_limits == ("q2",)
    assert found.limits[4].above == pytest.approx(-0.1)
    assert found.limit_margin < 0.0
    robot = ikde.load_robot("ur5e_mecanum")
    heading = ikde.analyze(robot, robot.home).limits[2]
    assert (heading.below, heading.above, heading.share) == (np.inf, np.inf, 0.5)


def test_one_configuration_alone(qiao):
    with pytest.raises(InputError, match="expected one configuration"):
        ikde.analyze(qiao, [qiao.home] * 2)
    with pytest.raises(InputError, match="length_m: expected a number above 0"):
        ikde.analyze(qiao, qiao.home, length_m=-1.0)

"""Labels of configurations: what they look like, and that they are the closed form's own branches."""

import numpy as np
import pytest

import ikde
from ikde.kernels.closed_form import DOWN, FLIP, RIGHT
from ikde.model.closed_form import find_ur_arm
from ikde.solver.families import FAMILIES, compute_families, family
from tests import reference
from tests.conftest import random_q
from tests.random_robots import random_robot
from tests.ur_robots import any_turn, every_ur_robot, random_arm_q, solve

QIAO = ikde.load_robot("qiao2021")


def test_labels_say_what_codes_mean():
    assert FAMILIES[0] == "left/up/no flip"
    assert FAMILIES[RIGHT + DOWN + FLIP] == "right/down/flip"
    assert len(set(FAMILIES)) == 8


@every_ur_robot
def test_the_closed_forms_branches_have_their_own_label(robot, rng):
    arm = find_ur_arm(robot)
    _, poses = random_arm_q(robot, rng, 100)
    for solutions, codes in zip(*solve(robot, poses, any_turn(robot)), strict=True):
        q = np.zeros((len(solutions), len(robot.joints)))
        q[:, list(arm.coordinates)] = solutions
        np.testing.assert_array_equal(compute_families(robot, q), codes)


def test_one_configuration_is_labelled_like_many(rng):
    q = random_q(QIAO, rng, 20)
    codes = compute_families(QIAO, q.reshape(4, 5, 9))
    assert codes.shape == (4, 5)
    assert [family(QIAO, row) for row in q] == [FAMILIES[code] for code in codes.ravel()]


def test_the_label_does_not_depend_on_how_the_arm_is_written_down(rng):
    other = ikde.load_robot("qiao2021_dh")
    for q in random_q(QIAO, rng, 50):
        shifted = q + np.array([0, 0, 0, 0, 0, 0, 0, np.pi, 0])
        assert family(QIAO, q) == family(other, shifted) == family(QIAO, shifted, "classical")


def test_up_and_right_are_where_they_look_to_be(rng):
    """Qiao2021's first axis points up, and with q1 = 0 its links move in the plane of x and z, ahead along x."""
    compared = 0
    for q in random_q(QIAO, rng, 200):
        q[:4] = 0.0
        T = reference.compute_frames(QIAO, q)
        base, shoulder, elbow, wrist, centre = (T[name][:3, 3] for name in ("Ob", "Oc12", "Oc23", "O3", "O5"))
        ahead = centre[0] - base[0]
        side, bend, _ = family(QIAO, q).split("/")
        assert side == ("right" if ahead * (centre[1] - base[1]) < 0.0 else "left")
        if ahead * (wrist[0] - shoulder[0]) > 0.0:  # not reaching over itself
            slope = (wrist[2] - shoulder[2]) / (wrist[0] - shoulder[0])
            height = shoulder[2] + slope * (elbow[0] - shoulder[0])
            assert bend == ("up" if elbow[2] > height else "down")
            compared += 1
    assert compared > 150


def test_at_the_borders_it_is_up_and_no_flip():
    assert family(QIAO, dict.fromkeys(QIAO.joint_names, 0.0) | {"q2": -0.5}).endswith("up/no flip")


def test_a_result_tells_its_family_if_it_is_reached():
    target = ikde.Target((0.8, 0.5, 1.0))
    alone, rows = ikde.solve(QIAO, target, seed=3), ikde.solve_many(QIAO, [target] * 5, seed=3)
    for result in (alone, *rows):
        assert result.reached
        assert result.family == result.grade.family == ikde.family(QIAO, result.q)
    missed = ikde.solve(QIAO, ikde.Target((50.0, 0.0, 1.0)))
    assert missed.family is None
    assert missed.grade.family == ikde.family(QIAO, missed.q)
    panda = ikde.load_robot("panda")
    assert ikde.solve(panda, ikde.Target((0.4, 0.1, 0.5))).family is None


@pytest.mark.parametrize("robot", [ikde.load_robot("panda"), random_robot(4)], ids=lambda robot: robot.name)
def test_other_robots_have_no_families(robot):
    assert family(robot, robot.home) is None
    assert compute_families(robot, np.zeros((3, len(robot.joints)))) is None

"""Weights of joints, the motion that they weigh, and the room that is left to the limits."""

from dataclasses import replace

import numpy as np
import pytest

import ikde
from ikde.errors import InputError
from ikde.model.robot import Frame
from ikde.solver.motion import default_weights, limit_margin, measure_motion, read_weights
from tests.conftest import random_q
from tests.random_robots import make_robot, with_ranges


def test_by_default_a_range_counts_as_much_as_a_metre_of_driving(qiao):
    weights = default_weights(qiao)
    for joint, weight in zip(qiao.joints, weights, strict=True):
        assert weight == (1.0 if joint.name in ("d_x", "d_y") else pytest.approx(1.0 / (joint.upper - joint.lower)))
    with pytest.raises(ValueError, match="read-only"):
        weights[0] = 2.0


def test_a_slide_of_an_arm_counts_by_its_range():
    slide = {"joint": "s", "axis": np.array([0.0, 0.0, 1.0])}
    tool = Frame(name="tool", parent="world", p_parent_frame=np.zeros(3), R_parent_frame=np.eye(3), **slide)
    robot = make_robot({"s": "prismatic"}, [tool], lower=-0.25, upper=0.25)
    assert default_weights(robot).tolist() == [2.0]


def test_a_joint_without_limits_counts_by_a_turn(qiao):
    turns = tuple(
        replace(joint, kind="continuous", lower=-np.inf, upper=np.inf) if joint.name == "q6" else joint
        for joint in qiao.joints
    )
    assert default_weights(replace(qiao, joints=turns))[-1] == pytest.approx(1.0 / (2.0 * np.pi))


def test_a_joint_that_cannot_move_has_a_weight_all_the_same(qiao):
    assert default_weights(with_ranges(qiao, {"q1": (0.5, 0.5)}))[3] == 1.0


def test_given_weights_replace_those_of_their_joints(qiao):
    weights = read_weights(qiao, {"q2": 3, "d_x": np.float64(0.5)})
    expected = default_weights(qiao).copy()
    expected[[qiao.joint_names.index("q2"), 0]] = 3.0, 0.5
    assert weights.tolist() == expected.tolist()
    assert read_weights(qiao, {}).tolist() == read_weights(qiao, None).tolist() == default_weights(qiao).tolist()


@pytest.mark.parametrize(
    ("weights", "message"),
    [
        ({"q22": 1.0}, "weights.q22: qiao2021 has no joint 'q22'"),
        ({"q2": 0.0}, "weights.q2: expected a number from 1e-06 to 1e\\+06, got 0.0"),
        ({"q2": -1.0}, "weights.q2: expected a number from"),
        ({"q2": float("nan")}, "weights.q2: expected a number from"),
        ({"q2": float("inf")}, "weights.q2: expected a number from"),
        ({"q2": True}, "weights.q2: expected a number from"),
        ({"q2": "2"}, "weights.q2: expected a number from"),
        ({"q2": 1e7}, "weights.q2: expected a number from"),
        ([1.0] * 9, "weights: expected weights by joint name"),
        ({3: 1.0}, "weights.3: qiao2021 has no joint 3"),
    ],
)
def test_other_weights_are_refused_in_one_line(qiao, weights, message):
    for call in (ikde.solve, lambda *a, **k: ikde.solve_many(a[0], [a[1]], **k)):
        with pytest.raises(InputError, match=message):
            call(qiao, ikde.Target((0.8, 0.5, 1.0)), weights=weights)


def test_the_motion_is_the_root_of_the_weighed_squares(qiao, rng):
    start, Q, weights = random_q(qiao, rng), random_q(qiao, rng, 5), rng.uniform(0.1, 3.0, 9)
    expected = [sum((w * (a - b)) ** 2 for w, a, b in zip(weights, q, start, strict=True)) ** 0.5 for q in Q]
    np.testing.assert_allclose(measure_motion(weights, start, Q), expected, rtol=1e-14)
    assert measure_motion(weights, start, start) == 0.0


def test_the_margin_is_that_of_the_joint_nearest_to_a_limit_as_a_share_of_its_range():
    lower, upper = np.array([0.0, -1.0, -np.inf, 2.0]), np.array([10.0, 1.0, np.inf, 2.0])
    Q = np.array([[5.0, 0.0, 9.0, 2.0], [9.0, 0.0, 0.0, 2.0], [5.0, -1.0, 0.0, 2.0], [2.0, 0.9, 0.0, 2.0]])
    np.testing.assert_allclose(limit_margin(lower, upper, Q), [0.5, 0.1, 0.0, 0.05])
    assert limit_margin(lower[2:], upper[2:], Q[0, 2:]) == 0.5

"""Every joint ends in the turn that was meant, and one without limits has no seam, whoever searches."""

import numpy as np
import pytest

import ikde
from ikde.solver.settings import BulkOptions
from tests.conftest import random_q
from tests.endless_robot import ENDLESS, LIMITED
from tests.robot_files import load_text
from tests.targets import make_targets

TURN = 2.0 * np.pi
CHECKED = BulkOptions(verify="all", explain=False)
each_method = pytest.mark.parametrize(("method", "count"), [("lm", 300), ("memetic", 12), ("de", 3)])


def is_wound(robot, Q, centre):
    """Whether a full turn inside the limits brings a joint of each row nearer to `centre`."""
    turns = ~robot.is_prismatic
    moved = [Q + side * TURN for side in (-1.0, 1.0)]
    nearer = [(abs(m - centre) < abs(Q - centre) - 1e-9) & (robot.lower <= m) & (m <= robot.upper) for m in moved]
    return (np.any(nearer, axis=0) & turns).any(axis=1)


@pytest.fixture(scope="module")
def endless():
    return load_text(ENDLESS)


@pytest.fixture(scope="module")
def ur5():
    return ikde.load_robot("ur5")


# ---- turns


@pytest.mark.parametrize(("method", "count"), [("lm", 300), ("analytic", 300), ("memetic", 12), ("de", 3)])
@pytest.mark.parametrize("near", [None, 2.5])
def test_no_answer_of_ur5_is_wound_up(ur5, rng, method, count, near):
    centre = ur5.home if near is None else np.full(6, near)
    targets = make_targets(ur5, random_q(ur5, rng, count), "pose")
    rows = ikde.solve_many(
        ur5, targets, ikde.SolveSettings.for_method(method), near=near and centre, bulk=CHECKED, collision="none"
    )
    assert rows.reached.mean() > 0.6
    assert rows.verified.all()
    assert not is_wound(ur5, rows.q, np.clip(centre, ur5.lower, ur5.upper)).any()


@each_method
def test_one_and_many_end_in_the_same_turns_to_the_bit(ur5, endless, rng, method, count):
    settings = ikde.SolveSettings.for_method(method)
    for robot in (ur5, endless):
        targets = make_targets(robot, random_q(robot, rng, min(count, 12)), "pose")
        rows = ikde.solve_many(robot, targets, settings, seed=5)
        for stream, target in enumerate(targets):
            one = ikde.solve(robot, target, settings, seed=5, stream=stream)
            assert one.q.tobytes() == rows.q[stream].tobytes()


def test_distinct_solutions_are_not_wound_up(ur5, endless, rng):
    for robot in (ur5, endless):
        for target in make_targets(robot, random_q(robot, rng, 3), "pose"):
            found = ikde.solve_distinct(robot, target, 4, near=(near := robot.home + 1.0))
            assert not is_wound(robot, np.array([result.q for result in found]), near).any()


def test_a_frozen_joint_stays_where_it_is_frozen(ur5, endless, rng):
    for robot, name, value in ((ur5, "wrist_3_joint", 6.0), (endless, "pan", 50.0), (endless, "spin", -1e4)):
        index = robot.joint_names.index(name)
        Q = random_q(robot, rng, 40)
        Q[:, index] = value
        rows = ikde.solve_many(robot, make_targets(robot, Q, "position"), freeze={name: value}, bulk=CHECKED)
        assert rows.reached.mean() > 0.5
        assert (rows.q[:, index] == value).all()


# ---- without limits


@each_method
@pytest.mark.parametrize("near", [None, 100.0, -3.0])
def test_a_joint_without_limits_is_given_within_half_a_turn(endless, rng, method, count, near):
    centre = endless.home if near is None else np.clip(endless.home + near, endless.lower, endless.upper)
    targets = make_targets(endless, random_q(endless, rng, min(count, 60)), "pose")
    rows = ikde.solve_many(
        endless, targets, ikde.SolveSettings.for_method(method), near=None if near is None else centre, bulk=CHECKED
    )
    free = np.isinf(endless.lower)
    assert rows.reached.mean() > 0.5
    assert (abs(rows.q - centre)[:, free] <= np.pi).all()
    assert not is_wound(endless, rows.q, centre).any()


@pytest.mark.parametrize(("attempts", "least"), [(1, 0.5), (4, 0.9)])
def test_the_far_side_is_met_as_often_as_any_other(endless, rng, attempts, least):
    settings, share = ikde.SolveSettings(method="lm", restarts=attempts), {}
    Q = random_q(endless, rng, 600)
    for place, (pan, spin) in {"far": (np.pi, -0.5 * np.pi), "side": (0.7, 2.0)}.items():
        Q[:, 0], Q[:, 5] = pan + rng.uniform(-0.3, 0.3, 600), spin + rng.uniform(-0.3, 0.3, 600)
        rows = ikde.solve_many(endless, make_targets(endless, Q, "pose"), settings, collision="none", bulk=CHECKED)
        share[place] = rows.reached.mean()
    assert share["side"] > least
    assert share["far"] > share["side"] - 0.06  # three standard deviations of the difference of 600


@pytest.mark.parametrize("side", [-1.0, 1.0])
@pytest.mark.parametrize("turns", [0, 3, -16])
def test_a_search_goes_on_across_the_far_side(endless, rng, side, turns):
    near = random_q(endless, rng, 50)
    near[:, 0] = side * (np.pi - 0.05) + turns * TURN
    targets = make_targets(endless, near + side * np.eye(6)[0] * 0.1, "pose")
    for q, target in zip(near, targets, strict=True):
        result = ikde.solve(endless, target, method="lm", near=q, collision="none")
        assert result.attempts == 1
        assert abs(result.q - q).max() < 1.0
        assert side * (result.q[0] - turns * TURN) > np.pi - 0.01
    if turns == 0:  # the same arm with limits has to go all the way round
        assert abs(ikde.solve(load_text(LIMITED), targets[0], near=near[0], collision="none").q - near[0]).max() > 1.0

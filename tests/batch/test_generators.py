"""Generators against what they promise: corners, bounds, freedom from collision, and the same targets however cut."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ikde.batch.generators import ReachableSource, make_ball, make_box, make_grid
from ikde.errors import InputError
from ikde.model.collision_model import CollisionModel
from ikde.model.generate.module import load_module
from ikde.solver.search import search
from tests.batch.small import target_bits
from tests.problems import problem_of
from tests.random_robots import random_robot
from tests.substitutes import never

few = settings(max_examples=10)
START, TO = np.array([-1.0, 0.0, 1.0]), np.array([1.0, 2.0, 0.5])


def reachable(robot, goal="pose", count=30, seed=3, detector=None, widen=0.0):
    return ReachableSource(
        collision=CollisionModel.of(robot, detector),
        lower=robot.lower - widen,
        upper=robot.upper + widen,
        goal=goal,
        count=count,
        seed=seed,
    )


def positions(source, first=0, last=10**9):
    return np.array([target.p_world_tool for target in source.read(first, last)])


def test_a_grid_has_its_corners_and_runs_z_first():
    source = make_grid(START, TO, (3, 1, 2), {})
    assert source.count == 6
    expected = [(-1, 0, 1), (-1, 0, 0.5), (0, 0, 1), (0, 0, 0.5), (1, 0, 1), (1, 0, 0.5)]
    np.testing.assert_array_equal(positions(source), expected)


def test_a_box_may_be_given_by_any_two_corners():
    source = make_box(START, TO, 500, 1, {})
    assert np.all(positions(source) >= np.minimum(START, TO))
    assert np.all(positions(source) <= np.maximum(START, TO))
    np.testing.assert_array_equal(positions(source), positions(make_box(TO, START, 500, 1, {})))


def test_a_ball_is_round():
    distances = np.linalg.norm(positions(make_ball(START, 0.5, True, 500, 1, {})) - START, axis=1)
    assert 0.4 < distances.max() <= 0.5
    distances = np.linalg.norm(positions(make_ball(START, 0.5, False, 500, 1, {})) - START, axis=1)
    assert distances == pytest.approx(0.5)


def test_every_point_has_the_orientation():
    R = np.diag([-1.0, -1.0, 1.0])
    targets = make_box(START, TO, 5, 1, {"R_world_tool": R}).read(0, 5)
    assert [t.kind for t in targets] == ["pose"] * 5
    np.testing.assert_array_equal(targets[3].R_world_tool, R)


@pytest.mark.parametrize("goal", ["position", "axis", "pose"])
def test_reachable_targets_ask_for_the_goal(qiao, goal):
    pose, target = reachable(qiao).sample(5, 6)[0], reachable(qiao, goal).read(5, 6)[0]
    assert target.kind == goal
    np.testing.assert_array_equal(target.p_world_tool, pose[:, 3])
    if goal != "position":
        np.testing.assert_allclose(target.axis_world_tool, pose[:, 2], atol=1e-15)


def test_reachable_targets_are_reached(qiao):
    problem = problem_of(qiao, collision="typical")
    targets = reachable(qiao, "position", detector="typical").read(0, 10)
    assert search(problem, targets, seed=0, streams=range(10)).counts[:, 0].all()


@few
@given(cut=st.integers(0, 30), seed=st.integers(0, 2**64 - 1))
def test_any_cut_gives_the_same_targets(qiao, cut, seed):
    for source in (reachable(qiao, seed=seed), make_box(START, TO, 30, seed, {}), make_grid(START, TO, (2, 3, 5), {})):
        assert target_bits(source.read(0, cut)) + target_bits(source.read(cut, 99)) == target_bits(source.read(0, 30))


def test_kernels_of_the_robot_draw_only_inside_its_limits(qiao, monkeypatch, substitute):
    """They leave out pairs that never touch there."""
    expected = target_bits(reachable(qiao, widen=0.5).read(0, 9))  # by tables
    monkeypatch.delenv("IKDE_KERNELS")
    substitute(load_module, never)
    assert target_bits(reachable(qiao, widen=0.5).read(0, 9)) == expected
    for widen in (0.0, -0.1):
        with pytest.raises(pytest.fail.Exception):
            reachable(qiao, widen=widen).read(0, 9)


def test_seeds_give_different_targets(qiao):
    assert target_bits(reachable(qiao, seed=1).read(0, 5)) != target_bits(reachable(qiao, seed=2).read(0, 5))


def test_a_robot_that_is_never_free_is_named():
    robot = random_robot(0)
    with pytest.raises(InputError, match="no configuration for 'some' is free of self-collision in 100,000 draws"):
        reachable(robot).read(0, 1)

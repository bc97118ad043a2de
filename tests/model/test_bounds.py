"""Both bounds of one robot: many targets get the bits that each gets alone, and held joints make them sharp."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ikde.model.bounds import find_bounds
from ikde.model.rotation import rotation_from_rpy
from ikde.model.target import Target, Targets
from tests import reference
from tests.random_robots import random_robot
from tests.scara import make_scara


def random_targets(rng, count):
    """Of all kinds, near and far."""
    for _ in range(count):
        p, turn = rng.uniform(-4.0, 4.0, 3), rotation_from_rpy(rng.uniform(-np.pi, np.pi, 3))
        yield [Target(p), Target(p, turn), Target(p, axis_world_tool=turn[:, 2])][rng.integers(3)]


@settings(max_examples=60)
@given(seed=st.integers(0, 10_000), share=st.sampled_from([0.0, 0.4, 1.0]))
def test_many_targets_get_the_bits_that_each_gets_alone(seed, share):
    robot, rng = random_robot(seed), np.random.default_rng(seed)
    held = rng.random(len(robot.joints)) < share
    bounds = find_bounds(robot, robot.lower, np.where(held, robot.lower, robot.upper))
    targets = list(random_targets(rng, 12))
    far_m, off_rad = bounds.excess_of_many(Targets.of(targets))
    assert [bounds.excess(target) for target in targets] == list(zip(far_m.tolist(), off_rad.tolist(), strict=True))


def test_the_bounds_of_a_scara_tell_both():
    robot = make_scara()
    bounds = find_bounds(robot, robot.lower, robot.upper)
    targets = Targets.of([
        Target((2.0, 0.0, 0.0), axis_world_tool=(1, 0, -1)),
        Target((0.5, 0.0, 0.0), axis_world_tool=(1, 0, -1)),
        Target((2.0, 0.0, 0.0)),
        Target((0.5, 0.0, 0.0), rotation_from_rpy(np.array([np.pi - 0.3, 0.0, 0.0]))),
    ])  # fmt: skip
    far_m, off_rad = bounds.excess_of_many(targets)
    assert far_m == pytest.approx([1.2, 0.0, 1.2, 0.0])
    assert off_rad == pytest.approx([np.pi / 4, np.pi / 4, 0.0, 0.3])


@settings(max_examples=100)
@given(seed=st.integers(0, 10_000))
def test_of_a_robot_that_is_held_the_bound_is_where_it_is(seed):
    robot, rng = random_robot(seed), np.random.default_rng(seed)
    q = rng.uniform(robot.lower, robot.upper)
    here, p = reference.compute_frames(robot, q)[robot.tool], rng.uniform(-4.0, 4.0, 3)
    bounds = find_bounds(robot, q, q)
    assert bounds.excess(Target(p))[0] == pytest.approx(np.linalg.norm(p - here[:3, 3]), abs=1e-11)
    assert bounds.excess(Target(here[:3, 3], here[:3, :3])) == (0.0, 0.0)
    asked = Target(p, axis_world_tool=rng.normal(size=3))
    off_rad = np.arccos(np.clip(asked.axis_world_tool @ here[:3, 2], -1.0, 1.0))
    assert bounds.excess(asked)[1] == pytest.approx(off_rad, abs=1e-7)


def test_bounds_are_kept_for_the_ranges_they_hold_in():
    robot = make_scara()
    lower, upper = robot.lower, robot.upper
    first = find_bounds(robot, lower, upper)
    assert find_bounds(robot, lower.copy(), upper.copy()) is first
    lower[0] = upper[0]
    target = Target((0.0, -0.75, 0.0))
    assert first.excess(target)[0] == 0.0
    assert find_bounds(robot, lower, upper).excess(target)[0] > 0.1

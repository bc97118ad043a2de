"""Random free configurations against a plain twin, however they are cut, by tables and by written kernels."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import ikde
from ikde.kernels.draws import MAX_DRAWS, SAMPLING, draw_free
from ikde.model.collision_model import CollisionModel
from ikde.model.generate.module import load_module
from ikde.model.pack import pack_robot
from tests import reference
from tests.random_robots import random_robot
from tests.three_joints import ROBOT

SOMETIMES_FREE = (5, 6, 14, 16, 19, 20, 21, 22)  # random robots; most others always collide

pytestmark = pytest.mark.filterwarnings("ignore:overflow encountered:RuntimeWarning")  # uncompiled words wrap around


def draw(collision, seed, first, count, module=None):
    """So many configurations, and how many of them were found."""
    robot, q = collision.robot, np.empty((count, len(collision.robot.joints)))
    models, kernel = (pack_robot(robot), collision.arrays), draw_free
    if module is not None:
        models, kernel = module.use_models(*models), module.draw_free
    return q, kernel(*models, robot.lower, robot.upper, np.uint64(seed), np.int64(first), q)


@pytest.mark.parametrize("seed", SOMETIMES_FREE)
def test_configurations_equal_the_twin(seed):
    robot = random_robot(seed)
    collision = CollisionModel.of(robot)
    for k, q in enumerate(draw(collision, seed, 7, 4)[0]):
        stream, twin, clearance = reference.Stream.for_attempt(seed, 7 + k, int(SAMPLING)), None, -np.inf
        while clearance <= collision.detector.safe_distance_m:
            ranges = zip(robot.lower, robot.upper, strict=True)
            twin = np.array([lower + stream.uniform() * (upper - lower) for lower, upper in ranges])
            clearance, *_ = reference.compute_clearance(robot, collision.detector, twin)
        np.testing.assert_array_equal(q, twin)


@settings(max_examples=25)
@given(seed=st.integers(0, 2**64 - 1), first=st.integers(0, 10**9), cut=st.integers(0, 6))
def test_any_cut_gives_the_same_bits(qiao, seed, first, cut):
    collision = CollisionModel.of(qiao)
    parts = draw(collision, seed, first, cut)[0], draw(collision, seed, first + cut, 6 - cut)[0]
    np.testing.assert_array_equal(draw(collision, seed, first, 6)[0], np.concatenate(parts))


def test_a_robot_that_is_never_free_is_found_out():
    assert draw(CollisionModel.of(random_robot(0)), 0, 0, 2)[1] == 0
    assert MAX_DRAWS == 100_000


def test_how_many_were_found_in_a_row_is_told(qiao):
    q, found = draw(CollisionModel.of(qiao), 0, 0, 3)
    assert found == 3
    assert np.isfinite(q).all()


@pytest.mark.parametrize("robot", [ROBOT, pytest.param("qiao2021", marks=pytest.mark.slow)], ids=["small", "large"])
def test_written_kernels_draw_the_same_bits(robot):
    """A robot of three joints: other tests compile its kernels as well."""
    robot = ikde.load_robot(robot) if isinstance(robot, str) else robot
    for name in robot.detectors:
        collision = CollisionModel.of(robot, name)
        module = load_module(collision, "position")
        written, tables = draw(collision, 3, 10, 400, module), draw(collision, 3, 10, 400)
        np.testing.assert_array_equal(written[0], tables[0])
        assert written[1] == tables[1] == 400

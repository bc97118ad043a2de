"""Blocks that end with a world: what is large is not copied twice, and is nobody's while another holds it."""

import gc

import numpy as np
import pytest

import ikde
from ikde.kernels.flat_arguments import Terms, flatten_grader, flatten_search
from ikde.model.collision_model import CollisionModel
from ikde.model.pack import pack_robot
from ikde.solver import joined as module
from ikde.solver.engines.engine import make_descent, make_ranges
from ikde.solver.engines.lm import pack_block
from ikde.solver.engines.pool import make_seeds
from ikde.solver.joined import Joins, cut_world, is_large, without_world
from ikde.solver.metrics import pack_grader
from ikde.solver.problem import make_problem, pack_searched
from tests.three_joints import ROBOT


@pytest.fixture
def small(monkeypatch):
    monkeypatch.setattr(module, "LARGE", 4)


def test_an_array_is_taken_again_once_nothing_holds_it(small):
    joins, world = Joins(), np.arange(5.0)
    world.setflags(write=False)
    first, second = joins.join(np.zeros(2), world), joins.join(np.ones(2), world)
    assert not np.shares_memory(first, second)
    assert (first.tolist(), second.tolist()) == ([0.0, 0.0, *range(5)], [1.0, 1.0, *range(5)])
    place = first.ctypes.data
    del first
    third = joins.join(np.full(2, 7.0), world)
    assert (third.ctypes.data, third.tolist()) == (place, [7.0, 7.0, *range(5)])
    assert joins.join(np.zeros(3), world).tolist() == [0.0, 0.0, 0.0, *range(5)]
    del world
    gc.collect()
    assert not len(joins)


def test_a_block_without_its_world_stays_when_the_whole_is_taken_again(small):
    joins, world = Joins(), np.arange(5.0)
    world.setflags(write=False)
    sizes = np.full(7, len(world))
    head, other = cut_world(joins.join(np.zeros(2), world), sizes)
    assert joins.join(np.full(2, 7.0), world).tolist() == [7.0, 7.0, *range(5)]
    assert (head.tolist(), other[module.SIZE]) == ([0.0, 0.0], 0)


def test_what_may_be_written_to_and_small_worlds_are_copied(small):
    joins = Joins()
    assert joins.join(np.zeros(1), np.ones(3)).tolist() == [0.0, 1.0, 1.0, 1.0]
    assert joins.join(np.zeros(1), np.ones(9)).tolist() == [0.0, *[1.0] * 9]
    assert not len(joins)


@pytest.mark.parametrize("has_world", [False, True])
def test_blocks_are_those_that_are_laid_out_as_a_whole(has_world):
    obstacles = {"can": {"sphere": {"radius": 0.05}, "position": [2, 0, 0.5]}} if has_world else {}
    collision = CollisionModel.of(ROBOT, ikde.load_world({"obstacles": obstacles}))
    assert not is_large(collision.arrays)
    problem = make_problem(ROBOT, ikde.SolveSettings(), collision=collision, near=None, freeze=None)
    settings = make_ranges(problem), make_descent(problem, "position"), make_seeds(problem, "position")
    expected = flatten_search(*pack_searched(problem.collision), *settings)
    for found, part in zip(pack_block(problem, "position"), expected, strict=True):
        np.testing.assert_array_equal(found, part)
    terms = make_terms(problem)
    whole = flatten_grader(pack_robot(ROBOT), problem.collision.arrays, terms)
    for found, part in zip(pack_grader(problem.collision, problem.settings), whole, strict=True):
        np.testing.assert_array_equal(found, part)
    alone = flatten_grader(pack_robot(ROBOT), without_world(problem.collision.arrays), terms)
    for found, part in zip(cut_world(*whole), alone, strict=True):
        np.testing.assert_array_equal(found, part)


def make_terms(problem):
    settings, robot = problem.settings, problem.robot
    tolerances = settings.position_tolerance_m, settings.orientation_tolerance_rad
    return Terms(np.array((robot.lower, robot.upper)), *map(float, tolerances))

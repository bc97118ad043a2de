"""What is laid end to end comes apart as it was."""

import sys

import numpy as np
import pytest

from ikde.kernels.arrays import DescentArrays
from ikde.kernels.flat_arguments import (
    flatten_closed_form,
    flatten_grader,
    flatten_search,
    unpack_closed_form,
    unpack_grader,
    unpack_search,
)
from ikde.kernels.tables import unpack_used
from ikde.model.closed_form import find_ur_arm, pack_ur_arm
from ikde.model.collision_model import CollisionModel
from ikde.model.pack import pack_robot
from tests.conftest import random_q
from tests.kernels.grading import ROBOTS, terms_of
from tests.kernels.seeding import no_seeds, pack_seeds


def assert_same(ours, theirs):
    assert type(ours) is type(theirs)
    for name, a, b in zip(ours._fields, ours, theirs, strict=True):
        assert np.shape(a) == np.shape(b), name
        assert np.array_equal(a, b), name
        assert np.asarray(a).dtype == np.asarray(b).dtype, name


@pytest.mark.parametrize("robot", ROBOTS[::3], ids=lambda robot: robot.name)
def test_the_graders_tables_come_back(robot):
    for detector in (None, *robot.detectors.values()):
        packed = pack_robot(robot), CollisionModel(robot=robot, detector=detector).arrays, terms_of(robot, 0.25, 0.5)
        for ours, theirs in zip(packed, unpack_grader(*flatten_grader(*packed)), strict=True):
            assert_same(ours, theirs)


def test_the_search_comes_back(qiao, rng):
    ranges = np.array([qiao.lower, qiao.upper, qiao.home])
    descent = DescentArrays(position_tolerance=0.25, orientation_tolerance=0.5, most_steps=7, patience=3)
    for seeds in (pack_seeds(qiao, random_q(qiao, rng, 100), np.array([0, 1, 2])), no_seeds(qiao, 0.125)):
        for choice in (None, "none"):
            packed = (pack_robot(qiao), CollisionModel.of(qiao, choice).arrays, descent, seeds)
            numbers, whole, *pool = flatten_search(*packed[:2], ranges, *packed[2:])
            robot, collision = unpack_used(numbers, whole)
            back, *others = unpack_search(numbers, whole, *pool)
            assert numbers[0] == collision.safe_distance
            assert numbers.flags.writeable  # as all that is laid end to end: numba compiles each way of it anew
            assert whole.flags.writeable
            assert (back == ranges).all()
            for ours, theirs in zip(packed, (robot, collision, *others), strict=True):
                assert_same(ours, theirs)


@pytest.mark.parametrize("carrier", [0, 3])
def test_the_closed_form_comes_back(qiao, carrier):
    arm, ranges = pack_ur_arm(find_ur_arm(qiao), np.arange(9.0)), np.array([qiao.lower, qiao.upper, qiao.home])
    models = pack_robot(qiao), CollisionModel.of(qiao).arrays
    numbers, whole = flatten_closed_form(*models, ranges, arm, carrier)
    back, own, body = unpack_closed_form(numbers, whole)
    assert (back == ranges).all()
    assert body == carrier
    assert own.angles[2].tolist() == [3.0, 4.0, 5.0, 6.0, 7.0, 8.0]
    for ours, theirs in zip((*models, arm), (*unpack_used(numbers, whole), own), strict=True):
        assert_same(ours, theirs)


def test_what_is_unpacked_often_is_still_there(qiao):
    """Views that are not counted would free the blocks under them."""
    models, ranges = (pack_robot(qiao), CollisionModel.of(qiao).arrays), np.array([qiao.lower, qiao.upper, qiao.home])
    search = flatten_search(*models, ranges, DescentArrays(), no_seeds(qiao, 0.125))
    grader = flatten_grader(*models, terms_of(qiao, 0.25, 0.5))
    before = [sys.getrefcount(block) for block in (*search, *grader)]
    for _ in range(100):
        unpack_search(*search)
        unpack_used(*search[:2])
        unpack_grader(*grader)
    assert [sys.getrefcount(block) for block in (*search, *grader)] == before
    assert_same(models[0], unpack_used(*search[:2])[0])
    assert_same(models[1], unpack_grader(*grader)[1])

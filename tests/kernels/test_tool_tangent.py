"""The split of small motions against numpy, and the bend of the target against differences."""

import numpy as np
import pytest

from ikde.kernels import motion_work, tool_tangent
from ikde.kernels.motion_work import ALONG, BEND, ERROR, MULTIPLIER, NULL
from ikde.model.collision_model import CollisionModel
from ikde.model.pack import pack_robot, pack_targets
from tests import reference
from tests.conftest import random_q
from tests.kernels.optimum import miss, slope
from tests.targets import make_target
from tests.uncompiled import plain_module

kernels, rooms = plain_module(tool_tangent), plain_module(motion_work)
LENGTH = 0.3  # m/rad
ROWS = {"position": 3, "axis": 5, "pose": 6}


def split_at(robot, target, q, weight):
    """Tables, weighed Jacobian over the joints that move, rank, rows and counts at `q`."""
    arrays, packed = pack_robot(robot), pack_targets([target])
    tables = rooms.make_motion_work(arrays, CollisionModel.of(robot, "none").arrays, len(q)).tables
    count, carrying = kernels.list_moving(arrays, np.array([robot.lower, robot.upper]), tables)
    kernels.place_tool(arrays, packed, 0, LENGTH, q, tables)
    used = kernels.fill_rows(arrays, packed.kind[0], LENGTH, weight, count, tables)
    first = motion_work.ROWS
    jacobian = tables.vectors[first : first + used, :count].copy()
    return tables, jacobian, kernels.split(tables, used, count), used, (count, carrying)


@pytest.mark.parametrize("kind", ROWS)
def test_the_null_space_leaves_the_tool_and_the_rest_brings_it(any_robot, kind, rng):
    weight = rng.uniform(0.2, 2.0, len(any_robot.joints))
    q = random_q(any_robot, rng)
    target = make_target(any_robot, q + 1e-3 * rng.standard_normal(len(q)), kind)
    tables, jacobian, rank, used, (count, _) = split_at(any_robot, target, q, weight)
    assert (rank, used) == (np.linalg.matrix_rank(jacobian, tol=1e-9), ROWS[kind])
    kernels.fill_null(tables, rank, count)
    null = tables.matrices[NULL, : count - rank, :count]
    np.testing.assert_allclose(null @ null.T, np.eye(count - rank), atol=1e-12)
    np.testing.assert_allclose(null @ jacobian.T, 0.0, atol=1e-12 * np.abs(jacobian).max())
    along = tables.vectors[ALONG]
    kernels.solve_along(tables, rank, along)
    along[rank:] = 0.0
    kernels.apply(tables, rank, count, along)
    np.testing.assert_allclose(null @ along[:count], 0.0, atol=1e-12)
    np.testing.assert_allclose(jacobian @ along[:count], tables.numbers[ERROR, :used], atol=1e-6)
    y = rng.standard_normal(count)
    turned = y.copy()
    kernels.apply_transposed(tables, rank, count, turned)
    kernels.set_multipliers(tables, rank, used, turned)
    expected = np.linalg.lstsq(jacobian.T, y, rcond=None)[0]
    np.testing.assert_allclose(jacobian.T @ tables.numbers[MULTIPLIER, :used], jacobian.T @ expected, atol=1e-8)


@pytest.mark.parametrize("kind", ["position", "pose"])
def test_the_bend_is_the_second_derivative_of_what_the_tool_misses(any_robot, kind, rng):
    size = len(any_robot.joints)
    q, weight = random_q(any_robot, rng), rng.uniform(0.5, 2.0, size)
    target = make_target(any_robot, q, kind)
    tables, _, _, used, (_, carrying) = split_at(any_robot, target, q, weight)
    multipliers = rng.standard_normal(6)
    tables.numbers[MULTIPLIER, :6] = multipliers
    kernels.fill_bend(pack_targets([target]).kind[0], LENGTH, weight, carrying, tables)
    scaled = multipliers[:used] * np.array([1.0] * 3 + [LENGTH] * (used - 3))
    hessian = slope(lambda x: scaled @ slope(lambda z: miss(any_robot, target, z), x), q)
    moving = tables.whole[0, :carrying]
    expected = hessian[np.ix_(moving, moving)] / np.outer(weight[moving], weight[moving])
    np.testing.assert_allclose(tables.matrices[BEND, :carrying, :carrying], expected, atol=2e-3)


def test_of_an_axis_the_bend_is_that_of_the_axis(qiao, rng):
    q, weight = random_q(qiao, rng), np.ones(9)
    target = make_target(qiao, q, "axis")
    tables, _, _, _, (_, carrying) = split_at(qiao, target, q, weight)
    T = tables.T_world_tool.copy()
    multipliers = rng.standard_normal(5)
    tables.numbers[MULTIPLIER, :5] = multipliers
    kernels.fill_bend(pack_targets([target]).kind[0], LENGTH, weight, carrying, tables)

    def turned(x):  # about the tool's x the axis goes to -y, about its y to x
        R = reference.compute_frames(qiao, x)[qiao.tool]
        about = LENGTH * np.array([-T[:, 1] @ R[:3, 2], T[:, 0] @ R[:3, 2]])
        return np.array([multipliers @ np.concatenate([R[:3, 3], about])])

    hessian = slope(lambda x: slope(turned, x)[0], q)
    moving = tables.whole[0, :carrying]
    np.testing.assert_allclose(tables.matrices[BEND, :carrying, :carrying], hessian[np.ix_(moving, moving)], atol=2e-3)

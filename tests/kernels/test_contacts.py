"""Contacts and their gradients against naive twins, and the laws of a damped step with them."""

import math

import numpy as np
import pytest

from ikde.kernels.arrays import DescentArrays
from ikde.kernels.contacts import MAX_CONTACTS, add_contacts, find_contacts, make_contacts, take_clear_step
from ikde.kernels.damped import compute_error, make_descent_workspace, take_step
from ikde.kernels.frames import compute_bodies, compute_tool
from ikde.kernels.spheres import compute_bounds, compute_centres
from ikde.model.collision_model import CollisionModel
from ikde.model.pack import pack_robot, pack_targets
from ikde.model.target import Target
from tests import reference
from tests.conftest import random_q
from tests.random_robots import random_robot

FAR = 10.0  # m: every pair is nearer


class Placed:
    """A robot at `q`: packed, with all buffers filled."""

    def __init__(self, robot, q, target=None, rows=6 + MAX_CONTACTS):
        self.robot, self.q = robot, np.array(q)
        self.detector = CollisionModel.of(robot).detector
        self.arrays, self.spheres = pack_robot(robot), CollisionModel(robot=robot, detector=self.detector).arrays
        self.work = make_descent_workspace(self.arrays, len(q), rows)
        bounds = np.empty((self.spheres.components.shape[0], 3))
        self.contacts = make_contacts(bounds, np.empty((3, self.spheres.radius.size)), rows)
        self.target = pack_targets([target or Target((0.0, 0.0, 0.0))])
        self.place()

    def place(self):
        compute_bodies(self.arrays, self.q, self.work.T_world_body)
        compute_tool(self.arrays, self.work.T_world_body, self.work.T_world_tool)
        compute_bounds(self.spheres, self.work.T_world_body, self.contacts.bounds)
        compute_centres(self.spheres, self.work.T_world_body, self.contacts.centres)
        return compute_error(self.target, 0, 0.5, self.work.T_world_tool, self.work.error)

    def add_contacts(self, reach):
        rows = add_contacts(self.arrays, self.spheres, reach, 3, self.contacts, self.work)
        return self.work.error[3:rows], self.work.jacobian[3:rows]

    def step(self, reach):
        ranges = np.array([self.robot.lower, self.robot.upper])
        arguments = (self.arrays, self.spheres, self.target, 0, ranges, DescentArrays(), reach)
        square = take_clear_step(*arguments, self.contacts, self.q, self.work)
        return square, self.place()


def clearances(robot, q):
    detector = CollisionModel.of(robot).detector
    return reference.compute_pair_clearances(
        reference.list_spheres(robot, detector, q), robot.pair_lists[detector.pairs]
    )


def differentiate(robot, q, pair, step=1e-6):
    """Central differences of one pair's clearance."""
    units = step * np.eye(len(q))
    return np.array([(clearances(robot, q + u)[pair] - clearances(robot, q - u)[pair]) / (2.0 * step) for u in units])


@pytest.mark.parametrize("seed", range(12))
@pytest.mark.parametrize("room", [1, 3, 60])
def test_contacts_are_the_nearest_pairs_with_their_spheres(seed, room, rng):
    robot = random_robot(seed)
    placed = Placed(robot, random_q(robot, rng), rows=60)
    gaps = clearances(robot, placed.q)
    for reach in (gaps.mean(), FAR):
        count = find_contacts(placed.spheres, reach, room, placed.contacts)
        found, (pairs, i, j) = placed.contacts.gap[:count], placed.contacts.spheres[:count].T
        near = np.argsort(gaps)[: min(room, (gaps < reach).sum())]
        assert sorted(pairs.tolist()) == sorted(near.tolist())
        np.testing.assert_allclose(found, gaps[pairs], rtol=0, atol=1e-13)
        centres, radius = placed.contacts.centres, placed.spheres.radius
        apart = np.linalg.norm(centres[:, i] - centres[:, j], axis=0)
        np.testing.assert_allclose(found, apart - radius[i] - radius[j], rtol=0, atol=1e-13)


@pytest.mark.parametrize("seed", range(12))
def test_contact_rows_are_gradients(seed, rng):
    robot = random_robot(seed)
    q = random_q(robot, rng)
    errors, rows = Placed(robot, q, rows=60).add_contacts(FAR)
    gaps = clearances(robot, q)
    assert len(rows) == len(gaps)
    np.testing.assert_allclose(errors, FAR - gaps, rtol=0, atol=1e-12)
    for pair, row in enumerate(rows):
        np.testing.assert_allclose(row, differentiate(robot, q, pair), rtol=0, atol=1e-6)


def test_only_pairs_within_reach_and_the_deepest_of_many_are_kept(qiao, rng):
    for q in random_q(qiao, rng, 20):
        gaps = clearances(qiao, q)
        for reach in (0.0, 0.05, FAR):
            errors, _ = Placed(qiao, q).add_contacts(reach)
            room = 3 + MAX_CONTACTS  # rows that a position target leaves to contacts
            deepest = np.sort(reach - gaps[gaps < reach])[::-1][:room]
            np.testing.assert_allclose(np.sort(errors)[::-1], deepest, rtol=0, atol=1e-12)


def test_without_a_reach_it_is_the_tools_step(qiao, rng):
    T = reference.compute_frames(qiao, random_q(qiao, rng))[qiao.tool]
    target = Target(T[:3, 3], R_world_tool=T[:3, :3])
    placed = Placed(qiao, random_q(qiao, rng), target)
    q, work = placed.q.copy(), make_descent_workspace(placed.arrays, 9, 6)
    ranges = np.array([qiao.lower, qiao.upper])
    for _ in range(5):
        take_step(placed.arrays, placed.target, 0, ranges, DescentArrays(), q, work)
        placed.step(-math.inf)
        assert placed.q.tobytes() == q.tobytes()


def test_contacts_are_pushed_apart_while_the_tool_stays(qiao, rng):
    cleared = total = 0
    for q in random_q(qiao, rng, 60):
        depth = -clearances(qiao, q).min()
        if not 0.0 < depth < 0.02:
            continue
        T = reference.compute_frames(qiao, q)[qiao.tool]
        placed = Placed(qiao, q, Target(T[:3, 3], R_world_tool=T[:3, :3]))
        for _ in range(20):
            _, errors = placed.step(1e-5)
        total += 1
        cleared += max(errors) < 1e-5 and clearances(qiao, placed.q).min() > 0.0
        assert np.all((qiao.lower <= placed.q) & (placed.q <= qiao.upper))
    assert total >= 3
    assert cleared >= 0.7 * total


def test_it_returns_the_squared_error_before_the_step(qiao, rng):
    q = random_q(qiao, rng)
    placed = Placed(qiao, q, Target((0.5, 0.5, 0.5)))
    gaps = clearances(qiao, q)
    away = reference.compute_frames(qiao, q)[qiao.tool][:3, 3] - 0.5
    expected = away @ away + np.sum(np.maximum(0.0, 0.05 - gaps) ** 2)
    assert np.sum(gaps < 0.05) <= MAX_CONTACTS + 3
    assert placed.step(0.05)[0] == pytest.approx(expected, rel=1e-12)

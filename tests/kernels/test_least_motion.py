"""A descent to the least motion: a local minimum by scipy and by its conditions, and never a worse answer."""

from dataclasses import replace

import numpy as np
import pytest

import ikde
from ikde.kernels import least_motion, turns
from ikde.model.collision_model import CollisionModel
from ikde.model.pack import pack_targets
from ikde.model.target import Targets
from ikde.solver.engines.engine import make_descent, make_ranges
from ikde.solver.engines.stay_near import pack_walk
from ikde.solver.problem import pack_searched
from tests.conftest import random_q
from tests.kernels.optimum import find_optimum, motion, residual, room
from tests.problems import problem_of
from tests.random_robots import random_robot, with_ranges
from tests.targets import free_q, make_target
from tests.uncompiled import plain_module, quietly

KINDS = ("position", "axis", "pose")
kernels = plain_module(least_motion)


def reduce_motion(problem, target, q, run=kernels.reduce_motion):
    """Where the descent ends that begins at `q`."""
    end = np.array(q)
    arrays = make_ranges(problem), make_descent(problem, target.kind), problem.weights
    with quietly():
        run(*pack_searched(problem.collision), pack_targets([target]), 0, *arrays, end)
    return end


def beside(robot, q, rng, angle_rad):
    """Joint values about so far from `q` in each joint, inside the limits."""
    return np.clip(q + angle_rad * rng.standard_normal(len(q)), robot.lower, robot.upper)


def make_case(robot, kind, rng, angle_rad=0.3, collision="none", **options):
    """A problem with `near`, a target that is about so far from it, and an answer between the two."""
    near = free_q(robot, rng)
    q = beside(robot, near, rng, angle_rad)
    return problem_of(robot, collision=collision, near=near, **options), make_target(robot, q, kind), q


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("angle_rad", [0.1, 0.6])
def test_shipped_robots_end_where_scipy_finds_nothing_nearer(any_robot, kind, angle_rad, rng):
    for _ in range(3):
        problem, target, q = make_case(any_robot, kind, rng, angle_rad)
        end = reduce_motion(problem, target, q)
        moved, before = (motion(problem.weights, problem.near, x) for x in (end, q))
        assert ikde.verify(any_robot, target, end, collision="none").accepted
        assert moved <= before
        assert moved <= find_optimum(problem, target, end) * (1.0 + 1e-4) + 2e-5


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("seed", range(20))
def test_random_robots_meet_the_conditions_of_a_minimum(seed, kind, rng):
    robot = random_robot(seed)
    near = random_q(robot, rng)
    q = beside(robot, near, rng, 0.4)
    problem, target = problem_of(robot, collision="none", near=near), make_target(robot, q, kind)
    end = reduce_motion(problem, target, q)
    assert ikde.verify(robot, target, end, collision="none").accepted
    if np.array_equal(end, q):  # nothing but the tolerances is left to win
        assert motion(problem.weights, near, q) <= find_optimum(problem, target, q) * (1.0 + 1e-4) + 1e-4
    else:
        assert residual(problem, target, end) < 2e-3


@pytest.mark.parametrize("kind", KINDS)
def test_joint_ranges_hold_and_are_used_to_their_ends(qiao, kind, rng):
    active = 0
    for _ in range(6):
        near, ends = free_q(qiao, rng), 0.15 + 0.1 * rng.uniform(size=9)
        q = near + ends * rng.uniform(-1.0, 1.0, 9)
        robot = with_ranges(qiao, {n: (a - e, a + e) for n, a, e in zip(qiao.joint_names, near, ends, strict=True)})
        problem, target = problem_of(robot, collision="none", near=near), make_target(qiao, q, kind)
        end = reduce_motion(problem, target, q)
        assert ikde.verify(robot, target, end, collision="none").accepted
        assert residual(problem, target, end) < 1e-3
        active += np.count_nonzero((end == robot.lower) | (end == robot.upper))
    assert active


@pytest.mark.parametrize("kind", KINDS)
def test_what_collides_on_its_way_slides_along_the_contact(qiao, kind, rng):
    collision, touching, left = CollisionModel.of(qiao), 0, []
    for _ in range(25):
        q = free_q(qiao, rng)
        near, target = beside(qiao, q, rng, 0.5), make_target(qiao, q, kind)
        problem = problem_of(qiao, near=near)
        end = reduce_motion(problem, target, q)
        assert ikde.verify(qiao, target, end).accepted
        assert motion(problem.weights, near, end) <= motion(problem.weights, near, q)
        if room(collision, end).min() < 1e-6:
            touching += 1
            left.append(residual(problem, target, end, collision))
    assert touching >= 2
    assert np.median(left) < 1e-3


@pytest.mark.parametrize("kind", KINDS)
def test_near_itself_is_the_answer_to_the_bit(any_robot, kind, rng):
    near = free_q(any_robot, rng)
    target = make_target(any_robot, near, kind)
    problem = problem_of(any_robot, near=near)
    assert reduce_motion(problem, target, any_robot.home).tobytes() == near.tobytes()


def test_near_is_no_answer_if_it_collides(qiao, rng):
    usual, one = CollisionModel.of(qiao), free_q(qiao, rng)
    target, gap = make_target(qiao, one, "position"), 0.0
    while gap < 1e-3:  # two answers, of which a larger safe distance makes one collide
        far = problem_of(qiao, near=beside(qiao, one, rng, 0.8))
        near, q = sorted([one, reduce_motion(far, target, one)], key=lambda x: room(usual, x).min())
        gap = room(usual, q).min() - room(usual, near).min()
    limit = usual.limit_m + room(usual, near).min() + 0.5 * gap
    strict = CollisionModel(robot=qiao, detector=replace(usual.detector, safe_distance_m=limit))
    problem = problem_of(qiao, near=near, collision=strict)
    end = reduce_motion(problem, target, q)
    assert ikde.verify(qiao, target, end, collision=strict).accepted
    assert 0.0 < motion(problem.weights, near, end) <= motion(problem.weights, near, q)
    assert reduce_motion(problem_of(qiao, near=near), target, q).tobytes() == near.tobytes()


@pytest.mark.parametrize("kind", ["position", "axis"])
def test_a_joint_that_the_target_does_not_depend_on_goes_back_to_near(any_robot, kind, rng):
    last = len(any_robot.joints) - 1
    problem, target, q = make_case(any_robot, kind, rng)
    q[last] = 0.5 * (any_robot.lower[last] + any_robot.upper[last])
    assert ikde.verify(any_robot, target, q, collision="none").accepted
    end = reduce_motion(problem, target, q)
    assert abs(end[last] - problem.near[last]) < 1e-9


@pytest.mark.parametrize("kind", KINDS)
def test_frozen_joints_stay_to_the_bit(qiao, kind, rng):
    near = free_q(qiao, rng)
    q = beside(qiao, near, rng, 0.3)
    frozen = {name: float(q[qiao.joint_names.index(name)]) for name in ("d_y", "q2")}
    problem = problem_of(qiao, near=near, freeze=frozen, collision="none")
    end = reduce_motion(problem, make_target(qiao, q, kind), q)
    assert {name: end[qiao.joint_names.index(name)] for name in frozen} == frozen
    assert motion(problem.weights, problem.near, end) < motion(problem.weights, problem.near, q)


def test_with_all_joints_frozen_it_stays(qiao, rng):
    near = free_q(qiao, rng)
    frozen = dict(zip(qiao.joint_names, near.tolist(), strict=True))
    problem = problem_of(qiao, near=near, freeze=frozen, collision="none")
    assert reduce_motion(problem, make_target(qiao, near, "pose"), near).tobytes() == near.tobytes()


@pytest.mark.parametrize("kind", KINDS)
def test_a_second_descent_finds_nothing_more(qiao, kind, rng):
    problem, target, q = make_case(qiao, kind, rng)
    once = reduce_motion(problem, target, q)
    twice = reduce_motion(problem, target, once)
    first, second = (motion(problem.weights, problem.near, x) for x in (once, twice))
    assert first * (1.0 - 1e-4) <= second <= first


def test_a_walk_that_is_cut_short_returns_to_its_target(qiao, rng, monkeypatch):
    steps = {"MAX_STEPS": 5, "RETURNING": 3}
    for name, count in steps.items():
        monkeypatch.setitem(kernels.reduce_motion.__globals__, name, count)
    shares = []
    for _ in range(8):
        problem, target, q = make_case(qiao, "pose", rng, angle_rad=1.0)
        end = reduce_motion(problem, target, q)
        shares.append(motion(problem.weights, problem.near, end) / motion(problem.weights, problem.near, q))
    assert np.count_nonzero(np.array(shares) < 0.99) >= 6


def test_heavy_joints_stand_and_light_ones_move(qiao, rng):
    near = free_q(qiao, rng)
    q = beside(qiao, near, rng, 0.3)
    target = make_target(qiao, q, "position")
    shares = {}
    for name, weights in {"base": {"d_x": 1e-3, "d_y": 1e-3}, "arm": {"d_x": 1e3, "d_y": 1e3}}.items():
        problem = problem_of(qiao, near=near, collision="none", weights=weights)
        end = reduce_motion(problem, target, q)
        assert residual(problem, target, end) < 1e-3
        shares[name] = np.linalg.norm((end - near)[:2])
    assert shares["arm"] < 1e-3 < shares["base"]


def test_rows_are_those_of_one_by_one(qiao, rng):
    near = free_q(qiao, rng)
    Q = np.array([beside(qiao, near, rng, 0.2) for _ in range(4)])
    targets = [make_target(qiao, q, "axis") for q in Q]
    problem, end = problem_of(qiao, near=near), Q.copy()
    rows = np.array([3, 1])
    with quietly():
        kernels.reduce_motions(*pack_walk(problem, "axis"), *pack_targets(Targets.of(targets)), rows, end)
    for row, (q, target) in enumerate(zip(Q, targets, strict=True)):
        expected = reduce_motion(problem, target, q) if row in rows else q
        assert end[row].tobytes() == expected.tobytes()


def test_no_joint_ends_where_a_full_turn_brings_it_nearer(rng):
    """A joint that weighs little may be moved beyond half a turn: it is turned back, and the descent begins again."""
    robot, turned = ikde.load_robot("ur5"), 0
    for _ in range(40):
        near, q = random_q(robot, rng), random_q(robot, rng)
        light = dict(zip(robot.joint_names, 10.0 ** rng.uniform(-2.0, 2.0, 6), strict=True))
        problem, target = (
            problem_of(robot, collision="none", near=near, weights=light),
            make_target(robot, q, "position"),
        )
        begin, (lower, upper, turning, centre) = q.copy(), problem.turns
        turns.unwind.py_func(lower, upper, turning, centre, begin)
        end = reduce_motion(problem, target, begin)
        assert ikde.verify(robot, target, end, collision="none").accepted
        assert motion(problem.weights, near, end) <= motion(problem.weights, near, begin)
        again = end.copy()
        turns.unwind.py_func(lower, upper, turning, centre, again)
        assert again.tobytes() == end.tobytes()
        turned += bool((np.abs(end - begin) > np.pi).any())
    assert turned > 0

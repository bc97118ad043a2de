"""Tests of lattices against spheres: together they are the detector's pairs, and each is written as it is."""

import numpy as np
import pytest

from ikde.kernels.arrays import BODY
from ikde.model.collision_model import CollisionModel
from ikde.model.generate.collision import (
    count_sphere_pairs,
    count_tests,
    find_root,
    group_by_guard,
    list_tests,
    reach_name,
    write_margin,
)
from ikde.model.generate.kinematics import write_bodies
from ikde.model.generate.writer import Writer
from ikde.model.pack import pack_robot
from tests import reference
from tests.collision_robots import CASES, SHIPPED, find_gaps, make_row, name_case, two_arms
from tests.conftest import random_q
from tests.uncompiled import evaluate, joint_names

every_case = pytest.mark.parametrize("case", CASES, ids=name_case)
JUST_SOME = [*SHIPPED, *CASES[len(SHIPPED) : len(SHIPPED) + 6]]
some_cases = pytest.mark.parametrize("case", JUST_SOME, ids=name_case)


def find_distance(T_world_body, test):
    """Smallest distance between centres of a test, m, by numpy."""
    sides = [
        side.centres @ T_world_body[side.body][:3, :3].T + T_world_body[side.body][:3, 3]
        for side in (test.lattice, test.sphere)
    ]
    return np.linalg.norm(sides[0][:, None] - sides[1][None], axis=2).min()


def write(robot, detector):
    """(writer, poses, tests, root) of a robot."""
    arrays, tests, writer = (
        pack_robot(robot),
        list_tests(CollisionModel(robot=robot, detector=detector).arrays),
        Writer(),
    )
    root = find_root(arrays, tests)
    return writer, write_bodies(writer, arrays, root), tests, root


def squared_reaches(tests, safe_distance):
    return {reach_name(test.reach): (test.reach + safe_distance) ** 2 for test in tests}


@every_case
def test_the_tests_of_a_pair_find_its_clearance(case, rng):
    """The smallest distance less reach over a pair's tests is the pair's clearance: nothing is left out."""
    robot, detector = case
    tests, arrays = list_tests(CollisionModel(robot=robot, detector=detector).arrays), pack_robot(robot)
    Q = random_q(robot, rng, 4)
    for q, gaps in zip(Q, find_gaps(robot, detector, Q), strict=True):
        T_world_body = reference.compute_bodies(arrays, q)
        found = np.full(len(gaps), np.inf)
        for test in tests:
            found[test.pair] = min(found[test.pair], find_distance(T_world_body, test) - test.reach)
        np.testing.assert_allclose(found, gaps, rtol=0, atol=1e-12)


@every_case
def test_lattices_save_tests(case):
    tests, packed = (
        list_tests(CollisionModel(robot=case[0], detector=case[1]).arrays),
        CollisionModel(robot=case[0], detector=case[1]).arrays,
    )
    assert len(tests) == count_tests(packed) <= count_sphere_pairs(packed)
    assert [test.number for test in tests] == list(range(len(tests)))
    assert all(len(test.sphere.centres) == 1 for test in tests)


def test_sphere_pairs_are_counted(qiao):
    counts = {
        name: count_sphere_pairs(CollisionModel(robot=qiao, detector=detector).arrays)
        for name, detector in qiao.detectors.items()
    }
    for name, detector in qiao.detectors.items():
        rows, total = qiao.approximations[detector.spheres], 0
        for a, b in CollisionModel(robot=qiao, detector=detector).pairs:
            total += int(np.prod([sum(row.count for row in rows if row.component == c) for c in (a, b)]))
        assert counts[name] == total


@every_case
def test_a_margin_is_squared_distance_less_squared_reach(case, rng):
    robot, detector = case
    writer, poses, tests, root = write(robot, detector)
    margins = [write_margin(writer, poses, test, root) for test in tests]
    for safe_distance, q in zip((0.0, 0.1), random_q(robot, rng, 2), strict=True):
        values = evaluate(writer, margins, **joint_names(q), **squared_reaches(tests, safe_distance))
        T_world_body = reference.compute_bodies(pack_robot(robot), q)
        distances = np.array([find_distance(T_world_body, test) for test in tests])
        reaches = np.array([test.reach for test in tests]) + safe_distance
        np.testing.assert_allclose(values, distances**2 - reaches**2, rtol=0, atol=1e-12)


@every_case
def test_the_root_is_the_last_body_that_carries_all(case):
    robot, detector = case
    arrays, packed = pack_robot(robot), CollisionModel(robot=robot, detector=detector).arrays
    root = find_root(arrays, list_tests(packed))
    carried = {int(packed.components[int(c), BODY]) for pair in packed.pairs for c in pair}

    def carries(body):
        return all(body in chain for chain in chains)

    chains = []
    for body in carried:
        chain = [body]
        while chain[-1] != 0:
            chain.append(int(arrays.bodies[chain[-1], 0]))
        chains.append(chain)
    assert carries(root)
    assert not any(carries(body) for body in range(root + 1, len(arrays.bodies)))


def test_the_base_of_a_mobile_robot_does_not_enter(qiao):
    writer, poses, tests, root = write(qiao, CollisionModel.of(qiao).detector)
    margins = [write_margin(writer, poses, test, root) for test in tests]
    assert root == 3
    names = " ".join(writer.lines(margins, set())).split()
    assert not {"q0", "q1", "q2", "s2", "c2"} & set(names)


def test_nothing_to_test_stands_on_the_world(qiao):
    assert find_root(pack_robot(qiao), []) == 0


@some_cases
def test_a_guard_lets_every_failing_test_through(case, rng):
    """What stands outside the box has no contact, whatever the safe distance; and the box is not the whole world."""
    robot, detector = case
    writer, poses, tests, root = write(robot, detector)
    groups = group_by_guard(writer, poses, tests, root)
    assert sorted(test.number for _, group in groups for test in group) == [test.number for test in tests]
    kept, outside = 0, 0
    for safe_distance, q in zip((0.0, 0.03, 0.5) * 7, random_q(robot, rng, 21), strict=True):
        T_world_body = reference.compute_bodies(pack_robot(robot), q)
        known = joint_names(q)
        for guard, group in groups:
            if guard is None:
                continue
            centre = evaluate(writer, guard.values, **known)
            named = {n: x for n, x in zip(guard.values, centre, strict=True) if isinstance(n, str)}
            inside = eval(guard.condition, {"safe_distance": safe_distance, **named})
            fails = any(find_distance(T_world_body, test) <= test.reach + safe_distance for test in group)
            assert inside or not fails
            kept, outside = kept + fails, outside + (not inside)
    if any(guard is not None for guard, _ in groups):
        assert outside > 0


def test_only_what_stands_still_is_boxed(qiao):
    writer, poses, tests, root = write(qiao, CollisionModel.of(qiao).detector)
    for guard, group in group_by_guard(writer, poses, tests, root):
        stands = {test.lattice.body == root and test.sphere.body != root for test in group}
        assert (guard is not None) in stands
        if guard is not None:
            assert stands == {True}
            assert len({(test.sphere.body, *test.sphere.middle) for test in group}) == 1


def test_names_tell_reaches_apart():
    reaches = [0.1, 0.1000000001, 0.1 + 1e-16, 0.30000000000000004, 0.3, 1.0, 1e-5, 0.00001234]
    names = {reach: reach_name(reach) for reach in reaches}
    assert len(set(names.values())) == len(set(reaches))
    assert all(name.isidentifier() for name in names.values())


@pytest.mark.parametrize("shift", [5e-17, 1e-9, 3e-7])
def test_spheres_almost_in_one_place_have_names_of_their_own(shift, rng):
    """Centres, radii and directions that agree in all the digits that names show."""
    points = {
        "a": ("f0", (0.3, 0.05, 0.1)),
        "b": ("f0", (0.3 + shift, 0.05, 0.1)),
        "c": ("f0", (0.3, 0.05, 0.6)),
        "d": ("f0", (0.3 + 1e3 * shift, 0.05, 0.6)),
    }
    rows = [
        make_row("x", "a", "c", 0.05, 3),
        make_row("y", "b", "d", 0.05 + shift, 3),
        make_row("t", "tool", "tool", 0.05),
        make_row("u", "tool", "f1", 0.05, 4),
    ]
    robot = two_arms(rows, [("x", "t"), ("y", "t"), ("x", "u"), ("u", "y")], points)
    test_a_margin_is_squared_distance_less_squared_reach((robot, CollisionModel.of(robot).detector), rng)

"""The functions of a module, run as plain Python: verdicts against brute force, lanes against one at a time."""

from functools import cache
from typing import NamedTuple

import numpy as np
import pytest

from ikde.kernels.arrays import DescentArrays
from ikde.kernels.flat_arguments import flatten_search
from ikde.kernels.tables import LANES
from ikde.model.collision_model import CollisionModel
from ikde.model.generate import assemble
from ikde.model.generate.assemble import NO_TABLES
from ikde.model.generate.collision import list_tests
from ikde.model.generate.functions import format_find, format_step, format_steps, order_pairs
from ikde.model.generate.proofs import drop_implied, drop_proved
from ikde.model.pack import pack_robot, pack_targets
from tests.collision_robots import (
    CASES,
    RANDOM,
    SHIPPED,
    away_from_contact,
    find_gaps,
    make_row,
    name_case,
    two_arms,
)
from tests.conftest import random_q
from tests.kernels.seeding import no_seeds
from tests.random_robots import random_robot
from tests.targets import make_targets
from tests.uncompiled import quietly, run_text

FEWER = [*SHIPPED, *RANDOM[:8]]
every_case = pytest.mark.parametrize("case", CASES, ids=name_case)
fewer_cases = pytest.mark.parametrize("case", FEWER, ids=name_case)
MARGIN = 0.1  # what proofs allow for here


class Limit(NamedTuple):
    """All that a written check reads of a collision model."""

    safe_distance: float  # m


@cache
def make_checks(robot, detector, margin=MARGIN):
    """`find_collision`, with the tests that a module has."""
    arrays, packed = pack_robot(robot), CollisionModel(robot=robot, detector=detector).arrays
    tests = drop_implied(list_tests(packed))
    if np.isfinite(margin):
        tests = drop_proved(arrays, tests, margin, robot.lower, robot.upper)
    text = format_find(arrays, tests, robot.lower, robot.upper)
    return run_text(f"{NO_TABLES}\n{text}")


@cache
def make_table_checks(robot, detector, _margin=MARGIN):
    """A whole module whose check is written as tables."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(assemble, "MAX_TESTS", -1)
        return run_text(assemble.format_module(CollisionModel(robot=robot, detector=detector), "position"))


def find_pairs(robot, detector, Q, safe_distance, margin=MARGIN, make=make_checks):
    """The generated answer for each row of `Q`."""
    checks, asked = make(robot, detector, margin), (None, Limit(safe_distance))
    if make is make_table_checks:
        packed = CollisionModel(robot=robot, detector=detector).arrays
        asked = pack_robot(robot), packed._replace(safe_distance=safe_distance)
    buffers = checks.make_buffers(*asked, len(robot.joints))
    return np.array([checks.find_collision(*asked, q, buffers) for q in Q.tolist()])


def assert_verdicts(robot, detector, Q, safe_distance, margin=MARGIN, make=make_checks):
    """Brute force says the same, and the pair that is named does collide; returns the verdicts."""
    gaps = find_gaps(robot, detector, Q)
    clear = away_from_contact(gaps, safe_distance)
    Q, gaps = Q[clear], gaps[clear]
    pairs = find_pairs(robot, detector, Q, safe_distance, margin, make)
    collides = (gaps <= safe_distance).any(axis=1)
    np.testing.assert_array_equal(pairs >= 0, collides)
    assert (gaps[collides, pairs[collides]] <= safe_distance).all()
    return collides


@every_case
def test_verdicts_are_those_of_brute_force(case, rng):
    robot, detector = case
    for safe_distance in (0.0, 0.003, 0.05, 0.0999):
        assert_verdicts(robot, detector, random_q(robot, rng, 40), safe_distance)


@every_case
def test_verdicts_in_tables_are_those_of_brute_force(case, rng):
    """And so those of straight-line code, which are the same."""
    robot, detector = case
    for safe_distance in (0.0, 0.05, 0.0999):
        assert_verdicts(robot, detector, random_q(robot, rng, 20), safe_distance, make=make_table_checks)


def test_both_verdicts_occur(rng):
    seen = np.concatenate([assert_verdicts(*case, random_q(case[0], rng, 20), 0.0) for case in FEWER])
    assert 0.1 < seen.mean() < 0.9


@pytest.mark.parametrize("safe_distance", [0.3, 2.0])
@fewer_cases
def test_beyond_the_margins_nothing_is_proved_and_everything_found(case, safe_distance, rng):
    robot, detector = case
    margin = 1.0 if safe_distance < 1.0 else np.inf
    assert_verdicts(robot, detector, random_q(robot, rng, 20), safe_distance, margin)


def test_configurations_at_the_limits_are_judged_like_others(rng):
    for robot, detector in FEWER:
        ends = rng.integers(3, size=(20, len(robot.joints)))
        Q = np.choose(ends, [robot.lower, robot.upper, random_q(robot, rng, 20)])
        assert_verdicts(robot, detector, Q, detector.safe_distance_m)


@pytest.mark.parametrize("counts", [(1, 1), (2, 3), (5, 4), (6, 2)])
@pytest.mark.parametrize("seed", range(4))
def test_rows_and_grids_of_any_count_are_found(seed, counts):
    """Oblique grids and rows against each other, on the move and standing; half of the configurations are close."""
    rng = np.random.default_rng(seed)
    u, v = np.linalg.qr(rng.normal(size=(3, 2)))[0].T
    if seed % 2:
        u, v = np.eye(3)[rng.permutation(3)[:2]]
    middle = np.array([0.15, 0.0, 0.2])
    points = {
        f"{side}{end}{k}": (side, tuple(middle * (side == "world") + 0.1 * along * u + 0.09 * k * v))
        for side in ("world", "f0", "f1")
        for k in (0, 1)
        for end, along in (("a", -1.0), ("b", 1.0))
    }
    rows = [
        make_row(side, f"{side}a{k}", f"{side}b{k}", 0.03, count)
        for side, count in (("world", counts[0]), ("f0", counts[1]), ("f1", 3))
        for k in (0, 1)
    ]
    robot = two_arms(rows, [("world", "f0"), ("f1", "f0"), ("f1", "world")], points, lower=-3.0, upper=3.0)
    for safe_distance in (0.0, 0.02):
        assert_verdicts(robot, CollisionModel.of(robot).detector, random_q(robot, rng, 60), safe_distance)


def test_reaches_that_almost_agree_are_kept_apart():
    """Two radii 0.4 um apart: between their contacts only the larger sphere touches."""
    points = {"a": ("f0", (0.35, 0.0, -0.2)), "b": ("f0", (0.35, 0.0, 0.4))}
    rows = [
        make_row("x", "a", "a", 0.05),
        make_row("y", "b", "b", 0.05 + 4e-7),
        make_row("t", "tool", "tool", 0.05),
    ]
    robot = two_arms(rows, [("x", "t"), ("y", "t")], points, lower=-3.0, upper=3.0)
    detector = CollisionModel.of(robot).detector
    Q = np.column_stack([np.linspace(-0.3, 0.3, 41), np.linspace(-0.1, 0.1, 41)])
    gaps = find_gaps(robot, detector, Q)
    k = int(np.abs(gaps[:, 0]).argmin())
    # A safe distance that brings the contact of x just out of reach, and the larger radius would bring it in.
    assert_verdicts(robot, detector, Q[k : k + 1], gaps[k, 0] - 2e-7, np.inf)
    assert find_pairs(robot, detector, Q[k : k + 1], gaps[k, 0] - 2e-7, np.inf)[0] != 0


def test_without_tests_nothing_collides(qiao):
    arrays = pack_robot(qiao)
    checks = run_text(format_find(arrays, [], qiao.lower, qiao.upper))
    assert checks.find_collision(None, Limit(0.1), qiao.home, None) == -1


def test_every_pair_with_a_test_is_looked_at_once(qiao):
    for detector in qiao.detectors.values():
        tests = list_tests(CollisionModel(robot=qiao, detector=detector).arrays)
        order = order_pairs(pack_robot(qiao), tests, qiao.lower, qiao.upper)
        assert sorted(order) == sorted({test.pair for test in tests})


def test_likely_pairs_come_first(qiao, rng):
    """Fewer tests are looked at than in the order of the detector, on the average over colliding configurations."""
    detector = CollisionModel.of(qiao).detector
    tests = drop_implied(list_tests(CollisionModel(robot=qiao, detector=detector).arrays))
    order = order_pairs(pack_robot(qiao), tests, qiao.lower, qiao.upper)
    hits = find_gaps(qiao, detector, random_q(qiao, rng, 400)) <= 0.0
    hits = hits[hits.any(axis=1)]
    cost = np.bincount([test.pair for test in tests], minlength=hits.shape[1])

    def work(pairs):
        return np.mean([cost[pairs][: 1 + int(np.argmax(row[pairs]))].sum() for row in hits if row[pairs].any()])

    assert work(order) < 0.6 * work(sorted(order))


@pytest.mark.parametrize("kind", ["position", "axis", "pose"])
@pytest.mark.parametrize("seed", range(4))
def test_lanes_step_as_one_at_a_time(seed, kind, rng):
    """The same bits in every lane, met or not; lanes without a target may hold anything."""
    robot, descent = random_robot(seed), DescentArrays(position_tolerance=0.3, orientation_tolerance=0.5)
    arrays, ranges = pack_robot(robot), np.array([robot.lower, robot.upper])
    texts = format_step(arrays, kind), format_steps(arrays, kind)
    functions = run_text("".join(texts))
    packed = pack_targets(make_targets(robot, random_q(robot, rng, LANES), kind))
    Q = random_q(robot, rng, LANES)
    q, T, errors = Q.T.ravel().copy(), packed.T_world_tool.reshape(LANES, 12).T.ravel().copy(), np.zeros(2 * LANES)
    row = np.arange(LANES)
    row[-1], q[LANES - 1 :: LANES] = -1, np.nan
    with quietly():
        functions.take_steps(0, packed, row, ranges, descent, q, T, errors, np.zeros(len(robot.joints)), 0)
        met = 0
        for lane in range(LANES - 1):
            after = Q[lane].copy()
            one = functions.take_step(0, packed, lane, ranges, descent, after, 0)
            assert errors[lane::LANES].tolist() == [float(error) for error in one]
            assert q[lane::LANES].tobytes() == after.tobytes()
            met += after.tobytes() == Q[lane].tobytes()
    assert met < LANES - 1


def test_straight_line_code_takes_the_safe_distance_of_both_models(qiao):
    """By name in bulk, from the front of the block for one target."""
    module = run_text(f"from ikde.kernels.arrays import SafeDistance\n\n\n{NO_TABLES}")
    models = pack_robot(qiao), CollisionModel.of(qiao).arrays._replace(safe_distance=0.25)
    block = flatten_search(*models, np.zeros((3, 9)), DescentArrays(), no_seeds(qiao, 0.125))
    assert module.use_models(*models)[1].safe_distance == module.unpack_used(*block[:2])[1].safe_distance == 0.25

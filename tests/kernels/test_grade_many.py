"""The grader in lanes: the bits of the scalar kernels on every robot, however many configurations; wide registers."""

import re

import numba
import numpy as np
import pytest

from ikde.kernels import grade_many as module
from ikde.kernels.clearance import compute_clearance
from ikde.kernels.flat_arguments import flatten_grader
from ikde.kernels.grade_many import LANES, grade_many
from ikde.kernels.grade_one import grade_one
from ikde.kernels.pose_error import compute_orientation_error, compute_position_error
from ikde.model.collision_model import CollisionModel
from ikde.model.pack import pack_robot, pack_targets
from ikde.model.target import Targets
from tests.conftest import random_q
from tests.kernels.arrays import run_bodies, run_spheres, run_tool
from tests.kernels.grading import ROBOTS, grade, terms_of
from tests.targets import targets_near

every_robot = pytest.mark.parametrize("robot", ROBOTS, ids=lambda robot: robot.name)


def run_scalar(robot, detector, targets, Q):
    """The same figures and pairs by the kernels that search."""
    packed, figures, pairs = pack_targets(targets), [], []
    for row, q in enumerate(Q):
        T_world_tool = run_tool(robot, run_bodies(robot, q))
        clearance, pair = np.inf, -1
        if detector is not None:
            arrays, centres, bounds = run_spheres(robot, detector, q)
            clearance, pair = compute_clearance(arrays, bounds, centres)
        errors = (f(packed, row, T_world_tool) for f in (compute_position_error, compute_orientation_error))
        figures.append([*errors, clearance])
        pairs.append(pair)
    return np.array(figures), np.array(pairs)


@every_robot
def test_the_bits_are_those_of_the_scalar_kernels(robot, rng):
    Q = random_q(robot, rng, 2 * LANES + 7)
    Q[3], Q[4] = 0.0, robot.upper
    targets = targets_near(robot, Q, rng)
    for detector in (None, *robot.detectors.values()):
        figures, pairs, _ = grade(robot, detector, targets, Q)
        expected, expected_pairs = run_scalar(robot, detector, targets, Q)
        assert figures.tobytes() == expected.tobytes()
        np.testing.assert_array_equal(pairs, expected_pairs)


@pytest.mark.parametrize("count", [0, 1, 2, 3, LANES - 1, LANES, LANES + 1, 3 * LANES])
def test_a_configuration_does_not_hang_on_its_neighbours(qiao, rng, count):
    Q = random_q(qiao, rng, 3 * LANES)
    targets, detector = targets_near(qiao, Q, rng), CollisionModel.of(qiao).detector
    whole, piece = grade(qiao, detector, targets, Q), grade(qiao, detector, targets[:count], Q[:count])
    for every, some in zip(whole, piece, strict=True):
        assert some.tobytes() == every[:count].tobytes()


def test_accepted_means_within_tolerances_and_limits_and_free(qiao, rng):
    Q = random_q(qiao, rng, 400)
    Q[::3, 2] = qiao.upper[2] + 1e-15 * np.arange(134)
    Q[5] = np.nan
    targets, detector = targets_near(qiao, Q[:5].repeat(80, axis=0), rng), CollisionModel.of(qiao).detector
    figures, _, _ = grade(qiao, detector, targets, Q)
    position, orientation = np.nanmedian(figures[:, 0]), np.nanmedian(figures[:, 1])
    _, _, accepted = grade(qiao, detector, targets, Q, terms_of(qiao, position, orientation))
    within = (figures[:, 0] <= position) & (figures[:, 1] <= orientation)
    inside = ((qiao.lower <= Q) & (qiao.upper >= Q)).all(axis=1)
    expected = within & inside & (figures[:, 2] > detector.safe_distance_m)
    np.testing.assert_array_equal(accepted, expected)
    assert 0 < accepted.sum() < 400
    assert not accepted[5]


def test_at_the_safe_distance_or_the_tolerance_itself_counts(qiao):
    q, targets = qiao.home[None], Targets(np.zeros((1, 3)))
    (position, _, clearance), *_ = grade(qiao, CollisionModel.of(qiao).detector, targets, q)[0]
    detector = CollisionModel(robot=qiao, detector=CollisionModel.of(qiao).detector).arrays
    for safe_distance, tolerance, expected in (
        (clearance, position, False),
        (np.nextafter(clearance, 0.0), position, True),
        (np.nextafter(clearance, 0.0), np.nextafter(position, 0.0), False),
    ):
        nearest = detector._replace(safe_distance=float(safe_distance))
        block = flatten_grader(pack_robot(qiao), nearest, terms_of(qiao, float(tolerance)))
        accepted = np.zeros(1, dtype=np.bool_)
        out = (np.empty((1, 3)), np.empty(1, dtype=np.int64), accepted)
        grade_many(*block, *pack_targets(targets), q, *out)
        assert accepted[0] == expected
        assert grade_one(*block, *pack_targets(targets), q[0])[4] == expected


def test_it_shares_no_code_with_the_search():
    names = {getattr(value, "__module__", "") for value in vars(module).values()}
    assert {name for name in names if name.startswith("ikde.")} <= {
        *(f"ikde.kernels.{own}" for own in ("grade_many", "jit", "trig", "arrays", "flat_arguments", "world_grades")),
    }


@pytest.mark.slow
@pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="needs compiled kernels")
def test_it_is_vectorised(qiao):
    fresh = numba.njit(error_model="numpy", nogil=True)(grade_many.py_func)  # of cached code there is no text
    grade(qiao, CollisionModel.of(qiao).detector, Targets(np.zeros((1, 3))), qiao.home[None], grader=fresh)
    text = next(iter(fresh.inspect_asm().values()))
    if "vsubpd" not in text:
        pytest.skip("a machine without wide registers")
    for instruction in ("vsqrtpd", "vminpd", "vsubpd", "vmulpd"):
        assert re.search(rf"{instruction}\s.*[yz]mm", text), instruction

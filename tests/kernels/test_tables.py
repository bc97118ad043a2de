"""What the engine reads from tables is what its parts compute, in every lane."""

import numpy as np
import pytest

from ikde.kernels import damped, tables
from ikde.kernels.arrays import DescentArrays
from ikde.kernels.tables import LANES
from ikde.model.collision_model import CollisionModel
from ikde.model.pack import pack_robot, pack_targets
from ikde.model.target import Target
from tests.collision_robots import RANDOM, SHIPPED, away_from_contact, find_gaps, name_case
from tests.conftest import random_q
from tests.uncompiled import plain, plain_module, quietly

PLAIN = plain_module(tables)
CASES = [*SHIPPED, *RANDOM[:4]]
every_case = pytest.mark.parametrize("case", CASES, ids=name_case)


def make_buffers(robot, detector):
    return PLAIN.make_buffers(
        pack_robot(robot), CollisionModel(robot=robot, detector=detector).arrays, len(robot.joints)
    )


@every_case
def test_collisions_are_those_of_brute_force(case, rng):
    """The first pair in the detector's order."""
    robot, detector = case
    buffers, packed = make_buffers(robot, detector), CollisionModel(robot=robot, detector=detector).arrays
    for safe_distance in (0.0, 0.05):
        Q = random_q(robot, rng, 8)
        gaps = find_gaps(robot, detector, Q)
        collision = packed._replace(safe_distance=safe_distance)
        for q, row, clear in zip(Q, gaps, away_from_contact(gaps, safe_distance), strict=True):
            pair = PLAIN.find_collision(pack_robot(robot), collision, q, buffers)
            collides = row <= safe_distance
            assert not clear or pair == (int(collides.argmax()) if collides.any() else -1)


@every_case
def test_buffers_fit_the_robot(case):
    robot, detector = case
    buffers, packed = make_buffers(robot, detector), CollisionModel(robot=robot, detector=detector).arrays
    assert buffers.step.T_world_body.shape == (len(pack_robot(robot).bodies), 3, 4)
    assert buffers.step.jacobian.shape == (tables.TASK_ROWS, len(robot.joints))
    assert buffers.centres.shape == (3, len(packed.radius))
    assert buffers.bounds.shape == (len(packed.components), 3)


@pytest.mark.parametrize("robot", [case[0] for case in RANDOM[:4]], ids=lambda robot: robot.name)
def test_a_step_in_lanes_is_the_step_of_one(robot, rng):
    """Bit for bit, whatever the kinds of target; a lane without one keeps what it holds."""
    arrays, ranges, descent = pack_robot(robot), np.array([robot.lower, robot.upper]), DescentArrays()
    buffers, Q, joints = (
        make_buffers(robot, CollisionModel.of(robot).detector),
        random_q(robot, rng, LANES),
        len(robot.joints),
    )
    extras = ({}, {"axis_world_tool": [0.0, 0.6, 0.8]}, {"R_world_tool": np.eye(3)})
    targets = pack_targets([Target(rng.normal(size=3), **extras[k % 3]) for k in range(LANES)])
    row = rng.permutation(LANES)
    row[3] = -1
    q, errors = Q.T.ravel().copy(), np.full(2 * LANES, np.nan)
    with quietly():
        PLAIN.take_steps(arrays, targets, row, ranges, descent, q, np.zeros(0), errors, np.zeros(joints), buffers)
        for lane in range(LANES):
            after = Q[lane].copy()
            if row[lane] >= 0:
                one = plain(damped.take_step)(arrays, targets, row[lane], ranges, descent, after, buffers.step)
                assert errors[lane::LANES].tolist() == [float(error) for error in one]
            assert q[lane::LANES].tobytes() == after.tobytes()
    assert np.isnan(errors[3::LANES]).all()

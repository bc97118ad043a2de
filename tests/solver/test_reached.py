"""One meaning of "reached": what an engine calls reached, plain numpy accepts, at any tolerances and for every kind."""

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import settings as effort
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

import ikde
from ikde.kernels.arrays import REACHED
from ikde.model.target import POSE, Targets
from ikde.solver.plain import compute_frames, compute_gaps
from ikde.solver.verify import verify_many
from tests.conftest import random_q

TIGHT = st.floats(-9.0, -1.0).map(lambda exponent: 10.0**exponent)
POSITION_M = st.one_of(TIGHT, st.floats(0.05, 0.5))  # so loose that descents stop while the tool still turns
ORIENTATION_RAD = st.one_of(TIGHT, st.floats(0.1, np.pi))
PANDA = ikde.load_robot("panda")
DETECTOR = PANDA.detector(None)
SOME, MANY = 60, 400


def draw_poses(rng, count):
    """Tool poses [count, 3, 4] of free configurations."""
    Q = random_q(PANDA, rng, 4 * count)
    free = (compute_gaps(PANDA, DETECTOR.spheres, PANDA.pairs(DETECTOR), Q) > 0.0).all(axis=1)
    return compute_frames(PANDA, Q[free][:count])[PANDA.tool][:, :3].copy()


def search(poses, kinds, method, position_m, orientation_rad, **changes):
    settings = ikde.SolveSettings(
        method=method, position_tolerance_m=position_m, orientation_tolerance_rad=orientation_rad, **changes
    )
    return ikde.solve_many(PANDA, Targets.packed(kinds, poses), settings, explain_failures=False, verify="none")


@pytest.mark.parametrize(("method", "restarts"), [("lm", 8), ("memetic", 1)])
@effort(max_examples=25)
@example(position_m=0.1, orientation_rad=1.0, seed=0)
@example(position_m=0.1, orientation_rad=np.pi / 2, seed=0)  # where a sine folds
@example(position_m=0.1, orientation_rad=3.0, seed=0)
@example(position_m=0.1, orientation_rad=np.pi, seed=0)
@given(position_m=POSITION_M, orientation_rad=ORIENTATION_RAD, seed=st.integers(0, 999))
def test_what_an_engine_calls_reached_is_accepted(method, restarts, position_m, orientation_rad, seed):
    rng = np.random.default_rng(seed)
    poses, kinds = draw_poses(rng, SOME), rng.integers(0, 3, SOME)
    poses[::2, :, :3] = Rotation.random(len(poses[::2]), rng=rng).as_matrix()
    rows = search(poses, kinds, method, position_m, orientation_rad, restarts=restarts)
    called = rows.found.counts[:, REACHED] == 1
    accepted = verify_many(PANDA, rows.targets, rows.q, rows.problem.settings, DETECTOR).accepted
    assert not (called & ~accepted).any()


@pytest.mark.parametrize("method", ["lm", "memetic"])
def test_every_reachable_pose_is_reached_at_loose_tolerances(method, rng):
    rows = search(draw_poses(rng, MANY), np.full(MANY, POSE), method, 0.1, 1.0)
    assert len(rows) == MANY
    assert rows.reached.all()

"""With `near` what engines find is moved to a local minimum of the motion, each kind of target by its tolerances."""

import numpy as np
import pytest

import ikde
from ikde.model.target import Targets
from ikde.solver.engines.stay_near import stay_near
from ikde.solver.motion import measure_motion
from tests.problems import problem_of
from tests.targets import free_rows, target_at


def test_rows_are_moved_by_kind_and_others_stay(qiao, rng):
    Q = free_rows(qiao, rng, 6)
    poses = ikde.forward(qiao, Q)[qiao.tool]
    targets = Targets.of([target_at(T, kind) for T, kind in zip(poses, ("position", "axis", "pose") * 2, strict=True)])
    problem, moved, rows = problem_of(qiao, near=Q[0] + 0.1), Q.copy(), np.array([0, 1, 2, 4])
    stay_near(problem, targets, rows, moved)
    before, after = (measure_motion(problem.weights, problem.near, q) for q in (Q, moved))
    assert (after <= before).all()
    assert (after[rows] < before[rows]).sum() >= 3  # one that stands at a contact may find nothing better
    assert moved[[3, 5]].tobytes() == Q[[3, 5]].tobytes()
    for row in rows.tolist():
        assert ikde.verify(qiao, targets[row], moved[row]).accepted
        alone = Q[row : row + 1].copy()
        stay_near(problem, targets[row : row + 1], np.array([0]), alone)
        assert alone.tobytes() == moved[row].tobytes()


@pytest.mark.parametrize("method", ["lm", "memetic", "de"])
def test_every_engine_gives_near_itself_where_that_is_an_answer(qiao, method, rng):
    near = free_rows(qiao, rng, 1)[0]
    target = target_at(ikde.forward(qiao, near)[qiao.tool], "position")
    result = ikde.solve(qiao, target, method=method, near=near)
    assert result.q.tobytes() == near.tobytes()
    assert result.motion == 0.0
    assert result.reached


def test_one_by_one_and_in_bulk_on_any_number_of_threads_are_the_same_bits(qiao, rng):
    Q = free_rows(qiao, rng, 20)
    poses = ikde.forward(qiao, Q)[qiao.tool]
    targets = [target_at(T, ("position", "axis", "pose")[k % 3]) for k, T in enumerate(poses)]
    rows = [ikde.solve_many(qiao, targets, near=Q[0], bulk=ikde.BulkOptions(threads=n)) for n in (1, 2)]
    assert rows[0].q.tobytes() == rows[1].q.tobytes()
    assert rows[0].reached.all()
    for row in (0, 4, 19):
        result = ikde.solve(qiao, targets[row], near=Q[0], stream=row)
        assert result.q.tobytes() == rows[0].q[row].tobytes()
        assert result.motion == pytest.approx(rows[0].motion[row], rel=1e-15)


def test_weights_decide_which_joints_move(qiao, rng):
    near = free_rows(qiao, rng, 1)[0]
    target = ikde.Target(ikde.forward(qiao, near)[qiao.tool][:3, 3] + np.array([0.1, 0.05, 0.05]))
    heavy = {"d_x": 100.0, "d_y": 100.0, "q_z": 100.0}
    light, stiff = (ikde.solve(qiao, target, near=near, weights=w) for w in (None, heavy))
    assert np.abs(stiff.q - near)[:3].max() < 1e-3 < np.abs(light.q - near)[:3].max()
    weights = {"q2": 2.0, **heavy}
    result = ikde.solve(qiao, target, near=near, weights=weights)
    expected = [weights.get(j.name, 1.0 / (j.upper - j.lower)) for j in qiao.joints]
    assert result.motion == pytest.approx(np.linalg.norm(np.array(expected) * (result.q - near)))

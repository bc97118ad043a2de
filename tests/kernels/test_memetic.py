"""The memetic search: without polishing against its naive twin along the random stream; with it by its laws."""

import json
import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numba
import numpy as np
import pytest

import ikde
from ikde.kernels.arrays import ATTEMPTS, COLLIDING, COUNTS, EVALUATIONS, REACHED, DescentArrays, MemeticArrays
from ikde.kernels.memetic import (
    evolve_memetic,
    make_memetic_workspace,
    solve_memetic_lane,
)
from ikde.kernels.rng import seed_stream
from ikde.model.collision_model import CollisionModel
from ikde.model.pack import pack_robot, pack_targets
from ikde.model.target import Target
from ikde.solver.problem import pack_search
from tests import reference, reference_memetic
from tests.conftest import random_q
from tests.flat_settings import flat_settings
from tests.problems import problem_of
from tests.random_robots import random_robot
from tests.targets import make_target

ROOT = Path(__file__).parents[2]
KINDS = ("position", "axis", "pose")
UNPOLISHED = MemeticArrays(evaluations=120, first_population=10, last_population=4, polish_share=0.0)
QUICK = MemeticArrays(evaluations=1500, first_population=20)

pytestmark = pytest.mark.filterwarnings("ignore:overflow encountered:RuntimeWarning")  # numpy's scalars, uncompiled


def make_case(robot, *, detector=None, near=None, freeze=None, **changes):
    settings = flat_settings(bounds="midpoint", **changes)
    return problem_of(robot, settings, collision=detector, near=near, freeze=freeze)


def free_in_ranges(robot, problem, rng):
    """A configuration inside the problem's ranges that is free."""
    while True:
        q = rng.uniform(problem.lower, problem.upper)
        if problem.collision.detector is None or reference.compute_depth(robot, problem.collision.detector, q) == 0.0:
            return q


def run_evolve(problem, target, memetic, seed=1):
    robot, detector = pack_robot(problem.robot), problem.collision.arrays
    work = make_memetic_workspace(robot, detector, len(problem.lower), memetic)
    state, box = np.zeros(1, dtype=np.uint64), np.array([problem.lower, problem.upper])
    seed_stream(np.uint64(seed), np.int64(2), 3, state)
    where = (robot, detector, pack_targets([target]), 0, pack_search(problem))
    best, meets, spent = evolve_memetic(*where, memetic, DescentArrays(), box, state, work)
    return work, int(best), bool(meets), int(spent), int(state[0])


def run_lane(problem, target, memetic=None, *, seed=1, stream=0, blocks=((0, 6),)):
    """(q, score, counts, pairs) of a lane."""
    robot, detector = pack_robot(problem.robot), problem.collision.arrays
    q, score, counts = np.zeros(len(problem.lower)), np.full(2, np.inf), np.zeros(COUNTS, dtype=np.int64)
    outputs = (q, score, counts, np.zeros(detector.pairs.shape[0], dtype=np.int64))
    where = (robot, detector, pack_targets([target]), 0, pack_search(problem), memetic or QUICK, DescentArrays())
    for block in blocks:
        if not counts[REACHED]:
            solve_memetic_lane(*where, np.uint64(seed), np.int64(stream), np.array(block), *outputs)
    return outputs


def assert_like_twin(problem, target, memetic, seed=1):
    work, best, meets, spent, state = run_evolve(problem, target, memetic, seed)
    stream = reference.Stream.for_attempt(seed, 2, 3)
    x, scores, best_twin, meets_twin, spent_twin, history = reference_memetic.evolve_memetic(
        problem, target, stream, memetic
    )
    assert (best, meets, spent, state) == (best_twin, meets_twin, spent_twin, stream.state)
    np.testing.assert_allclose(work.members.x[best], x[best], rtol=0, atol=1e-9)
    if spent >= memetic.first_population:
        np.testing.assert_allclose(work.members.x[: len(x)], x, rtol=0, atol=1e-9)
    assert tuple(work.members.score[best][::-1]) == pytest.approx(scores[best], rel=1e-9, abs=1e-9)
    np.testing.assert_allclose(work.history.weight, history.weight, rtol=1e-9)
    return meets


@pytest.mark.parametrize("is_weighted", [False, True])
@pytest.mark.parametrize("kind", KINDS)
def test_the_paper_robot_evolves_like_the_twin(qiao, kind, is_weighted, rng):
    target = make_target(qiao, random_q(qiao, rng), kind)
    assert not assert_like_twin(make_case(qiao), target, UNPOLISHED._replace(is_weighted=is_weighted))


@pytest.mark.parametrize("seed", [0, 1, 3, 4, 5, 6, 7, 8])
def test_random_robots_evolve_like_the_twin(seed, rng):
    robot = random_robot(seed)
    problem = make_case(robot, detector="none" if seed % 3 == 0 else None)
    memetic = UNPOLISHED._replace(archive_share=(0.0, 1.0, 2.6)[seed % 3], memory=2 + seed % 4)
    assert_like_twin(problem, make_target(robot, random_q(robot, rng), KINDS[seed % 3]), memetic)


def test_it_stops_like_the_twin_when_the_target_is_met(qiao, rng):
    target = make_target(qiao, random_q(qiao, rng), "position")
    problem = make_case(qiao, position_tolerance_m=0.4)
    assert assert_like_twin(problem, target, UNPOLISHED._replace(evaluations=600))


@pytest.mark.parametrize("polish_share", [0.0, 0.5, 2.0])
@pytest.mark.parametrize("evaluations", [1, 9, 50, 333, 1500])
def test_the_budget_is_kept(qiao, evaluations, polish_share, rng):
    target = Target((20.0, 0.0, 1.0))
    memetic = MemeticArrays(evaluations=evaluations, polish_share=polish_share)
    _, _, meets, spent, _ = run_evolve(make_case(qiao), target, memetic)
    assert not meets
    assert evaluations - 10 <= spent <= evaluations


@pytest.mark.parametrize("kind", KINDS)
def test_what_is_reached_is_verified(any_robot, kind, rng):
    problem = make_case(any_robot)
    for stream in range(5):
        target = make_target(any_robot, free_in_ranges(any_robot, problem, rng), kind)
        q, score, counts, _ = run_lane(problem, target, MemeticArrays(), stream=stream)
        assert counts[REACHED] == 1
        assert score.tolist() == [0.0, 0.0]
        assert ikde.verify(any_robot, target, q).accepted


def test_clearance_and_frozen_joints_are_kept(qiao, rng):
    detector = replace(CollisionModel.of(qiao).detector, safe_distance_m=0.02)
    freeze = {"d_x": 0.1, "d_y": 1.0 / 3.0, "q_z": -0.2}
    problem = make_case(qiao, detector=detector, freeze=freeze)
    for stream in range(3):
        target = make_target(qiao, free_in_ranges(qiao, problem, rng), "pose")
        q, _, counts, _ = run_lane(problem, target, MemeticArrays(), stream=stream, blocks=[(0, 20)])
        assert counts[REACHED] == 1
        assert q[:3].tolist() == list(freeze.values())
        assert ikde.verify(qiao, target, q, collision=detector).accepted


def test_near_a_configuration_the_first_box_is_kept(qiao, rng):
    problem = make_case(qiao, near=free_in_ranges(qiao, make_case(qiao), rng))
    target = make_target(qiao, problem.near, "pose")
    q, _, counts, _ = run_lane(problem, target)
    assert counts[REACHED] == 1
    assert np.all(np.abs(q - problem.near) <= (problem.upper - problem.lower) / 64.0 + 1e-12)


def test_a_pose_that_only_collides_is_counted_with_its_pair(qiao):
    detector = replace(CollisionModel.of(qiao).detector, safe_distance_m=0.2)  # the wrist's own pairs are nearer
    problem = make_case(qiao, detector=detector)
    _, score, counts, pairs = run_lane(problem, Target((0.8, 0.5, 1.0)), blocks=[(0, 3)])
    assert counts[[REACHED, ATTEMPTS, COLLIDING]].tolist() == [0, 3, 3]
    assert pairs.max() == 3
    assert score[0] == 0.0
    assert score[1] > 0.0


def test_other_rules_search_the_pose_alone(qiao, rng):
    target = make_target(qiao, random_q(qiao, rng), "pose")
    assert run_lane(make_case(qiao, detector="none"), target)[2][REACHED] == 1
    _, _, counts, _ = run_lane(make_case(qiao, collision="reject"), target, blocks=[(0, 40)])
    assert counts[COLLIDING] + counts[REACHED] == counts[ATTEMPTS]


def test_attempts_may_be_cut_into_calls(qiao):
    problem, target = make_case(qiao), Target((20.0, 0.0, 1.0))
    whole = run_lane(problem, target, blocks=[(0, 4)])
    parts = run_lane(problem, target, blocks=[(0, 1), (1, 3), (3, 4)])
    assert [a.tobytes() for a in whole] == [b.tobytes() for b in parts]
    assert whole[2][ATTEMPTS] == 4
    assert whole[2][EVALUATIONS] <= 4 * (QUICK.evaluations + QUICK.polish_steps * 10 + 1)


def test_what_is_kept_never_worsens_with_more_attempts(qiao):
    problem, target = make_case(qiao), Target((20.0, 0.0, 1.0))
    scores = [run_lane(problem, target, blocks=[(0, attempts)])[1].tolist() for attempts in range(1, 6)]
    assert scores == sorted(scores, reverse=True)


def solve_all():
    """The bits of small searches over kinds of target and rules, as hexadecimal text."""
    robot, rng, bits = ikde.load_robot("qiao2021"), np.random.default_rng(3), []
    for kind in KINDS:
        for memetic in (UNPOLISHED, UNPOLISHED._replace(polish_share=0.8, evaluations=400)):
            target = make_target(robot, random_q(robot, rng), kind)
            problem = make_case(robot, position_tolerance_m=1e-9, orientation_tolerance_rad=1e-9)
            q, _, counts, _ = run_lane(problem, target, memetic, seed=2**63 + 1, blocks=[(0, 1)])
            bits += [q.tobytes().hex(), counts.tobytes().hex()]
    return bits


def test_twice_gives_the_same_bits_and_streams_differ(qiao):
    assert solve_all() == solve_all()
    problem, target = make_case(qiao), Target((0.8, 0.5, 1.0))
    assert len({run_lane(problem, target, stream=stream)[0].tobytes() for stream in range(5)}) == 5


@pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="needs compiled kernels")
def test_uncompiled_kernels_give_the_same_bits():
    script = "import json; from tests.kernels.test_memetic import solve_all; print(json.dumps(solve_all()))"
    command = [sys.executable, "-W", "error", "-W", "ignore:overflow encountered:RuntimeWarning", "-c", script]
    environment = {**os.environ, "NUMBA_DISABLE_JIT": "1"}
    done = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout) == solve_all()

"""What is preferred: an answer stays on its target, inside the limits and free, and no sample of its null space nearby
is better."""

from functools import lru_cache

import numpy as np
import pytest

import ikde
from ikde.errors import InputError
from ikde.solver.objectives import make_objective
from ikde.solver.problem import make_problem
from ikde.solver.settings import SolveSettings
from tests.targets import free_q, make_target

PREFERRED = ("manipulability", "clearance", "limits", "motion")
BETTER = {"manipulability": 1e-6, "clearance": 1e-6, "limits": 1e-6, "motion": 1e-6}


def meet(robot, target, q):
    """The configuration near `q` that meets the target, by Newton's method on forward kinematics alone."""
    for _ in range(4):
        T = ikde.forward(robot, q)["tool"]
        miss = target.p_world_tool - T[:3, 3]
        if target.kind == "pose":
            D = target.R_world_tool @ T[:3, :3].T
            miss = [*miss, *(0.5 * np.array([D[2, 1] - D[1, 2], D[0, 2] - D[2, 0], D[1, 0] - D[0, 1]]))]
        q = q + np.linalg.pinv(ikde.jacobian(robot, q)[: len(miss)]) @ miss
    return q


def is_allowed(robot, target, q):
    return ikde.verify(robot, target, q).accepted


@lru_cache
def example(name, kind):
    robot = ikde.load_robot(name)
    target = make_target(robot, free_q(robot, np.random.default_rng(5)), kind)
    return robot, target, ikde.solve(robot, target, seed=1)


@pytest.mark.parametrize("prefer", PREFERRED)
@pytest.mark.parametrize(("name", "kind"), [("panda", "pose"), ("qiao2021", "position")])
def test_no_sample_nearby_is_better(name, kind, prefer):
    """Of panda all of its self-motion nearby, step by step; of the nine joints of qiao2021 random ones, of six free."""
    robot, target, before = example(name, kind)
    result = ikde.solve(robot, target, seed=1, prefer=prefer)
    problem = make_problem(robot, SolveSettings(), collision=None, near=robot.home, freeze=None)
    worth = make_objective(problem, prefer).worth
    assert result.reached
    assert result.verified
    assert is_allowed(robot, target, result.q)
    assert worth(result.q) >= worth(before.q) - 1e-12
    if prefer != "motion":  # which the search with `near` has done before
        assert result.preferred.settled
        assert result.preferred.steps > 0
    rng, tried = np.random.default_rng(1), 0
    asked = 3 if kind == "position" else 6
    null = np.linalg.svd(ikde.jacobian(robot, result.q)[:asked])[2][asked:]
    lengths = np.arange(-0.1, 0.1, 0.005) if len(null) == 1 else rng.uniform(1e-3, 0.03, 40)
    for length in lengths:
        along = rng.standard_normal(len(null)) if len(null) > 1 else np.ones(1)
        q = meet(robot, target, result.q + length * (along / np.linalg.norm(along)) @ null)
        if is_allowed(robot, target, q) and ikde.check(robot, q).clearance_m > 1e-3:
            tried += 1
            assert worth(q) <= worth(result.q) + BETTER[prefer], length
    assert tried > 10


def test_what_it_says_is_what_it_has():
    robot, target, before = example("panda", "pose")
    result = ikde.solve(robot, target, seed=1, prefer="limits")
    assert (result.preferred.what, before.preferred) == ("limits", None)
    assert result.preferred.after == ikde.analyze(robot, result.q).limit_margin
    assert result.preferred.before == ikde.analyze(robot, before.q).limit_margin
    assert result.preferred.after > result.preferred.before
    moved = ikde.solve(robot, target, seed=1, prefer="manipulability")
    assert moved.preferred.after == float(ikde.analyze(robot, moved.q).scaled["whole"]["pose"].manipulability)
    roomy = ikde.solve(robot, target, seed=1, prefer="clearance")
    assert roomy.preferred.after == pytest.approx(roomy.room_m, abs=1e-11)
    assert roomy.position_error_m < 1e-12


def test_frozen_joints_stay_and_obstacles_are_kept_away_from(qiao):
    target = ikde.Target((0.9, 0.3, 0.9))
    held = ikde.solve(qiao, target, freeze={"d_x": 0.1, "q_z": 0.2}, prefer="manipulability")
    assert held.q[[0, 2]].tolist() == [0.1, 0.2]
    assert held.preferred.after > held.preferred.before
    world = ikde.load_world({"obstacles": {"ball": {"sphere": {"radius": 0.2}, "position": [0.5, 0.8, 1.0]}}})
    among = ikde.CollisionModel.of(qiao).in_world(world, 0.05)
    result = ikde.solve(qiao, target, collision=among, prefer="manipulability")
    assert result.reached
    assert result.room_m > 0.0
    assert ikde.check(qiao, result.q, among).collision is False


def test_without_freedom_it_stays():
    robot = ikde.load_robot("ur5")
    T = ikde.forward(robot, robot.home)["tool"]
    plain, moved = (ikde.solve(robot, T, near=robot.home, prefer=prefer) for prefer in (None, "manipulability"))
    assert moved.q.tobytes() == plain.q.tobytes()
    assert (moved.preferred.steps, moved.preferred.settled) == (0, True)
    lost = ikde.solve(robot, (9.0, 0.0, 0.0), prefer="limits")
    assert not lost.reached
    assert (lost.preferred.steps, lost.preferred.settled) == (0, False)


def test_less_motion_begins_at_home_or_near(qiao):
    target = ikde.Target((0.9, 0.3, 0.9))
    assert ikde.solve(qiao, target, prefer="motion").motion <= ikde.solve(qiao, target).motion
    near = qiao.home + 0.1
    assert ikde.solve(qiao, target, near=near, prefer="motion").near.tolist() == near.tolist()


def test_what_cannot_be_preferred_is_refused(qiao):
    for words, message in (
        ({"prefer": "speed"}, r"prefer: expected one of manipulability, clearance, limits, motion, got 'speed'"),
        ({"prefer": "clearance", "collision": "none"}, "prefer: without a detector no clearance is known to prefer"),
    ):
        with pytest.raises(InputError, match=message):
            ikde.solve(qiao, (0.9, 0.3, 0.9), **words)
    box = ikde.Region.box((0.9, 0.3, 0.9), position_m=(0.01, 0.01, 0.01))
    with pytest.raises(InputError, match="prefer: an answer is moved for an exact target; this one is a region"):
        ikde.solve(qiao, box, prefer="limits")

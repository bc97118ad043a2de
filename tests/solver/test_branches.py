"""What the closed form proves: nothing that can be reached is ruled out, and nothing that is ruled out is reached."""

import re

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import ikde
from ikde.kernels.arrays import REACHED
from ikde.model.closed_form import find_still_arm
from ikde.model.collision_model import CollisionModel
from ikde.model.target import Targets
from ikde.solver.branches import find_beyond, judge_branches, rule_out_by_branches, tell_branches
from ikde.solver.plain import compute_frames, compute_gaps
from ikde.solver.result import STOP_REASONS
from ikde.solver.search import search
from tests.conftest import random_q
from tests.problems import problem_of
from tests.targets import free_rows, make_targets

QIAO, UR5 = (ikde.load_robot(name) for name in ("qiao2021", "ur5"))
OWN, SETTINGS = CollisionModel.of(UR5), ikde.SolveSettings()
PARKED = {"d_x": 0.3, "d_y": -0.2, "q_z": 0.5}
QUESTIONS = [problem_of(UR5), problem_of(QIAO, freeze=PARKED), problem_of(UR5, collision="none")]
each_question = pytest.mark.parametrize("problem", QUESTIONS, ids=["ur5", "qiao2021", "ur5, not checked"])


def beside(robot, Q, rng, share=0.999):
    """Poses that differ from those of `Q` by nearly all that the tolerances allow."""
    T = compute_frames(robot, Q)[robot.tool].copy()
    way, axis = (vectors / np.linalg.norm(vectors, axis=1)[:, None] for vectors in rng.normal(size=(2, len(Q), 3)))
    T[:, :3, 3] += share * SETTINGS.position_tolerance_m * way
    T[:, :3, :3] = Rotation.from_rotvec(share * SETTINGS.orientation_tolerance_rad * axis).as_matrix() @ T[:, :3, :3]
    return Targets(T[:, :3, 3], R_world_tool=T[:, :3, :3])


def park(problem, Q):
    """The same configurations with what is frozen in its place."""
    return np.where(problem.lower == problem.upper, problem.lower, Q)


def some_free(problem, rng, count):
    Q = park(problem, free_rows(problem.robot, rng, 4 * count))
    return Q[(compute_gaps(problem.collision, Q) > problem.collision.limit_m).all(axis=1)][:count]


def others(rng, count):
    """Poses anywhere about the robot."""
    return Targets(rng.uniform(-1.0, 1.0, (count, 3)), R_world_tool=Rotation.random(count, rng=rng).as_matrix())


@each_question
def test_what_a_configuration_reaches_within_the_tolerances_is_not_ruled_out(problem, rng):
    targets = beside(problem.robot, some_free(problem, rng, 400), rng)
    assert (rule_out_by_branches(problem, targets) == -1).all()


def test_what_is_reached_from_the_very_limits_is_not_ruled_out(rng):
    """Each pose has one configuration inside, and a pose beside it may have none."""
    for q in free_rows(UR5, rng, 40):
        problem = problem_of(UR5).with_ranges(q - 1e-9, q)
        assert (rule_out_by_branches(problem, beside(UR5, np.repeat(q[None], 10, axis=0), rng)) == -1).all()


def test_what_touches_almost_is_not_ruled_out(rng):
    """On the way from a free configuration to a colliding one, a micrometre before contact."""
    problem, collision = problem_of(UR5), CollisionModel.of(UR5)
    Q = random_q(UR5, rng, 600)
    collides = (compute_gaps(collision, Q) <= collision.limit_m).any(axis=1)
    count = min(collides.sum(), (~collides).sum())
    free, hit = Q[~collides][:count], Q[collides][:count]
    for _ in range(40):
        middle = 0.5 * (free + hit)
        is_hit = (compute_gaps(collision, middle) <= collision.limit_m).any(axis=1)[:, None]
        free, hit = np.where(is_hit, free, middle), np.where(is_hit, middle, hit)
    assert (compute_gaps(collision, free).min(axis=1) < collision.limit_m + 1e-6).all()
    for share in (0.0, 0.999):
        assert (rule_out_by_branches(problem, beside(UR5, free, rng, share)) == -1).all()


@each_question
@pytest.mark.parametrize(("count", "attempts"), [(60, 4), pytest.param(300, 40, marks=pytest.mark.slow)])
def test_nearly_all_that_no_engine_reaches_is_ruled_out(problem, rng, count, attempts):
    targets = others(rng, count)
    reached = search(problem, targets, seed=1, streams=range(count), attempts=attempts).counts[:, REACHED] == 1
    ruled_out = rule_out_by_branches(problem, targets) >= 0
    assert not (reached & ruled_out).any()
    assert ruled_out[~reached].mean() > 0.95
    assert ruled_out.sum() > count / 6


def test_all_collisions_are_named_and_counted_as_plain_numpy_sees_them(rng):
    problem = problem_of(UR5)
    targets = make_targets(UR5, random_q(UR5, rng, 400), "pose")
    ruled_out, names = rule_out_by_branches(problem, targets), [str(reason) for reason in STOP_REASONS]
    seen = np.flatnonzero(ruled_out == names.index("collision"))
    assert len(seen) > 5
    for row in seen.tolist():
        judged = judge_branches(problem, targets.take(np.array([row])))
        real = ~judged.missing[0]
        hits = (compute_gaps(problem.collision, judged.q[0][real]) <= 0.0) & ~judged.outside[0][real][:, None]
        reason, blocking = tell_branches(problem, targets[row])
        outside, colliding = int(judged.outside.sum()), int(hits.any(axis=1).sum())
        assert outside + colliding == real.sum()
        assert reason.startswith(f"no solution, proved: of {real.sum()} configurations with this pose ")
        assert f"{colliding} in collision (" in reason
        assert (f"{outside} outside the limits of" in reason) == (outside > 0)
        for (a, b), count in blocking.items():
            assert 0 < count <= hits[:, problem.collision.pairs.index((a, b))].sum()


def test_among_obstacles_the_blocker_of_each_branch_is_named_alike_ones_once(rng):
    wall = ikde.load_world({"obstacles": {"wall": {"box": [0.3, 2.0, 0.02], "position": [0.5, 0.0, 0.45]}}})
    problem = problem_of(UR5, collision=OWN.in_world(wall))
    targets = make_targets(UR5, random_q(UR5, rng, 400), "pose")
    world = [str(reason) for reason in STOP_REASONS].index("world")
    seen = np.flatnonzero(rule_out_by_branches(problem, targets) == world)
    assert len(seen) > 5
    several = 0
    for row in seen.tolist():
        judged = judge_branches(problem, targets.take(np.array([row])))
        hits = judged.colliding[0][judged.colliding[0].any(axis=-1)]
        reason, _ = tell_branches(problem, targets[row])
        named = reason.split(f"{len(hits)} in collision: ")[1].split("; ")
        found = [re.fullmatch(r"\w+ - \w+ (-?[\d.]+) mm(?: \((\d+) of them\))?", words) for words in named]
        assert sum(int(match[2] or 1) for match in found) == len(hits)
        assert len({match[0].split(" (")[0] for match in found}) == len(found)
        assert all(float(match[1]) <= 0.0 for match in found)
        several += any(match[2] for match in found)
    assert several > 2


def test_joints_that_stand_in_the_way_are_named(rng):
    narrow = problem_of(UR5, collision="none")
    lower, upper = narrow.lower.copy(), narrow.upper.copy()
    lower[4], upper[4] = 0.3, 0.9
    narrow = narrow.with_ranges(lower, upper)
    Q = random_q(UR5, rng, 60)
    Q[:, 4] = rng.uniform(1.2, 1.9, 60)
    targets = make_targets(UR5, Q, "pose")
    ruled_out = rule_out_by_branches(narrow, targets)
    assert (ruled_out == [str(reason) for reason in STOP_REASONS].index("limits")).mean() > 0.8
    for row in np.flatnonzero(ruled_out >= 0)[:20].tolist():
        reason, blocking = tell_branches(narrow, targets[row])
        assert "outside the limits of wrist_2_joint" in reason
        assert blocking == {}
        beyond = find_beyond(narrow, targets[row])
        graded = ikde.verify(UR5, targets[row], beyond)
        assert graded.within_tolerance
        assert not 0.3 <= beyond[4] <= 0.9


def test_a_pose_beyond_reach_has_no_configuration():
    target = ikde.Target((0.0, 0.0, 3.0), R_world_tool=np.eye(3))
    assert STOP_REASONS[rule_out_by_branches(problem_of(UR5), Targets.of([target]))[0]] == "out_of_reach"
    assert tell_branches(problem_of(UR5), target) == (
        "no solution, proved: no configuration of the arm, whatever its limits, has this pose",
        {},
    )
    assert find_beyond(problem_of(UR5), target) is None


def test_nothing_is_ruled_out_but_poses_of_an_arm_that_alone_may_move():
    far = Targets([[0.0, 0.0, 9.0]]), Targets([[0.0, 0.0, 9.0]], axis_world_tool=[[0.0, 0.0, 1.0]])
    for targets in far:
        assert rule_out_by_branches(problem_of(UR5), targets).tolist() == [-1]
    pose = Targets([[0.0, 0.0, 9.0]], R_world_tool=np.eye(3)[None])
    assert rule_out_by_branches(problem_of(UR5), pose).tolist() != [-1]
    for problem in (problem_of(QIAO), problem_of(QIAO, freeze=["d_x", "d_y"]), problem_of(ikde.load_robot("panda"))):
        assert find_still_arm(problem.robot, problem.lower, problem.upper) is None
        assert rule_out_by_branches(problem, pose).tolist() == [-1]

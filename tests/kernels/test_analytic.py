"""The engine `analytic`: what it finds is exact, free, inside the limits, and the nearest branch where one is asked."""

from types import SimpleNamespace

import numpy as np
import pytest

import ikde
from ikde.kernels import analytic
from ikde.kernels.answer import size_of
from ikde.kernels.arrays import ATTEMPTS, COLLIDING, COUNTS, EVALUATIONS, POSE, REACHED, UNKNOWN_DEPTH
from ikde.kernels.closed_form import ANGLES, BRANCHES, solve_ur_arm
from ikde.kernels.flat_arguments import flatten_answer
from ikde.model.closed_form import find_ur_arm, pack_ur_arm
from ikde.model.collision_model import CollisionModel
from ikde.model.generate.assemble import format_module
from ikde.model.pack import pack_robot, pack_targets
from ikde.model.target import Target, Targets
from ikde.solver.branches import judge_branches
from ikde.solver.engines.analytic import pack_still
from ikde.solver.metrics import pack_grader
from ikde.solver.motion import measure_motion
from ikde.solver.plain import compute_frames, compute_gaps
from ikde.solver.verify import verify_many
from tests.collision_robots import find_gaps
from tests.conftest import random_q
from tests.kernels.seeding import no_seeds, pack_seeds
from tests.problems import problem_of
from tests.targets import free_rows, make_targets
from tests.uncompiled import plain, plain_module, quietly, run_text
from tests.ur_robots import random_ur_robot

PLAIN = plain_module(analytic)
EXACT = ikde.SolveSettings(position_tolerance_m=1e-11, orientation_tolerance_rad=1e-7)
QIAO, UR5 = (ikde.load_robot(name) for name in ("qiao2021", "ur5"))
every_robot = pytest.mark.parametrize("robot", [QIAO, UR5], ids=lambda robot: robot.name)
BASE = np.array([0, 1, 2])


def make_pool(robot, rng):
    if robot is not QIAO:
        return no_seeds(robot)
    Q = free_rows(robot, rng, 300)
    Q[:, BASE] = 0.0
    return pack_seeds(robot, Q, BASE)


def run(robot, targets, seeds, *, budget=20, near=None, module=PLAIN, rows=None, streams=None):
    """The outputs of the kernel, by tables or by a module of the robot's own."""
    detector, arm, count = CollisionModel.of(robot).detector, find_ur_arm(robot), len(targets)
    packed, arrays = CollisionModel(robot=robot, detector=detector).arrays, pack_robot(robot)
    models = (arrays, packed._replace(safe_distance=packed.safe_distance + 1e-12))
    outputs = SimpleNamespace(
        q=np.zeros((count, len(robot.joints))),
        score=np.full((count, 2), np.inf),
        counts=np.zeros((count, COUNTS), dtype=np.int64),
        pairs=np.zeros((count, len(packed.pairs)), dtype=np.int64),
    )
    rows = (0, count) if rows is None else rows
    middle = 0.5 * (robot.lower + robot.upper) if near is None else near
    ranges = np.array([robot.lower, robot.upper, middle])
    attempts = np.tile([0, budget], (rows[1] - rows[0], 1))
    streams = np.arange(count) if streams is None else streams
    with quietly():
        module.solve_branches(
            *(*models, models[1], pack_ur_arm(arm), arm.carrier, pack_targets(targets), np.array(rows), ranges, seeds),
            *(np.uint64(4), streams, attempts, *vars(outputs).values()),
        )
    return outputs


def list_branches(robot, T, near):
    """All solutions [n, 6] of a robot that is just an arm, for a tool pose [4, 4], in the turns nearest `near`."""
    work, out_q = np.empty((2, ANGLES)), np.empty((BRANCHES, 6))
    ranges = np.array([robot.lower, robot.upper, near])
    count = plain(solve_ur_arm)(pack_ur_arm(find_ur_arm(robot)), ranges, T[:3], work, out_q, np.empty(BRANCHES, int))
    return out_q[:count]


@every_robot
def test_what_is_reached_is_exact_free_and_inside_the_limits(robot, rng):
    targets = make_targets(robot, free_rows(robot, rng, 25), "pose")
    found = run(robot, targets, make_pool(robot, rng))
    reached = found.counts[:, REACHED] == 1
    assert reached.mean() > 0.9
    verdicts = verify_many(CollisionModel.of(robot), targets, found.q, EXACT)
    assert verdicts.accepted[reached].all()
    assert verdicts.within_tolerance[found.score[:, 0] == 0.0].all()


def test_an_arm_without_a_base_is_done_with_one_attempt(rng):
    """Made by a free configuration: one of all branches is free."""
    targets = make_targets(UR5, free_rows(UR5, rng, 30), "pose")
    found = run(UR5, targets, no_seeds(UR5), budget=1)
    assert (found.counts[:, REACHED] == 1).all()
    assert (found.counts[:, ATTEMPTS] == 1).all()


@every_robot
def test_counts_add_up(robot, rng):
    targets = make_targets(robot, random_q(robot, rng, 25), "pose")
    found, budget = run(robot, targets, make_pool(robot, rng), budget=3), 3
    reached = found.counts[:, REACHED] == 1
    assert (found.counts[~reached, ATTEMPTS] == budget).all()
    assert (found.counts[:, ATTEMPTS] <= budget).all()
    assert (found.counts[:, EVALUATIONS] <= 8 * found.counts[:, ATTEMPTS]).all()
    assert (found.counts[:, COLLIDING] + reached <= found.counts[:, EVALUATIONS]).all()
    np.testing.assert_array_equal(found.pairs.sum(axis=1), found.counts[:, COLLIDING])
    met = found.counts[:, EVALUATIONS] > 0
    assert (found.score[reached] == [0.0, 0.0]).all()
    assert (found.score[met & ~reached] == [0.0, UNKNOWN_DEPTH]).all()
    assert np.isinf(found.score[~met]).all()
    # Who is not reached keeps one that meets the target but collides.
    verdicts = verify_many(CollisionModel.of(robot), targets, found.q, EXACT)
    assert verdicts.within_tolerance[met].all()
    assert not verdicts.accepted[met & ~reached].any()


def test_near_a_configuration_the_nearest_free_branch_is_taken(rng):
    """Against all branches, each judged by plain numpy."""
    detector, width, seen = CollisionModel.of(UR5).detector, UR5.upper - UR5.lower, 0
    for q in free_rows(UR5, rng, 25):
        near = random_q(UR5, rng)
        T = compute_frames(UR5, q)[UR5.tool]
        targets = Targets.of([Target(T[:3, 3], R_world_tool=T[:3, :3])])
        branches = list_branches(UR5, T, near)
        free = (find_gaps(UR5, detector, branches) > detector.safe_distance_m).all(axis=1)
        distance = (((branches - near) / width) ** 2).sum(axis=1)
        expected = branches[free][distance[free].argmin()]
        found = run(UR5, targets, no_seeds(UR5, 1.0 / 64.0), budget=1, near=near)
        np.testing.assert_allclose(found.q[0], expected, rtol=0, atol=1e-9)
        seen += distance[free].argmin() > 0
    assert seen > 0


def test_the_first_base_near_a_configuration_is_its_own(rng):
    """Attempt 0 keeps the base where it is: the configuration that made the target is found again."""
    Q = free_rows(QIAO, rng, 10)
    for q in Q:
        found = run(QIAO, make_targets(QIAO, q[None], "pose"), no_seeds(QIAO, 1.0 / 64.0), budget=1, near=q)
        np.testing.assert_allclose(found.q[0], q, rtol=0, atol=1e-7)


@every_robot
def test_a_module_of_the_robots_own_finds_the_same(robot, rng):
    module = run_text(format_module(CollisionModel.of(robot), "pose"))
    targets, seeds = make_targets(robot, random_q(robot, rng, 20), "pose"), make_pool(robot, rng)
    by_tables, own = run(robot, targets, seeds), run(robot, targets, seeds, module=module)
    for name in ("q", "score", "counts"):
        np.testing.assert_array_equal(getattr(by_tables, name), getattr(own, name))


@every_robot
def test_rows_do_not_hang_on_each_other(robot, rng):
    targets, seeds = make_targets(robot, random_q(robot, rng, 12), "pose"), make_pool(robot, rng)
    whole, part = run(robot, targets, seeds), run(robot, targets, seeds, rows=(4, 9))
    for name in ("q", "score", "counts", "pairs"):
        np.testing.assert_array_equal(getattr(whole, name)[4:9], getattr(part, name)[4:9])
        outside = np.delete(getattr(part, name), range(4, 9), axis=0)
        assert (np.isinf(outside) if name == "score" else outside == 0).all()


def run_still(problem, targets, *, attempt=0, module=PLAIN):
    """The outputs of the kernel for arms that stand still."""
    arm, count = find_ur_arm(problem.robot), len(targets)
    outputs = SimpleNamespace(
        q=np.zeros((count, len(problem.robot.joints))),
        score=np.full((count, 2), np.inf),
        counts=np.zeros((count, COUNTS), dtype=np.int64),
        pairs=np.zeros((count, len(problem.collision.pairs)), dtype=np.int64),
    )
    attempts = np.tile([attempt, attempt + 1], (count, 1))
    with quietly():
        module.solve_poses(
            *(*pack_still(problem, arm), targets.T_world_tool, np.array([0, count]), np.uint64(4)),
            *(np.arange(count), attempts, *vars(outputs).values()),
        )
    return outputs


PARKED = {"d_x": 0.4, "d_y": -0.3, "q_z": 0.7}
STILL = [problem_of(UR5), problem_of(QIAO, freeze=PARKED)]
each_still = pytest.mark.parametrize("problem", STILL, ids=["ur5", "qiao2021"])


def park(problem, Q):
    """Configurations with what is frozen in its place, those that are free."""
    Q = np.where(problem.lower == problem.upper, problem.lower, Q)
    return Q[(compute_gaps(problem.collision, Q) > problem.collision.limit_m).all(axis=1)]


@each_still
def test_an_arm_that_stands_still_takes_the_free_branch_of_least_motion(problem, rng):
    """Against all branches, each judged by plain numpy; from home, or from a configuration that is near."""
    robot, later = problem.robot, 0
    for q in park(problem, free_rows(robot, rng, 25)):
        for near in (None, park(problem, random_q(robot, rng, 50))[0]):
            frozen = dict(zip(problem.frozen, problem.lower[: len(problem.frozen)].tolist(), strict=True))
            asked = problem_of(robot, near=near, freeze=frozen)
            T = compute_frames(robot, q)[robot.tool]
            targets = Targets.of([Target(T[:3, 3], R_world_tool=T[:3, :3])])
            found = run_still(asked, targets)
            judged = judge_branches(asked, targets)
            branches = judged.q[0][np.isfinite(judged.q[0]).all(axis=1)]
            away = branches - asked.centre
            turned = branches - 2 * np.pi * np.rint(away / (2 * np.pi)) * ~robot.is_prismatic
            branches = np.where((turned >= asked.lower) & (turned <= asked.upper), turned, branches)
            inside = ((branches >= asked.lower - 1e-9) & (branches <= asked.upper + 1e-9)).all(axis=1)
            free = inside & (compute_gaps(asked.collision, branches) > asked.collision.limit_m).all(axis=1)
            motion = measure_motion(asked.weights, asked.centre, branches)
            np.testing.assert_allclose(found.q[0], branches[free][motion[free].argmin()], rtol=0, atol=1e-8)
            later += not free[np.where(inside, motion, np.inf).argmin()]
    assert later > 0


@each_still
def test_of_an_arm_that_stands_still_later_attempts_show_other_branches(problem, rng):
    most = 0
    for q in park(problem, free_rows(problem.robot, rng, 20))[:6]:
        targets = make_targets(problem.robot, np.repeat(q[None], 60, axis=0), "pose")
        first, later = run_still(problem, targets), run_still(problem, targets, attempt=6)
        assert len({row.tobytes() for row in first.q}) == 1
        judged = judge_branches(problem, targets.take(np.array([0])))
        free = (compute_gaps(problem.collision, judged.q[0]) > problem.collision.limit_m).all(axis=1)
        assert len({row.tobytes() for row in later.q}) == (free & ~judged.outside[0]).sum()
        for found in (first, later):
            assert verify_many(problem.collision, targets, found.q, EXACT).accepted.all()
        most = max(most, len({row.tobytes() for row in later.q}))
    assert most > 1


@each_still
def test_what_an_arm_that_stands_still_counts_adds_up(problem, rng):
    targets = make_targets(problem.robot, random_q(problem.robot, rng, 60), "pose")
    found = run_still(problem, targets)
    reached, met = found.counts[:, REACHED] == 1, found.counts[:, EVALUATIONS] > 0
    assert (found.counts[:, ATTEMPTS] == 1).all()
    assert (found.counts[~reached, COLLIDING] == found.counts[~reached, EVALUATIONS]).all()
    assert (found.counts[reached, COLLIDING] < found.counts[reached, EVALUATIONS]).all()
    np.testing.assert_array_equal(found.pairs.sum(axis=1), found.counts[:, COLLIDING])
    assert (found.score[reached] == [0.0, 0.0]).all()
    assert (found.score[met & ~reached] == [0.0, UNKNOWN_DEPTH]).all()
    assert np.isinf(found.score[~met]).all()
    verdicts = verify_many(problem.collision, targets, found.q, EXACT)
    assert verdicts.accepted[reached].all()
    assert not verdicts.accepted[~reached].any()
    assert verdicts.within_tolerance[met].all()


@each_still
def test_one_pose_and_many_are_the_same_bits(problem, rng):
    targets = make_targets(problem.robot, random_q(problem.robot, rng, 30), "pose")
    many, joints = run_still(problem, targets), len(problem.robot.joints)
    block = flatten_answer(
        pack_still(problem, find_ur_arm(problem.robot)),
        pack_grader(problem.collision, problem.settings),
        POSE,
        problem.turns,
    )
    for row in range(30):
        out = np.full(size_of(joints, len(problem.collision.pairs)), np.nan)
        with quietly():
            accepted = PLAIN.answer_pose(*block, targets.T_world_tool[row], 4, row, 0, 1, out)
        q, score, counts, pairs = PLAIN.open_row(joints, 1, out)
        reached = many.counts[row, REACHED] == 1
        assert accepted == reached
        assert counts.tolist() == many.counts[row].tolist()
        assert pairs.tolist() == many.pairs[row].tolist()
        assert score.tolist() == many.score[row].tolist()
        if many.counts[row, EVALUATIONS]:
            assert q.tobytes() == many.q[row].tobytes()


@pytest.mark.parametrize("problem", STILL, ids=["ur5", "qiao2021"])
def test_a_module_of_the_robots_own_answers_the_same_while_it_stands_still(problem, rng):
    module = run_text(format_module(problem.collision, "pose"))
    targets = make_targets(problem.robot, random_q(problem.robot, rng, 20), "pose")
    by_tables, own = run_still(problem, targets), run_still(problem, targets, module=module)
    for name in ("q", "score", "counts"):
        np.testing.assert_array_equal(getattr(by_tables, name), getattr(own, name))


def test_nothing_is_found_out_of_reach(rng):
    targets = Targets.of([Target([3.0, 0.0, 0.5], R_world_tool=np.eye(3))])
    found = run(UR5, targets, no_seeds(UR5), budget=5)
    assert found.counts[0].tolist() == [0, 5, 0, 0, 0]


@pytest.mark.parametrize("seed", range(5))
def test_random_arms_whatever_carries_them(seed, rng):
    """Up to three joints of any kind before the arm; joints in any order; nothing to collide with."""
    robot = random_ur_robot(seed)
    targets = make_targets(robot, random_q(robot, rng, 6), "pose")
    found = run(robot, targets, no_seeds(robot), budget=60)
    verdicts = verify_many(CollisionModel.of(robot, "none"), targets, found.q, EXACT)
    reached = found.counts[:, REACHED] == 1
    assert verdicts.accepted[reached].all()
    assert reached.sum() >= 2

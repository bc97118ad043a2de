"""The engine `lm`: one target at a time and side by side are the same bits, and what it calls reached is."""

from functools import cache
from itertools import pairwise
from types import SimpleNamespace

import numba
import numpy as np
import pytest

import ikde
from ikde.kernels import lm
from ikde.kernels.arrays import ATTEMPTS, COLLIDING, COUNTS, EVALUATIONS, REACHED, UNKNOWN_DEPTH, DescentArrays
from ikde.kernels.flat_arguments import flatten_search
from ikde.kernels.tables import LANES
from ikde.model.collision_model import CollisionModel
from ikde.model.generate.assemble import format_module
from ikde.model.generate.module import load_module
from ikde.model.pack import pack_targets
from ikde.model.reach import arm_length_m
from ikde.model.target import KINDS, Targets
from ikde.solver.plain import compute_frames
from ikde.solver.problem import pack_searched
from ikde.solver.verify import verify_many
from tests.collision_robots import RANDOM, find_gaps
from tests.conftest import random_q
from tests.kernels.arrays import freeze
from tests.kernels.seeding import no_seeds, pack_seeds
from tests.targets import free_rows, target_at
from tests.three_joints import CROWDED
from tests.three_joints import ROBOT as THREE_JOINTS
from tests.uncompiled import plain_module, quietly, run_text

needs_compiler = pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="needs compiled kernels")
each_kind = pytest.mark.parametrize("kind", KINDS)
SETTINGS = ikde.SolveSettings()
ROBOTS = [ikde.load_robot("qiao2021"), RANDOM[2][0], RANDOM[8][0]]
BASE = np.array([0, 1, 2])
by_tables = plain_module(lm)


@cache
def generated(robot, kind):
    """The module of a robot, not compiled."""
    return run_text(format_module(CollisionModel.of(robot), kind))


def some_out_of_reach(robot, kind, count, rng):
    """Targets that a configuration free of collision meets, and one in ten that is out of reach."""
    Ts = compute_frames(robot, free_rows(robot, rng, count))[robot.tool].copy()
    Ts[5::10, :3, 3] += 50.0
    return Targets.of([target_at(T, kind) for T in Ts])


def make_question(robot, kind, count=2 * LANES + 5, budget=6, seed=3):
    """Targets, streams and budgets of differing size; starts from a pool of free configurations."""
    rng, detector = np.random.default_rng(seed), CollisionModel.of(robot).detector
    targets = some_out_of_reach(robot, kind, count, rng)
    base = robot.name == "qiao2021"
    Q = random_q(robot, rng, 400)
    Q[:, BASE] *= 0.0 if base else 1.0
    Q = Q[(find_gaps(robot, detector, Q) > detector.safe_distance_m).all(axis=1)]
    pool = pack_seeds(robot, Q, BASE) if base else no_seeds(robot)
    return SimpleNamespace(
        robot=robot,
        kind=kind,
        targets=targets,
        packed=pack_targets(targets),
        ranges=freeze([robot.lower, robot.upper, 0.5 * (robot.lower + robot.upper)]),
        descent=DescentArrays(
            rotation_length=arm_length_m(robot) / 6.0,
            position_tolerance=1e-5 - 1e-12,
            orientation_tolerance=1e-4 - 1e-12,
        ),
        seeds=pool,
        streams=rng.integers(0, 1000, len(targets)),
        budgets=np.where(np.arange(len(targets)) % 7 == 3, 1, budget),
    )


def make_outputs(asked):
    count, pairs = len(asked.targets), len(CollisionModel.of(asked.robot).pairs)
    return (
        np.zeros((count, len(asked.robot.joints))),
        np.full((count, 2), np.inf),
        np.zeros((count, COUNTS), dtype=np.int64),
        np.zeros((count, pairs), dtype=np.int64),
    )


def models_of(asked):
    """Packed robot and collision model."""
    return pack_searched(CollisionModel.of(asked.robot))


def solve_singly(module, asked, rows=None, *, first=0, budgets=None, outputs=None):
    """Row after row, in the order given; outputs are added to."""
    outputs = make_outputs(asked) if outputs is None else outputs
    budgets = asked.budgets if budgets is None else budgets
    models = models_of(asked)
    with quietly():
        for row in range(len(asked.targets)) if rows is None else rows:
            if outputs[2][row, REACHED]:
                continue
            question = (*flatten_search(*models, asked.ranges, asked.descent, asked.seeds), *asked.packed, row)
            lane = (np.uint64(9), int(asked.streams[row]), first, int(budgets[row]), *(array[row] for array in outputs))
            module.solve_target(*question, *lane)
    return outputs


def solve_together(module, asked, cuts=(), *, first=0, budgets=None, outputs=None):
    """Side by side, in calls that begin at the rows of `cuts`; outputs are added to."""
    outputs = make_outputs(asked) if outputs is None else outputs
    budgets = asked.budgets if budgets is None else budgets
    models = models_of(asked)
    ends = [0, *cuts, len(asked.targets)]
    with quietly():
        for start, stop in pairwise(ends):
            attempts = np.column_stack([np.full(stop - start, first), budgets[start:stop]])
            attempts[outputs[2][start:stop, REACHED] == 1, 1] = first
            block = flatten_search(*models, asked.ranges, asked.descent, asked.seeds)
            lanes = (np.array([start, stop]), np.uint64(9), asked.streams, attempts)
            module.solve_targets(*block, *asked.packed, *lanes, *outputs)
    return outputs


def assert_same_bits(a, b):
    for x, y in zip(a, b, strict=True):
        assert x.tobytes() == y.tobytes()


@pytest.fixture(
    scope="module", params=[(robot, kind) for robot in ROBOTS for kind in KINDS], ids=lambda p: f"{p[0].name}-{p[1]}"
)
def asked(request):
    return make_question(*request.param)


@pytest.fixture(scope="module")
def answers(asked):
    return solve_singly(generated(asked.robot, asked.kind), asked)


# ---- the same bits, however the rows are asked


@pytest.mark.parametrize("cuts", [(), (1, 2, 30), (LANES,)], ids=str)
def test_side_by_side_is_one_after_the_other(asked, answers, cuts):
    assert_same_bits(solve_together(generated(asked.robot, asked.kind), asked, cuts), answers)


def test_the_order_and_the_other_rows_do_not_matter(asked, answers, rng):
    module = generated(asked.robot, asked.kind)
    order = rng.permutation(len(asked.targets))[:9]
    some = solve_singly(module, asked, order)
    assert_same_bits([array[order] for array in some], [array[order] for array in answers])


def test_attempts_may_be_cut_into_calls(asked, answers):
    module = generated(asked.robot, asked.kind)
    outputs = solve_together(module, asked, budgets=np.minimum(asked.budgets, 2))
    outputs = solve_together(module, asked, (7,), first=2, budgets=np.maximum(asked.budgets, 2), outputs=outputs)
    assert_same_bits(outputs, answers)


def test_data_driven_rows_are_the_same_side_by_side():
    asked = make_question(ROBOTS[1], "pose", count=LANES + 3, budget=3)
    assert_same_bits(solve_together(by_tables, asked), solve_singly(by_tables, asked))


# ---- what the answers are


def test_what_is_reached_is_accepted_by_plain_numpy(asked, answers):
    q, _, counts, _ = answers
    reached = counts[:, REACHED] == 1
    verdicts = verify_many(CollisionModel.of(asked.robot), asked.targets, q, SETTINGS)
    assert verdicts.accepted[reached].all()
    assert reached[asked.budgets > 1].mean() > 0.4
    assert not reached[5::10].any()


def test_budgets_are_kept_and_counted(asked, answers):
    _, score, counts, pair_counts = answers
    reached = counts[:, REACHED] == 1
    assert (counts[:, ATTEMPTS] <= asked.budgets).all()
    assert (counts[~reached, ATTEMPTS] == asked.budgets[~reached]).all()
    assert (counts[:, EVALUATIONS] >= counts[:, ATTEMPTS]).all()
    assert (counts[:, EVALUATIONS] <= counts[:, ATTEMPTS] * asked.descent.most_steps).all()
    np.testing.assert_array_equal(pair_counts.sum(axis=1), counts[:, COLLIDING])
    assert (counts[:, COLLIDING] + reached <= counts[:, ATTEMPTS]).all()
    assert (score[reached] == [0.0, 0.0]).all()
    assert (score[~reached & (counts[:, COLLIDING] > 0)] == [0.0, UNKNOWN_DEPTH]).all()
    assert (score[~reached & (counts[:, COLLIDING] == 0), 0] == 1.0).all()


def test_a_row_that_is_not_reached_keeps_its_best(asked, answers):
    """More attempts never make the score worse, and what is kept lies inside the ranges."""
    module = generated(asked.robot, asked.kind)
    outputs, before = make_outputs(asked), np.full((len(asked.targets), 2), np.inf)
    for attempt in range(3):
        budgets = np.full(len(asked.targets), attempt + 1)
        solve_together(module, asked, first=attempt, budgets=budgets, outputs=outputs)
        after = outputs[1]
        better = (after[:, 0] < before[:, 0]) | ((after[:, 0] == before[:, 0]) & (after[:, 1] <= before[:, 1]))
        assert better.all()
        before = after.copy()
    q = outputs[0]
    assert np.all((asked.robot.lower <= q) & (q <= asked.robot.upper))


def test_rows_without_attempts_are_left_alone(asked):
    module = generated(asked.robot, asked.kind)
    budgets = np.where(np.arange(len(asked.targets)) % 2, asked.budgets, 0)
    outputs = solve_together(module, asked, budgets=budgets)
    assert (outputs[2][::2] == 0).all()
    assert (outputs[2][1::2, ATTEMPTS] > 0).all()
    assert np.isinf(outputs[1][::2]).all()
    assert_same_bits(solve_together(module, asked, budgets=np.zeros_like(budgets)), make_outputs(asked))


@each_kind
def test_the_data_driven_instance_reaches_the_same_targets(kind):
    """Other roundings on the way, the same seeds: the same targets reached with the same number of attempts."""
    for robot in (ROBOTS[0], ROBOTS[1], CROWDED):
        asked = make_question(robot, kind, count=12, budget=3)
        _, _, counts, _ = solve_singly(generated(robot, kind), asked)
        q, _, others, _ = solve_singly(by_tables, asked)
        np.testing.assert_array_equal(counts[:, [REACHED, ATTEMPTS]], others[:, [REACHED, ATTEMPTS]])
        verdicts = verify_many(CollisionModel.of(robot), asked.targets, q, SETTINGS)
        assert verdicts.accepted[others[:, REACHED] == 1].all()


def assert_compiled_like_plain(robot, kind):
    """Machine code of both, vector instructions and all, and plain Python: the same bits."""
    asked = make_question(robot, kind)
    compiled = load_module(CollisionModel.of(robot), kind)
    expected = solve_singly(generated(robot, kind), asked)
    assert_same_bits(solve_singly(compiled, asked), expected)
    assert_same_bits(solve_together(compiled, asked, (6,)), expected)


@needs_compiler
def test_compiled_kernels_give_the_same_bits():
    """A robot of three joints: it is compiled in seconds."""
    assert_compiled_like_plain(THREE_JOINTS, "pose")


@needs_compiler
def test_compiled_tables_give_the_same_bits():
    """A robot whose check is written as tables."""
    assert_compiled_like_plain(CROWDED, "position")


@pytest.mark.slow
@needs_compiler
@each_kind
def test_compiled_kernels_of_a_large_robot_give_the_same_bits(kind):
    assert_compiled_like_plain(ROBOTS[0], kind)


# ---- the rules of an attempt


def test_an_attempt_goes_on_until_it_is_met_hopeless_or_at_its_end():
    descent = DescentArrays(position_tolerance=1e-3, orientation_tolerance=1e-2, rotation_length=0.5)
    judge = by_tables.judge_step
    assert judge(descent, 1, 1e-3, 1e-2) == lm.MET
    assert judge(descent, 1, 1.1e-3, 1e-2) == lm.GO_ON
    assert judge(descent, 1, 1e-3, 1.1e-2) == lm.GO_ON
    assert judge(descent, descent.patience - 1, 9.0, 9.0) == lm.GO_ON
    assert judge(descent, descent.patience, 1.01 * descent.hopeless, 0.0) == lm.GIVE_UP
    assert judge(descent, descent.patience, 0.0, 2.02 * descent.hopeless) == lm.GIVE_UP
    assert judge(descent, descent.patience, 0.99 * descent.hopeless, 1.98 * descent.hopeless) == lm.GO_ON
    assert judge(descent, descent.most_steps, 2e-3, 0.0) == lm.GIVE_UP
    assert judge(descent, descent.most_steps, 1e-4, 0.0) == lm.MET


def test_better_answers_take_the_place_of_worse_ones():
    """Not met, less far off, met but colliding, free: each displaces the ones before and none after."""
    descent, record = DescentArrays(rotation_length=0.5), by_tables.record
    steps = [(lm.GIVE_UP, -1, 0.5, 0.0), (lm.GIVE_UP, -1, 0.2, 0.2), (lm.MET, 1, 1e-6, 0.0), (lm.MET, -1, 1e-5, 0.0)]
    for order in ([0, 1, 2, 3], [2, 1, 0, 3], [1, 0, 2, 2]):
        q, score, counts, pairs = np.zeros(1), np.full(2, np.inf), np.zeros(COUNTS, dtype=int), np.zeros(2, dtype=int)
        best, done = -1, False
        for k in order:
            done = record(descent, *steps[k], np.array([float(k)]), q, score, counts, pairs)
            best = max(best, k)
            assert q[0] == best
        assert done == (order[-1] == 3)
        assert counts[REACHED] == done
        assert counts[ATTEMPTS] == len(order)
        assert counts[COLLIDING] == pairs[1] == order.count(2)


def test_work_is_found_in_order():
    attempts = np.array([[0, 0], [2, 5], [3, 3], [0, 1]])
    for start, expected in ((10, 11), (11, 11), (12, 13), (13, 13), (14, 14)):
        assert by_tables.find_work(attempts, 10, start, 14) == expected

"""Differential evolution against its naive twin, bit by bit of the random stream, and its laws."""

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ikde.kernels.arrays import ATTEMPTS, COLLIDING, COUNTS, EVALUATIONS, OUTSIDE, REACHED
from ikde.kernels.evolution import evolve, evolve_alone, find_best, is_better, make_workspace, solve_lane
from ikde.kernels.mutation import REPAIRS, STRATEGIES
from ikde.kernels.rng import seed_stream
from ikde.model.collision_model import CollisionModel
from ikde.model.pack import pack_robot, pack_targets
from ikde.model.target import Target
from ikde.solver.problem import pack_search
from ikde.track.settings import TypicalSettings
from ikde.track.typical import bound_sample
from ikde.track.typical import pack_search as pack_sample_search
from tests import reference
from tests.conftest import random_q
from tests.flat_settings import flat_settings
from tests.problems import problem_of
from tests.random_robots import random_robot
from tests.targets import make_target
from tests.track.paper_tasks import follower_of, short_task, start_of

KINDS = ("position", "axis", "pose")
RULES = ("ignore", "reject", "feasibility")
UPDATES = ("generation", "in_place")


def make_case(robot, *, rule="feasibility", freeze=None, **changes):
    """A small problem; the rule `ignore` is that of a robot without a detector."""
    chosen = {"population": 8, "generations": 10, "collision": "reject" if rule == "ignore" else rule, **changes}
    detector = "none" if rule == "ignore" else None
    return problem_of(robot, flat_settings(**chosen), collision=detector, freeze=freeze)


def run_evolve(problem, target, seed=1):
    """The kernel's outcome as the twin returns it."""
    robot, detector = pack_robot(problem.robot), problem.collision.arrays
    work = make_workspace(robot, detector, len(problem.lower), problem.settings.de.population)
    state = np.zeros(1, dtype=np.uint64)
    seed_stream(np.uint64(seed), np.int64(2), 3, state)
    search, lower, upper = pack_search(problem), problem.lower.copy(), problem.upper.copy()
    best, meets, evaluations = evolve(robot, detector, pack_targets([target]), 0, search, lower, upper, state, work)
    return work.x, work.score, int(best), bool(meets), int(evaluations), int(state[0])


def assert_like_twin(problem, target, seed=1):
    """Same best member, same verdict, same count, same population, and the stream at the same place."""
    x, score, best, meets, evaluations, state = run_evolve(problem, target, seed)
    stream = reference.Stream.for_attempt(seed, 2, 3)
    x_twin, scores, best_twin, meets_twin, evaluations_twin = reference.evolve(problem, target, stream)
    assert (best, meets, evaluations, state) == (best_twin, meets_twin, evaluations_twin, stream.state)
    np.testing.assert_allclose(x[best], x_twin[best], rtol=0, atol=1e-12)
    if evaluations >= problem.settings.de.population:  # else the first generation is not full
        np.testing.assert_allclose(x, x_twin, rtol=0, atol=1e-12)
    assert tuple(score[best][::-1]) == pytest.approx(scores[best], rel=1e-12, abs=1e-12)
    return meets


@pytest.mark.parametrize("update", UPDATES)
@pytest.mark.parametrize("rule", RULES)
@pytest.mark.parametrize("kind", KINDS)
def test_paper_robot_evolves_like_the_twin(qiao, kind, rule, update, rng):
    target = make_target(qiao, random_q(qiao, rng), kind)
    assert not assert_like_twin(make_case(qiao, rule=rule, update=update), target)


# Without robot 2: two of its members collide equally deep, and there rounding decides which one is better.
@pytest.mark.parametrize("seed", range(13))
def test_random_robots_evolve_like_the_twin(seed, rng):
    robot = random_robot(seed)
    rule, update, kind = RULES[seed % 3], UPDATES[seed % 2], KINDS[seed // 3 % 3]
    assert_like_twin(
        make_case(robot, rule=rule, update=update, generations=6), make_target(robot, random_q(robot, rng), kind)
    )


@pytest.mark.parametrize("update", UPDATES)
@pytest.mark.parametrize("strategy", STRATEGIES)
def test_every_strategy_evolves_like_the_twin(strategy, update, rng):
    robot = random_robot(3)
    problem = make_case(robot, strategy=strategy, update=update, weight=0.8)
    assert_like_twin(problem, make_target(robot, random_q(robot, rng), "position"))


@pytest.mark.parametrize("update", UPDATES)
@pytest.mark.parametrize("bounds", REPAIRS)
def test_every_repair_evolves_like_the_twin(bounds, update, rng):
    robot = random_robot(5)
    problem = make_case(robot, rule="ignore", bounds=bounds, update=update, weight=0.9)
    assert_like_twin(problem, make_target(robot, random_q(robot, rng), "pose"))


def test_a_narrow_start_evolves_like_the_twin_and_stays_in_the_middle(rng):
    robot = random_robot(5)
    problem = make_case(robot, start_share=0.125)
    assert_like_twin(problem, make_target(robot, random_q(robot, rng), "pose"))
    start, *_ = run_evolve(
        make_case(robot, start_share=0.125, generations=1), make_target(robot, random_q(robot, rng), "pose"), 3
    )
    distance = np.abs(start - 0.5 * (robot.lower + robot.upper)) / (robot.upper - robot.lower)
    assert np.mean(distance <= 0.0625) > 0.5


@pytest.mark.parametrize("update", UPDATES)
@pytest.mark.parametrize("rule", RULES)
def test_it_stops_like_the_twin_when_the_target_is_met(qiao, rule, update, rng):
    target = make_target(qiao, random_q(qiao, rng), "position")
    problem = make_case(qiao, rule=rule, update=update, generations=60, position_tolerance_m=0.3)
    assert assert_like_twin(problem, target)


def test_a_met_target_is_free_under_feasibility(qiao, rng):
    target = make_target(qiao, random_q(qiao, rng), "position")
    problem = make_case(qiao, generations=60, position_tolerance_m=0.3, update="generation")
    for seed in range(20):
        x, score, best, meets, _, _ = run_evolve(problem, target, seed)
        assert meets
        assert score[best, 1] == 0.0
        assert reference.compute_depth(qiao, problem.collision.detector, x[best]) == 0.0


@pytest.mark.parametrize(("rule", "update"), list(itertools.product(RULES, UPDATES)))
def test_the_best_score_never_worsens(qiao, rule, update, rng):
    target = make_target(qiao, random_q(qiao, rng), "pose")
    scores = []
    for generations in range(1, 40):
        problem = make_case(qiao, rule=rule, update=update, generations=generations)
        _, score, best, _, _, _ = run_evolve(problem, target)
        scores.append(tuple(score[best][::-1]))
    assert scores == sorted(scores, reverse=True)
    assert scores[-1] < scores[0]


def test_the_best_member_has_the_best_score(qiao, rng):
    target = make_target(qiao, random_q(qiao, rng), "pose")
    for update in UPDATES:
        _, score, best, _, _, _ = run_evolve(make_case(qiao, update=update), target)
        assert tuple(score[best][::-1]) == min(tuple(row[::-1]) for row in score)


@pytest.mark.parametrize("strategy", STRATEGIES)
def test_a_frozen_joint_never_moves(qiao, strategy, rng):
    target = make_target(qiao, random_q(qiao, rng), "position")
    problem = make_case(qiao, strategy=strategy, freeze={"q1": 0.1, "d_x": 1.0 / 3.0})
    x, *_ = run_evolve(problem, target)
    assert set(x[:, qiao.joint_names.index("q1")]) == {0.1}
    assert set(x[:, qiao.joint_names.index("d_x")]) == {1.0 / 3.0}


@pytest.mark.parametrize("bounds", [name for name in REPAIRS if name != "none"])
@pytest.mark.parametrize("update", UPDATES)
def test_repaired_populations_stay_inside_the_limits(qiao, bounds, update, rng):
    problem = make_case(qiao, bounds=bounds, update=update, weight=0.9)
    x, *_ = run_evolve(problem, make_target(qiao, random_q(qiao, rng), "position"))
    assert np.all((problem.lower <= x) & (x <= problem.upper))


def test_every_generation_costs_one_population_of_evaluations(qiao, rng):
    for generations in (1, 5):
        _, _, _, meets, evaluations, _ = run_evolve(
            make_case(qiao, generations=generations), make_target(qiao, random_q(qiao, rng), "pose")
        )
        assert not meets
        assert evaluations == 8 * (generations + 1)


VALUES = st.sampled_from([0.0, 1e-12, 0.5, 1.0, np.inf]) | st.floats(0.0, 10.0)
DEPTHS = st.sampled_from([0.0, 1e-12, 0.1]) | st.floats(0.0, 1.0)


@settings(max_examples=200)
@given(cost=VALUES, depth=DEPTHS, other_cost=VALUES, other_depth=DEPTHS)
def test_is_better_is_debs_rules(cost, depth, other_cost, other_depth):
    better = bool(is_better(cost, depth, np.array([other_cost, other_depth])))
    if depth == 0.0 and other_depth == 0.0:
        assert better == (cost <= other_cost)
    elif (depth == 0.0) != (other_depth == 0.0):
        assert better == (depth == 0.0)
    elif depth != other_depth:
        assert better == (depth < other_depth)
    else:
        assert better == (cost <= other_cost)


@settings(max_examples=100)
@given(rows=st.lists(st.tuples(VALUES, DEPTHS), min_size=1, max_size=10))
def test_find_best_is_the_first_of_the_best(rows):
    expected = min(range(len(rows)), key=lambda i: rows[i][::-1])
    assert find_best(np.array(rows)) == expected


# ---- whole solves: attempts cut into calls, and what is counted

HARD = Target([0.54, -0.131, 0.974])


def run_lane(robot, target, blocks, *, seed=3, detector=None, near=None, **changes):
    """Run the attempts block by block: (q, score, counts, pair counts)."""
    settings = flat_settings(**{"population": 8, "generations": 40, "update": "generation", **changes})
    problem = problem_of(robot, settings, collision=detector, near=near)
    packed, spheres = pack_robot(robot), problem.collision.arrays
    q, score, counts = np.zeros(len(robot.joints)), np.full(2, np.inf), np.zeros(COUNTS, dtype=np.int64)
    pairs = np.zeros(len(spheres.pairs), dtype=np.int64)
    search, targets = pack_search(problem), pack_targets([target])
    for begin, end in blocks:
        out = (q, score, counts, pairs)
        block = np.array([begin, end])
        if not counts[REACHED]:
            solve_lane(packed, spheres, targets, 0, search, np.uint64(seed), np.int64(0), block, *out)
    return q, score, counts, pairs


@pytest.mark.parametrize(
    ("changes", "reached"),
    [
        ({"collision": "reject"}, False),
        ({"collision": "feasibility"}, False),
        ({"collision": "reject", "position_tolerance_m": 0.05, "generations": 100}, None),
        ({"collision": "feasibility", "position_tolerance_m": 0.05, "generations": 100}, True),
    ],
)
def test_attempts_cut_into_calls_give_the_same_bits(qiao, changes, reached):
    whole = run_lane(qiao, HARD, [(0, 7)], **changes)
    cut = run_lane(qiao, HARD, [(0, 1), (1, 3), (3, 3), (3, 7)], **changes)
    for one, other in zip(whole, cut, strict=True):
        assert one.tobytes() == other.tobytes()
    assert reached is None or bool(whole[2][REACHED]) == reached


def test_no_attempts_touch_nothing(qiao):
    q, score, counts, pairs = run_lane(qiao, HARD, [(0, 0)])
    assert not q.any()
    assert not counts.any()
    assert not pairs.any()
    assert np.all(score == np.inf)


def test_a_start_that_solves_already_is_the_answer(qiao):
    near = np.array([0.4, -0.2, 0.5, 1.0, 0.3, -0.9, 0.4, 0.2, 0.1])
    target = Target(reference.compute_frames(qiao, near)["tool"][:3, 3])
    q, _, counts, _ = run_lane(qiao, target, [(0, 1)], near=near)
    assert counts[REACHED] == 1
    assert counts[EVALUATIONS] == 1
    np.testing.assert_array_equal(q, near)


def test_unreached_attempts_and_evaluations_are_counted(qiao):
    counts = run_lane(qiao, HARD, [(0, 3)], generations=2)[2]
    expected = np.zeros(COUNTS, dtype=np.int64)
    expected[ATTEMPTS], expected[EVALUATIONS] = 3, 3 * 8 * 3
    np.testing.assert_array_equal(counts, expected)


def test_rejected_attempts_are_counted_with_the_pairs_that_blocked_them(qiao):
    changes = {"collision": "reject", "position_tolerance_m": 0.05, "generations": 200}
    _, score, counts, pairs = run_lane(qiao, HARD, [(0, 20)], **changes)
    assert counts[COLLIDING] > 0
    assert counts[COLLIDING] <= pairs.sum()
    assert pairs.max() <= counts[COLLIDING]
    assert score[0] == 0.0


def test_the_score_of_a_reached_target_is_zero(qiao):
    q, score, counts, _ = run_lane(qiao, HARD, [(0, 30)], position_tolerance_m=0.05, generations=200)
    assert counts[REACHED] == 1
    assert tuple(score) == (0.0, 0.0)
    T = reference.compute_frames(qiao, q)["tool"]
    assert reference.compute_position_error(T, HARD) <= 0.05
    assert reference.compute_depth(qiao, CollisionModel.of(qiao).detector, q) == 0.0


def test_the_kept_configuration_has_the_lowest_cost_of_all_attempts(qiao):
    single = [run_lane(qiao, HARD, [(k, k + 1)], generations=5)[1][1] for k in range(8)]
    q, score, _, _ = run_lane(qiao, HARD, [(0, 8)], generations=5)
    assert score[1] == min(single)
    T = reference.compute_frames(qiao, q)["tool"]
    assert reference.compute_position_error(T, HARD) == pytest.approx(score[1], abs=1e-12)


def test_unrepaired_solutions_outside_the_ranges_are_not_reached(qiao):
    lane = {"bounds": "none", "generations": 300, "position_tolerance_m": 0.01, "detector": "none", "weight": 0.9}
    counts = sum(run_lane(qiao, Target([5.5, 0.0, 0.9]), [(0, 5)], seed=seed, **lane)[2] for seed in range(5))
    assert counts[OUTSIDE] > 0


def test_near_keeps_the_first_attempt_in_its_box(qiao):
    q, _, counts, _ = run_lane(qiao, HARD, [(0, 1)], near=qiao.home, generations=3)
    assert counts[ATTEMPTS] == 1
    assert np.all(np.abs(q - qiao.home) <= (qiao.upper - qiao.lower) / 64 + 1e-15)


def test_a_sample_by_itself_is_one_population_on_its_stream(qiao):
    follower, sample = follower_of(qiao, short_task(1), collision="none"), 3
    alone = TypicalSettings(generations=20)
    robot, detector, search = (
        pack_robot(qiao),
        CollisionModel.of(qiao, "none").arrays,
        pack_sample_search(follower, alone),
    )
    lower, upper = bound_sample(follower, alone, start_of("qiao2021", 1))
    work, q, state = make_workspace(robot, detector, 9, 50), np.zeros(9), np.zeros(1, dtype=np.uint64)
    evolve_alone(robot, detector, follower.target, sample, search, lower, upper, np.uint64(5), work, q)
    seed_stream(np.uint64(5), np.int64(sample), np.int64(0), state)
    best, _, _ = evolve(robot, detector, follower.target, sample, search, lower, upper, state, work)
    np.testing.assert_array_equal(q, work.x[best])
    assert ((q >= lower) & (q <= upper)).all()

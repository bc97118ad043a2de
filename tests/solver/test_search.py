"""The one place that calls the search kernels: bits do not depend on threads or calls, and Ctrl-C gets through."""

import threading
from itertools import count
from types import SimpleNamespace

import numpy as np
import pytest

import ikde
from ikde.kernels.arrays import ATTEMPTS, COLLIDING, EVALUATIONS, REACHED
from ikde.kernels.evolution import solve_lanes
from ikde.solver import choice
from ikde.solver import search as module
from ikde.solver.engine_table import ENGINES, NAMES
from ikde.solver.engines import de
from ikde.solver.engines.de import DifferentialEvolution
from ikde.solver.proof import prove_many
from ikde.solver.search import make_engine, run_on_threads, search, usable_cores
from tests.conftest import random_q
from tests.flat_settings import flat_settings
from tests.problems import problem_of
from tests.scara import make_scara
from tests.targets import free_q, make_target

CHEAP = flat_settings(population=8, generations=5, restarts=3)
TARGETS = [ikde.Target((0.8, 0.1 * k, 1.0)) for k in range(5)]


@pytest.fixture
def problem(qiao):
    return problem_of(qiao, CHEAP)


def bits(found):
    pairs = [found.pair_counts.row(row).tolist() for row in range(len(found.q))]
    return found.q.tobytes(), found.counts.tobytes(), pairs


def run(problem, targets=TARGETS, streams=range(5), **options):
    return search(problem, targets, seed=7, streams=list(streams), **options)


@pytest.mark.parametrize("threads", [2, 3, 16, None])
def test_threads_do_not_change_the_bits(problem, threads):
    assert bits(run(problem, threads=threads)) == bits(run(problem, threads=1))


def test_an_answer_hangs_on_its_stream_not_on_its_neighbours(problem):
    whole = run(problem)
    for k, target in enumerate(TARGETS):
        assert bits(run(problem, [target], [k])) == bits(whole.row(k))


def test_cutting_attempts_into_calls_does_not_change_the_bits(problem, monkeypatch):
    whole = run(problem)
    monkeypatch.setattr(DifferentialEvolution, "attempts_per_call", 1)
    assert bits(run(problem)) == bits(whole)


def test_only_what_is_unreached_after_a_few_attempts_is_proved_out_of_reach(qiao, substitute):
    asked = []

    def watched(problem, targets):
        asked.append(len(targets))
        return prove_many(problem, targets)

    substitute(prove_many, watched)
    problem = problem_of(qiao, ikde.SolveSettings(method="de", restarts=9))
    found = search(problem, [*TARGETS, ikde.Target((50.0, 0.0, 1.0))], seed=1, streams=range(6))
    assert asked == [1]
    assert np.flatnonzero(found.excess_m).tolist() == [5]
    assert found.counts[:, REACHED].tolist() == [1, 1, 1, 1, 1, 0]
    assert found.counts[5, ATTEMPTS] == ENGINES["de"].attempts_before_proof


def test_an_orientation_that_no_joint_gives_is_excluded_after_a_few_attempts():
    robot, settings = make_scara(), ikde.SolveSettings(method="de", restarts=9)
    tilted = ikde.Target((0.5, 0.0, 0.0), axis_world_tool=(1, 0, -1))
    upright, free = ikde.Target((0.74, 0.1, -0.2), axis_world_tool=(0, 0, -1)), ikde.Target((0.74, 0.1, 0.2))
    targets = [upright, tilted, free, tilted]
    found = search(problem_of(robot, settings), targets, seed=1, streams=range(4))
    assert found.excess_rad == pytest.approx([0.0, np.pi / 4, 0.0, np.pi / 4])
    assert found.counts[:, REACHED].tolist() == [1, 0, 1, 0]
    assert found.counts[[1, 3], ATTEMPTS].tolist() == [ENGINES["de"].attempts_before_proof] * 2
    rows = ikde.solve_many(robot, targets, settings, bulk=ikde.BulkOptions(explain=False))
    assert rows[1].stop_reason == "out_of_reach"
    assert rows[1].reason == "out of reach: at least 0.785 rad off in orientation, whatever the joints do"


def test_the_first_few_attempts_are_part_of_the_budget(qiao):
    for restarts in (1, 3, 4, 5, 21):
        settings = flat_settings(population=6, generations=1, restarts=restarts)
        problem = problem_of(qiao, settings)
        assert run(problem).counts[:, ATTEMPTS].tolist() == [restarts] * 5
        whole, cut = run(problem, attempts=restarts), run(problem)
        assert bits(whole) == bits(cut)


@pytest.mark.parametrize("lanes", [1, 2, 3, 64])
def test_lanes_that_share_a_call_do_not_change_the_bits(qiao, monkeypatch, lanes):
    settings = flat_settings(population=8, generations=40, restarts=6, position_tolerance_m=0.02)
    far = ikde.Target((50.0, 0.0, 1.0))  # proved out of reach: fewer attempts than its neighbours
    targets = [*TARGETS, far, *TARGETS]
    problem = problem_of(qiao, settings)
    whole = search(problem, targets, seed=7, streams=range(11))
    assert len(set(whole.counts[:, ATTEMPTS])) > 2
    monkeypatch.setattr(de, "EVALUATIONS_PER_CALL", 10**9)
    monkeypatch.setattr(de, "LANES_PER_CALL", lanes)
    assert bits(search(problem, targets, seed=7, streams=range(11))) == bits(whole)


def test_short_searches_share_a_call_and_long_ones_do_not(qiao):
    def lanes(**changes):
        settings = flat_settings(ikde.SolveSettings.for_method("de"), **changes)
        return de._lanes_per_call(problem_of(qiao, settings))

    assert lanes() == 1
    assert lanes(generations=1, restarts=1) == 64
    assert lanes(generations=7, restarts=1) == 50


FROZEN_BASE, BASE_AND_ELBOW = {"d_x", "d_y", "q_z"}, {"d_x", "d_y", "q_z", "q3"}


@pytest.mark.parametrize(("frozen", "attempts"), [(FROZEN_BASE, 1), (BASE_AND_ELBOW, 1), ({"d_x"}, 20)])
def test_the_branches_of_an_arm_on_a_frozen_base_are_enumerated_once(qiao, frozen, attempts):
    target, settings = make_target(qiao, qiao.home, "pose"), ikde.SolveSettings(method="analytic", restarts=20)
    found = search(
        problem_of(qiao, settings, collision="single", freeze=dict.fromkeys(frozen, 0.0)), [target], seed=1, streams=[0]
    )
    assert found.counts[0, [REACHED, ATTEMPTS]].tolist() == [0, attempts]


def test_streams_and_seeds_are_different_searches(problem):
    same_target = run(problem, [TARGETS[0]] * 3, range(3)).q
    assert len({q.tobytes() for q in same_target}) == 3
    other = search(problem, TARGETS[:1], seed=8, streams=[0]).q
    assert other.tobytes() != same_target[:1].tobytes()


def test_attempts_and_evaluations_are_counted(problem):
    counts = run(problem).counts
    assert counts[:, REACHED].tolist() == [0] * 5
    assert counts[:, ATTEMPTS].tolist() == [3] * 5
    assert np.all(counts[:, EVALUATIONS] >= 3 * 8 * 5)


def test_later_attempts_are_other_attempts(problem):
    first, second = (run(problem, first_attempt=k, attempts=1) for k in (0, 1))
    assert first.q.tobytes() != second.q.tobytes()


def test_a_reached_target_is_not_searched_further(qiao):
    settings = ikde.SolveSettings.for_method("auto")
    found = search(problem_of(qiao, settings), TARGETS, seed=1, streams=range(5))
    assert found.counts[:, REACHED].tolist() == [1] * 5
    assert found.counts[:, ATTEMPTS].max() < settings.budget("lm")


@pytest.mark.parametrize("threads", [1, 2])
def test_ctrl_c_inside_a_lane_gets_through(problem, substitute, threads):
    def interrupted(*arguments):
        raise KeyboardInterrupt

    substitute(solve_lanes, interrupted)
    with pytest.raises(KeyboardInterrupt):
        run(problem, threads=threads)


def test_after_ctrl_c_no_further_lane_begins(problem, monkeypatch, substitute):
    begun = []
    wait = threading.Event()

    def lane(robot, detector, target, lanes, *rest):
        if lanes[0] == lanes[1]:
            return  # only compiles
        begun.append(lanes[0])
        if lanes[0] == 0:
            raise KeyboardInterrupt
        wait.wait(0.05)  # long enough that the first is heard of

    substitute(solve_lanes, lane)
    monkeypatch.setattr(DifferentialEvolution, "attempts_per_call", 1)
    monkeypatch.setattr(de, "LANES_PER_CALL", 1)
    targets = TARGETS * 20
    with pytest.raises(KeyboardInterrupt):
        run(problem, targets, range(100), threads=2, attempts=50)
    assert len(begun) < 100


def test_an_error_inside_a_lane_gets_through(problem, substitute):
    def broken(*arguments):
        raise ZeroDivisionError

    substitute(solve_lanes, broken)
    with pytest.raises(ZeroDivisionError):
        run(problem, threads=2)


def test_there_is_a_core_to_use():
    assert usable_cores() >= 1


@pytest.mark.parametrize(("kind", "later"), [("axis", "memetic")])
def test_what_a_later_engine_reaches_replaces_what_an_earlier_one_met_in_collision(qiao, rng, monkeypatch, kind, later):
    hasty = ENGINES["lm"]._replace(attempts_before_next=1)
    monkeypatch.setattr(choice, "ENGINES", {**ENGINES, "lm": hasty})
    choice.choose_budgets.cache_clear()
    taken_over = 0
    for stream in range(40):
        q = free_q(qiao, rng)
        frozen = dict(zip(qiao.joint_names[:3], q[:3].tolist(), strict=True))
        problem = problem_of(qiao, freeze=frozen)
        found = search(problem, [make_target(qiao, q, kind)], seed=1, streams=[stream])
        assert found.counts[0, REACHED]
        if NAMES[found.engine[0]] == later and found.counts[0, COLLIDING]:
            taken_over += 1
            assert not ikde.check(qiao, found.q[0]).collision
    assert taken_over > 0


@pytest.fixture
def clock(monkeypatch):
    """A clock that says that every call of an engine takes a second."""
    monkeypatch.setattr(module, "time", SimpleNamespace(perf_counter=count().__next__))


def make_endless(robot, method, **settings):
    """A question that is never answered: every configuration collides."""
    settings = flat_settings(ikde.SolveSettings(method=method), **{"restarts": 10**6, "timeout_s": 5.0, **settings})
    return problem_of(robot, settings, collision="single")


BRIEF = {"population": 6, "generations": 1}


@pytest.mark.parametrize(
    ("method", "settings", "first", "attempts"), [("de", BRIEF, 1, 1), ("lm", {}, 16, 64), ("memetic", {}, 1, 1)]
)
def test_no_attempt_is_begun_when_the_time_is_up(qiao, clock, method, settings, first, attempts):
    problem = make_endless(qiao, method, **settings)
    found = search(problem, TARGETS[:1], seed=1, streams=[0])
    assert found.counts[0, [REACHED, ATTEMPTS]].tolist() == [0, first + 4 * attempts]
    assert found.seconds.tolist() == [5.0]
    found = search(problem, TARGETS[:1], seed=1, streams=[0], spent_s=3.5)
    assert found.counts[0, ATTEMPTS] == first + attempts


def test_every_target_has_its_own_time(qiao, clock):
    found = search(make_endless(qiao, "de", **BRIEF), TARGETS, seed=1, streams=range(5), threads=1)
    assert found.counts[:, ATTEMPTS].tolist() == [5] * 5
    found = search(make_endless(qiao, "lm"), TARGETS, seed=1, streams=range(5), threads=1)
    assert (
        found.counts[:, ATTEMPTS].tolist() == [64 + 19 * (64 // 5)] * 5
    )  # 25 calls that they share; the 6th ends at 64
    assert found.seconds == pytest.approx(np.full(5, 5.0))


def test_an_engine_that_has_no_time_left_is_not_even_made(qiao, clock, substitute):
    made = []
    substitute(make_engine, lambda name, question: made.append(name) or make_engine(name, question))
    search(make_endless(qiao, "auto", timeout_s=1.0), TARGETS[:1], seed=1, streams=[0])
    assert made == ["lm"]


@pytest.mark.parametrize(("method", "targets"), [("auto", 1), ("auto", 70), ("memetic", 2), ("de", 3)])
def test_a_timeout_that_is_not_reached_changes_no_bits(qiao, rng, method, targets):
    kinds = ("pose", "axis", "position")
    asked = [make_target(qiao, free_q(qiao, rng), kinds[k % 3]) for k in range(targets)]

    def run(timeout_s):
        settings = ikde.SolveSettings(method=method, restarts=3, timeout_s=timeout_s)
        problem = problem_of(qiao, settings)
        return search(problem, asked, seed=1, streams=range(targets))

    assert bits(run(None)) == bits(run(1e6))


@pytest.mark.parametrize("threads", [1, 2])
@pytest.mark.parametrize(("piece", "fewest"), [(1, 1), (7, 2), (13, 512), (26, 4)])
def test_pieces_and_their_parts_do_not_change_the_bits(qiao, rng, monkeypatch, piece, fewest, threads):
    kinds = ("pose", "position", "axis")
    targets = [make_target(qiao, q, kinds[k % 3]) for k, q in enumerate(random_q(qiao, rng, 24))]  # some collide
    targets[5:5] = [ikde.Target((50.0, 0.0, 1.0)), ikde.Target((0.0, 0.0, 0.2))]
    problem = problem_of(qiao, flat_settings(ikde.SolveSettings(method="lm"), restarts=70))
    whole = search(problem, targets, seed=3, streams=range(9, 35), threads=1)
    assert whole.counts[:, COLLIDING].any()
    monkeypatch.setattr(module, "PIECE", piece)
    monkeypatch.setattr(module, "MIN_TARGETS", fewest)
    found = search(problem, targets, seed=3, streams=range(9, 35), threads=threads)
    assert bits(found) == bits(whole)
    assert found.metrics.clearance_m.tobytes() == whole.metrics.clearance_m.tobytes()
    assert (
        found.metrics.accepted.tolist() == whole.metrics.accepted.tolist() == (whole.counts[:, REACHED] == 1).tolist()
    )
    assert found.excess_m.tolist() == whole.excess_m.tolist()
    assert found.pair_counts.filled.size == 0  # what only kernels need is not kept


@pytest.mark.parametrize("threads", [1, 2, 5])
def test_every_part_is_run_once(threads):
    run = []
    run_on_threads(run.append, [range(k, k + 1) for k in range(40)], threads, threading.Event())
    assert sorted(part.start for part in run) == list(range(40))


@pytest.mark.parametrize("threads", [1, 2, 5])
def test_an_error_ends_all_threads_and_is_raised(threads):
    stop, begun = threading.Event(), []

    def run(part):
        begun.append(part.start)
        if part.start == 3:
            raise IndexError("of its own")
        stop.wait(0.02)

    with pytest.raises(IndexError, match="of its own"):
        run_on_threads(run, [range(k, k + 1) for k in range(40)], threads, stop)
    assert stop.is_set()
    assert len(begun) < 20
    assert not [thread for thread in threading.enumerate() if "(work)" in thread.name]

"""The quick way gives the bits of the long way, and leaves to it what it cannot answer."""

import os
import pickle
import subprocess
import sys
import time

import numpy as np
import pytest

import ikde
from ikde.kernels.answer import BLOCKED, FIRST_COUNT, METRICS, SCORE
from ikde.kernels.arrays import ATTEMPTS, COLLIDING
from ikde.model.collision_model import CollisionModel
from ikde.model.target import KINDS
from ikde.solver.engine_table import ENGINES
from ikde.solver.grade import confirm
from ikde.solver.quick import find_quick
from ikde.solver.result import FIELDS
from ikde.solver.results import solve_rows
from ikde.solver.settings import SolveSettings
from tests.conftest import random_q
from tests.problems import problem_of
from tests.quick_ways import AUTO, make_quick
from tests.targets import free_q, make_target

LM = SolveSettings.for_method("lm")


def solve_quick(robot, target, seed, stream, detector=None):
    return make_quick(robot, target.kind, detector=detector).solve(target, seed, stream, 0.0)


def solve_long(robot, target, settings, seed, stream):
    problem = problem_of(robot, settings)
    return solve_rows(problem, [target], seed=seed, first_stream=stream).row(0)


@pytest.mark.parametrize("kind", KINDS)
def test_quick_and_long_give_the_same_result(qiao, rng, kind):
    for stream in range(5):
        target = make_target(qiao, free_q(qiao, rng), kind)
        quick, long = solve_quick(qiao, target, 4, stream), solve_long(qiao, target, AUTO, 4, stream)
        assert quick.q.tobytes() == long.q.tobytes()
        assert quick.grade == long.grade
        own = {"q", "target", "solve_seconds", "compile_seconds", "verify", "verified"}
        for name in set(FIELDS) - own:
            assert getattr(quick, name) == getattr(long, name), name
        assert (quick.target.p_world_tool == long.target.p_world_tool).all()


def test_a_quick_result_is_verified_once_plain_numpy_has_confirmed_it_and_not_before(qiao):
    result = solve_quick(qiao, ikde.Target((0.8, 0.5, 1.0)), 0, 0)
    assert (result.reached, result.collision, result.verified) == (True, False, None)
    assert result.grade.accepted
    assert result.verified is None
    confirmed = confirm(qiao, result)
    assert (confirmed.verified, result.verified) == (True, None)
    assert confirmed.q.tobytes() == result.q.tobytes()


def test_each_distinct_solution_is_verified_however_the_first_was_found(qiao, substitute):
    substitute(find_quick, lambda robot, settings, *_: make_quick(robot, "position", settings))
    target, settings = ikde.Target((0.8, 0.5, 1.0)), SolveSettings(restarts=9)
    assert ikde.solve(qiao, target, settings).verified is None
    for count in (1, 2):
        assert [found.verified for found in ikde.solve_distinct(qiao, target, count, settings)] == [True] * count


def test_without_a_detector_a_quick_result_is_neither_free_nor_colliding(qiao):
    result = solve_quick(qiao, ikde.Target((0.8, 0.5, 1.0)), 0, 0, detector="none")
    assert (result.reached, result.collision, result.clearance_m) == (True, None, None)
    assert result.reason == "within tolerance, inside the limits, self-collision not checked"
    assert result.grade.collision is None
    assert result.detector == "none"


@pytest.mark.parametrize("name", ["typical", "improved"])
def test_a_quick_result_names_the_detector_that_compared(qiao, name):
    assert solve_quick(qiao, ikde.Target((0.8, 0.5, 1.0)), 0, 0, detector=name).detector == name


def test_a_result_of_the_quick_way_cannot_be_changed(qiao):
    result = solve_quick(qiao, ikde.Target((0.8, 0.5, 1.0)), 0, 0)
    with pytest.raises(ValueError, match="read-only"):
        result.q[0] = 1.0
    with pytest.raises(AttributeError):
        result.reached = False


def test_what_the_grader_does_not_accept_goes_the_long_way(qiao):
    quick, target = make_quick(qiao, "position"), ikde.Target((0.8, 0.5, 1.0))
    assert quick.solve(target, 0, 0, 0.0) is not None
    quick.answer = refuse(quick.answer)
    assert quick.solve(target, 0, 0, 0.0) is None


def refuse(answer):
    """A call whose grader accepts nothing."""
    return lambda *question: answer(*question) and False


def test_what_is_not_reached_and_may_be_in_reach_goes_the_long_way(rng):
    panda, wanted = ikde.load_robot("panda"), 0
    once = make_quick(panda, "pose", AUTO.with_changes(method="lm", restarts=1))
    for stream in range(60):
        target = make_target(panda, free_q(panda, rng), "pose")
        wanted += once.solve(target, 4, stream, 0.0) is None
    assert wanted > 0


@pytest.mark.parametrize("seed", [0, 2**63, 2**64 - 1])
def test_all_seeds_have_a_quick_way(qiao, seed):
    target = ikde.Target((0.8, 0.5, 1.0))
    quick, long = solve_quick(qiao, target, seed, 7), solve_long(qiao, target, AUTO, seed, 7)
    assert (quick.q.tobytes(), quick.seed) == (long.q.tobytes(), seed)


@pytest.mark.parametrize("kind", KINDS)
def test_what_a_bound_excludes_is_known_at_once_and_put_into_words_when_asked(qiao, kind):
    target = make_target(qiao, qiao.home, kind)
    far = ikde.Target.packed(kind, target.T_world_tool + np.array([0.0, 0.0, 0.0, 9.0]))
    quick, long = solve_quick(qiao, far, 0, 0), solve_long(qiao, far, AUTO, 0, 0)
    assert (quick.reached, quick.stop_reason) == (False, "out_of_reach")
    assert "_explanation" not in vars(quick)
    assert (quick.reason, quick.hint) == (long.reason, long.hint)
    assert quick.q.tobytes() == long.q.tobytes()
    assert (quick.attempts, quick.collision, quick.grade) == (long.attempts, long.collision, long.grade)
    again = pickle.loads(pickle.dumps(quick))
    assert (again.reason, again.q.tobytes()) == (quick.reason, quick.q.tobytes())


@pytest.mark.parametrize("settings", [SolveSettings(method="memetic"), SolveSettings(method="de")])
def test_other_engines_have_no_quick_way(qiao, settings, monkeypatch):
    monkeypatch.setattr("ikde.solver.quick.runs_on_tables", lambda: False)
    assert find_quick(qiao, SolveSettings(restarts=7), "auto", None, "pose") is not None
    assert find_quick(qiao, settings, "auto", None, "pose") is None


WITH_WRITTEN_KERNELS = """
import pickle
import numpy as np
import ikde
robot = ikde.load_robot("qiao2021")
target = ikde.Target((0.8, 0.5, 1.0), R_world_tool=np.diag([1.0, -1.0, -1.0]).T)
results = [ikde.solve(robot, target, seed=3), ikde.solve(robot, pickle.loads(pickle.dumps(target)), seed=3)]
rows = ikde.solve_many(robot, [target] * 8, seed=3)
print([result.compile_seconds for result in results], rows.compile_seconds, results[1].solve_seconds < 1.0)
print(results[0].q.tobytes().hex(), results[0].q.tobytes() == results[1].q.tobytes() == rows.q[0].tobytes())
"""


@pytest.mark.slow
def test_written_kernels_and_their_pool_serve_the_next_process_with_the_same_bits(tmp_path):
    kept = {name: value for name, value in os.environ.items() if name != "IKDE_KERNELS"}
    command, own = [sys.executable, "-c", WITH_WRITTEN_KERNELS], {**kept, "IKDE_CACHE_DIR": str(tmp_path)}
    first, second = (
        subprocess.run(command, env=own, capture_output=True, text=True, check=True).stdout.splitlines()
        for _ in range(2)
    )
    assert second[0] == "[0.0, 0.0] 0.0 True"
    assert first[1] == second[1]
    assert second[1].endswith("True")
    assert len(list(tmp_path.rglob("*.pool"))) == 0


UR5 = ikde.load_robot("ur5")


def test_a_fixed_arm_is_answered_by_its_closed_form():
    target = make_target(UR5, np.array([0.3, -1.2, 1.4, -1.5, -1.3, 0.4]), "pose")
    assert ikde.solve(UR5, target).method == "analytic"


def test_the_closed_form_answers_quickly_what_it_answers_the_long_way(rng):
    """Poses of any configuration, free or not: reached, out of reach, or left to the long way."""
    quick, told = make_quick(UR5, "pose"), set()
    targets = [make_target(UR5, random_q(UR5, rng), "pose") for _ in range(60)]
    targets += [ikde.Target(p, R_world_tool=np.eye(3)) for p in rng.uniform(-1.0, 1.0, (20, 3))]
    for stream, target in enumerate(targets):
        short = quick.solve(target, 4, stream, 0.0)
        if short is None:
            told.add(None)
            continue
        long = solve_long(UR5, target, AUTO, 4, stream)
        assert short.q.tobytes() == long.q.tobytes()
        own = {"q", "target", "solve_seconds", "compile_seconds", "verify", "verified"}
        for name in set(FIELDS) - own:
            assert getattr(short, name) == getattr(long, name), name
        told.add((str(short.stop_reason), short.method))
    assert {("reached", "analytic"), ("out_of_reach", "lm")} <= told


def test_where_no_branch_is_free_lm_goes_on_with_what_was_counted(rng, monkeypatch):
    """A pose whose closed form is made to find nothing: `lm` finds a solution, and the counts are those of both."""
    quick = make_quick(UR5, "pose")
    quick.solve(make_target(UR5, UR5.home, "pose"), 4, 0, 0.0)
    target = make_target(UR5, free_q(UR5, rng), "pose")
    alone = make_quick(UR5, "pose", LM).solve(target, 4, 0, 0.0)

    def fail(T, seed, stream, first, last, out):
        whole = out[len(UR5.joints) + METRICS :].view(np.int64)
        whole[:] = 0
        out[len(UR5.joints) + METRICS + SCORE :][:2] = np.inf
        whole[FIRST_COUNT + ATTEMPTS], whole[FIRST_COUNT + COLLIDING], whole[BLOCKED] = 1, 2, 2
        return False

    monkeypatch.setattr(quick, "answer", fail)
    result = quick.solve(target, 4, 0, 0.0)
    assert (result.method, result.q.tobytes()) == ("lm", alone.q.tobytes())
    assert (result.attempts, result.rejected) == (alone.attempts + 1, alone.rejected + 2)
    pair = CollisionModel.of(UR5).pairs[0]
    assert result.blocking_pairs[pair] == alone.blocking_pairs.get(pair, 0) + 2
    quick = make_quick(UR5, "pose", SolveSettings.for_method("analytic"))
    quick.solve(target, 4, 0, 0.0)
    monkeypatch.setattr(quick, "answer", fail)
    assert quick.solve(target, 4, 0, 0.0) is None


def test_a_search_that_is_begun_goes_on_where_it_stopped(rng):
    """Attempts 0 to 15, a bound, and then the others: together those of one search."""
    panda, on = ikde.load_robot("panda"), 0
    way = make_quick(panda, "pose")
    for stream in range(300):
        corner = np.where(rng.random(7) < 0.5, panda.lower, panda.upper) + rng.uniform(-0.02, 0.02, 7)
        target = make_target(panda, corner.clip(panda.lower, panda.upper), "pose")
        quick = way.solve(target, 4, stream, 0.0)
        if quick is None or quick.attempts <= ENGINES["lm"].attempts_before_proof:
            continue
        long = solve_long(panda, target, AUTO, 4, stream)
        assert (quick.q.tobytes(), quick.attempts, quick.rejected) == (long.q.tobytes(), long.attempts, long.rejected)
        assert quick.blocking_pairs == long.blocking_pairs
        on += 1
    assert on > 0


def test_waiting_for_machine_code_is_no_solving(qiao, monkeypatch):
    quick, target = make_quick(qiao, "position"), ikde.Target((0.8, 0.5, 1.0))
    quick.solve(target, 0, 0, 0.0)
    monkeypatch.setattr(quick.ways, "take_waited_s", lambda: (50.0, 20.0))
    quick.is_ready = False
    result = quick.solve(target, 0, 0, time.perf_counter() - 60.0)
    assert 10.0 <= result.solve_seconds < 40.0
    assert result.compile_seconds == 20.0

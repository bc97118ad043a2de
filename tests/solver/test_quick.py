"""The quick way gives the bits of the long way, and leaves to it what it cannot answer."""

import os
import subprocess
import sys

import numpy as np
import pytest

import ikde
from ikde.kernels.grade_one import grade_one
from ikde.model.collision_model import CollisionModel
from ikde.model.target import KINDS
from ikde.solver.grade import confirm
from ikde.solver.quick import Quick, find_quick
from ikde.solver.results import solve_rows
from ikde.solver.search import choose_engines
from ikde.solver.settings import SolveSettings
from tests.problems import problem_of
from tests.substitutes import BothWays
from tests.targets import free_q, make_target

AUTO = SolveSettings.for_method("auto")


def solve_quick(robot, target, seed, stream, detector=None):
    """By the quick way itself: on the tables, which tests run on, `ikde.solve` goes the long way."""
    quick = Quick(CollisionModel.of(robot, detector), AUTO, target.kind)
    quick.solve(target, seed, stream)
    return quick.solve(target, seed, stream)


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
        told = [vars(result) for result in (quick, long)]
        assert told[0].keys() == told[1].keys()
        own = {"q", "target", "solve_seconds", "compile_seconds", "verify", "grade", "verified"}
        for name in told[0].keys() - own:
            assert told[0][name] == told[1][name], name
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
    substitute(find_quick, lambda robot, settings, *_: Quick(CollisionModel.of(robot), settings, "position"))
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


def test_what_the_grader_does_not_accept_goes_the_long_way(qiao, substitute):
    substitute(grade_one, BothWays(lambda *question: (*grade_one(*question)[:4], False)))
    assert solve_quick(qiao, ikde.Target((0.8, 0.5, 1.0)), 0, 0) is None


def test_what_is_not_reached_goes_the_long_way(qiao):
    assert solve_quick(qiao, ikde.Target((0.0, 0.0, 9.0)), 0, 0) is None
    result = ikde.solve(qiao, ikde.Target((0.0, 0.0, 9.0)))
    assert (result.reached, result.stop_reason) == (False, "out_of_reach")
    assert result.hint


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
    assert len(list(tmp_path.rglob("*.npz"))) == 1


def test_a_fixed_arm_falls_back_on_its_closed_form():
    robot = ikde.load_robot("ur5")
    assert choose_engines(robot, AUTO, {"pose"}) == ["lm", "analytic", "memetic"]
    assert choose_engines(robot, AUTO, {"pose", "axis"}) == ["lm", "memetic"]
    target = make_target(robot, np.array([0.3, -1.2, 1.4, -1.5, -1.3, 0.4]), "pose")
    assert ikde.solve(robot, target).method == "lm"


def test_no_more_attempts_are_made_than_the_settings_allow(rng):
    panda = ikde.load_robot("panda")
    once, harder = AUTO.with_changes(method="lm", restarts=1), 0
    for stream in range(40):
        target = make_target(panda, free_q(panda, rng), "pose")
        usual = solve_quick(panda, target, 4, stream)
        if usual is None or usual.attempts == 1:
            continue
        quick = Quick(CollisionModel.of(panda), once, "pose")
        assert quick.solve(target, 4, stream) is None
        harder += 1
    assert harder > 0

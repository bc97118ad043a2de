"""The same bits with and without compilation, on one or two threads, in any process, time after time."""

import json
import os
import subprocess
import sys
from pathlib import Path

import numba
import pytest

import ikde
from ikde.solver.settings import BulkOptions
from tests.flat_settings import flat_settings

ROOT = Path(__file__).parents[2]
SCRIPT = """
import json
from tests.kernels.test_parity import solve_all
from tests.flat_settings import flat_settings
print(json.dumps(solve_all()))
"""
RUN_UNCOMPILED = ("-W", "ignore:overflow encountered:RuntimeWarning")  # numpy's scalars wrap around, but complain


TARGETS = [
    ikde.Target([0.8, 0.5, 1.0]),
    ikde.Target([0.54, -0.131, 0.974], axis_world_tool=[0.0, 0.3, 1.0]),
    ikde.Target([0.9, 0.2, 1.2], R_world_tool=[[0, 0, 1], [1, 0, 0], [0, 1, 0]]),
]


def make_settings(**changes):
    return flat_settings(population=8, generations=5, restarts=1, **changes)


def solve_all():
    """The bits of small solves over kinds of target, collision rules and update modes, as hexadecimal text."""
    robot = ikde.load_robot("qiao2021")
    bits = []
    for collision, update in (("reject", "generation"), ("feasibility", "in_place")):
        settings = make_settings(collision=collision, update=update)
        results = ikde.solve_many(robot, TARGETS, settings, seed=2**63 + 1, bulk=BulkOptions(threads=1, explain=False))
        bits += [result.q.tobytes().hex() for result in results]
    return bits


def solve_in_a_new_process(*options, **environment):
    command = [sys.executable, "-W", "error", *options, "-c", SCRIPT]
    done = subprocess.run(
        command,
        cwd=ROOT,
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def test_twice_in_one_process_gives_the_same_bits():
    assert solve_all() == solve_all()


def test_targets_rules_and_updates_give_different_bits():
    bits = solve_all()
    assert len(set(bits)) == len(bits)


@pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="needs compiled kernels")
def test_uncompiled_kernels_give_the_same_bits():
    assert solve_in_a_new_process(*RUN_UNCOMPILED, NUMBA_DISABLE_JIT="1") == solve_all()


@pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="needs compiled kernels")
def test_a_new_process_gives_the_same_bits():
    assert solve_in_a_new_process() == solve_all()


@pytest.mark.slow
@pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="needs compiled kernels")
def test_an_empty_cache_gives_the_same_bits(tmp_path):
    assert solve_in_a_new_process(IKDE_CACHE_DIR=str(tmp_path)) == solve_all()
    assert list(tmp_path.rglob("*.nbc"))


@pytest.mark.slow
@pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="needs compiled kernels")
def test_a_full_solve_of_uncompiled_kernels_gives_the_same_bits(qiao):
    script = (
        "import ikde; result = ikde.solve(ikde.load_robot('qiao2021'), ikde.Target([0.8, 0.5, 1.0]), seed=4);"
        "print(result.reached, result.q.tobytes().hex())"
    )
    command = [sys.executable, "-W", "error", *RUN_UNCOMPILED, "-c", script]
    environment = {**os.environ, "NUMBA_DISABLE_JIT": "1"}
    done = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, timeout=600, check=True)
    result = ikde.solve(qiao, ikde.Target([0.8, 0.5, 1.0]), seed=4)
    assert done.stdout.split() == ["True", result.q.tobytes().hex()]


@pytest.mark.parametrize("method", ["auto", "de"])
def test_one_and_two_threads_give_the_same_bits(qiao, method):
    targets = TARGETS[:2] * 3
    one, two = (
        [
            r.q.tobytes()
            for r in ikde.solve_many(qiao, targets, method=method, seed=5, bulk=BulkOptions(threads=threads))
        ]
        for threads in (1, 2)
    )
    assert one == two
    assert len(set(one)) > 2  # each target has its own stream, though two streams may choose the same seed


def test_a_target_does_not_depend_on_those_after_it(qiao):
    targets = TARGETS
    together = [r.q.tobytes() for r in ikde.solve_many(qiao, targets, seed=5)]
    assert ikde.solve_many(qiao, targets[:1], seed=5)[0].q.tobytes() == together[0]
    assert ikde.solve(qiao, targets[0], seed=5).q.tobytes() == together[0]

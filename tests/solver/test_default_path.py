"""What users run: kernels written for the robot, and compiled, by every engine and for every kind of target.

Answers are judged by the naive twins of `tests/reference.py`, which share no code with ikde.
"""

from itertools import combinations
from types import SimpleNamespace

import numba
import numpy as np
import pytest

import ikde
from tests.conftest import random_q
from tests.problems import are_apart
from tests.substitutes import BothWays
from tests.three_joints import KINDS, ROBOT, free_q, is_met, meet
from tests.uncompiled import plain_module
from tests.written import written_kernels

ENGINES = ("auto", "lm", "memetic", "de")
COUNT = 6  # targets: more than are solved one after the other

pytestmark = pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="needs compiled kernels")
each_kind = pytest.mark.parametrize("kind", KINDS)
each_engine = pytest.mark.parametrize("engine", ENGINES)


@pytest.fixture(autouse=True)
def written(monkeypatch):
    """The kinds of targets whose written kernels were asked for."""
    with written_kernels(monkeypatch) as asked:
        yield asked


def settings_of(engine):
    return ikde.SolveSettings.for_method(engine)


def targets_of(kind):
    return [meet(ROBOT, q, kind) for q in free_q(COUNT)]


def assert_met(target, result, engine):
    assert result.reached, result.reason
    assert is_met(ROBOT, target, result.q, result.settings)
    assert result.method == ("lm" if engine == "auto" else engine)


@each_engine
@each_kind
def test_one_target_and_many_are_met(kind, engine, written):
    targets, settings = targets_of(kind), settings_of(engine)
    many = ikde.solve_many(ROBOT, targets, settings, seed=3)
    for stream, (target, row) in enumerate(zip(targets, many, strict=True)):
        one = ikde.solve(ROBOT, target, settings, seed=3, stream=stream)
        assert_met(target, one, engine)
        assert_met(target, row, engine)
        assert one.q.tobytes() == row.q.tobytes()
    assert set(written) == ({kind} if engine in ("auto", "lm") else set())


@each_engine
def test_distinct_solutions_are_met_and_apart(engine):
    target = meet(ROBOT, free_q(COUNT)[0], "position")
    found = ikde.solve_distinct(ROBOT, target, 2, settings_of(engine), seed=1)
    assert len(found) == 2
    for result in found:
        assert_met(target, result, engine)
    assert all(are_apart(ROBOT, a.q, b.q) for a, b in combinations(found, 2))


@each_engine
@each_kind
def test_near_and_freeze_are_kept(kind, engine):
    settings = settings_of(engine)
    for q in free_q(COUNT)[:2]:
        target, near = meet(ROBOT, q, kind), q + 0.02
        close = ikde.solve(ROBOT, target, settings, near=near)
        assert_met(target, close, engine)
        frozen = ikde.solve(ROBOT, target, settings, freeze={"turn": q[0]})
        assert_met(target, frozen, engine)
        assert frozen.q[0] == q[0]
        both = ikde.solve_many(ROBOT, [target], settings, near=near, freeze={"turn": q[0]})[0]
        assert_met(target, both, engine)
        assert both.q[0] == q[0]
        if engine in ("auto", "lm"):
            assert np.abs(close.q - q).max() < 0.1
            assert np.abs(both.q - q).max() < 0.1


@each_kind
def test_out_of_reach_is_told(kind):
    target = meet(ROBOT, free_q(1)[0], kind, shift=(3.0, 0.0, 0.0))
    results = [ikde.solve(ROBOT, target), *ikde.solve_many(ROBOT, [target] * COUNT)]
    assert {(result.reached, result.stop_reason) for result in results} == {(False, "out_of_reach")}


def both_ways(module):
    """Its functions as kernels."""
    return SimpleNamespace(**{name: BothWays(own) if callable(own) else own for name, own in vars(module).items()})


def test_a_closed_form_meets_poses(rng, monkeypatch):
    """By its module as plain Python: six joints take long to compile."""
    arm, settings = ikde.load_robot("ur5"), settings_of("analytic")
    free = [q for q in random_q(arm, rng, 12) if is_met(arm, meet(arm, q, "pose"), q, settings)]
    targets = [meet(arm, q, "pose") for q in free]
    assert len(targets) > 4
    with written_kernels(monkeypatch, lambda module: both_ways(plain_module(module))) as asked:
        results = [ikde.solve(arm, targets[0], settings), *ikde.solve_many(arm, targets[1:], settings)]
        near = ikde.solve(arm, targets[0], settings, near=free[0] + 0.02)
        frozen = ikde.solve(arm, targets[0], settings, freeze={arm.joint_names[0]: free[0][0]})
        found = ikde.solve_distinct(arm, targets[0], 2, settings)
    for target, result in zip([*targets, *targets[:1] * 4], [*results, near, frozen, *found], strict=True):
        assert result.reached, result.reason
        assert is_met(arm, target, result.q, settings)
        assert result.method == "analytic"
    assert np.abs(near.q - free[0]).max() < 0.1
    assert frozen.q[0] == free[0][0]
    assert set(asked) == {"pose"}

"""Few targets are answered one after the other: the bits are those of lanes."""

import numpy as np
import pytest

from ikde.kernels.answer import pack_row
from ikde.kernels.arrays import ATTEMPTS
from ikde.model.target import KINDS, Target, Targets
from ikde.solver import few
from ikde.solver.engines.search_state import make_search_state
from ikde.solver.metrics import COLUMNS
from ikde.solver.search import search
from tests.problems import problem_of
from tests.three_joints import ROBOT, free_q, meet
from tests.written import written_kernels

COUNT = 12


@pytest.fixture(autouse=True)
def _written(monkeypatch):
    with written_kernels(monkeypatch):
        yield
    few.find_answer.cache_clear()


def targets_of(*kinds):
    return [meet(ROBOT, q, kinds[k % len(kinds)]) for k, q in enumerate(free_q(COUNT))]


def assert_same(ours, theirs):
    for name in ("q", "score", "counts", "excess_m", "engine"):
        assert getattr(ours, name).tobytes() == getattr(theirs, name).tobytes(), name
    for name in COLUMNS:
        assert getattr(ours.metrics, name).tolist() == getattr(theirs.metrics, name).tolist()
    for row in range(len(ours.q)):
        assert ours.pair_counts.row(row).tolist() == theirs.pair_counts.row(row).tolist()


@pytest.mark.parametrize("kinds", [("position",), ("pose",), KINDS], ids=str)
def test_the_answers_are_those_of_lanes(kinds, monkeypatch):
    problem, asked = problem_of(ROBOT), {"seed": 2**64 - 5, "streams": range(7, 7 + COUNT)}
    ours = search(problem, targets_of(*kinds), **asked)
    assert few.find_answer.cache_info().currsize == len(kinds)  # lanes never ran
    assert (ours.seconds > 0.0).all()
    monkeypatch.setattr(few, "FEW", 0)
    assert_same(ours, search(problem, targets_of(*kinds), **asked))


def test_pairs_that_blocked_are_counted(rng):
    problem = problem_of(ROBOT)
    found, pairs = make_search_state(problem, 3), len(problem.collision.pairs)
    blocked = rng.integers(0, 3, (3, pairs)) * np.array([[1], [0], [1]])
    counts = [[1, 5, 9, int(row.sum()), 0] for row in blocked]
    rows = [pack_row(rng.random(3), [1e-6, 1e-7, 0.1], 1, *row) for row in zip(counts, blocked, strict=True)]
    few._unpack(np.array(rows), found)
    assert found.counts.tolist() == counts
    assert [found.pair_counts.row(row).tolist() for row in range(3)] == blocked.tolist()
    assert found.metrics.closest_pair.tolist() == [1] * 3


@pytest.mark.parametrize("count", [few.FEW, few.FEW + 1])
def test_beyond_a_few_there_are_lanes(count):
    problem, targets = problem_of(ROBOT), targets_of("position")
    some = make_search_state(problem, count)
    asked = (targets * 4)[:count]

    assert few.answer_few(problem, Targets.of(asked), some, 64, seed=0, streams=range(count)) is (count <= few.FEW)


def test_where_one_is_not_reached_nothing_is_filled():

    problem = problem_of(ROBOT)
    found = make_search_state(problem, COUNT + 1)
    targets = Targets.of([*targets_of("position"), Target((50.0, 0.0, 0.0))])
    assert not few.answer_few(problem, targets, found, 64, seed=0, streams=range(COUNT + 1))
    assert not found.counts.any()
    assert np.isinf(found.score).all()
    whole = search(problem, targets, seed=0, streams=range(COUNT + 1))
    assert whole.counts[:-1, ATTEMPTS].all()
    assert whole.excess_m[-1] > 0.0

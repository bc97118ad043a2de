"""The work of one part, and that it travels."""

import pickle

import pytest

from ikde.batch.parts import Part
from ikde.batch.sources import ListSource
from ikde.batch.task import make_task, solve_task
from tests.batch.small import make_batch, make_targets

NAMED = ListSource(targets=make_targets(12), names=tuple("abcdefghijkl"))


@pytest.mark.parametrize(
    ("first", "last", "repeats", "names"),
    [(0, 5, 2, "abc"), (5, 10, 2, "cde"), (3, 4, 2, "b"), (20, 24, 2, "kl"), (1, 4, 10, "a"), (4, 6, 1, "ef")],
)
def test_a_task_holds_its_targets_once(first, last, repeats, names):
    batch = make_batch(source=NAMED, repeats=repeats)
    task = make_task(batch, Part("auto", 0, first, last))
    assert task.names == tuple(names)
    assert [tuple(t.p_world_tool) for t in task.targets] == [
        tuple(NAMED.targets["abcdefghijkl".index(name)].p_world_tool) for name in names
    ]
    solved = solve_task(task, threads=1).solutions
    assert solved["target_name"].to_pylist() == ["abcdefghijkl"[i // repeats] for i in range(first, last)]
    assert solved["repeat"].to_pylist() == [i % repeats for i in range(first, last)]


def test_the_answer_does_not_hang_on_how_a_run_is_cut():
    batch = make_batch(source=NAMED)
    whole = solve_task(make_task(batch, Part("auto", 0, 0, 24))).solutions
    for first, last in ((0, 5), (7, 8), (13, 24)):
        piece = solve_task(make_task(batch, Part("auto", 0, first, last)), threads=1).solutions
        assert piece.to_pylist() == whole.slice(first, last - first).to_pylist()


def test_a_task_is_the_same_after_a_journey():
    task = make_task(make_batch(), Part("auto", 1, 5, 10))
    there = solve_task(pickle.loads(pickle.dumps(task)), threads=1)
    back = pickle.loads(pickle.dumps(there))
    assert back.part == task.part
    assert back.solutions.equals(solve_task(task, threads=2).solutions)

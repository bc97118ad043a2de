"""The work of one part, and that it travels."""

import pickle
import threading

import pytest

import ikde
from ikde.batch.parts import Part
from ikde.batch.sources import GoalSource, ListSource
from ikde.batch.task import make_task, solve_task
from ikde.model.region import Region
from ikde.solver.cancellation import stoppable
from tests.batch.small import FAR, ROBOT, make_arm, make_batch, make_targets

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


NEAR = (0.8, 0.1, 0.9)
GOALS = GoalSource(goals=[Region.box(NEAR, 0.05), ikde.Target(NEAR), Region.any_of([FAR, NEAR]), Region.box(FAR, 0.1)])


def test_goals_with_freedom_are_asked_as_single_ones_and_rows_say_which_alternative():
    batch = make_batch(arms=(make_arm(restarts=2),), source=GOALS, repeats=2)
    task = pickle.loads(pickle.dumps(make_task(batch, Part("auto", 0, 1, 8))))
    table = solve_task(task).solutions.to_pydict()
    for row, stream in enumerate(range(1, 8)):
        goal = GOALS.goals[stream // 2]
        single = ikde.solve(ROBOT, goal, task.arm.problem.settings, seed=batch.seed, stream=stream)
        own = [table[f"q_{name}"][row] for name in ROBOT.joint_names]
        assert own == single.q.tolist()
        assert table["reached"][row] == single.reached
        assert (table["alternative"][row], table["poses"][row]) == (single.alternative, single.poses)
        assert table["target_x_m"][row] == single.target.p_world_tool[0]
    assert table["target"] == [0, 1, 1, 2, 2, 3, 3]
    assert table["alternative"] == [0, None, None, 1, 1, 0, 0]
    assert table["verified"] == [True] * 7
    assert table["reached"] == [True] * 5 + [False] * 2
    exact = solve_task(make_task(batch, Part("auto", 0, 2, 4))).solutions
    assert exact.schema.remove_metadata() == solve_task(task).solutions.schema.remove_metadata()
    assert exact.to_pylist() == solve_task(task).solutions.slice(1, 2).to_pylist()


def test_a_run_of_goals_with_freedom_can_be_stopped():
    stop = threading.Event()
    stop.set()
    with stoppable(stop), pytest.raises(KeyboardInterrupt):
        solve_task(make_task(make_batch(source=GOALS), Part("auto", 0, 0, 8)))

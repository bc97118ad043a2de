"""So few targets that preparing lanes takes longer than they save: a call each, one after the other.

Until lanes are compiled, for half a minute, a thousand are answered so, in plain Python (2 ms each) or by the machine
code of one target.
"""

import time
from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from ikde.kernels.answer import BLOCKED, FIRST_COUNT, METRICS, PAIR, SCORE, size_of
from ikde.model.large_worlds import KEPT
from ikde.model.target import KINDS, Targets
from ikde.solver.ask import Ask
from ikde.solver.asker import find_asker
from ikde.solver.background import MANY, Question, answers_plainly
from ikde.solver.choice import find_free, is_inside
from ikde.solver.engine_table import NAMES
from ikde.solver.engines.lm import prepare
from ikde.solver.engines.search_state import PairCounts, SearchState
from ikde.solver.joined import is_large
from ikde.solver.metrics import Metrics
from ikde.solver.problem import Problem
from ikde.solver.way import as_word

MAX_FEW, MAX_WITHOUT_LANES = 32, 1000


def answer_few(problem: Problem, targets: Targets, *, seed: int, streams: Sequence[int]) -> SearchState | None:
    """What `solver.ask` says of each target, a row each, or None: they are too many, or have no such.

    A row that it leaves to other engines is empty: nothing has been attempted. The bits are those of lanes and
    `referee`.
    """
    count = len(targets)
    if problem.settings.timeout_s is not None or count > MAX_WITHOUT_LANES or not _is_usual(problem):
        return None
    asked = _find_asked(problem, {*targets.kind.tolist()})
    if not asked or (count > MAX_FEW and _has_lanes(problem, asked)):
        return None
    return _Rows(problem, targets, asked).answer(as_word(seed), streams)


@KEPT.add
@lru_cache(maxsize=16)
def _is_usual(problem: Problem) -> bool:
    """Whether its ranges are inside the robot's limits, and only what is frozen cannot move: not so of some probes."""
    robot, free = problem.robot, find_free(problem.lower, problem.upper)
    return is_inside(problem) and free == find_free(robot.lower, robot.upper) - {
        *map(robot.joint_names.index, problem.frozen)
    }


def _find_asked(problem: Problem, kinds: set[int]) -> dict[int, Ask]:
    """How each kind of target is asked; none for kinds that lanes answer by another engine where they are mixed."""
    asked, find = {}, find_ask
    if is_large(problem.collision.arrays):
        find = find_ask.__wrapped__
    for kind in kinds:
        ask = find(problem, KINDS[kind])
        if ask is None or (ask.plan.is_closed and len(kinds) > 1):
            return {}
        asked[kind] = ask
    return asked


@KEPT.add
@lru_cache(maxsize=16)
def find_ask(problem: Problem, kind: str) -> Ask | None:
    """How one kind of target is asked, kept for the next call about the same problem."""
    return find_asker(problem.collision, problem.settings, kind).make(problem, Ask)


def _has_lanes(problem: Problem, asked: dict[int, Ask]) -> bool:
    """Whether machine code of lanes is loaded, kept or to be waited for; else a child is asked to compile it.

    That of the closed form is always waited for: it is compiled in seconds.
    """
    for kind, ask in asked.items():
        if ask.plan.is_closed:
            continue
        kernels, _, ready = prepare(problem, KINDS[kind])
        question = Question(problem.collision.own, KINDS[kind], MANY)
        if False not in ready and answers_plainly(kernels.solve_targets.bind(), question):
            return False
    return True


class _Rows:
    """A row of numbers a target (`kernels/answer.py`), and beside them what is not said in them."""

    def __init__(self, problem: Problem, targets: Targets, asked: dict[int, Ask]) -> None:
        self._targets, self._asked, count, joints = targets, asked, len(targets), len(problem.lower)
        self._joints, self._counts = joints, joints + METRICS
        self._rows = np.empty((count, size_of(joints, len(problem.collision.counted))))
        self._accepted, self._excess = np.empty(count, dtype=np.bool_), np.zeros((2, count))
        engines = [NAMES.index(asked[kind].engine) if kind in asked else 0 for kind in range(len(KINDS))]
        self._engine, self._why = np.array(engines)[targets.kind], np.full(count, -1)

    def answer(self, word: int, streams: Sequence[int]) -> SearchState:
        """Ask for each, one after the other."""
        began, accepted, asked = time.perf_counter(), [], self._asked
        kinds, poses = self._targets.kind.tolist(), self._targets.T_world_tool
        for kind, T_world_tool, row, stream in zip(kinds, poses, self._rows, streams, strict=True):
            ask = asked[kind]
            if not ask.is_ready:
                ask.bind()
            accepted.append(ask.answer(T_world_tool, word, stream, 0, ask.plan.first, row))
        self._accepted[:] = accepted
        if not all(accepted):
            for index in (~self._accepted).nonzero()[0].tolist():
                self._settle(index, asked[kinds[index]], word, streams[index])
        waited_s = sum(ask.ways.take_waited_s()[0] for ask in asked.values())
        return self._found((time.perf_counter() - began - waited_s) / max(1, len(kinds)))

    def _settle(self, index: int, ask: Ask, word: int, stream: int) -> None:
        """What the first call has not answered: a solution, a proof, or an empty row."""
        row = self._rows[index]
        settled = ask.settle(row, self._targets[index], word, stream)
        if settled is None:
            row[:], row[self._counts :].view(np.int64)[:] = 0.0, 0
            row[self._counts + SCORE : self._counts + BLOCKED] = np.inf
            return
        row[:], self._engine[index] = settled.row, NAMES.index(settled.engine)
        self._excess[:, index], self._why[index] = settled.excess, settled.why
        self._accepted[index] = settled.excess == (0.0, 0.0) and settled.why < 0

    def _found(self, seconds: float) -> SearchState:
        """The rows as columns, most of them views."""
        joints, rows = self._joints, self._rows
        whole = rows[:, self._counts :].view(np.int64)
        return SearchState(
            q=rows[:, :joints].copy(),
            score=rows[:, self._counts + SCORE : self._counts + BLOCKED],
            counts=whole[:, FIRST_COUNT:SCORE],
            pair_counts=PairCounts(whole[:, BLOCKED:]),
            excess_m=self._excess[0],
            excess_rad=self._excess[1],
            ruled_out=self._why,
            seconds=np.zeros(len(rows)) + seconds,
            engine=self._engine,
            metrics=Metrics(
                position_error_m=rows[:, joints],
                orientation_error_rad=rows[:, joints + 1],
                clearance_m=rows[:, joints + 2],
                closest_pair=whole[:, PAIR],
                accepted=self._accepted,
            ),
        )

"""One target after another, without preparation: everything but target, seed and stream is ready and waits.

The answer is that of the long way (`solver.search`), bit for bit; what this way cannot answer is left to that one.
"""

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from ikde.kernels.answer import BLOCKED, FIRST_COUNT, METRICS, SCORE, size_of
from ikde.kernels.arrays import REACHED, Floats
from ikde.kernels.flat_arguments import exchange_world
from ikde.model.closed_form import find_ur_arm
from ikde.model.collision_model import CollisionModel
from ikde.model.target import Target, Targets
from ikde.solver.background import NEAR, ONE, Question
from ikde.solver.choice import choose_engines
from ikde.solver.engine_table import ENGINES
from ikde.solver.engines import analytic, lm
from ikde.solver.engines.pool import load_kernels
from ikde.solver.problem import Problem
from ikde.solver.proof import prove, rule_out
from ikde.solver.settings import SolveSettings
from ikde.solver.way import Answer, Way, WithDescent

LM, CLOSED = "lm", "analytic"


class Ways:
    """Those of one collision model and kind of target, for each engine, with `near` and without."""

    def __init__(self, collision: CollisionModel, kind: str) -> None:
        kernels = load_kernels(collision, kind)
        self.kind = kind
        self._ways = {}
        for engine, name in ((LM, "answer_target"), (CLOSED, "answer_pose")):
            if hasattr(kernels, name):
                call = getattr(kernels, name)
                self._ways[engine, False] = Way(call, Question(collision.own, kind, ONE, engine))
                self._ways[engine, True] = Way(WithDescent(call), Question(collision.own, kind, NEAR, engine))

    def find(self, engine: str, is_near: bool) -> Way:
        """The way of an engine."""
        return self._ways[engine, is_near]

    def take_waited_s(self) -> tuple[float, float]:
        """For how long machine code has been waited for since this was asked last, and how much of it was compiling."""
        waited = [way.take_waited_s() for way in self._ways.values() if way.waited_s]
        return sum(waited_s for waited_s, _ in waited), sum(compile_s for _, compile_s in waited)


class Plan(NamedTuple):
    """How a question is asked: of the closed form, or of `lm`, a few attempts, a bound, and then all that it has."""

    size: int
    """Of a row."""
    counts: int
    """Where in a row whole numbers begin."""
    is_closed: bool
    has_lm: bool
    first: int
    """Attempts of the first call: one shows all branches of the closed form."""
    few: int
    all: int


class Settled(NamedTuple):
    """How a question ends that the first call has not answered: a solution, or a proof that there is none."""

    row: Floats
    engine: str
    excess: tuple[float, float] = (0.0, 0.0)
    """By how much bounds prove that it is missed, m and rad."""
    why: int = -1
    """The reason for which it is ruled out: index into `STOP_REASONS`."""


def make_plan(collision: CollisionModel, settings: SolveSettings, kind: str, free: set[int]) -> Plan | None:
    """The plan where the joints `free` may move; None if another engine comes first.

    The closed form must be that of an arm that alone may move.
    """
    engines, arm = choose_engines(collision.robot, settings, {kind}, free=free), find_ur_arm(collision.robot)
    if not free or engines[0] not in (LM, CLOSED) or kind not in ENGINES[engines[0]].target_kinds:
        return None
    if engines[0] == CLOSED and (arm is None or not free <= set(arm.coordinates)):
        return None
    joints, row, budget = len(collision.robot.joints), ENGINES[LM], settings.budget(LM)
    few = min(row.attempts_before_proof, budget)
    all_of_it = budget if engines[-1] == LM or row.attempts_before_next is None else row.attempts_before_next
    return Plan(
        size=size_of(joints, len(collision.counted)),
        counts=joints + METRICS,
        is_closed=engines[0] == CLOSED,
        has_lm=LM in engines,
        first=1 if engines[0] == CLOSED else few,
        few=few,
        all=few if settings.timeout_s is not None else all_of_it,
    )


class Ask:
    """A question with its plan; `lay_out` gives what stays of an engine's call."""

    def __init__(self, problem: Problem, plan: Plan, ways: Ways, lay_out: Callable[[str], Sequence[Any]]) -> None:
        self.plan, self.ways = plan, ways
        self._problem, self._lay_out = problem, lay_out
        self.engine = CLOSED if plan.is_closed else LM
        self.answer, self.is_ready = self._bind(self.engine)

    def bind(self) -> None:
        """Take the machine code of the first call, if it is there by now."""
        self.answer, self.is_ready = self._bind(self.engine)

    def settle(self, row: Floats, target: Target, word: int, stream: int) -> Settled | None:
        """How it ends with what the first call left in `row`; None if this target needs another engine, or a reason."""
        if row[self.plan.counts :].view(np.int64)[FIRST_COUNT + REACHED] or not self.plan.has_lm:
            return None
        settle = self._go_on if self.plan.is_closed else self._prove
        return settle(row, target, word, stream)

    def _bind(self, engine: str) -> tuple[Answer, bool]:
        """The call of an engine, and whether it is machine code."""
        way = self.ways.find(engine, self._problem.near is not None)
        return partial(way.machine or way.begin, *self._lay_out(engine)), way.machine is not None

    def _prove(self, row: Floats, target: Target, word: int, stream: int) -> Settled | None:
        """What a few attempts of `lm` did not reach: a proof, or what further ones reach."""
        plan, excess = self.plan, prove(self._problem, target)
        if excess != (0.0, 0.0):
            return Settled(row, LM, excess)
        why = int(rule_out(self._problem, Targets.of([target]))[0])
        if why >= 0:
            return Settled(row, LM, why=why)
        if plan.all > plan.few and self.answer(target.T_world_tool, word, stream, plan.few, plan.all, row):
            return Settled(row, LM)
        return None

    def _go_on(self, tried: Floats, target: Target, word: int, stream: int) -> Settled | None:
        """What no branch reaches: a few attempts of `lm`, counted with those of the closed form, and a proof."""
        plan, problem = self.plan, self._problem
        row, (answer, _) = np.empty(plan.size), self._bind(LM)
        is_reached = answer(target.T_world_tool, word, stream, 0, plan.few, row)
        excess, why = (0.0, 0.0), -1
        if not is_reached:
            excess = prove(problem, target)
            why = -1 if excess != (0.0, 0.0) else int(rule_out(problem, Targets.of([target]))[0])
        if not is_reached and excess == (0.0, 0.0) and why < 0:
            return None
        best = keep_better(plan, tried, row)
        return Settled(best, CLOSED if best is tried else LM, excess, why)


def keep_better(plan: Plan, tried: Floats, row: Floats) -> Floats:
    """Of two rows the one whose score is better, the first of equals, with the counts of both."""
    whole = [part[plan.counts :].view(np.int64) for part in (tried, row)]
    scores = [tuple(part[plan.counts + SCORE : plan.counts + BLOCKED].tolist()) for part in (tried, row)]
    for part in (slice(FIRST_COUNT, SCORE), slice(BLOCKED, None)):
        whole[0][part] = whole[1][part] = whole[0][part] + whole[1][part]
    return row if scores[1] < scores[0] else tried


def lay_out(problem: Problem, kind: str, engine: str) -> Sequence[Any]:
    """What stays from target to target of an engine's call."""
    return analytic.pack_answer(problem) if engine == CLOSED else lm.pack_answer(problem, kind)


class Layouts:
    """The same of one robot's questions in any world: all but the world is laid out once for what it carries."""

    def __init__(self, kind: str) -> None:
        self._kind = kind
        self._kept: dict[str, tuple[CollisionModel, Sequence[Any]]] = {}

    def lay_out(self, problem: Problem, engine: str) -> Sequence[Any]:
        """What stays of an engine's call in the world of a problem, which is that of the first one but for that."""
        laden = problem.collision.laden
        kept = self._kept.get(engine)
        if kept is None or kept[0] is not laden:
            numbers, whole, *others = lay_out(problem, self._kind, engine)
            kept = self._kept[engine] = laden, (*exchange_world(numbers, whole, np.empty(0)), *others)
        numbers, whole, *others = kept[1]
        return *exchange_world(numbers, whole, problem.collision.arrays.world), *others

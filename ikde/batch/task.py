"""The work of one part: it holds all it needs, so that it can be sent to another process or machine."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypedDict

import numpy as np
import pyarrow as pa

from ikde.batch.columns import keep_own_words, make_solutions, make_timing
from ikde.batch.parts import Part
from ikde.batch.plan import Arm, Batch
from ikde.batch.sources import Goals, take_goals
from ikde.kernels.arrays import Ints
from ikde.model.robot import Detector
from ikde.model.target import Targets
from ikde.solver.background import WAIT, compile_way
from ikde.solver.region_rows import solve_goals
from ikde.solver.results import SolveResults, solve_rows
from ikde.solver.settings import BulkOptions


class Where(TypedDict):
    """Of the random numbers of a part."""

    seed: int
    first_stream: int


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Task:
    """One part to be solved."""

    part: Part
    arm: Arm
    targets: Goals
    """Each once, the first being that of the first solve."""
    names: tuple[str, ...] | None
    """A name a target, if they have names."""
    repeats: int
    seed: int
    graders: tuple[Detector, ...]
    groups: tuple[str, ...]
    explain: bool


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Answer:
    """A part solved."""

    part: Part
    solutions: pa.Table
    timing: pa.Table


def make_task(batch: Batch, part: Part) -> Task:
    """Read the targets of a part and pack its bag."""
    first, last = part.first // batch.repeats, (part.last - 1) // batch.repeats + 1
    return Task(
        part=part,
        arm=next(arm for arm in batch.arms if arm.name == part.arm),
        targets=batch.source.read(first, last),
        names=batch.source.names[first:last] if batch.source.names else None,
        repeats=batch.repeats,
        seed=batch.seed,
        graders=batch.graders,
        groups=batch.columns,
        explain=batch.explain,
    )


def solve_task(task: Task, threads: int | None = None) -> Answer:
    """Solve, grade and tabulate one part; the solutions are the same bits wherever this runs."""
    return tabulate(task, search_task(task, threads))


def search_task(task: Task, threads: int | None = None) -> SolveResults:
    """Solve and grade one part."""
    goals, where = take_goals(task.targets, _places(task)), Where(seed=task.seed, first_stream=task.part.first)
    with compile_way(WAIT):  # others follow, for which it is compiled at last
        if not isinstance(goals, Targets):
            return solve_goals(task.arm.problem, goals, **where)
        return solve_rows(task.arm.problem, goals, BulkOptions(threads=threads, explain=task.explain), **where)


def _places(task: Task) -> Ints:
    """The place of each solve's target among those of the task."""
    numbers = np.arange(task.part.first, task.part.last)
    return numbers // task.repeats - numbers[0] // task.repeats


def tabulate(task: Task, rows: SolveResults) -> Answer:
    """The tables of a part that has been solved."""
    numbers = np.arange(task.part.first, task.part.last)
    solutions = make_solutions(
        task.arm.name,
        rows,
        numbers=numbers,
        repeats=task.repeats,
        names=pa.array(task.names, pa.string()).take(pa.array(_places(task))) if task.names else None,
        groups=task.groups,
        graders=task.graders,
        world=task.arm.world,
    )
    timing = make_timing(task.arm.name, rows, numbers=numbers, repeats=task.repeats)
    return Answer(part=task.part, solutions=solutions, timing=timing)


def cut_answer(answer: Answer, parts: Sequence[Part]) -> list[Answer]:
    """The answers of the parts that were solved as one: the same tables as if each had been solved by itself."""

    def cut(part: Part) -> Answer:
        first = part.first - answer.part.first
        solutions = keep_own_words(answer.solutions.slice(first, part.rows))
        return Answer(part=part, solutions=solutions, timing=answer.timing.slice(first, part.rows))

    return [cut(part) for part in parts]

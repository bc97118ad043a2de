"""What a batch would do, and how long it would take: measured by solving a sample of each arm, writing nothing.

Compiling is no part of that time: it is done first, measured apart, and on the same machine need not be done again.
"""

from dataclasses import dataclass, replace
from typing import Any

import pyarrow as pa

from ikde.batch.options import check_options
from ikde.batch.parts import Part, seal_part, serialize
from ikde.batch.plan import Arm, Batch
from ikde.batch.sources import GoalSource, ListSource
from ikde.batch.task import Answer, Task, make_task, solve_task
from ikde.kernels.cache_folder import CACHE_IS_WRITABLE
from ikde.kernels.jit import compile_clock
from ikde.model.target import Targets
from ikde.solver.engine_table import SEVERAL
from ikde.solver.search import usable_cores

SAMPLE_SECONDS = 2.0  # of all arms together, about
GROWTH = 4  # from one sample to the next


@dataclass(frozen=True, slots=True, kw_only=True)
class ArmPreview:
    """One arm and how fast it went."""

    name: str
    method: str
    detector: str
    sample: int
    """Solves that were timed."""
    sample_reached: int
    seconds: float
    """What all its solves would take, on all threads together, without compiling."""
    load_seconds: float
    """What loading its kernels and seeds took, which a run does once, too."""
    compile_seconds: float
    """What the sample took to compile; 0 if it was compiled already."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Preview:
    """What would run."""

    name: str
    robot: str
    targets: int
    repeats: int
    seed: int
    arms: tuple[ArmPreview, ...]
    solves: int
    """Of all arms."""
    parts: int
    threads: int
    columns: tuple[str, ...]
    bytes: int
    """On the disk, about."""

    compiles_again: bool
    """No cache folder can be used: the run itself compiles as much once more."""

    @property
    def seconds(self) -> float:
        """Of all arms, about, with loading, without compiling."""
        return sum(arm.seconds + arm.load_seconds for arm in self.arms)

    @property
    def compile_seconds(self) -> float:
        """What the samples of all arms took to compile."""
        return sum(arm.compile_seconds for arm in self.arms)


def preview_batch(batch: Batch, *, threads: int | None = None) -> Preview:
    """Say what would run; solves a sample of each arm, some seconds long, and writes nothing."""
    check_options(threads, None, None)
    cores, parts = threads or usable_cores(), -(-batch.solves // batch.chunk)
    budget = SAMPLE_SECONDS / len(batch.arms)
    samples = [_time_arm(batch, arm, cores, budget) for arm in batch.arms]
    return Preview(
        name=batch.name,
        robot=batch.robot.name,
        targets=batch.source.count,
        repeats=batch.repeats,
        seed=batch.seed,
        arms=tuple(arm for arm, _ in samples),
        solves=batch.solves * len(batch.arms),
        parts=parts * len(batch.arms),
        threads=cores,
        columns=tuple(samples[0][1].solutions.column_names),
        compiles_again=not CACHE_IS_WRITABLE,
        bytes=sum(_estimate_bytes(answer, batch.solves, parts) for _, answer in samples),
    )


def _time_arm(batch: Batch, arm: Arm, threads: int, budget: float) -> tuple[ArmPreview, Answer]:
    """Solve larger and larger samples until one fills about the budget.

    As many targets as are solved side by side come first, untimed: they compile or load what the others need, too. What
    a harder one needs beyond is compiled when that comes, and left out.
    """
    with compile_clock() as all_clock:
        solve_task(_take_sample(batch, arm, min(SEVERAL, batch.solves)), threads)
        load_seconds = all_clock.run_seconds
        size = min(max(SEVERAL, threads), batch.solves)
        while True:
            sample = _take_sample(batch, arm, size)
            with compile_clock() as clock:
                answer = solve_task(sample, threads)
                seal_part(sample.part, answer.solutions, answer.timing, recipe="")
            seconds = clock.run_seconds
            if seconds > budget / GROWTH or size == batch.solves:
                break
            size = min(size * GROWTH, batch.solves)
    facts = ArmPreview(
        name=arm.name,
        method=arm.method,
        detector=arm.problem.collision.name,
        sample=size,
        sample_reached=sum(answer.solutions["reached"].to_pylist()),
        seconds=seconds / size * batch.solves,
        load_seconds=load_seconds,
        compile_seconds=all_clock.seconds,
    )
    return facts, answer


def _take_sample(batch: Batch, arm: Arm, size: int) -> Task:
    """A task of solves that are evenly spread over all targets."""
    chosen = [index * batch.source.count // size for index in range(size)]
    names = batch.source.names
    own = tuple(names[target] for target in chosen) if names else None
    cut = [batch.source.read(target, target + 1) for target in chosen]
    goals: list[Any] = [some[0] for some in cut]
    is_exact = isinstance(cut[0], Targets)
    sample = ListSource(targets=goals, names=own) if is_exact else GoalSource(goals=goals, names=own)
    return make_task(replace(batch, source=sample, repeats=1), Part(arm.name, 0, 0, size))


def _estimate_bytes(answer: Answer, solves: int, parts: int) -> int:
    """Bytes of an arm: so many a row, and the frame of each file."""
    tables = (answer.solutions, answer.timing)
    frames = sum(_size(table.slice(0, 0)) for table in tables)
    rows = sum(_size(table) for table in tables) - frames
    return round(rows / len(answer.solutions) * solves) + frames * parts


def _size(table: pa.Table) -> int:
    return serialize(table).size

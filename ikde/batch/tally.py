"""What one part of a run amounts to: counted where it is solved, or read again from its files."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
import pyarrow as pa

from ikde.batch.parts import Part
from ikde.batch.read import read_verdicts
from ikde.batch.statistics import Rate
from ikde.kernels.arrays import Floats, Ints
from ikde.solver.verify import Bools

MAX_LISTED = 1000  # unreached targets of an arm that are kept with name and reason
NONE = Rate(0, 0)
BLOCKERS = A, B = "blocker_a", "blocker_b"
MAX_COMPARED = 10  # targets that are few enough to be counted one by one


@dataclass(frozen=True, slots=True, kw_only=True)
class Counts:
    """Solves and what became of them."""

    name: str | None = None
    """Of the target, if they are all of one."""
    reached: Rate = NONE
    collisions: Mapping[str, Rate] = field(default_factory=dict)
    """By grader: how many of the reached solutions that it checked it sees in collision."""

    def __add__(self, other: "Counts") -> "Counts":
        """Both counted together."""
        collisions = {name: self.collisions.get(name, NONE) + rate for name, rate in other.collisions.items()}
        return Counts(name=self.name or other.name, reached=self.reached + other.reached, collisions=collisions)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PartTally:
    """The counts of one part."""

    part: Part
    all: Counts
    of_target: Mapping[int, Counts]
    """Each target by itself, if there are few."""
    collision_checked: int
    verified: Rate
    stop_reasons: Mapping[str, int]
    blockers: Mapping[tuple[str, str], int]
    """Rows that were not reached, by the pair that blocked most often; none where a run is in no world."""
    attempts: Ints | None
    """[n] of all solves; None if the run keeps no cost."""
    seconds: Floats
    """[n] of all solves."""
    missed: Ints
    """[m] targets that were not reached, each once, in order."""
    misses: Ints
    """[m] how often each was not."""
    first_missed: pa.Table
    """The first row that missed a target, of the first `MAX_LISTED` targets."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Counting:
    """What is counted in a run."""

    graders: tuple[str, ...]
    one_by_one: bool
    """Each target by itself, too: a few are solved repeatedly."""

    @classmethod
    def of(cls, graders: Sequence[str], repeats: int, targets: int) -> "Counting":
        """For so many targets, each solved so often."""
        return cls(graders=tuple(graders), one_by_one=repeats > 1 and 2 <= targets <= MAX_COMPARED)

    def count(self, part: Part, solutions: pa.Table, seconds: Floats) -> PartTally:
        """One part by its solutions and the seconds [n] that each took."""
        reached = solutions["reached"].to_numpy()
        missed, first, misses = _find_missed(solutions, reached)
        return PartTally(
            part=part,
            all=self._count_solves(solutions, reached),
            of_target=self._count_targets(solutions, reached) if self.one_by_one else {},
            collision_checked=len(solutions) - solutions["collision"].null_count,
            verified=Rate.of(read_verdicts(solutions["verified"])),
            stop_reasons={row["values"]: row["counts"] for row in solutions["stop_reason"].value_counts().to_pylist()},
            blockers=count_blockers(solutions),
            attempts=solutions["attempts"].to_numpy() if "attempts" in solutions.column_names else None,
            seconds=seconds,
            missed=missed,
            misses=misses,
            first_missed=solutions.select(_list_shown(solutions)).take(pa.array(first[:MAX_LISTED])),
        )

    def _count_solves(self, solutions: pa.Table, reached: Bools, name: str | None = None) -> Counts:
        seen = {grader: read_verdicts(solutions[f"{grader}_collides"])[reached] for grader in self.graders}
        collisions = {grader: Rate.of(verdicts) for grader, verdicts in seen.items()}
        return Counts(name=name, reached=Rate(int(reached.sum()), len(reached)), collisions=collisions)

    def _count_targets(self, solutions: pa.Table, reached: Bools) -> dict[int, Counts]:
        targets, counts = solutions["target"].to_numpy(), dict[int, Counts]()
        for target in np.unique(targets).tolist():
            mine = solutions.filter(pa.array(targets == target))
            name = mine["target_name"][0].as_py() if "target_name" in mine.column_names else None
            counts[target] = self._count_solves(mine, reached[targets == target], name)
        return counts


def count_blockers(solutions: pa.Table) -> dict[tuple[str, str], int]:
    """Rows by the pair that blocked them most often: two components, or the robot and an obstacle."""
    if not set(BLOCKERS) <= set(solutions.column_names):
        return {}
    counted = solutions.group_by(BLOCKERS).aggregate([([], "count_all")]).to_pylist()
    return {(row[A], row[B]): row["count_all"] for row in counted if row[A] is not None}


def _find_missed(solutions: pa.Table, reached: Bools) -> tuple[Ints, Ints, Ints]:
    """Targets that were not reached, in order, the first row that missed each, and how many did."""
    rows = np.flatnonzero(~reached)
    targets, first, counts = np.unique(solutions["target"].to_numpy()[rows], return_index=True, return_counts=True)
    return targets, rows[first], counts


def _list_shown(solutions: pa.Table) -> list[str]:
    """The columns that a list of what was not reached shows."""
    columns = ("arm", "target", "target_name", "repeat", "stop_reason", "reason")
    return [name for name in columns if name in solutions.column_names]

"""What came of one arm of a run, counted part by part."""

from collections import Counter, defaultdict
from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
import pyarrow as pa

from ikde.batch.manifest import ArmFacts, Manifest
from ikde.batch.read import read_verdicts
from ikde.batch.statistics import Rate, Spread, compute_spread

MAX_LISTED = 1000  # unreached targets of an arm that are kept with name and reason
MAX_COMPARED = 10  # targets that are few enough to be counted one by one


@dataclass(frozen=True, slots=True, kw_only=True)
class Unreached:
    """A target that an arm did not reach every time; of the first time it missed, when and why."""

    arm: str
    target: int
    name: str | None
    repeat: int
    missed: int
    """Repeats that did not reach it."""
    stop_reason: str
    reason: str | None
    """None if the run keeps no reasons."""


@dataclass(frozen=True, slots=True, kw_only=True)
class TargetSummary:
    """What came of the repeats of one target."""

    target: int
    name: str | None
    reached: Rate
    collisions: Mapping[str, Rate]
    """By grader: how many of the reached solutions that it checked it sees in collision."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ArmSummary:
    """What came of one arm, over the finished parts."""

    name: str
    method: str
    detector: str
    reached: Rate
    collision_checked: int
    """Solves whose self-collision was checked: all, or none without a detector."""
    verified: Rate
    """Of the solves that plain numpy graded as well, those that it agrees with."""
    stop_reasons: Mapping[str, int]
    attempts: Spread | None
    """Of all solves; None if the run keeps no cost."""
    milliseconds: Spread | None
    """Of all solves; None before the first part is finished."""
    collisions: Mapping[str, Rate]
    """By grader: how many of the reached solutions that it checked it sees in collision."""
    by_target: tuple[TargetSummary, ...]
    """Each target by itself, if a few were solved repeatedly: then the rates of all together are of these targets
    only."""
    unreached_targets: int
    listed: tuple[Unreached, ...]
    """The first of them."""


@dataclass(slots=True)
class _Counts:
    """Solves and what became of them."""

    name: str | None = None
    reached: Rate = field(default_factory=lambda: Rate(0, 0))
    collisions: dict[str, Rate] = field(default_factory=lambda: defaultdict(lambda: Rate(0, 0)))

    def add(self, solutions: pa.Table, graders: tuple[str, ...]) -> None:
        reached = solutions["reached"].to_numpy()
        self.reached += Rate(int(reached.sum()), len(solutions))
        for grader in graders:
            self.collisions[grader] += Rate.of(read_verdicts(solutions[f"{grader}_collides"])[reached])


class ArmTally:
    """The counts of one arm, so far."""

    def __init__(self, facts: ArmFacts, manifest: Manifest) -> None:
        self._facts = facts
        self._graders = manifest.graders
        self._one_by_one = manifest.repeats > 1 and 2 <= manifest.targets <= MAX_COMPARED
        self._all = _Counts()
        self._of_target: dict[int, _Counts] = {}
        self._collision_checked = 0
        self._verified = Rate(0, 0)
        self._stop_reasons: Counter[str] = Counter()
        self._attempts: list[np.ndarray] = []
        self._seconds: list[np.ndarray] = []
        self._missed: list[np.ndarray] = []
        self._listed: dict[int, Unreached] = {}

    def add(self, solutions: pa.Table, seconds: np.ndarray) -> None:
        """Count one part in."""
        self._all.add(solutions, self._graders)
        self._collision_checked += len(solutions) - solutions["collision"].null_count
        self._verified += Rate.of(read_verdicts(solutions["verified"]))
        for entry in solutions["stop_reason"].value_counts().to_pylist():
            self._stop_reasons[entry["values"]] += entry["counts"]
        if "attempts" in solutions.column_names:
            self._attempts.append(solutions["attempts"].to_numpy())
        self._seconds.append(seconds)
        self._list_unreached(solutions)
        if self._one_by_one:
            self._count_targets(solutions)

    def summary(self) -> ArmSummary:
        """The counts as figures."""
        return ArmSummary(
            name=self._facts.name,
            method=self._facts.method,
            detector=self._facts.detector,
            reached=self._all.reached,
            collision_checked=self._collision_checked,
            verified=self._verified,
            stop_reasons=dict(self._stop_reasons.most_common()),
            attempts=compute_spread(_join(self._attempts)),
            milliseconds=compute_spread(_join(self._seconds) * 1e3),
            collisions={grader: self._all.collisions[grader] for grader in self._graders},
            by_target=tuple(
                TargetSummary(target=target, name=one.name, reached=one.reached, collisions=dict(one.collisions))
                for target, one in self._of_target.items()
            ),
            unreached_targets=len(np.unique(_join(self._missed))),
            listed=tuple(self._listed.values()),
        )

    def _count_targets(self, solutions: pa.Table) -> None:
        targets = solutions["target"].to_numpy()
        for target in np.unique(targets).tolist():
            mine = solutions.filter(pa.array(targets == target))
            name = mine["target_name"][0].as_py() if "target_name" in mine.column_names else None
            self._of_target.setdefault(target, _Counts(name)).add(mine, self._graders)

    def _list_unreached(self, solutions: pa.Table) -> None:
        """Each target once: the first repeat that missed it, and how many did; it may go on in the next part."""
        missed = solutions.filter(pa.array(~solutions["reached"].to_numpy()))
        targets, first, counts = np.unique(missed["target"].to_numpy(), return_index=True, return_counts=True)
        self._missed.append(targets)
        # A listed target may go on in this part; of those that are new, as many as there is room for.
        known = np.isin(targets, list(self._listed))
        for target, count in zip(targets[known].tolist(), counts[known].tolist(), strict=True):
            self._listed[target] = replace(self._listed[target], missed=self._listed[target].missed + count)
        new = np.flatnonzero(~known)[: MAX_LISTED - len(self._listed)]
        rows = missed.take(pa.array(first[new])).to_pylist() if new.size else []
        for row, count in zip(rows, counts[new].tolist(), strict=True):
            self._listed[row["target"]] = Unreached(
                arm=row["arm"],
                target=row["target"],
                name=row.get("target_name"),
                repeat=row["repeat"],
                missed=count,
                stop_reason=row["stop_reason"],
                reason=row.get("reason"),
            )


def _join(pieces: list[np.ndarray]) -> np.ndarray:
    return np.concatenate(pieces) if pieces else np.empty(0)

"""What came of one arm of a run, added up part by part."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import pyarrow as pa

from ikde.batch.manifest import ArmFacts
from ikde.batch.statistics import Rate, Spread, compute_spread
from ikde.batch.tally import MAX_LISTED, Counts, PartTally
from ikde.kernels.arrays import Floats, Ints


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
    world: str | None
    """The world that it solved in, if the run has any."""
    reached: Rate
    collision_checked: int
    """Solves whose self-collision was checked: all, or none without a detector."""
    verified: Rate
    """Of the solves that plain numpy graded as well, those that it agrees with."""
    stop_reasons: Mapping[str, int]
    blockers: Mapping[str, int]
    """Solves that were not reached by what blocked most often: an obstacle, or two components; in worlds alone."""
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


class ArmTally:
    """The counts of one arm, so far."""

    def __init__(self, facts: ArmFacts, graders: Sequence[str], robot: str) -> None:
        self._facts, self._robot = facts, robot
        self._blockers: Counter[str] = Counter()
        self._all = Counts(collisions=dict.fromkeys(graders, Rate(0, 0)))
        self._of_target: dict[int, Counts] = {}
        self._collision_checked = 0
        self._verified = Rate(0, 0)
        self._stop_reasons: Counter[str] = Counter()
        self._attempts: list[Ints] = []
        self._seconds: list[Floats] = []
        self._missed: list[Ints] = []
        self._listed: dict[int, Unreached] = {}

    def add(self, tally: PartTally) -> None:
        """Count one part in: part after part, in the order of the answers."""
        self._all += tally.all
        self._collision_checked += tally.collision_checked
        self._verified += tally.verified
        self._stop_reasons.update(tally.stop_reasons)
        for pair, count in tally.blockers.items():
            self._blockers[name_blocker(pair, self._robot)] += count
        if tally.attempts is not None:
            self._attempts.append(tally.attempts)
        self._seconds.append(tally.seconds)
        self._missed.append(tally.missed)
        self._list_unreached(tally)
        for target, counts in tally.of_target.items():
            self._of_target[target] = self._of_target.get(target, Counts()) + counts

    def summary(self) -> ArmSummary:
        """The counts as figures."""
        return ArmSummary(
            name=self._facts.name,
            method=self._facts.method,
            detector=self._facts.detector,
            world=self._facts.world,
            reached=self._all.reached,
            collision_checked=self._collision_checked,
            verified=self._verified,
            stop_reasons=dict(self._stop_reasons.most_common()),
            blockers=dict(self._blockers.most_common()),
            attempts=compute_spread(_join(self._attempts)),
            milliseconds=compute_spread(_join(self._seconds) * 1e3),
            collisions=self._all.collisions,
            by_target=tuple(
                TargetSummary(target=target, name=one.name, reached=one.reached, collisions=one.collisions)
                for target, one in self._of_target.items()
            ),
            unreached_targets=len(np.unique(_join(self._missed))),
            listed=tuple(self._listed.values()),
        )

    def _list_unreached(self, tally: PartTally) -> None:
        """Each target once: the first repeat that missed it, and how many did; it may go on in the next part."""
        # A listed target may go on in this part; of those that are new, as many as there is room for.
        known = np.isin(tally.missed, list(self._listed))
        for target, count in zip(tally.missed[known].tolist(), tally.misses[known].tolist(), strict=True):
            self._listed[target] = replace(self._listed[target], missed=self._listed[target].missed + count)
        new = np.flatnonzero(~known)[: MAX_LISTED - len(self._listed)]
        rows = tally.first_missed.take(pa.array(new)).to_pylist() if new.size else []
        for row, count in zip(rows, tally.misses[new].tolist(), strict=True):
            self._listed[row["target"]] = Unreached(
                arm=row["arm"],
                target=row["target"],
                name=row.get("target_name"),
                repeat=row["repeat"],
                missed=count,
                stop_reason=row["stop_reason"],
                reason=row.get("reason"),
            )


def name_blocker(pair: tuple[str, str], robot: str) -> str:
    """An obstacle, where the robot stands for what touched it; else two components."""
    return pair[1] if pair[0] == robot else " - ".join(pair)


def _join(pieces: Sequence[np.ndarray]) -> np.ndarray:
    return np.concatenate(pieces) if pieces else np.empty(0)

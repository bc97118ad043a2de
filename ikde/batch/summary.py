"""What came of a run, gathered part by part."""

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa

from ikde.batch.manifest import Manifest, read_manifest
from ikde.batch.parts import SOLUTIONS, TIMING
from ikde.batch.read import list_finished, read_part
from ikde.batch.statistics import Rate, Spread, compute_spread

LISTED = 20  # unreached solves that are kept with name and reason


@dataclass(frozen=True, slots=True, kw_only=True)
class Unreached:
    """A solve that did not reach its target."""

    arm: str
    target: int
    name: str | None
    repeat: int
    stop_reason: str
    reason: str | None
    """None if the run keeps no reasons."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ArmSummary:
    """What came of one arm, over the finished parts."""

    name: str
    method: str
    detector: str
    reached: Rate
    stop_reasons: Mapping[str, int]
    attempts: Spread | None
    """Of all solves; None if the run keeps no cost."""
    milliseconds: Spread | None
    """Of all solves; None before the first part is finished."""
    collisions: Mapping[str, Rate]
    """By grader: how many of the reached solutions it sees in collision."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RunSummary:
    """What came of a run."""

    folder: Path
    name: str
    robot: str
    seed: int
    hash: str
    parts_done: int
    parts: int
    arms: tuple[ArmSummary, ...]
    unreached: int
    listed: tuple[Unreached, ...]
    """The first of the unreached."""

    @property
    def finished(self) -> bool:
        """True if no part is missing."""
        return self.parts_done == self.parts


def summarise(folder: str | PathLike[str]) -> RunSummary:
    """Summarise a run, finished or not, one part in memory at a time.

    Raises:
        FileError: for a folder that is no run, or holds a part that is damaged.
    """
    folder = Path(folder)
    manifest = read_manifest(folder)
    tallies = {arm.name: _Tally() for arm in manifest.arms}
    listed: list[Unreached] = []
    done = list(list_finished(folder, manifest))
    for part in done:
        solutions = read_part(folder, part, SOLUTIONS, _columns(manifest))
        seconds = read_part(folder, part, TIMING, ["solve_seconds"])["solve_seconds"].to_numpy()
        tallies[part.arm].add(solutions, seconds, manifest.graders)
        listed += _list_unreached(solutions, LISTED - len(listed))
    arms = tuple(
        tallies[arm.name].summary(name=arm.name, method=arm.method, detector=arm.detector) for arm in manifest.arms
    )
    return RunSummary(
        folder=folder,
        name=manifest.name,
        robot=manifest.robot,
        seed=manifest.seed,
        hash=manifest.hash,
        parts_done=len(done),
        parts=manifest.parts,
        arms=arms,
        unreached=sum(arm.reached.total - arm.reached.count for arm in arms),
        listed=tuple(listed),
    )


def _columns(manifest: Manifest) -> list[str]:
    identity = ["arm", "target", "target_name", "repeat", "reached", "stop_reason", "reason", "attempts"]
    return [*identity, *(f"{grader}_collides" for grader in manifest.graders)]


@dataclass(slots=True)
class _Tally:
    """Counts of one arm, so far."""

    solves: int = 0
    reached: int = 0
    stop_reasons: Counter[str] = field(default_factory=Counter)
    attempts: list[np.ndarray] = field(default_factory=list)
    seconds: list[np.ndarray] = field(default_factory=list)
    colliding: Counter[str] = field(default_factory=Counter)
    graders: tuple[str, ...] = ()

    def add(self, solutions: pa.Table, seconds: np.ndarray, graders: tuple[str, ...]) -> None:
        """Count one part in."""
        reached = solutions["reached"].to_numpy()
        self.solves += len(solutions)
        self.reached += int(reached.sum())
        for entry in solutions["stop_reason"].value_counts().to_pylist():
            self.stop_reasons[entry["values"]] += entry["counts"]
        if "attempts" in solutions.column_names:
            self.attempts.append(solutions["attempts"].to_numpy())
        self.seconds.append(seconds)
        self.graders = graders
        for grader in graders:
            self.colliding[grader] += int((reached & solutions[f"{grader}_collides"].to_numpy()).sum())

    def summary(self, **facts: Any) -> ArmSummary:
        """The counts as figures."""
        return ArmSummary(
            reached=Rate(self.reached, self.solves),
            stop_reasons=dict(self.stop_reasons.most_common()),
            attempts=compute_spread(_join(self.attempts)),
            milliseconds=compute_spread(_join(self.seconds) * 1e3),
            collisions={grader: Rate(self.colliding[grader], self.reached) for grader in self.graders},
            **facts,
        )


def _join(pieces: list[np.ndarray]) -> np.ndarray:
    return np.concatenate(pieces) if pieces else np.empty(0)


def _list_unreached(solutions: pa.Table, most: int) -> list[Unreached]:
    """The first unreached solves of a part."""
    rows = solutions.filter(pa.array(~solutions["reached"].to_numpy())).slice(0, most).to_pylist()
    return [
        Unreached(
            arm=row["arm"],
            target=row["target"],
            name=row.get("target_name"),
            repeat=row["repeat"],
            stop_reason=row["stop_reason"],
            reason=row.get("reason"),
        )
        for row in rows
    ]

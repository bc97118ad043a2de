"""What a page shows of a run, gathered part by part: numbers as arrays, words as counts."""

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa

from ikde.batch.arm_summary import name_blocker
from ikde.batch.check_part import verdict_columns
from ikde.batch.manifest import ArmFacts, Manifest, read_manifest
from ikde.batch.parts import SOLUTIONS, TIMING, Part
from ikde.batch.read import list_finished, read_part, read_verdicts
from ikde.batch.statistics import Rate
from ikde.batch.tally import BLOCKERS, count_blockers
from ikde.errors import FileError
from ikde.solver.verify import MaskedBools

MAX_MISSED = 50  # targets that are listed with a reason
MAX_NAMED = 10_000  # targets whose names are kept
TIMED_ALONE = 0.5  # share of different times, from which on solves have been timed one by one
MAX_PLACED = 400  # targets that are drawn
ALWAYS = ("target", "repeat", "reached")
NUMBERS = (*ALWAYS, "attempts", "evaluations", "position_error_m", "orientation_error_rad", "clearance_m")
WORDS = ("stop_reason", "pair_a", "pair_b")
NOTHING = {  # the numbers of an arm of which no part is finished
    "target": np.empty(0, dtype=np.int64),
    "repeat": np.empty(0, dtype=np.int64),
    "reached": np.empty(0, dtype=bool),
    "solve_seconds": np.empty(0),
}
PLACE = ("target_x_m", "target_y_m", "target_z_m")
MISSED = (*PLACE, "reason", "hint")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ArmAnswers:
    """One arm's answers over the finished parts."""

    facts: ArmFacts
    numbers: Mapping[str, np.ndarray]
    """By column, [solves] each, NaN where there is none; with `solve_seconds`. Columns that the run does not keep are
    missing."""
    verdicts: Mapping[str, MaskedBools]
    """`collision`, `verified` and what each grader sees, [solves] each, masked where nothing was checked."""
    stop_reasons: Mapping[str, int]
    closest_pairs: Mapping[tuple[str, str], int]
    """Of the reached solutions."""
    blockers: Mapping[str, int]
    """Solves that were not reached, by what blocked most often; in worlds alone."""
    missed: Mapping[int, Mapping[str, Any]]
    """The first row that was not reached, by target, of the first `MAX_MISSED` of them."""

    @property
    def name(self) -> str:
        """Its name."""
        return self.facts.name

    @property
    def reached(self) -> np.ndarray:
        """[solves] True where the target was reached."""
        return self.numbers["reached"]

    @property
    def solves(self) -> int:
        """How many there are so far."""
        return len(self.reached)

    @property
    def rate(self) -> Rate:
        """How many were reached."""
        return Rate(int(self.reached.sum()), self.solves)

    def of_reached(self, column: str) -> np.ndarray:
        """A column where the target was reached, without its NaN; empty if the run does not keep it."""
        if column not in self.numbers:
            return np.empty(0)
        values = self.numbers[column][self.reached]
        return values[np.isfinite(values)]

    @property
    def timed_alone(self) -> bool:
        """Whether each solve was timed by itself; short ones share a call, and its time in equal parts."""
        seconds = self.numbers["solve_seconds"]
        return len(np.unique(seconds)) > TIMED_ALONE * len(seconds)

    @property
    def collision_checked(self) -> bool | None:
        """Whether the arm's detector checked its solves for self-collision; None before there is one."""
        return bool(self.verdicts["collision"].count()) if self.solves else None

    @property
    def verified(self) -> Rate:
        """Of the solves that plain numpy graded as well, those that it agrees with."""
        return Rate.of(self.verdicts["verified"])

    def collides(self, grader: str) -> MaskedBools:
        """[reached solutions] True where a grader sees a collision, masked where it compares nothing."""
        return self.verdicts[f"{grader}_collides"][self.reached]


@dataclass(frozen=True, slots=True, kw_only=True)
class RunAnswers:
    """A run's answers so far."""

    folder: Path
    manifest: Manifest
    parts_done: int
    arms: tuple[ArmAnswers, ...]
    names: Mapping[int, str]
    """By target; empty if targets have no names, or there are very many."""
    places_m: Mapping[int, tuple[float, ...]]
    """x, y, z by target, of at most `MAX_PLACED` that are evenly spread; empty if the run does not keep them."""

    @property
    def finished(self) -> bool:
        """True if no part is missing."""
        return self.parts_done == self.manifest.parts

    @property
    def rate(self) -> Rate:
        """How many solves of all arms reached their target."""
        return Rate(sum(arm.rate.count for arm in self.arms), sum(arm.solves for arm in self.arms))


def gather_answers(folder: str | PathLike[str]) -> RunAnswers:
    """Read of each part of a run what a page shows; raises `FileError` for what is no run, or is damaged."""
    folder = Path(folder)
    manifest = read_manifest(folder)
    piles = {arm.name: _Pile() for arm in manifest.arms}
    done = list(list_finished(folder, manifest))
    names: dict[int, str] = {}
    places: dict[int, tuple[float, ...]] = {}
    drawn = np.unique(np.linspace(0, manifest.targets - 1, MAX_PLACED).round().astype(np.int64))
    for part in done:
        solutions = piles[part.arm].add(folder, part, manifest)
        if manifest.targets <= MAX_NAMED and "target_name" in solutions.column_names:
            names.update(_find_names(solutions))
        places.update(_find_places(solutions, drawn))
    arms = tuple(piles[arm.name].answers(folder, arm, manifest.graders) for arm in manifest.arms)
    return RunAnswers(folder=folder, manifest=manifest, parts_done=len(done), arms=arms, names=names, places_m=places)


@dataclass(slots=True)
class _Pile:
    """One arm's answers, so far."""

    numbers: dict[str, list[np.ndarray]] = field(default_factory=dict)
    verdicts: dict[str, list[MaskedBools]] = field(default_factory=dict)
    stop_reasons: Counter[str] = field(default_factory=Counter)
    closest_pairs: Counter[tuple[str, str]] = field(default_factory=Counter)
    blockers: Counter[str] = field(default_factory=Counter)
    missed: dict[int, dict[str, Any]] = field(default_factory=dict)

    def add(self, folder: Path, part: Part, manifest: Manifest) -> pa.Table:
        """Put one part on the pile; returns what was read of its solutions."""
        graders = manifest.graders
        listing = MISSED if len(self.missed) < MAX_MISSED else ()
        wanted = [*NUMBERS, *verdict_columns(graders), *WORDS, *BLOCKERS, "target_name", *PLACE, *listing]
        solutions = read_part(folder, manifest, part, SOLUTIONS, wanted)
        timing = read_part(folder, manifest, part, TIMING, ["solve_seconds"])
        for table, names in ((solutions, NUMBERS), (timing, ("solve_seconds",))):
            for name in names:
                if name in table.column_names:
                    self.numbers.setdefault(name, []).append(table[name].to_numpy())
        for name in verdict_columns(graders):
            self.verdicts.setdefault(name, []).append(read_verdicts(solutions[name]))
        self._count_words(solutions)
        for pair, count in count_blockers(solutions).items():
            self.blockers[name_blocker(pair, manifest.robot)] += count
        if listing:
            self._list_missed(solutions)
        return solutions

    def _count_words(self, solutions: pa.Table) -> None:
        self.stop_reasons.update(_count(solutions, "stop_reason"))
        if "pair_a" in solutions.column_names:
            counts = _count(solutions.filter(solutions["reached"]), "pair_a", "pair_b")
            self.closest_pairs.update({pair: count for pair, count in counts.items() if None not in pair})

    def _list_missed(self, solutions: pa.Table) -> None:
        """Keep the first row of each target that was not reached."""
        numbers = np.flatnonzero(~solutions["reached"].to_numpy())
        targets, first = np.unique(solutions["target"].to_numpy()[numbers], return_index=True)
        for target, index in zip(targets.tolist(), first, strict=True):
            if target not in self.missed and len(self.missed) < MAX_MISSED:
                self.missed[target] = solutions.slice(numbers[index], 1).to_pylist()[0]

    def answers(self, folder: Path, facts: ArmFacts, graders: tuple[str, ...]) -> ArmAnswers:
        """The pile as arrays."""
        numbers = {name: np.concatenate(pieces) for name, pieces in self.numbers.items()}
        if len(set(map(len, numbers.values()))) > 1:
            raise FileError(folder, f"its parts of arm {facts.name} hold different columns")
        nothing = np.ma.masked_array(np.empty(0, dtype=bool))
        verdicts = {name: np.ma.concatenate(self.verdicts.get(name, [nothing])) for name in verdict_columns(graders)}
        return ArmAnswers(
            facts=facts,
            numbers=numbers or NOTHING,
            verdicts=verdicts,
            stop_reasons=dict(self.stop_reasons.most_common()),
            closest_pairs=dict(self.closest_pairs.most_common()),
            blockers=dict(self.blockers.most_common()),
            missed=self.missed,
        )


def _find_names(solutions: pa.Table) -> dict[int, str]:
    targets, first = np.unique(solutions["target"].to_numpy(), return_index=True)
    return dict(zip(targets.tolist(), solutions["target_name"].take(pa.array(first)).to_pylist(), strict=True))


def _find_places(solutions: pa.Table, drawn: np.ndarray) -> dict[int, tuple[float, ...]]:
    if not set(PLACE) <= set(solutions.column_names):
        return {}
    targets = solutions["target"].to_numpy()
    rows = np.flatnonzero(np.isin(targets, drawn))
    points = np.column_stack([solutions[name].to_numpy()[rows] for name in PLACE])
    return dict(zip(targets[rows].tolist(), map(tuple, points.tolist()), strict=True))


def _count(table: pa.Table, *columns: str) -> dict[Any, int]:
    """How often each word of a column is there, or each row of several."""
    counted = table.group_by(columns).aggregate([([], "count_all")])
    words = [counted[name].to_pylist() for name in columns]
    return dict(
        zip(words[0] if len(words) == 1 else zip(*words, strict=True), counted["count_all"].to_pylist(), strict=True)
    )

"""What came of a run, gathered part by part."""

from dataclasses import dataclass
from os import PathLike
from pathlib import Path

from ikde.batch.arm_summary import ArmSummary, ArmTally
from ikde.batch.check_part import check_part, verdict_columns
from ikde.batch.manifest import Manifest, read_manifest
from ikde.batch.parts import SOLUTIONS, TIMING, Part, read_finished
from ikde.batch.read import list_finished, read_part
from ikde.batch.tally import BLOCKERS, Counting, PartTally
from ikde.errors import FileError


@dataclass(frozen=True, slots=True, kw_only=True)
class RunSummary:
    """What came of a run."""

    folder: Path
    name: str
    robot: str
    seed: int
    hash: str
    repeats: int
    parts_done: int
    parts: int
    arms: tuple[ArmSummary, ...]

    def __repr__(self) -> str:
        solves = sum(arm.reached.total for arm in self.arms)
        done = "" if self.finished else f", {self.parts_done} of {self.parts} parts"
        return f"<RunSummary of {self.name}: {self.robot}, {solves - self.unreached:,} of {solves:,} reached{done}>"

    @property
    def finished(self) -> bool:
        """True if no part is missing."""
        return self.parts_done == self.parts

    @property
    def unreached(self) -> int:
        """Solves of all arms that did not reach their target."""
        return sum(arm.reached.total - arm.reached.count for arm in self.arms)


class RunTally:
    """The counts of a run, so far: a part is read at most once, and one that is solved now not at all."""

    def __init__(self, folder: Path) -> None:
        """For the run in a folder; raises `FileError` for what is none."""
        self._folder, self._manifest = folder, read_manifest(folder)
        self._counting = Counting.of(self._manifest.graders, self._manifest.repeats, self._manifest.targets)
        self._parts: dict[Part, PartTally] = {}

    def add(self, tally: PartTally) -> None:
        """Count one part in; they may come in any order."""
        self._parts[tally.part] = tally

    def find(self, part: Part) -> bool:
        """Count a part in that was finished before; False if it was not, or is damaged or none of this run."""
        found = read_finished(self._folder, part, self._manifest.hash, _columns(self._manifest))
        if found is None:
            return False
        solutions, timing = found
        try:
            for kind, table, columns in ((SOLUTIONS, solutions, _columns(self._manifest)), (TIMING, timing, None)):
                check_part(part.path(self._folder, kind), self._manifest, part, kind, table, columns)
        except FileError:
            return False
        self.add(self._counting.count(part, solutions, timing["solve_seconds"].to_numpy()))
        return True

    def read(self) -> None:
        """Count all parts in that are there; raises `FileError` for one that is damaged, or none of this run."""
        for part in list_finished(self._folder, self._manifest):
            solutions = read_part(self._folder, self._manifest, part, SOLUTIONS, _columns(self._manifest))
            timing = read_part(self._folder, self._manifest, part, TIMING, ["solve_seconds"])
            self.add(self._counting.count(part, solutions, timing["solve_seconds"].to_numpy()))

    def summary(self) -> RunSummary:
        """The counts as figures."""
        manifest = self._manifest
        tallies = {arm.name: ArmTally(arm, manifest.graders, manifest.robot) for arm in manifest.arms}
        for part in manifest.list_parts():
            if part in self._parts:
                tallies[part.arm].add(self._parts[part])
        return RunSummary(
            folder=self._folder,
            name=manifest.name,
            robot=manifest.robot,
            seed=manifest.seed,
            hash=manifest.hash,
            repeats=manifest.repeats,
            parts_done=len(self._parts),
            parts=manifest.parts,
            arms=tuple(tally.summary() for tally in tallies.values()),
        )


def summarise(folder: str | PathLike[str]) -> RunSummary:
    """Summarise a run, finished or not, a part in memory at a time; raises `FileError` for what is none, or damaged."""
    tally = RunTally(Path(folder))
    tally.read()
    return tally.summary()


def _columns(manifest: Manifest) -> list[str]:
    identity = ["arm", "target", "target_name", "repeat", "stop_reason", "reason", "attempts"]
    return [*identity, *BLOCKERS, "reached", *verdict_columns(manifest.graders)]

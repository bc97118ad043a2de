"""What came of a run, gathered part by part."""

from dataclasses import dataclass
from os import PathLike
from pathlib import Path

from ikde.batch.arm_summary import ArmSummary, ArmTally
from ikde.batch.check_part import verdict_columns
from ikde.batch.manifest import Manifest, read_manifest
from ikde.batch.parts import SOLUTIONS, TIMING
from ikde.batch.read import list_finished, read_part


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

    @property
    def finished(self) -> bool:
        """True if no part is missing."""
        return self.parts_done == self.parts

    @property
    def unreached(self) -> int:
        """Solves of all arms that did not reach their target."""
        return sum(arm.reached.total - arm.reached.count for arm in self.arms)


def summarise(folder: str | PathLike[str]) -> RunSummary:
    """Summarise a run, finished or not, a part in memory at a time; raises `FileError` for what is none, or damaged."""
    folder = Path(folder)
    manifest = read_manifest(folder)
    tallies = {arm.name: ArmTally(arm, manifest) for arm in manifest.arms}
    done = list(list_finished(folder, manifest))
    for part in done:
        solutions = read_part(folder, manifest, part, SOLUTIONS, _columns(manifest))
        timing = read_part(folder, manifest, part, TIMING, ["solve_seconds"])
        tallies[part.arm].add(solutions, timing["solve_seconds"].to_numpy())
    return RunSummary(
        folder=folder,
        name=manifest.name,
        robot=manifest.robot,
        seed=manifest.seed,
        hash=manifest.hash,
        repeats=manifest.repeats,
        parts_done=len(done),
        parts=manifest.parts,
        arms=tuple(tally.summary() for tally in tallies.values()),
    )


def _columns(manifest: Manifest) -> list[str]:
    identity = ["arm", "target", "target_name", "repeat", "stop_reason", "reason", "attempts"]
    return [*identity, "reached", *verdict_columns(manifest.graders)]

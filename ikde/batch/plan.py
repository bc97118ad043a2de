"""What will run: a batch with every name resolved, ready for the runner."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from ikde.batch.recipe import digest
from ikde.batch.sources import TargetSource
from ikde.model.robot import Detector, Robot
from ikde.solver.problem import Problem


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Arm:
    """One way to solve, to be compared with others over the same targets and random streams."""

    name: str
    method: str
    problem: Problem
    world: str | None = None
    """The name of the world that it solves in, if the run has any."""
    world_file: str | None = None
    """Where that was read, for the record only; None also of one of which obstacles were moved or picked up."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Batch:
    """Everything about a run but where its answers go.

    Solve i of an arm is target i // repeats, repeat i % repeats, and searches random stream i; arms share the streams.
    """

    name: str
    robot: Robot
    arms: tuple[Arm, ...]
    source: TargetSource
    repeats: int
    seed: int
    chunk: int
    """Solves a part."""
    graders: tuple[Detector, ...]
    """Further detectors that grade every solution."""
    columns: tuple[str, ...]
    """Column groups of the solutions: some of `spec.COLUMN_GROUPS`."""
    explain: bool
    """Probe why a target was not reached."""
    recipe: Mapping[str, Any]
    """Plain JSON data: all that the answers depend on."""
    file: str | None
    """The file it was read from, for the record only."""
    attach: str | None = None
    """What the robot picks up beside what the file says, as it was typed, for the record only."""

    def __repr__(self) -> str:
        arms = ", ".join(arm.name for arm in self.arms[:3]) + (", ..." if len(self.arms) > 3 else "")
        return f"<Batch {self.name}: {self.robot.name}, {self.source.count:,} targets, {len(self.arms)} arms: {arms}>"

    @property
    def solves(self) -> int:
        """Solves of one arm."""
        return self.source.count * self.repeats

    @property
    def hash(self) -> str:
        """SHA-256 of the recipe, hex: the same for the same answers."""
        return digest(self.recipe)

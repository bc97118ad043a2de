"""What the paper's report is computed from (the print, and where it is wrong, ships as data), and how much of it.

All of it takes minutes, a taste of it seconds.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from ikde.io.robots import load_robot
from ikde.io.yaml_file import read_yaml
from ikde.model.robot import Robot
from ikde.model.target import Target
from ikde.solver.progress import SILENCE, Progress

FOLDER = Path(__file__).parent
APPROXIMATIONS: tuple[str, ...] = ("typical", "improved")
PAIR_LISTS: tuple[str, ...] = ("formula_22", "formula_22_printed", "non_adjacent")


@cache
def load_published() -> dict[str, Any]:
    """Printed numbers of [Qiao2021] by table, formula and section (`qiao2021.yaml` says how they are written)."""
    return dict(read_yaml(FOLDER / "qiao2021.yaml").data or {})


@cache
def load_dong_zhao() -> dict[str, Any]:
    """Printed numbers of [DongZhao] and lengths that were searched for them (`dong_zhao.yaml`)."""
    return dict(read_yaml(FOLDER / "dong_zhao.yaml").data or {})


@cache
def load_misprints() -> list[dict[str, str]]:
    """Misprints and puzzles: paper, kind, place, printed, meant, evidence; the entries of docs/misprints.md."""
    papers = read_yaml(FOLDER / "misprints.yaml").data
    return [
        {"paper": paper, "kind": kind, **entry}
        for paper, kinds in papers.items()
        for kind, entries in kinds.items()
        for entry in entries
    ]


def meant(entry: Mapping[str, Any]) -> dict[str, Any]:
    """A published entry as it was meant: its misprint, if it has one, put right."""
    return {**entry, **entry.get("misprint", {})}


@dataclass(frozen=True, slots=True, kw_only=True)
class Budget:
    """Sample sizes of the sections that have any."""

    solves: int  # of each target in Table 4
    variation_solves: int  # of each target for every variation of Table 4's setting
    waits: int  # solves of each target and detector until a solution is free
    timing_rounds: int  # over which a time's median is taken, the things compared taking turns
    verdicts: int  # random configurations over which pair lists are compared
    surface_verdicts: int  # over which surface points and centres are compared
    plain_verdicts: int  # judged the paper's way, every surface point against every other; 0.4 s each
    timed_verdicts: int  # timed one by one
    curve_points: int  # moments of a situation's curve
    run_steps_per_s: int = 50  # of simulated runs


FULL = Budget(
    solves=10_000,
    variation_solves=500,
    waits=1_000,
    timing_rounds=21,
    verdicts=10_000,
    surface_verdicts=1_000,
    plain_verdicts=5,
    timed_verdicts=500,
    curve_points=201,
)
QUICK = Budget(
    solves=300,
    variation_solves=10,
    waits=40,
    timing_rounds=5,
    verdicts=1_000,
    surface_verdicts=100,
    plain_verdicts=1,
    timed_verdicts=50,
    curve_points=101,
    run_steps_per_s=25,
)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Inputs:
    """What every section is computed from."""

    robot: Robot  # qiao2021, the key-point model
    classical: Robot  # qiao2021_dh, the Denavit-Hartenberg model of the same arm
    tracked: Robot  # leobot, the tracked manipulator of [DongZhao]
    published: Mapping[str, Any]  # [Qiao2021]
    dong_zhao: Mapping[str, Any]
    misprints: Sequence[Mapping[str, str]]
    budget: Budget
    progress: Progress = SILENCE

    @property
    def targets(self) -> dict[str, Target]:
        """The two targets of section 5.3.3."""
        return {name: Target(np.array(p_mm) * 1e-3) for name, p_mm in self.published["targets_mm"].items()}


def load_inputs(budget: Budget) -> Inputs:
    """The shipped robots and printed numbers."""
    return Inputs(
        robot=load_robot("qiao2021"),
        classical=load_robot("qiao2021_dh"),
        tracked=load_robot("leobot"),
        published=load_published(),
        dong_zhao=load_dong_zhao(),
        misprints=load_misprints(),
        budget=budget,
    )

"""What a user waits for: attempts and time until the first solution that the detector accepts."""

from dataclasses import asdict, dataclass, field

import numpy as np

from ikde.batch.statistics import Spread
from ikde.model.collision_model import CollisionModel
from ikde.model.target import Target
from ikde.paper.inputs import APPROXIMATIONS, Inputs
from ikde.paper.plain_search import SEED, Setup, make_setup_problem
from ikde.paper.rejection import READINGS, describe_setup, spread_of
from ikde.paper.section import Computed, format_spread, make_collision, make_table
from ikde.report.page import Column, Section, Text
from ikde.solver.distinct import UNEXPLAINED
from ikde.solver.results import SolveResults, solve_rows

WAITS_IN_TURN = 50


@dataclass(frozen=True, slots=True, kw_only=True)
class WaitCell:
    """A target and a detector."""

    target: str
    reading: str
    spheres: str
    pairs: str


@dataclass(frozen=True, slots=True, kw_only=True)
class CellOutcome(WaitCell):
    """How many solves end, after how many attempts."""

    solves: int
    reached: int
    attempts: Spread


@dataclass(frozen=True, slots=True, kw_only=True)
class CellTimes(WaitCell):
    """Milliseconds of a solve."""

    ms: Spread


@dataclass(frozen=True, slots=True, kw_only=True)
class Waiting(Computed):
    """All cells."""

    rows: list[CellOutcome]
    measured: dict[str, list[CellTimes]]


@dataclass(frozen=True, slots=True)
class _Wait:
    """A cell as it is solved; cells take turns, so that a slow minute of the machine hits all of them."""

    cell: WaitCell
    target: Target
    collision: CollisionModel
    rows: list[SolveResults] = field(default_factory=list)

    @property
    def outcome(self) -> CellOutcome:
        reached = np.concatenate([rows.reached for rows in self.rows])
        attempts = np.concatenate([rows.attempts for rows in self.rows])
        return CellOutcome(
            **asdict(self.cell), solves=len(reached), reached=int(reached.sum()), attempts=spread_of(attempts)
        )

    @property
    def times(self) -> CellTimes:
        seconds = np.concatenate([rows.found.seconds for rows in self.rows])
        return CellTimes(**asdict(self.cell), ms=spread_of(1e3 * seconds))


def compute_waiting(inputs: Inputs) -> Waiting:
    """The search of Table 4's setting, started again until its solution is free, each solve with its own stream."""
    setup, robot = Setup(settings=Setup().settings.with_changes(restarts=1000)), inputs.robot
    waits = [
        _Wait(
            WaitCell(target=name, reading=reading, spheres=spheres, pairs=pairing[spheres]),
            target,
            make_collision(robot, spheres, pairing[spheres]),
        )
        for name, target in inputs.targets.items()
        for reading, pairing in READINGS.items()
        for spheres in APPROXIMATIONS
    ]
    problems = [make_setup_problem(robot, setup, wait.collision.detector) for wait in waits]
    for begin in range(0, inputs.budget.waits, WAITS_IN_TURN):
        count = min(WAITS_IN_TURN, inputs.budget.waits - begin)
        for wait, problem in zip(waits, problems, strict=True):
            wait.rows.append(solve_rows(problem, [wait.target] * count, UNEXPLAINED, seed=SEED, first_stream=begin))
            inputs.progress.advance(count)
    return Waiting(
        rows=[wait.outcome for wait in waits],
        measured={"rows": [wait.times for wait in waits]},
        settings=describe_setup(setup),
    )


# ---- the section


def show_waiting(data: Waiting, _: Inputs) -> Section:
    """Attempts and time to the first solution that a detector accepts."""
    return Section(
        "What a user waits for",
        (
            Text(
                "The same search, started again from a new population until its solution is free. The cells take turns."
            ),
            make_table(
                zip(data.rows, data.measured["rows"], strict=True),
                (Column("target", align="left"), lambda row: row[0].target),
                (Column("pairs", align="left"), lambda row: row[0].pairs.replace("_", " ")),
                (Column("detector", align="left"), lambda row: row[0].spheres),
                (Column("reached", mark="ours"), lambda row: f"{row[0].reached:,} of {row[0].solves:,}"),
                (Column("attempts: median / p95 / max", mark="ours"), lambda row: _format_attempts(row[0].attempts)),
                (Column("time: median / p95 / max", "ms", mark="ours"), lambda row: format_spread(row[1].ms)),
                caption="To the first collision-free solution",
                note="Wall time of a solve while all cores are busy with others.",
            ),
        ),
        anchor="waiting",
    )


def _format_attempts(attempts: Spread) -> str:
    return f"{attempts.median:g} / {attempts.p95:g} / {attempts.max:g}"

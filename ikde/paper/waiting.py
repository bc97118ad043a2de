"""What a user waits for: attempts and time until the first solution that the detector accepts."""

from dataclasses import dataclass
from itertools import product

from ikde.batch.statistics import Spread
from ikde.paper.columns import label, make_table, ours
from ikde.paper.inputs import APPROXIMATIONS, Inputs
from ikde.paper.plain_search import SEED, Setup, gather, make_setup_problem
from ikde.paper.rejection import READINGS, describe_setup, spread_of
from ikde.paper.section import Computed, format_spread, make_collision
from ikde.report.page import Section, Text
from ikde.solver.distinct import UNEXPLAINED
from ikde.solver.results import solve_rows

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


def compute_waiting(inputs: Inputs) -> Waiting:
    """The search of Table 4's setting, started again until its solution is free, each solve with its own stream."""
    setup, robot = Setup(settings=Setup().settings.with_changes(restarts=1000)), inputs.robot
    cells = [
        {"target": target, "reading": reading, "spheres": spheres, "pairs": READINGS[reading][spheres]}
        for target, reading, spheres in product(inputs.targets, READINGS, APPROXIMATIONS)
    ]
    searches = [
        make_setup_problem(robot, setup, make_collision(robot, c["spheres"], c["pairs"]).detector) for c in cells
    ]
    parts = []  # cells take turns, so that a slow minute of the machine hits all of them
    for begin in range(0, inputs.budget.waits, WAITS_IN_TURN):
        count = min(WAITS_IN_TURN, inputs.budget.waits - begin)
        for cell, search in zip(cells, searches, strict=True):
            targets = [inputs.targets[cell["target"]]] * count
            parts.append(solve_rows(search, targets, UNEXPLAINED, seed=SEED, first_stream=begin))
            inputs.progress.advance(count)
    solved = [(cell, gather(parts[k :: len(cells)])) for k, cell in enumerate(cells)]
    return Waiting(
        rows=[
            CellOutcome(**cell, solves=len(found.seconds), reached=len(found.Q), attempts=spread_of(found.attempts))
            for cell, found in solved
        ],
        measured={"rows": [CellTimes(**cell, ms=spread_of(1e3 * found.seconds)) for cell, found in solved]},
        settings=describe_setup(setup),
    )


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
                label("target", lambda row: row[0].target),
                label("pairs", lambda row: row[0].pairs.replace("_", " ")),
                label("detector", lambda row: row[0].spheres),
                ours("reached", "", lambda row: f"{row[0].reached:,} of {row[0].solves:,}"),
                ours("attempts: median / p95 / max", "", lambda row: _format_attempts(row[0].attempts)),
                ours("time: median / p95 / max", "ms", lambda row: format_spread(row[1].ms)),
                caption="To the first collision-free solution",
                note="Wall time of a solve while all cores are busy with others.",
            ),
        ),
        anchor="waiting",
    )


def _format_attempts(attempts: Spread) -> str:
    return f"{attempts.median:g} / {attempts.p95:g} / {attempts.max:g}"

"""What the observations leave free: an interval for one number at a time, and scans of two at a time."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np

from calibration.layout import (
    MOVES,
    Move,
    look_at_link_2_and_motor_5,
    set_load,
    set_motor5,
    set_platform,
    set_platform_x,
    set_safe_distance,
    set_support,
    shift_links,
)
from calibration.observations import first_failure, load_sweeps, observe_collisions, observe_sweep
from ikde.model.robot import Robot
from ikde.paper.inputs import APPROXIMATIONS
from ikde.paper.sweeps import bisect, shows_sweep

SPAN_MM = 60.0


@dataclass(frozen=True, slots=True, kw_only=True)
class End:
    """One end of an interval in mm, and the observation that breaks beyond it, if any within the span."""

    value: float
    breaks: str | None


def find_end(robot: Robot, move: Move, value: float, sign: int) -> End:
    """Walk away from a value in growing steps until something breaks, then bisect."""
    inside, step = value, 0.02
    while step <= SPAN_MM:
        outside = value + sign * step
        if first_failure(move(robot, outside)) is not None:
            end = bisect(lambda v: first_failure(move(robot, v)) is None, inside, outside, steps=12)
            beyond = end + (outside - inside) * 2.0**-11 * 1.01
            return End(value=end, breaks=first_failure(move(robot, beyond)))
        inside, step = outside, 1.25 * step
    return End(value=inside, breaks=None)


def find_intervals(robot: Robot) -> dict[str, tuple[End, End]]:
    """The interval of every number, the others as shipped."""
    return {
        name: (find_end(robot, move, value, -1), find_end(robot, move, value, +1))
        for name, (_, value, move) in MOVES.items()
    }


@dataclass(frozen=True, slots=True, kw_only=True)
class Candidate:
    """A layout in mm, and the smaller slack of its situation's two onsets in fine steps."""

    values: tuple[float, float]
    slack: float


def scan(
    robot: Robot,
    place: Callable[[Robot, float, float], Robot],
    situation: str,
    grid: Iterable[tuple[float, float]],
) -> list[Candidate]:
    """Candidates for which everything holds, the roomiest first."""
    sweep = next(sweep for sweep in load_sweeps() if sweep.name == situation)
    found = []
    for values in grid:
        moved = place(robot, *values)
        if all(shows_sweep(moved, sweep, d) for d in APPROXIMATIONS) and first_failure(moved) is None:
            slack = min(observe_sweep(moved, sweep, d).slack for d in APPROXIMATIONS)
            found.append(Candidate(values=values, slack=slack))
    return sorted(found, key=lambda candidate: -candidate.slack)


def scan_load(robot: Robot) -> list[Candidate]:
    """The load's (x, z) in steps of 1 mm about the shipped place."""
    grid = [(float(x), float(z)) for x in range(262, 281) for z in range(422, 446)]
    return scan(robot, set_load, "2", grid)


def scan_load_at_printed_x(robot: Robot) -> list[Candidate]:
    """The load 140 mm behind the platform's centre, as printed: every height in steps of 0.5 mm."""
    return scan(robot, set_load, "2", [(200.0, float(z)) for z in np.arange(250.0, 600.5, 0.5)])


def scan_platform(robot: Robot, z: float) -> list[Candidate]:
    """Half extents in steps of 0.5 mm at one height of the platform's spheres."""
    grid = [(z, float(half)) for half in np.arange(220.0, 310.5, 0.5)]
    return scan(robot, set_platform, "3", grid)


def alternatives(robot: Robot) -> dict[str, Robot]:
    """Other layouts that we met: name -> robot."""
    loose = set_support(set_platform(set_load(robot, 270, 434), 219, 250.3), (440, 834), 177, 410.2)
    far = set_support(set_platform(set_load(robot, 270, 420), 206.4, 306.5), (396, 722), 238, 388)
    far = set_platform_x(far, 365.6)
    return {
        "as shipped": robot,
        "low platform: z 214, half extent 284": set_platform(robot, 214, 284),
        "flush platform: z 213.3, half extent 292": set_platform(robot, 213.3, 292),
        "free support: x 440..834, y 177, z 410.2": loose,
        "(L2, J5) looked at as well": look_at_link_2_and_motor_5(robot),
        "links to Formula 13's letter, outwards": shift_links(robot, +1),
        "links to Formula 13's letter, inwards": shift_links(robot, -1),
        "J5 at O4 and R_sf 6": set_safe_distance(set_motor5(far, -94.65), 6.0),
    }


def judge(robot: Robot) -> tuple[str, float, float]:
    """The first failure (or empty), the smallest slack of the onsets, and of home and labels in mm."""
    seen = observe_collisions(robot)
    failed = next((line.name for line in seen if not line.holds), "")
    slack = {unit: min(line.slack for line in seen if line.unit == unit) for unit in ("fine steps", "mm")}
    return failed, slack["fine steps"], slack["mm"]

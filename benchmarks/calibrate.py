"""Check the shipped qiao2021 against every published observation, and show what they leave free.

    python benchmarks/calibrate.py              # observations and intervals, about ten seconds
    python benchmarks/calibrate.py --search     # and the scans that led to the shipped layout, ten more

Exits 1 if an observation fails. docs/calibration.md explains the choice.
"""

import argparse
import sys

from calibration.layout import MOVES
from calibration.observations import Observation, observe_collisions, observe_volumes
from calibration.search import (
    Candidate,
    End,
    alternatives,
    find_intervals,
    judge,
    scan_load,
    scan_load_at_printed_x,
    scan_platform,
)
from rich.console import Console
from rich.table import Table

import ikde
from ikde.paper.inputs import APPROXIMATIONS

console = Console()
PLATFORM_Z = (213.0, 213.3, 214.0, 215.0, 216.0, 217.0, 218.0, 219.0, 220.0, 221.0, 222.0)


def table(title: str, *columns: str) -> Table:
    """An empty table."""
    made = Table(title=title, title_justify="left", min_width=40)
    for column in columns:
        made.add_column(column)
    return made


def show_observations(seen: list[Observation]) -> None:
    """Every published observation beside ours."""
    made = table("Published observations (angles in deg)", "observation", "published", "ours", "margin", "holds")
    for line in seen:
        margin = f"{line.slack:.3f} {line.unit}" if line.unit else "-"
        made.add_row(line.name, line.printed, line.ours, margin, "yes" if line.holds else "NO")
    console.print(made)


def check_moves(robot: ikde.Robot) -> None:
    """Stop unless every number of `MOVES` is the shipped one: setting it must change no clearance at home."""
    for name, (_, value, move) in MOVES.items():
        for detector in APPROXIMATIONS:
            before, after = (ikde.check(r, r.home, detector).pairs for r in (robot, move(robot, value)))
            change = max(abs(a.clearance_m - b.clearance_m) for a, b in zip(before, after, strict=True))
            if change > 1e-12:
                sys.exit(f"benchmarks/calibration/layout.py: {name} is no longer {value:g} mm in the robot's file")


def show_intervals(robot: ikde.Robot) -> None:
    """Where everything still holds, one number at a time."""
    made = table("What stays free, one number at a time (mm)", "number", "kind", "value", "holds from", "to", "breaks")
    for name, (low, high) in find_intervals(robot).items():
        kind, value, _ = MOVES[name]
        made.add_row(name, kind, f"{value:g}", text(low), text(high), f"{low.breaks} | {high.breaks}")
    console.print(made)


def text(end: End) -> str:
    """An end of an interval; `...` where nothing breaks within the span."""
    return f"{end.value:.3f}" if end.breaks else f"{end.value:.1f} ..."


def show_scan(title: str, names: tuple[str, str], found: list[Candidate], count: int = 6) -> None:
    """The roomiest candidates of a scan."""
    made = table(f"{title}: {len(found)} hold", *names, "margin (fine steps)")
    for candidate in found[:count]:
        made.add_row(*(f"{value:g}" for value in candidate.values), f"{candidate.slack:.3f}")
    console.print(made)


def show_search(robot: ikde.Robot) -> None:
    """The scans that led to the shipped layout, and other layouts that hold."""
    show_scan("Load, 1 mm grid", ("x", "z"), scan_load(robot))
    show_scan("Load at x = 200", ("x", "z"), scan_load_at_printed_x(robot))
    made = table("Platform, 0.5 mm grid, Situation 3", "z", "hold", "half extents", "roomiest", "margin (fine steps)")
    for z in PLATFORM_Z:
        found = scan_platform(robot, z)
        halves = sorted(candidate.values[1] for candidate in found)
        best = (f"{found[0].values[1]:g}", f"{found[0].slack:.3f}") if found else ("-", "-")
        made.add_row(f"{z:g}", str(len(found)), ", ".join(f"{half:g}" for half in halves) or "-", *best)
    console.print(made)
    made = table("Whole layouts", "layout", "holds", "least margin (fine steps)", "(mm)")
    for name, other in alternatives(robot).items():
        failed, steps, mm = judge(other)
        made.add_row(name, f"NO: {failed}" if failed else "yes", f"{steps:+.3f}", f"{mm:+.2f}")
    console.print(made)


def main() -> int:
    """Print the tables; 1 if an observation fails."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--search", action="store_true", help="also scan for layouts; about ten seconds more")
    arguments = parser.parse_args()
    robot = ikde.load_robot("qiao2021")
    seen = [*observe_volumes(robot), *observe_collisions(robot)]
    show_observations(seen)
    check_moves(robot)
    show_intervals(robot)
    if arguments.search:
        show_search(robot)
    failed = [line.name for line in seen if not line.holds]
    console.print(f"{len(seen) - len(failed)} of {len(seen)} observations hold")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())

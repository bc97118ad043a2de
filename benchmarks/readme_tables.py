"""Write the tables of README.md and of docs/ from what was recorded: no figure is typed.

python benchmarks/readme_tables.py
"""

import json
import re
from pathlib import Path
from typing import Any

from peer_tables import CASES, format_ahead, format_arm, format_peers
from scene_tables import format_scene_ahead, format_scene_checks, format_scene_peers
from speed_tables import (
    format_ablation,
    format_batch,
    format_calls,
    format_engines,
    format_first_hour,
    format_five,
    format_kernels,
    format_many,
    format_memetic,
    format_search,
    format_start,
)
from track_tables import (
    format_between,
    format_methods,
    format_peers_along,
    format_starts,
    format_stops,
    format_whole_paths,
)

ROOT = Path(__file__).parent.parent
RESULTS = ROOT / "benchmarks" / "results"
BLOCK = re.compile(r"(<!-- measured: [^>]*-->\n).*?(<!-- end measured -->)", re.DOTALL)
ADAPTERS = "../benchmarks/peers/README.md"


def load(name: str) -> dict[str, Any]:
    """One recorded result."""
    return json.loads((RESULTS / f"{name}.json").read_text())


def format_machine(machine: dict[str, Any]) -> str:
    """One line about what the figures were taken on."""
    clock = machine.get("empty_array_us")
    speed = f"; at that moment it took {clock:.2f} µs to make an empty array (0.1 where nothing slows it down)"
    return f"{machine['cpu']}, one core, Python {machine['python']}, numba {machine['numba']}{speed if clock else ''}."


def make_readme() -> str:
    """The README's numbers."""
    return join(format_five(load("call"), load("bulk"), load("track")))


def make_calls() -> str:
    """Calls from Python, one at a time and many; whole processes."""
    engines = load("engines")
    return join(
        format_calls(load("call")),
        "## Many targets",
        format_many(load("bulk")),
        format_machine(engines["machine"]),
        format_engines(engines),
        format_batch(load("batch_scale")),
        "## Whole processes",
        format_start(load("start_up")),
    )


def make_speed() -> str:
    """What each idea buys, and what other solvers take."""
    ablation = load("ablation")
    return join(
        format_machine(ablation["machine"]),
        "## What each idea buys",
        format_ablation(ablation),
        "## Other solvers",
        "![Share of targets solved over time, ikde beside other solvers](peers.png)",
        format_peers(load("peers"), CASES, ADAPTERS),
        format_ahead(load("peers")),
        "### RoboPlan, and an arm on a fixed base",
        format_arm(load("peers_arm"), ADAPTERS),
        "## Differential evolution",
        format_memetic(load("memetic")),
        format_search(load("paper_search")),
        "## Data-driven kernels",
        format_kernels(load("kernel_times")),
    )


def make_scenes() -> str:
    """Grasp poses among obstacles beside other solvers, and the check beside other checkers."""
    peers = load("scene_peers")
    return join(
        format_scene_peers(peers, ADAPTERS), format_scene_ahead(peers), format_scene_checks(load("scene_checks"))
    )


def make_following() -> str:
    """What was measured of our methods."""
    record = load("track")
    return join(
        format_machine(record["machine"]),
        format_methods(record, ("differential", "omnidirectional")),
        format_between(record),
        format_whole_paths(record),
        format_stops(record),
    )


def make_following_peers() -> str:
    """The same beside others."""
    record = load("peer_tracks")
    return join(format_machine(record["machine"]), format_peers_along(record), format_starts(record))


def join(*parts: str) -> str:
    """Paragraphs."""
    return "\n\n".join(parts) + "\n"


def insert(page: str, *blocks: str) -> str:
    """A page with its blocks, in their order, made anew."""
    made = iter(blocks)
    return BLOCK.sub(lambda match: f"{match[1]}{next(made)}{match[2]}", page)


if __name__ == "__main__":
    pages = {
        "README.md": (make_readme(),),
        "docs/speed.md": (make_calls(), make_speed(), make_scenes()),
        "docs/following.md": (make_following(), make_following_peers()),
        "docs/first_hour.md": (join(format_first_hour(load("first_hour"))),),
    }
    for name, made in pages.items():
        path = ROOT / name
        path.write_text(insert(path.read_text(), *made))

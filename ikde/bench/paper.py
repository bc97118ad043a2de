"""The paper's tables and figures, computed: everything that the report shows, as plain data.

Each section has three parts: `exact`, the same bits in every run; `measured`, times; `settings`, how it was made.
"""

import json
import math
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from typing import Any

from ikde.batch.machine import describe_machine, describe_versions
from ikde.bench.approximation import APPROXIMATIONS, compute_approximation
from ikde.bench.budget import FULL, Budget
from ikde.bench.detection import compute_detection
from ikde.bench.kinematics import compute_kinematics
from ikde.bench.misprints import Data, compute_misprints
from ikde.bench.progress import SILENCE, Progress
from ikde.bench.rejection import READINGS, compute_rejection, compute_waiting
from ikde.bench.sensitivity import compute_sensitivity, list_variations
from ikde.bench.situations import compute_situations
from ikde.bench.solutions import compute_solutions
from ikde.bench.timing import compute_timing
from ikde.kernels.jit import compile_clock
from ikde.model.robot import Robot

SECTIONS = (
    *("kinematics", "approximation", "timing", "rejection", "sensitivity", "waiting"),
    *("detection", "solutions", "situations", "misprints"),
)
SAME = 1e-9  # relative: numpy's last bits may differ between processors, ours do not


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Sources:
    """What the report is computed from."""

    key_point: Robot
    """qiao2021"""
    classical: Robot
    """qiao2021_dh"""
    published: Mapping[str, Any]
    misprints: Sequence[Mapping[str, str]]


def count_solves(sources: Sources, budget: Budget) -> int:
    """Solves that a report makes, which is what takes its time."""
    targets = len(sources.published["targets_mm"])
    cells = len(READINGS) * len(APPROXIMATIONS)
    return targets * (budget.solves + cells * budget.waits + len(list_variations()) * budget.variation_solves)


def list_sections(sources: Sources, budget: Budget, progress: Progress) -> dict[str, Callable[[], Data]]:
    """Every section by name, in the order of the report."""
    robot, published = sources.key_point, sources.published
    robots = {"key_point": robot, "classical": sources.classical}
    solves = {"budget": budget, "advance": progress.advance}
    return {
        "kinematics": lambda: compute_kinematics(robots, published),
        "approximation": lambda: compute_approximation(robot, published),
        "timing": lambda: compute_timing(robot, published, budget),
        "rejection": lambda: compute_rejection(robot, published, **solves),
        "sensitivity": lambda: compute_sensitivity(robot, published, **solves),
        "waiting": lambda: compute_waiting(robot, published, **solves),
        "detection": lambda: compute_detection(robot, budget),
        "solutions": lambda: compute_solutions(robot, published),
        "situations": lambda: compute_situations(robot, published, budget),
        "misprints": lambda: compute_misprints(robot, sources.misprints),
    }


def compute_paper(
    sources: Sources,
    budget: Budget = FULL,
    *,
    only: Sequence[str] = SECTIONS,
    progress: Progress = SILENCE,
) -> Data:
    """Compute the report's sections.

    Args:
        sources: robots and published figures.
        budget: sample sizes; `QUICK` takes seconds instead of minutes.
        only: names of the sections to compute.
        progress: told how far it is.

    Returns:
        Plain data that JSON holds: `made` (when, how, on what) and `sections`.
    """
    started, clock = datetime.now(UTC), time.perf_counter()
    sections, seconds = {}, {}
    with compile_clock() as compiling:
        computations = list_sections(sources, budget, progress)
        for name in filter(set(only).__contains__, computations):
            progress.begin(name)
            began = time.perf_counter()
            sections[name] = as_json(computations[name]())
            seconds[name] = time.perf_counter() - began
    return {
        "made": {
            "whole": budget == FULL,
            "only": [name for name in SECTIONS if name in only],
            "budget": asdict(budget),
            "started": started.isoformat(timespec="seconds"),
            "seconds": time.perf_counter() - clock,
            "compile_seconds": compiling.seconds,
            "section_seconds": seconds,
            "machine": describe_machine(),
            "versions": describe_versions(),
        },
        "sections": sections,
    }


def check_paper(
    results: Mapping[str, Any],
    sources: Sources,
    *,
    progress: Progress = SILENCE,
) -> list[str]:
    """Compute the exact parts of a report again; returns a line for each difference.

    Args:
        results: what `compute_paper` gave.
        sources: robots and published figures.
        progress: told how far it is.
    """
    budget = Budget(**results["made"]["budget"])
    again = compute_paper(sources, budget, only=results["made"]["only"], progress=progress)
    return list_differences(_drop_times(results["sections"]), _drop_times(again["sections"]))


def _drop_times(sections: Mapping[str, Data]) -> Data:
    return {name: {part: section[part] for part in section if part != "measured"} for name, section in sections.items()}


def list_differences(recorded: Any, again: Any, path: str = "") -> list[str]:
    """Where two pieces of plain data differ, a line each; numbers may differ by 1e-9 of their size."""
    if isinstance(recorded, Mapping) and isinstance(again, Mapping):
        paths = {key: f"{path}.{key}".removeprefix(".") for key in [*again, *recorded]}
        shared = [key for key in again if key in recorded]
        return [
            *(line for key in shared for line in list_differences(recorded[key], again[key], paths[key])),
            *(f"{paths[key]}: not on record" for key in again if key not in recorded),
            *(f"{paths[key]}: only on record" for key in recorded if key not in again),
        ]
    if isinstance(recorded, list) and isinstance(again, list) and len(recorded) == len(again):
        pairs = enumerate(zip(recorded, again, strict=True))
        return [line for k, (a, b) in pairs for line in list_differences(a, b, f"{path}[{k}]")]
    if _is_same(recorded, again):
        return []
    return [f"{path}: {_shorten(recorded)} on record, {_shorten(again)} now"]


def _is_same(recorded: Any, again: Any) -> bool:
    if isinstance(recorded, float) and isinstance(again, float):
        return math.isclose(recorded, again, rel_tol=SAME, abs_tol=SAME)
    return type(recorded) is type(again) and recorded == again


def _shorten(value: Any) -> str:
    text = json.dumps(value)
    return text if len(text) <= 60 else f"{text[:57]}..."


def as_json(data: Data) -> Data:
    """Plain data as it comes back from a JSON file: tuples as lists, numpy's numbers as Python's."""
    return json.loads(json.dumps(data, allow_nan=False))

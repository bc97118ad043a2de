"""The paper's tables and figures, computed, and `results.json`: written, read back, computed again and compared."""

import json
import math
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, NamedTuple

from ikde.batch.machine import describe_machine, describe_versions
from ikde.errors import FileError, quoted
from ikde.formats.reading import read_json
from ikde.io.report_folder import RESULTS
from ikde.kernels.jit import compile_clock
from ikde.paper.approximation import compute_approximation, show_approximation
from ikde.paper.detection import compute_detection
from ikde.paper.detection_page import show_detection
from ikde.paper.inputs import APPROXIMATIONS, FULL, Budget, Inputs
from ikde.paper.kinematics import compute_kinematics, show_kinematics
from ikde.paper.manipulability import compute_manipulability
from ikde.paper.manipulability_page import show_manipulability
from ikde.paper.misprints import compute_misprints, show_misprints
from ikde.paper.null_space import compute_null_space
from ikde.paper.null_space_page import show_null_space
from ikde.paper.rejection import READINGS, compute_rejection
from ikde.paper.rejection_page import show_rejection
from ikde.paper.section import Computed
from ikde.paper.sensitivity import compute_sensitivity, list_variations, show_sensitivity
from ikde.paper.situations import compute_situations, show_situations
from ikde.paper.solutions import compute_solutions, show_solutions
from ikde.paper.timing import compute_timing, show_timing
from ikde.paper.waiting import compute_waiting, show_waiting
from ikde.report.page import Section

SAME = 1e-9  # relative: numpy's last bits may differ between processors, ours do not


class Topic(NamedTuple):
    """A section of the report."""

    compute: Callable[[Inputs], Computed]
    show: Callable[[Any, Inputs], Section]
    paper: str = "Qiao et al. 2021"


TOPICS = {
    "kinematics": Topic(compute_kinematics, show_kinematics),
    "approximation": Topic(compute_approximation, show_approximation),
    "timing": Topic(compute_timing, show_timing),
    "rejection": Topic(compute_rejection, show_rejection),
    "sensitivity": Topic(compute_sensitivity, show_sensitivity),
    "waiting": Topic(compute_waiting, show_waiting),
    "detection": Topic(compute_detection, show_detection),
    "solutions": Topic(compute_solutions, show_solutions),
    "situations": Topic(compute_situations, show_situations),
    "manipulability": Topic(compute_manipulability, show_manipulability, "Dong and Zhao"),
    "null_space": Topic(compute_null_space, show_null_space, "Zhang et al. 2022"),
    "misprints": Topic(compute_misprints, show_misprints, ""),
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Made:
    """When, how and on what."""

    whole: bool
    only: list[str]
    budget: Budget
    started: str
    seconds: float
    compile_seconds: float
    section_seconds: dict[str, float]
    machine: dict[str, Any]
    versions: dict[str, str]


@dataclass(frozen=True, slots=True, kw_only=True)
class Results:
    """Everything that the report shows."""

    made: Made
    sections: dict[str, Any]  # `Computed` by topic, in the order of the report

    def as_json(self) -> dict[str, Any]:
        """Plain data as it comes back from a JSON file."""
        sections = {name: section.as_json() for name, section in self.sections.items()}
        return {"made": asdict(self.made), "sections": sections}


def count_solves(inputs: Inputs) -> int:
    """Solves that a report makes, which is what takes its time."""
    budget, cells = inputs.budget, len(READINGS) * len(APPROXIMATIONS)
    one = budget.solves + cells * budget.waits + len(list_variations()) * budget.variation_solves
    return len(inputs.targets) * one


def compute_paper(inputs: Inputs, only: Sequence[str] = tuple(TOPICS)) -> Results:
    """Compute the report's sections, or `only` some of them by name."""
    started, begin = datetime.now(UTC), time.perf_counter()
    sections, seconds = {}, {}
    with compile_clock() as compiling:
        for name in filter(set(only).__contains__, TOPICS):
            inputs.progress.begin(name)
            began = time.perf_counter()
            sections[name] = TOPICS[name].compute(inputs)
            seconds[name] = time.perf_counter() - began
    made = Made(
        whole=inputs.budget == FULL,
        only=list(sections),
        budget=inputs.budget,
        started=started.isoformat(timespec="seconds"),
        seconds=time.perf_counter() - begin,
        compile_seconds=compiling.seconds,
        section_seconds=seconds,
        machine=describe_machine(),
        versions=describe_versions(),
    )
    return Results(made=made, sections=sections)


def read_results(folder: Path) -> dict[str, Any]:
    """What an earlier `ikde bench paper` recorded; raises `FileError` if the folder holds no such record."""
    path = folder / RESULTS
    results = read_json(path)
    try:
        made, sections = results["made"], results["sections"]
        budget, _ = asdict(Budget(**made["budget"])), set(made["only"])
    except (KeyError, TypeError):
        raise FileError(path, "not a record of this version's `ikde bench paper`") from None
    for name, size in budget.items():
        if type(size) is not int or size < 1:
            wrong = f"expected a whole number of at least 1, got {quoted(size)}"
            raise FileError(path, wrong, ("made", "budget", name))
    parts = {("sections", name): section for name, section in sections.items()} if isinstance(sections, dict) else {}
    for where, value in {("sections",): sections, **parts}.items():
        if not isinstance(value, dict):
            raise FileError(path, f"expected a mapping, got {quoted(value)}", where)
    return results


def check_paper(recorded: Mapping[str, Any], inputs: Inputs) -> list[str]:
    """A line for each difference, with what is exact of a record computed again; `inputs` have the record's budget."""
    again = compute_paper(inputs, recorded["made"]["only"]).as_json()
    return list_differences(_drop_times(recorded["sections"]), _drop_times(again["sections"]))


def _drop_times(sections: Mapping[str, Any]) -> dict[str, Any]:
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

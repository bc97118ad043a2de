"""The whole page: what was found in a few figures, then a section for each table."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

from ikde.model.robot import Robot
from ikde.report.numbers import fixed
from ikde.report.page import Code, Facts, Number, Numbers, Page, Section, Text
from ikde.report.paper.approximation import make_approximation
from ikde.report.paper.detection import make_detection
from ikde.report.paper.kinematics import make_kinematics
from ikde.report.paper.misprints import make_misprints
from ikde.report.paper.rejection import make_rejection, make_waiting
from ikde.report.paper.sensitivity import make_sensitivity
from ikde.report.paper.situations import make_situations
from ikde.report.paper.solutions import make_solutions
from ikde.report.paper.timing import make_timing

Data = Mapping[str, Any]


def make_paper_page(results: Data, robots: Mapping[str, Robot]) -> Page:
    """The report's page.

    Args:
        results: what `bench.paper.compute_paper` gave, or read back from `results.json`.
        robots: `key_point` (qiao2021) and `classical` (qiao2021_dh), to draw them.
    """
    made, robot = results["sections"], robots["key_point"]
    makers: dict[str, Callable[[Data], Section]] = {
        "kinematics": lambda data: make_kinematics(data, robots),
        "approximation": lambda data: make_approximation(data, robot),
        "timing": make_timing,
        "rejection": make_rejection,
        "sensitivity": make_sensitivity,
        "waiting": make_waiting,
        "detection": make_detection,
        "solutions": lambda data: make_solutions(data, robot),
        "situations": lambda data: make_situations(data, robot),
        "misprints": make_misprints,
    }
    shown = [_with_command(name, make(made[name])) for name, make in makers.items() if name in made]
    whole = len(shown) == len(makers)
    return Page(
        title="Qiao et al. 2021, recomputed",
        subtitle="Kinematics and self-collision detection of a mobile manipulator: what the paper prints beside what "
        "ikde computes.",
        lead=(*((_headline(made),) if whole else ()), _explain_marks(results)),
        sections=(*shown, _make_recipe(results)),
        footer="[Qiao2021] Qiao, L.; Luo, X.; Luo, Q.; Li, M.; Jiang, J. Applied Sciences 2021, 11, 10591. [Qiao2022] "
        "Qiao, L.; Luo, X.; Luo, Q. Machines 2022, 10, 1232. Every number on this page is in `results.json`.",
    )


def _with_command(name: str, section: Section) -> Section:
    """A section with the command that makes it alone."""
    return replace(section, blocks=(*section.blocks, Code(f"ikde bench paper --only {name} --out report/")))


def _headline(sections: Mapping[str, Data]) -> Numbers:
    """How much of the print comes out."""
    points = sections["kinematics"]["exact"]["points"]
    parts = sections["approximation"]["exact"]["components"]
    volumes = [part[name] for part in parts for name in ("typical", "improved")]
    rows = sections["solutions"]["exact"]["published"]
    detections = [d for s in sections["situations"]["exact"]["situations"] for d in s["detectors"]]
    farthest = max(max(point["difference_to_meant_mm"].values()) for point in points)
    return Numbers(
        (
            Number(f"{fixed(farthest, 3)} mm", "largest error of Formula 23", "misprints put right"),
            Number(f"{sum(v['agrees'] for v in volumes)} of {len(volumes)}", "volumes of Table 2 to five digits"),
            Number(f"{sum(_meets(row) for row in rows)} of {len(rows)}", "errors of Table 5 to four digits"),
            Number(f"{sum(d['agrees'] for d in detections)} of {len(detections)}", "detection angles of section 5.4"),
        )
    )


def _meets(row: Data) -> bool:
    return abs(row["ME_mm"]["printed"] - row["ME_mm"]["ours"]) < 5.1e-5


def _explain_marks(results: Data) -> Text:
    quick = (
        "**A quick run**: samples are small, so rates and times are rough. `ikde bench paper` without `--quick` "
        "makes the "
        "whole.\n\n"
        if not results["made"]["whole"]
        else ""
    )
    return Text(
        f"{quick}Published figures and ours are marked by their columns; ≠ marks what does not agree: a misprint, or a "
        "finding. Numbers of the robot are published, derived from published ones, or calibrated, that is chosen "
        "inside "
        "what the print leaves free; the [last sections](#misprints) list both."
    )


def _make_recipe(results: Data) -> Section:
    """Machine, versions, seeds and the commands that make it all again."""
    made = results["made"]
    machine, versions = made["machine"], made["versions"]
    seeds = ", ".join(f"{n} {s['settings']['seed']}" for n, s in results["sections"].items() if "seed" in s["settings"])
    samples = ", ".join(f"{name.replace('_', ' ')} {value:,}" for name, value in made["budget"].items())
    return Section(
        "How this was made",
        (
            Facts(
                (
                    ("started", made["started"]),
                    ("took", f"{fixed(made['seconds'], 0)} s, compiling {fixed(made['compile_seconds'], 0)} s of it"),
                    ("processor", f"{machine['processor']}, {machine['cores']} cores"),
                    ("system", machine["system"]),
                    ("versions", ", ".join(f"{name} {version}" for name, version in versions.items())),
                    ("seeds", seeds),
                    ("samples", samples),
                )
            ),
            Code(
                "ikde bench paper --out report/            # this page, minutes\n"
                "ikde bench paper --out report/ --quick    # a taste of it, seconds\n"
                "ikde bench paper --out report/ --check    # compute what is exact again and compare\n"
                "ikde batch configs/runs/qiao2021_table4.yaml --out runs/t4   # Table 4's solutions, one by one\n"
                "ikde report runs/t4",
                caption="To make it again. The exact figures are the same bits on every run, the times are not.",
            ),
        ),
        anchor="recipe",
    )

"""The whole page: what was found in a few figures, then a section for each topic."""

from dataclasses import asdict, replace

from ikde.paper.approximation import Approximation
from ikde.paper.inputs import Inputs
from ikde.paper.kinematics import Kinematics, largest_error_mm
from ikde.paper.misprints import Misprints
from ikde.paper.results import TOPICS, Results
from ikde.paper.section import Computed
from ikde.paper.situations import Situations
from ikde.paper.solutions import Solutions
from ikde.report.numbers import fixed, length
from ikde.report.page import Code, Facts, Number, Numbers, Page, Section, Text

SUBJECTS = {
    "Qiao et al. 2021": "Kinematics and self-collision detection of a mobile manipulator",
    "Dong and Zhao": "Manipulability of a tracked manipulator",
    "Zhang et al. 2022": "Two tasks on a mecanum platform",
}


def make_paper_page(results: Results, inputs: Inputs) -> Page:
    """The report's page; `inputs` are those that `results` were computed from: the robots are drawn."""
    computed = results.sections
    shown = [_with_command(name, TOPICS[name].show(section, inputs)) for name, section in computed.items()]
    headline = (_introduce(**computed), _headline(**computed)) if computed.keys() == TOPICS.keys() else ()
    papers = [paper for paper in dict.fromkeys(TOPICS[name].paper for name in computed) if paper]
    return Page(
        title=f"{' and '.join(papers)}, recomputed" if papers else "Papers, recomputed",
        subtitle=f"{'; '.join(SUBJECTS[paper] for paper in papers)}{': what' if papers else 'What'} is printed beside "
        "what ikde computes.",
        lead=(*headline, _explain_marks(results)),
        sections=(*shown, _make_recipe(results)),
        footer="[Qiao2021] Qiao, L.; Luo, X.; Luo, Q.; Li, M.; Jiang, J. Applied Sciences 2021, 11, 10591. [Qiao2022] "
        "Qiao, L.; Luo, X.; Luo, Q. Machines 2022, 10, 1232. [DongZhao] Dong, P.; Zhao, X. The Manipulability and "
        "Optimized Configuration of Tracked Mobile Manipulator. [Zhang2022] Zhang, S.; Cheng, S.; Jin, Z. Machines "
        "2022, 10, 1222. Every number on this page is in `results.json`.",
    )


def _with_command(name: str, section: Section) -> Section:
    """A section with the command that makes it alone."""
    return replace(section, blocks=(*section.blocks, Code(f"ikde bench paper --only {name} --out report/")))


def _introduce(
    approximation: Approximation, solutions: Solutions, situations: Situations, misprints: Misprints, **_: Computed
) -> Text:
    """What the paper is about, and the verdict."""
    agree = [v.agrees for v in approximation.volumes]
    agree += [row.shows_printed_error for row in solutions.published]
    agree += [detection.agrees for detection in situations.detections]
    most = "all" if all(agree) else f"{sum(agree)}"
    return Text(
        "Qiao et al. cover a mobile manipulator of nine joints with spheres, in the usual and in an improved way, and "
        "search configurations free of self-collision by differential evolution. **Verdict**: with "
        f"{len(misprints.misprints)} [misprints](#misprints) put right, {most} of {len(agree)} printed volumes, errors "
        "and detection angles come out as printed; ≠ marks what does not."
    )


def _headline(
    kinematics: Kinematics, approximation: Approximation, solutions: Solutions, situations: Situations, **_: Computed
) -> Numbers:
    """How much of the print comes out."""
    volumes, rows = approximation.volumes, solutions.published
    detections, met = situations.detections, sum(row.shows_printed_error for row in rows)
    return Numbers(
        (
            Number(length(1e-3 * largest_error_mm(kinematics)), "largest error of Formula 23", "misprints put right"),
            Number(f"{sum(v.agrees for v in volumes)} of {len(volumes)}", "volumes of Table 2 to five digits"),
            Number(f"{met} of {len(rows)}", "errors of Table 5 to four digits"),
            Number(f"{sum(d.agrees for d in detections)} of {len(detections)}", "detection angles of section 5.4"),
        )
    )


def _explain_marks(results: Results) -> Text:
    quick = (
        "**A quick run**: samples are small, so rates and times are rough. `ikde bench paper` without `--quick` "
        "makes the whole.\n\n"
        if not results.made.whole
        else ""
    )
    return Text(
        f"{quick}Published figures and ours are marked by their columns; ≠ marks what does not agree: a misprint, or a "
        "finding. Numbers of the robot are published, derived from published ones, or calibrated, that is chosen "
        "inside what the print leaves free; the [last sections](#misprints) list both."
    )


def _make_recipe(results: Results) -> Section:
    """Machine, versions, seeds and the commands that make it all again."""
    made = results.made
    settings = {name: section.settings for name, section in results.sections.items()}
    seeds = ", ".join(f"{name} {own['seed']}" for name, own in settings.items() if "seed" in own)
    samples = ", ".join(f"{name.replace('_', ' ')} {value:,}" for name, value in asdict(made.budget).items())
    return Section(
        "How this was made",
        (
            Facts(
                (
                    ("started", made.started),
                    ("took", f"{fixed(made.seconds, 0)} s, compiling {fixed(made.compile_seconds, 0)} s of it"),
                    ("processor", f"{made.machine['processor']}, {made.machine['cores']} cores"),
                    ("system", made.machine["system"]),
                    ("versions", ", ".join(f"{name} {version}" for name, version in made.versions.items())),
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

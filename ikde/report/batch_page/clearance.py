"""How good the answers are: clearance, errors, and what comes closest to what."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from ikde.plot.charts import Sample, plot_histogram
from ikde.plot.images import to_svg
from ikde.plot.style import Axis
from ikde.report.batch_page.answers import ArmAnswers, RunAnswers
from ikde.report.batch_page.cost import choose_curves, is_wide, name_curve
from ikde.report.batch_page.success import CHECKED
from ikde.report.numbers import angle, fixed, length
from ikde.report.page import Column, Figure, Gallery, Section, Table

MAX_PAIRS = 12
MIN_BINS, MAX_BINS = 12, 60


@dataclass(frozen=True, slots=True)
class Measure:
    """A column and how it is shown."""

    column: str
    title: str
    unit: str
    factor: float
    write: Callable[[float], str]
    """A value, in m or rad, with its unit."""


CLEARANCE_NOTE = "Clearance: the smallest distance between two spheres that the arm's detector compares"
IN_A_WORLD = ", or of a sphere from an obstacle"
CLEARANCE = Measure("clearance_m", "clearance", "mm", 1e3, length)
ERRORS = (
    Measure("position_error_m", "position error", "mm", 1e3, length),
    Measure("orientation_error_rad", "orientation error", "deg", float(np.degrees(1.0)), angle),
)


def make_clearance(run: RunAnswers) -> Section | None:
    """Clearance and errors of the reached solutions; None if the run keeps neither."""
    measures = [measure for measure in (CLEARANCE, *ERRORS) if _is_there(run.arms, measure)]
    if not measures:
        return None
    pairs = [_make_pairs(run)] if any(arm.closest_pairs for arm in run.arms) else []
    figures = tuple(_draw(run, measure) for measure in measures)
    return Section("Clearance and errors", (_make_table(run, measures), Gallery(figures), *pairs), anchor="clearance")


def _is_there(arms: Sequence[ArmAnswers], measure: Measure) -> bool:
    """True if some solution has more than nothing of it: a free orientation has no error."""
    return any(arm.of_reached(measure.column).any() for arm in arms)


def _make_table(run: RunAnswers, measures: Sequence[Measure]) -> Table:
    heads = {measure: ("smallest", "median") if measure is CLEARANCE else ("median", "at most") for measure in measures}
    return Table(
        columns=(
            *Column.of("arm", "detector"),
            *(Column(head, group=measure.title) for measure in measures for head in heads[measure]),
        ),
        rows=tuple(
            (arm.name, arm.facts.detector, *(text for measure in measures for text in _format(arm, measure)))
            for arm in run.arms
        ),
        caption="The solutions that reached their target",
        note=f"{CLEARANCE_NOTE}{IN_A_WORLD if run.manifest.has_worlds else ''}." if CLEARANCE in measures else "",
    )


def _format(arm: ArmAnswers, measure: Measure) -> tuple[str, str]:
    values = arm.of_reached(measure.column)
    if not values.size:
        text = CHECKED[False] if measure is CLEARANCE and arm.collision_checked is False else "–"
        return text, text
    middle = measure.write(float(np.median(values)))
    if measure is CLEARANCE:
        return measure.write(float(values.min())), middle
    return middle, measure.write(float(values.max()))


def _draw(run: RunAnswers, measure: Measure) -> Figure:
    shown, few = choose_curves([arm for arm in run.arms if arm.of_reached(measure.column).size])
    samples = [
        Sample(label=name_curve(run, arm), values=measure.factor * arm.of_reached(measure.column)) for arm in shown
    ]
    most = max(np.size(sample.values) for sample in samples)
    log = measure is not CLEARANCE and is_wide(samples)
    axis = Axis(label=measure.title, unit=measure.unit, log=log)
    bins = int(np.clip(2.0 * most ** (1 / 3), MIN_BINS, MAX_BINS))
    return Figure(
        image=to_svg(plot_histogram(samples, x=axis, bins=bins)),
        alt=f"Histogram of the {measure.title} of the reached solutions, a line an arm",
        caption=f"{measure.title.capitalize()} of the reached solutions.{few}",
    )


def _make_pairs(run: RunAnswers) -> Table:
    """Which pairs are closest, how often."""
    arms = [_share_pairs(arm) for arm in run.arms]
    sums: dict[tuple[str, str], float] = {}
    for shares in arms:
        for pair, share in shares.items():
            sums[pair] = sums.get(pair, 0.0) + share
    shown = sorted(sums, key=lambda pair: (-sums[pair], pair))[:MAX_PAIRS]
    left = len(sums) - len(shown)
    return Table(
        columns=(Column("pair", align="left"), *(Column(arm.name, "%", group="closest in") for arm in run.arms)),
        rows=tuple(
            (" – ".join(pair), *(fixed(100 * shares.get(pair, 0.0), 1) if shares else "–" for shares in arms))
            for pair in shown
        ),
        caption="Which two come closest, in percent of the reached solutions",
        note=f"{left} more pairs are rarer." if left else "",
    )


def _share_pairs(arm: ArmAnswers) -> dict[tuple[str, str], float]:
    """How often each pair is the closest; empty without a detector."""
    total = sum(arm.closest_pairs.values())
    return {pair: count / total for pair, count in arm.closest_pairs.items()}

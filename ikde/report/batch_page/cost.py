"""What the solves cost: attempts and wall time."""

from collections.abc import Callable, Sequence

import numpy as np

from ikde.batch.statistics import compute_spread
from ikde.plot.charts import Sample, plot_cdf
from ikde.plot.images import to_svg
from ikde.plot.style import Axis
from ikde.report.batch_page.answers import ArmAnswers, RunAnswers
from ikde.report.numbers import fixed, seconds
from ikde.report.page import Column, Figure, Gallery, Section, Table

MAX_CURVES = 6  # in one chart: there are six looks
WIDE = 30  # from here on, maximum over minimum, an axis is logarithmic


def make_cost(run: RunAnswers) -> Section:
    """Median, 95th percentile and maximum over all solves, and the whole distribution."""
    figures = tuple(_draw(run))
    drawn = (Gallery(figures),) if figures else ()
    return Section("Attempts and time", (_make_table(run), *drawn), anchor="cost")


def name_curve(run: RunAnswers, arm: ArmAnswers) -> str:
    """What a legend calls an arm; nothing if there is no other."""
    return arm.name if len(run.arms) > 1 else ""


def choose_curves(arms: Sequence[ArmAnswers]) -> tuple[Sequence[ArmAnswers], str]:
    """The arms that fit into one chart, and a remark if these are not all."""
    few = f" The first {MAX_CURVES} of {len(arms)} arms." if len(arms) > MAX_CURVES else ""
    return arms[:MAX_CURVES], few


def is_wide(samples: Sequence[Sample]) -> bool:
    """True for samples that want a logarithmic axis."""
    joined = np.concatenate([np.asarray(sample.values) for sample in samples])
    positive = joined[joined > 0]
    return bool(positive.size) and float(positive.max()) > WIDE * float(positive.min())


def _make_table(run: RunAnswers) -> Table:
    kept = any("attempts" in arm.numbers for arm in run.arms)
    spreads = ("median", "95 % within", "at most")
    return Table(
        columns=(
            Column("arm", align="left"),
            *(Column(title, group="attempts") for title in spreads if kept),
            *(Column(title, group="time") for title in spreads),
        ),
        rows=tuple(
            (arm.name, *(_spread(arm, "attempts", _count) if kept else ()), *_spread_time(arm)) for arm in run.arms
        ),
        caption="What a solve costs",
        note="Over all solves, also those that did not reach their target. The time is a solve's wall time while all "
        "threads are busy. Short solves are timed in calls of several, so that only their median is known.",
    )


def _count(value: float) -> str:
    return fixed(value, 0)


def _spread_time(arm: ArmAnswers) -> tuple[str, ...]:
    median, *others = _spread(arm, "solve_seconds", seconds)
    return median, *(others if arm.timed_alone else ["–"] * len(others))


def _spread(arm: ArmAnswers, column: str, write: Callable[[float], str]) -> tuple[str, ...]:
    spread = compute_spread(arm.numbers.get(column, ()))
    return ("–",) * 3 if spread is None else tuple(map(write, (spread.median, spread.p95, spread.max)))


def _draw(run: RunAnswers) -> list[Figure]:
    figures = []
    arms, few = choose_curves(run.arms)
    for column, factor, label, unit in (("attempts", 1.0, "attempts", ""), ("solve_seconds", 1e3, "time", "ms")):
        samples = [
            Sample(label=name_curve(run, arm), values=factor * arm.of_reached(column), total=arm.solves)
            for arm in arms
            if column in arm.numbers and (not unit or arm.timed_alone)
        ]
        if len(np.unique(np.concatenate([np.empty(0), *(sample.values for sample in samples)]))) < 2:
            continue  # a curve of one value says nothing that the table does not
        figure = plot_cdf(samples, x=Axis(label=label, unit=unit, log=is_wide(samples), whole=not unit), y="solves")
        alt = f"Share of the solves that reached their target within so much: {label}, a curve an arm"
        caption = f"Solves that reached their target within so {'much time' if unit else 'many attempts'}.{few}"
        figures.append(Figure(image=to_svg(figure), alt=alt, caption=caption))
    return figures

"""How many solves reached their target, by arm and by target."""

import numpy as np

from ikde.batch.statistics import Rate
from ikde.plot.charts import Estimate, plot_forest
from ikde.plot.images import to_svg
from ikde.plot.style import Axis
from ikde.report.batch_page.answers import ArmAnswers, RunAnswers
from ikde.report.numbers import count_of, with_interval
from ikde.report.page import Block, Column, Figure, Section, Table

CHECKED = {True: "checked", False: "not checked", None: "–"}
MAX_TARGETS = 30  # rows of the table by target


def make_success(run: RunAnswers) -> Section:
    """Rates with their intervals, and why a search stopped."""
    blocks: list[Block] = [_make_table(run)]
    if len({arm.rate.share for arm in run.arms if arm.solves}) > 1:  # equal shares are no picture
        figure = draw_rates([(arm.name, arm.rate) for arm in run.arms], "reached")
        blocks.append(Figure(image=figure, alt="Rate and 95 % interval of every arm", caption="Reached, by arm."))
    if run.manifest.targets > 1 and run.manifest.repeats > 1:
        blocks.append(_make_targets(run))
    return Section("Reached", tuple(blocks), anchor="reached")


def format_rate(rate: Rate) -> str:
    """Percent with Wilson's interval, `73.0 (63.6–80.7)`; a dash of nothing."""
    low, high = rate.interval
    return with_interval(100 * rate.share, (100 * low, 100 * high)) if rate.total else "–"


def draw_rates(rates: list[tuple[str, Rate]], label: str) -> str:
    """Rates and their intervals below each other, as SVG."""
    estimates = []
    for name, rate in rates:
        if rate.total:
            low, high = rate.interval
            estimates.append(Estimate(label=name, value=100 * rate.share, lower=100 * low, upper=100 * high))
    return to_svg(plot_forest(estimates, x=Axis(label=label, unit="%")))


def _make_table(run: RunAnswers) -> Table:
    reasons = list(dict.fromkeys(reason for arm in run.arms for reason in arm.stop_reasons if reason != "reached"))
    return Table(
        columns=(
            *Column.of("arm", ">solves", ">reached", ">rate [%]"),
            *(Column(reason.replace("_", " "), group="not reached") for reason in reasons),
            *Column.of(">self-collision", ">plain numpy agrees"),
        ),
        rows=tuple(
            (
                arm.name,
                f"{arm.solves:,}",
                f"{arm.rate.count:,}",
                format_rate(arm.rate),
                *(f"{arm.stop_reasons.get(reason, 0):,}" for reason in reasons),
                CHECKED[arm.collision_checked],
                _format_verified(arm.verified),
            )
            for arm in run.arms
        ),
        caption="How many solves reached their target",
        note="Reached: within tolerance, inside the limits and, where that was checked, free of self-collision"
        f"{_of_world(run)} by the arm's detector. {say_who_graded(run)} Rates with Wilson's 95 % interval.",
    )


def _of_world(run: RunAnswers) -> str:
    return ", and of its world," if run.manifest.has_worlds else ""


def say_who_graded(run: RunAnswers) -> str:
    """In one sentence, which grader graded how many."""
    solves = sum(arm.solves for arm in run.arms)
    again = sum((arm.verified for arm in run.arms), Rate(0, 0))
    agrees = f", and agrees with {'all' if again.count == again.total else f'{again.count:,}'} of them"
    grades = "the last 64 of each 4,096, and unreached ones that are explained"
    numpy = f"plain numpy graded {again.total:,} of these again ({grades}){agrees}"
    if not again.total:
        numpy = f"plain numpy, which grades {grades}, graded none of them"
    return (
        f"The kernels' grader, code of its own on the tables of the search, graded {'all ' if solves > 1 else ''}"
        f"{count_of(solves, 'solve')}; {numpy}."
    )


def _format_verified(rate: Rate) -> str:
    """`16 of 16`: with so many of those that it graded plain numpy agrees."""
    return f"{rate.count:,} of {rate.total:,}" if rate.total else CHECKED[False]


def _make_targets(run: RunAnswers) -> Table:
    """The targets that were reached least often; all of them if they are few."""
    counts = [_count_by_target(arm, run.manifest.targets) for arm in run.arms]
    reached, solves = np.sum(counts, axis=0)
    shares = np.divide(reached, solves, out=np.full(run.manifest.targets, np.inf), where=solves > 0)
    few = run.manifest.targets <= MAX_TARGETS
    shown = np.arange(run.manifest.targets) if few else np.sort(np.argsort(shares, kind="stable")[:MAX_TARGETS])
    names = run.names
    return Table(
        columns=(
            *Column.of(">target", *(["name"] if names else [])),
            *(Column(arm.name, "%", group="reached by") for arm in run.arms),
        ),
        rows=tuple(
            (
                str(target),
                *([names.get(target, "")] if names else []),
                *(format_rate(Rate(int(hits[target]), int(total[target]))) for hits, total in counts),
            )
            for target in shown.tolist()
        ),
        caption="By target" if few else f"The {MAX_TARGETS} targets that were reached least often",
    )


def _count_by_target(arm: ArmAnswers, targets: int) -> tuple[np.ndarray, np.ndarray]:
    numbers = arm.numbers["target"]
    return np.bincount(numbers[arm.reached], minlength=targets), np.bincount(numbers, minlength=targets)

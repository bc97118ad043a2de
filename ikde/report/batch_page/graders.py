"""The same solutions seen by further detectors."""

from itertools import combinations

import numpy as np

from ikde.batch.statistics import Rate
from ikde.report.batch_page.answers import ArmAnswers, RunAnswers
from ikde.report.batch_page.success import MAX_TARGETS, draw_rates, format_rate
from ikde.report.page import Block, Column, Figure, Section, Table


def make_graders(run: RunAnswers) -> Section | None:
    """How often each grader sees a collision, and where two of them disagree; None without graders."""
    graders = run.manifest.graders
    if not graders:
        return None
    blocks: list[Block] = [_make_rates(run), *_draw(run)]
    if 1 < run.manifest.targets <= MAX_TARGETS:
        blocks.append(_make_targets(run))
    if len(graders) > 1:
        blocks.append(_make_paired(run))
    return Section("Graded again", tuple(blocks), anchor="graded")


def _make_rates(run: RunAnswers) -> Table:
    return Table(
        columns=Column.of("arm", ">checked", "graded by", ">in collision", ">rate [%]"),
        rows=tuple(
            (arm.name, f"{rate.total:,}", grader, f"{rate.count:,}", format_rate(rate))
            for arm, grader, rate in _list_rates(run)
        ),
        caption="Reached solutions that a detector sees in collision",
        note="Every solution is checked with every detector, whatever the search took into account: by the kernels' "
        "grader and by plain numpy, which must agree. Rates with Wilson's 95 % interval.",
    )


def _list_rates(run: RunAnswers) -> list[tuple[ArmAnswers, str, Rate]]:
    return [(arm, grader, Rate.of(arm.collides(grader))) for arm in run.arms for grader in run.manifest.graders]


def _draw(run: RunAnswers) -> list[Figure]:
    several = len(run.arms) > 1
    rates = [(f"{arm.name}: {grader}" if several else grader, rate) for arm, grader, rate in _list_rates(run)]
    if not any(rate.total for _, rate in rates):
        return []
    alt = "Rate of collision with its 95 % interval, by arm and detector"
    return [Figure(image=draw_rates(rates, "in collision"), alt=alt, caption="In collision, by detector.")]


def _make_targets(run: RunAnswers) -> Table:
    """Rates by target, a column a grader."""
    graders = run.manifest.graders
    rows = []
    for arm in run.arms:
        targets = arm.numbers["target"][arm.reached]
        for target in np.unique(targets).tolist():
            mine = targets == target
            rates = (Rate.of(arm.collides(grader)[mine]) for grader in graders)
            name = run.names.get(target, str(target))
            rows.append((arm.name, name, f"{int(mine.sum()):,}", *map(format_rate, rates)))
    return Table(
        columns=(
            *Column.of("arm", "target", ">reached"),
            *(Column(grader, "%", group="in collision by") for grader in graders),
        ),
        rows=tuple(rows),
        caption="In collision, by target",
    )


def _make_paired(run: RunAnswers) -> Table:
    """Both verdicts on the same solutions, for every two graders."""
    return Table(
        columns=Column.of("arm", "A", "B", ">both free", ">only A free", ">only B free", ">both in collision"),
        rows=tuple(
            (arm.name, a, b, *_pair(arm, a, b)) for arm in run.arms for a, b in combinations(run.manifest.graders, 2)
        ),
        caption="Two detectors on the same solutions",
    )


def _pair(arm: ArmAnswers, a: str, b: str) -> tuple[str, ...]:
    verdicts = arm.collides(a), arm.collides(b)
    checked = ~np.ma.getmaskarray(verdicts[0]) & ~np.ma.getmaskarray(verdicts[1])
    hit_a, hit_b = (verdict.data[checked] for verdict in verdicts)
    cases = (~hit_a & ~hit_b, ~hit_a & hit_b, hit_a & ~hit_b, hit_a & hit_b)
    return tuple(f"{int(case.sum()):,}" for case in cases)

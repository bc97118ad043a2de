"""How many solves reached their target in each world, and what stood in the way of the others."""

from collections import Counter

from ikde.batch.statistics import Rate
from ikde.report.batch_page.answers import ArmAnswers, RunAnswers
from ikde.report.batch_page.success import draw_rates, format_rate
from ikde.report.page import Block, Column, Figure, Section, Table

MAX_BLOCKERS = 20  # rows of the table by blocker
MAX_DRAWN = 40  # worlds in the picture


def make_worlds(run: RunAnswers) -> Section | None:
    """Solved by world and by blocker; None of a run that is in no world."""
    if not run.manifest.has_worlds:
        return None
    worlds = dict.fromkeys(arm.facts.world or "" for arm in run.arms)
    arms = {world: [arm for arm in run.arms if arm.facts.world == world] for world in worlds}
    rates = {world: sum((arm.rate for arm in some), Rate(0, 0)) for world, some in arms.items()}
    blocks: list[Block] = [_make_table(run, arms, rates)] if len(worlds) > 1 else []
    if 1 < len(worlds) <= MAX_DRAWN and len({rate.share for rate in rates.values()}) > 1:
        picture = draw_rates(list(rates.items()), "reached")
        blocks.append(Figure(image=picture, alt="Rate and 95 % interval in every world", caption="Reached, by world."))
    blockers = _make_blockers(arms)
    blocks += [blockers] if blockers else []
    return Section("By world", tuple(blocks), anchor="worlds") if blocks else None


def _make_table(run: RunAnswers, arms: dict[str, list[ArmAnswers]], rates: dict[str, Rate]) -> Table:
    several = len({id(arm) for some in arms.values() for arm in some}) > len(arms)
    note = "All arms together. " if several else ""
    note += "Margins from obstacles stand under [what ran](#recipe)."
    return Table(
        columns=Column.of("world", ">solves", ">reached", ">rate [%]", "blocked most often by"),
        rows=tuple(
            (
                world,
                f"{rates[world].total:,}",
                f"{rates[world].count:,}",
                format_rate(rates[world]),
                _name_first(_count(some)),
            )
            for world, some in arms.items()
        ),
        caption="How many solves reached their target, by world",
        note=note,
    )


def _make_blockers(arms: dict[str, list[ArmAnswers]]) -> Table | None:
    counts = {world: _count(some) for world, some in arms.items()}
    rows = [(count, world, name) for world, some in counts.items() for name, count in some.items()]
    if not rows:
        return None
    rows.sort(key=lambda row: -row[0])
    missed = {world: sum(int((~arm.reached).sum()) for arm in some) for world, some in arms.items()}
    shown = [
        (world, name, f"{count:,}", f"{100 * count / missed[world]:.0f}") for count, world, name in rows[:MAX_BLOCKERS]
    ]
    return Table(
        columns=Column.of("world", "blocked by", ">solves", ">of the unreached [%]"),
        rows=tuple(shown),
        caption="What stood in the way"
        if len(rows) <= MAX_BLOCKERS
        else f"What stood in the way of most: {MAX_BLOCKERS} of {len(rows)}",
        note="Each unreached solve counts once, for the obstacle, or for the two components, that was to blame in most "
        "of its attempts; solves in which nothing met the target count for none.",
    )


def _count(arms: list[ArmAnswers]) -> Counter[str]:
    return sum((Counter(arm.blockers) for arm in arms), Counter())


def _name_first(blockers: Counter[str]) -> str:
    return ", ".join(name for name, _ in blockers.most_common(2))

"""A batch for the terminal: what would run, and what came of it."""

from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import asdict, replace
from itertools import pairwise
from typing import Any

from ikde.batch.arm_summary import ArmSummary, TargetSummary, Unreached
from ikde.batch.preview import Preview
from ikde.batch.statistics import Rate, Spread
from ikde.batch.summary import RunSummary
from ikde.report.numbers import count_of, seconds, significant
from ikde.report.render import make_table, plain, render

WIDTH = 160
MAX_NAMED = 20  # unreached targets
MAX_BLOCKERS = 5  # of an arm that are named
MAX_TARGETS = 5  # that have rows of their own
MAX_ARMS = 10  # that are named in a line
TIMES = ((86400, "d"), (3600, "h"), (60, "min"), (1, "s"))


def preview_json(preview: Preview) -> dict[str, Any]:
    """What would run, as plain data."""
    sums = {"seconds": preview.seconds, "compile_seconds": preview.compile_seconds}
    return asdict(preview) | {"columns": list(preview.columns), **sums}


def format_preview(preview: Preview, *, color: bool = False, width: int = WIDTH) -> str:
    """What would run, for the terminal."""
    from rich.filesize import decimal

    head = (
        f"[bold]{plain(preview.name)}[/]: robot {plain(preview.robot)}, {count_of(preview.targets, 'target')}, "
        f"{count_of(preview.repeats, 'repeat')}, seed {preview.seed}"
    )
    table = make_table("arm", "method", "detector", ">solves", ">ms a solve", ">about", ">of the sample reached")
    for arm in preview.arms:
        solves = preview.solves // len(preview.arms)
        table.add_row(
            *map(plain, (arm.name, arm.method, arm.detector)),
            f"{solves:,}",
            significant(arm.seconds / solves * 1e3),
            format_seconds(arm.seconds),
            f"{arm.sample_reached} / {arm.sample}",
        )
    loading = sum(arm.load_seconds for arm in preview.arms)
    lines = [
        f"in all     {preview.solves:,} solves in {count_of(preview.parts, 'part')}, about "
        f"{format_seconds(preview.seconds)} on {count_of(preview.threads, 'thread')}, "
        f"{format_seconds(loading)} of it to load kernels and seeds",
        f"compiling  {_tell_compiling(preview)}",
        f"on disk    about {decimal(preview.bytes)}",
        f"columns    {', '.join(preview.columns)}",
        "nothing was written",
    ]
    return render(head, table, *map(plain, lines), color=color, width=width)


def _tell_compiling(preview: Preview) -> str:
    if not preview.compile_seconds:
        return "nothing: all that the sample needed was compiled already"
    again = "will be done once more" if preview.compiles_again else "is done: the run need not do it again"
    return f"took {format_seconds(preview.compile_seconds)}, is not counted above, and {again}"


def run_json(summary: RunSummary) -> dict[str, Any]:
    """What came of a run, as plain data."""
    return {
        "name": summary.name,
        "folder": str(summary.folder),
        "robot": summary.robot,
        "seed": summary.seed,
        "hash": summary.hash,
        "parts": summary.parts,
        "parts_done": summary.parts_done,
        "solves": sum(arm.reached.total for arm in summary.arms),
        "unreached": summary.unreached,
        "unreached_targets": sum(arm.unreached_targets for arm in summary.arms),
        "arms": [_arm_json(arm) for arm in summary.arms],
        "listed": [asdict(row) for arm in summary.arms for row in arm.listed],
    }


def _arm_json(arm: ArmSummary) -> dict[str, Any]:
    """Its fields in their order, but for the targets that are listed for all arms together."""
    rows = [asdict(row) | _rates_json(row) for row in arm.by_target]
    verified = asdict(arm.verified) if arm.verified.total else None
    data = asdict(arm) | _rates_json(arm) | {"verified": verified, "by_target": rows}
    return {key: value for key, value in data.items() if key not in ("unreached_targets", "listed")}


def _rates_json(counted: ArmSummary | TargetSummary) -> dict[str, Any]:
    collisions = {grader: _rate_json(rate) for grader, rate in counted.collisions.items()}
    return {"reached": _rate_json(counted.reached), "collisions": collisions}


def _rate_json(rate: Rate) -> dict[str, Any]:
    share = rate.share if rate.total else None
    return {"count": rate.count, "total": rate.total, "share": share, "interval_95": list(rate.interval)}


def format_run(summary: RunSummary, *, color: bool = False, width: int = WIDTH) -> str:
    """What came of a run, for the terminal: the verdict, a line an arm, unreached targets and reasons, what is next."""
    solves = sum(arm.reached.total for arm in summary.arms)
    if summary.unreached:
        verdict = f"[bold red]{summary.unreached:,} of {solves:,} solves not reached[/] by {plain(summary.robot)}"
    else:
        verdict = f"[bold green]all reached[/] by {plain(summary.robot)}: {count_of(solves, 'solve')}"
    unchecked = [plain(arm.name) for arm in summary.arms if arm.collision_checked < arm.reached.total]
    if unchecked:
        verdict += f"\n[yellow]self-collision not checked[/]: {_name_arms(unchecked)}"
    tables: list[Any] = [_arm_table(summary.arms)]
    if any(arm.collisions for arm in summary.arms):
        tables.append(_collision_table(summary.arms))
    few = max(len(arm.by_target) for arm in summary.arms)
    if few:
        tables.append(f"these are the rates and intervals of just these {few} targets, not of targets in general\n")
    if 0 < few <= MAX_TARGETS:
        tables.append(_target_table(summary.arms))
    path = plain(str(summary.folder))
    tail = [f"wrote {path} ({count_of(summary.parts, 'part')})", f"next: ikde report {path}"]
    return render(verdict, *tables, *_list_unreached(summary), *tail, color=color, width=width)


def _name_arms(names: Sequence[str]) -> str:
    more = f" and {len(names) - MAX_ARMS} more" if len(names) > MAX_ARMS else ""
    return f"arm{'s' if len(names) > 1 else ''} {', '.join(names[:MAX_ARMS])}{more}"


def _arm_table(arms: Sequence[ArmSummary]) -> Any:
    spreads = (">attempts median / p95 / max", ">time median / p95 / max")
    placed = any(arm.world is not None for arm in arms)
    heads = ("arm", "?method", "?detector", *(("?world",) if placed else ()))
    table = make_table(*heads, ">reached", ">rate (95 %)", ">plain numpy agrees", *spreads)
    for arm in arms:
        table.add_row(
            *map(plain, (arm.name, arm.method, arm.detector, *((arm.world or "",) if placed else ()))),
            _format_count(arm.reached),
            format_rate(arm.reached),
            _format_count(arm.verified) if arm.verified.total else "not checked",
            _format_spread(arm.attempts, "{:,.0f}".format),
            _format_spread(arm.milliseconds, lambda value_ms: seconds(1e-3 * value_ms)),
        )
    return table


def _collision_table(arms: Iterable[ArmSummary]) -> Any:
    columns = ("arm", "detector", ">in collision", ">rate (95 %)")
    table = make_table(*columns, title="reached solutions, checked by other detectors")
    for arm in arms:
        for grader, rate in arm.collisions.items():
            table.add_row(plain(arm.name), plain(grader), _format_count(rate), format_rate(rate))
    return table


def _target_table(arms: Sequence[ArmSummary]) -> Any:
    """Rates by target, a column a grader."""
    graders = tuple(arms[0].collisions)
    columns = (">reached", ">rate (95 %)", *(f">in collision by {grader}" for grader in graders))
    table = make_table("arm", "target", *columns, title="by target")
    for arm in arms:
        for row in arm.by_target:
            rates = (format_rate(rate) for rate in (row.reached, *(row.collisions[name] for name in graders)))
            table.add_row(plain(arm.name), plain(row.name or str(row.target)), _format_count(row.reached), *rates)
    return table


def _list_unreached(summary: RunSummary) -> list[Any]:
    """Why, how often; and the first targets, each once for all arms that missed it for one reason."""
    if not summary.unreached:
        return []
    first, *others = summary.arms
    lines = [_reason_table(summary.arms)] if others else _tell_reasons(first)
    alike: dict[Unreached, list[str]] = {}
    for row in sorted((row for arm in summary.arms for row in arm.listed), key=lambda row: row.target):
        alike.setdefault(replace(row, arm=""), []).append(row.arm)
    named = list(alike.items())[:MAX_NAMED]
    lines += [f"  {plain(_format_unreached(row, arms, summary))}" for row, arms in named]
    named_of = Counter(name for _, arms in named for name in arms)
    left = [arm.unreached_targets - named_of[arm.name] for arm in summary.arms]
    lines += [f"  and {_count_more(left)}"] if any(left) else []
    return [*lines, ""]


def _count_more(left: Sequence[int]) -> str:
    """How many more targets were not reached, by each arm."""
    low, high = min(left), max(left)
    if len(left) == 1:
        return count_of(high, "more target")
    return f"{low:,} to {high:,} more an arm" if low < high else f"{high:,} more an arm"


def _tell_reasons(arm: ArmSummary) -> list[str]:
    counts = [f"{count:,} {reason.replace('_', ' ')}" for reason, count in _reasons(arm).items()]
    lines = [f"[bold]not reached[/]: {', '.join(counts)}"]
    return [*lines, f"blocked most often by: {plain(_tell_blockers(arm))}"] if arm.blockers else lines


def _reason_table(arms: Sequence[ArmSummary]) -> Any:
    """How many solves of each arm were not reached for which reason, a column a reason."""
    reasons = list(dict.fromkeys(reason for arm in arms for reason in _reasons(arm)))
    blocked = ("blocked most often by",) if any(arm.blockers for arm in arms) else ()
    table = make_table("arm", *(f">{reason.replace('_', ' ')}" for reason in reasons), *blocked, title="not reached")
    for arm in arms:
        counts = (f"{_reasons(arm).get(reason, 0):,}" for reason in reasons)
        table.add_row(plain(arm.name), *counts, *(plain(_tell_blockers(arm)) for _ in blocked))
    return table


def _reasons(arm: ArmSummary) -> dict[str, int]:
    return {reason: count for reason, count in arm.stop_reasons.items() if reason != "reached"}


def _tell_blockers(arm: ArmSummary) -> str:
    named = list(arm.blockers.items())[:MAX_BLOCKERS]
    more = len(arm.blockers) - len(named)
    return ", ".join(f"{name} {count:,}" for name, count in named) + (f" and {more} more" if more else "")


def _format_unreached(row: Unreached, arms: Sequence[str], summary: RunSummary) -> str:
    number, repeats = f"target {row.target}", summary.repeats
    name = f" {row.name}" if row.name not in (None, number) else ""
    often = f", {row.missed:,} of {repeats:,} repeats, first repeat {row.repeat}" if repeats > 1 else ""
    whose = f", {_name_arms(arms)}" if len(summary.arms) > len(arms) else ""
    return f"{number}{name}{whose}{often}: {row.reason or row.stop_reason}"


def _format_count(rate: Rate) -> str:
    return f"{rate.count:,} / {rate.total:,}"


def format_rate(rate: Rate) -> str:
    """`99.0 % (98.2 to 99.5)`, or nothing of nothing."""
    if not rate.total:
        return ""
    low, high = rate.interval
    return f"{100 * rate.share:.1f} % ({100 * low:.1f} to {100 * high:.1f})"


def _format_spread(spread: Spread | None, write: Callable[[float], str]) -> str:
    return " / ".join(map(write, (spread.median, spread.p95, spread.max))) if spread else ""


def format_seconds(seconds: float) -> str:
    """`2.5 s`, `3 min 20 s`, `5 h 12 min`, `4 d 7 h`."""
    for (large, unit), (small, rest) in pairwise(TIMES):
        if seconds >= large:
            whole, left = divmod(round(seconds / small), large // small)
            return f"{whole} {unit} {left} {rest}"
    return f"{seconds:.2g} s" if seconds < 10 else f"{seconds:.0f} s"

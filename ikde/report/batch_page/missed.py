"""Unreached targets and reasons."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from ikde.report.batch_page.answers import MAX_MISSED, PLACE, ArmAnswers, RunAnswers
from ikde.report.numbers import vector
from ikde.report.page import Column, Section, Table


def make_missed(run: RunAnswers) -> Section | None:
    """The first targets that were not reached, each once for all arms that missed it alike; None if all were."""
    misses = [(target, arm) for arm in run.arms for target in arm.missed]
    if not misses:
        return None
    alike: dict[tuple[str, ...], list[str]] = {}
    for target, arm in sorted(misses, key=lambda miss: miss[0]):
        alike.setdefault(_make_row(run, arm, target), []).append(arm.name)
    named = [(row, "all" if len(names) == len(run.arms) else ", ".join(names)) for row, names in alike.items()]
    rows = [(*row[:3], names if len(run.arms) > 1 else "", *row[3:]) for row, names in named[:MAX_MISSED]]
    total = np.unique(np.concatenate([arm.numbers["target"][~arm.reached] for arm in run.arms])).size
    columns = Column.of(">target", "name", ">x, y, z [m]", "arm", ">missed", "why", "what would help")
    kept = [k for k in range(len(columns)) if any(row[k] for row in rows)]
    shown = len({row[0] for row in rows})
    which = "Targets" if total <= shown else f"The first {shown} of {total:,} targets"
    table = Table(
        columns=tuple(columns[k] for k in kept),
        rows=tuple(tuple(row[k] for k in kept) for row in rows),
        caption=f"{which} that were not reached",
        note=_explain(run, rows),
    )
    return Section("Not reached", (table,), anchor="not-reached")


def _make_row(run: RunAnswers, arm: ArmAnswers, target: int) -> tuple[str, ...]:
    row = arm.missed[target]
    mine = arm.numbers["target"] == target
    missed, solves = int((mine & ~arm.reached).sum()), int(mine.sum())
    return (
        str(target),
        run.names.get(target, ""),
        _place(row),
        f"{missed:,} of {solves:,}" if run.manifest.repeats > 1 else "",
        row.get("reason") or row["stop_reason"].replace("_", " "),
        row.get("hint") or "",
    )


def _place(row: Mapping[str, Any]) -> str:
    return vector([row[name] for name in PLACE], 3) if all(name in row for name in PLACE) else ""


def _explain(run: RunAnswers, rows: list[tuple[str, ...]]) -> str:
    """What the table cannot say for itself."""
    notes = ["Reasons are those of the first repeat that missed."] if run.manifest.repeats > 1 else []
    if not run.manifest.recipe.get("explain", True):
        notes.append("The run does not explain what was missed (`explain: false`).")
    elif not any("reason" in row for arm in run.arms for row in arm.missed.values()):
        notes.append("The run keeps no reasons (`output: {columns}`).")
    elif not any(row[-1] for row in rows):
        notes.append("Nothing was found that would help.")
    return " ".join(notes)

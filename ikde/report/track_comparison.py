"""Ways to follow the same paths, side by side, as a page: one table, and the figures of each task."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, replace
from functools import partial
from typing import Any

import numpy as np

from ikde import __version__
from ikde.report.numbers import count_of, significant
from ikde.report.page import Animation, Block, Cell, Code, Column, Figure, Gallery, Page, Section, Table, Text
from ikde.report.track import MM, gap_mm, singular
from ikde.report.track_page import BASE, ERRORS, JOINTS, MARGINS, PATH, SPEEDS, animate, draw, draw_moments, tell_world
from ikde.track.comparison import Compared, TrackBudget
from ikde.track.summary import TrackSummary

FRAMES, DPI = 101, 70  # of an animation and of a picture: there are many on this page
DRAWINGS = (
    ("Clearance and limits", (MARGINS,)),
    ("Path and error", (PATH, ERRORS)),
    ("Joint angles and speeds", (JOINTS, SPEEDS)),
    ("Base", (BASE,)),
)
OURS = "continuation"
FIGURES = (
    Column("points reached"),
    *(Column("mm", group="largest error"), Column("rad", group="largest error")),
    *(Column("limits", group="broken"), Column("collisions", group="broken")),
    *(Column("mm", group="largest step"), Column("deg", group="largest step")),
    Column("smallest σ"),
    Column("clearance", "mm"),
    *(Column("median", "µs", group="a sample"), Column("p99", "µs", group="a sample")),
    Column("whole path", "s"),
)
NAMES = {"typical": "typical DE", "optimized": "optimized DE", "continuation": "ours, continuation"}

Row = Mapping[str, Any]


def compare_json(compared: Sequence[Compared], budget: TrackBudget) -> dict[str, Any]:
    """The whole comparison as plain data."""
    return {"made": {"ikde": __version__, "budget": asdict(budget)}, "tracks": [one.data for one in compared]}


def make_comparison_page(compared: Sequence[Compared], budget: TrackBudget, command: str) -> Page:
    """One table over all tracks, then each track with its figures."""
    methods = list(dict.fromkeys(method for one in compared for method in one.motions))
    paths, seeds = count_of(len(compared), "path"), count_of(budget.seeds, "seed")
    return Page(
        title="Following tool paths: the paper's methods beside ours",
        subtitle=f"{paths}: {', '.join(NAMES[method] for method in methods)}; {seeds} each.",
        lead=(_make_legend(),),
        sections=(
            Section("All in one table", (make_runs_table(compared), make_ends_table(compared))),
            *(_make_task(one) for one in compared),
            Section("How it was made", (Code(command, "The same again"),)),
        ),
        footer=f"Made by ikde {__version__}.",
    )


def _make_legend() -> Block:
    return Text(
        "- `typical` is the differential evolution that Qiao et al. 2022 compare theirs with: every sample by itself, "
        "nine free variables, no limit on speed, no collision.\n"
        "- `optimized` is their own: steps within the speed limits, collisions refused at the samples.\n"
        "- `continuation` is ikde's: limits and clearance as constraints of one step, a start chosen along the whole "
        "path, and certainty between the samples as well."
    )


def make_runs_table(compared: Sequence[Compared]) -> Table:
    """A row a track and method: the worst of all seeds, times of the first."""
    rows = []
    for one, path in zip(compared, shorten_names([one.data["name"] for one in compared]), strict=True):
        for method in one.motions:
            runs = [run for run in one.data["runs"] if run["method"] == method]
            rows.append(_mark_ours(path, method, *list_cells(runs)))
    return Table(
        columns=(*Column.of("path", "method"), *FIGURES),
        rows=tuple(rows),
        caption="What each method reaches, breaks and costs",
        note="Counts are ranges over the seeds; errors, steps and clearances the worst. A step is what the base or a "
        "joint does in one sample. Clearance is the certified one, between the samples, too. σ: the smallest singular "
        "value of the arm's Jacobian, in m and rad, in what the path asks for. Limits counts every joint, wheel and "
        "sample by itself. Times are those of the first seed, which ran alone: a sample of continuation is a step of "
        "the motion that was found, the whole path all the search for it, starts and backtracking; the other two were "
        "given their start. The typical DE moves the base freely in the plane.",
    )


def _mark_ours(path: str, method: str, *cells: str) -> tuple[str | Cell, ...]:
    return tuple(Cell(cell, "ours") if method == OURS else cell for cell in (path, method, *cells))


def shorten_names(names: Sequence[str]) -> list[str]:
    """Names without what stands before the comma, where that is the same in all of them."""
    parts = [name.partition(", ") for name in names]
    alike = len({head for head, _, _ in parts}) == 1 and all(tail for _, _, tail in parts)
    return [tail for _, _, tail in parts] if alike else list(names)


def list_cells(runs: Sequence[Row]) -> list[str]:
    """A method over its seeds, column by column of `FIGURES`."""
    alone = runs[:1]
    return [
        f"{_span(runs, 'reached_points')} of {runs[0]['points']}",
        _worst(runs, "largest_axis_error_mm", max, "{:.0e}".format),
        _worst(runs, "largest_rotation_error_rad", max, lambda value: f"{value:.0e}" if value else "–"),
        _span(runs, "limit_violations"),
        _span(runs, "colliding_samples"),
        _worst(runs, "largest_jump_m", max, lambda value: f"{1e3 * value:.1f}"),
        _worst(runs, "largest_jump_rad", max, lambda value: f"{float(np.degrees(value)):.1f}"),
        _worst(runs, "smallest_singular_value", min, lambda value: singular(value, 2)),
        _worst(runs, "certified_clearance_mm", min, lambda value: gap_mm(value / MM, 1)),
        *(_worst(alone, key, max, lambda value: significant(1e6 * value)) for key in ("median_s", "p99_s")),
        _worst(alone, "search_s", max, "{:.2g}".format),
    ]


def _worst(runs: Sequence[Row], key: str, pick: Callable[..., float], write: Callable[[float], str]) -> str:
    values = [run[key] for run in runs if run[key] is not None]
    return write(pick(values)) if values else "–"


def _span(runs: Sequence[Row], key: str) -> str:
    values = [run[key] for run in runs if run[key] is not None]
    if not values:
        return "not checked"
    low, high = min(values), max(values)
    return f"{low:,}" if low == high else f"{low:,}–{high:,}"


def make_ends_table(compared: Sequence[Compared]) -> Table:
    """From how many random starts each method ends before its path does, and what is then in the way."""
    rows = []
    for one, path in zip(compared, shorten_names([one.data["name"] for one in compared]), strict=True):
        ends = one.data["dead_ends"]
        for name in ends["reached_points"]:
            stops = ends["stops"].get(name, {})
            why = ", ".join(f"{count} {reason.replace('_', ' ')}" for reason, count in stops.items())
            rows.append(_mark_ours(path, name, f"{ends[name]} of {ends['starts']}", why))
    return Table(
        columns=Column.of("path", "method", ">dead ends", "what is in the way"),
        rows=tuple(rows),
        caption="Dead ends: random starts from which a path is not followed to its end",
        note="Starts are free configurations at the first pose, near which random ones came to rest. Greedy is "
        "`continuation` with least motion alone and no backtracking. Left to itself, `continuation` chooses its start "
        "along the whole path; here it must take the one it is given.",
    )


def _make_task(one: Compared) -> Section:
    blocks: list[Block] = [_make_stops(one)] if any(m.trajectory.stop for m in one.motions.values()) else []
    shown = {method: motion for method, motion in one.motions.items() if motion.started}
    if shown and (words := tell_world(next(iter(shown.values())))):
        blocks.append(Text(words))
    blocks.append(_beside(shown, lambda motion, prefix: animate(motion, FRAMES, prefix)))
    blocks.append(_beside(shown, lambda motion, prefix: draw_moments(motion, prefix, DPI)))
    for title, drawings in DRAWINGS:
        galleries = [_beside(shown, partial(draw, drawing)) for drawing in drawings]
        if drawn := [gallery for gallery in galleries if gallery.figures]:
            blocks += [Text(f"**{title}**"), *drawn]
    return Section(one.data["name"], tuple(blocks))


def _beside(
    motions: Mapping[str, TrackSummary], make: Callable[[TrackSummary, str], Figure | Animation | None]
) -> Gallery:
    """The same figure of every method."""
    made = [(method, make(motion, f"{NAMES[method]}: ")) for method, motion in motions.items()]
    titled = [replace(figure, caption=f"**{NAMES[method]}**") for method, figure in made if figure is not None]
    return Gallery(tuple(titled), narrow=True)


def _make_stops(one: Compared) -> Block:
    stops = [(name, motion.trajectory.stop) for name, motion in one.motions.items()]
    lines = [f"- **{NAMES[name]}** stops: {stop.line}" for name, stop in stops if stop is not None]
    return Text("\n".join(lines))

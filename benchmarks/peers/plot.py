"""Draw docs/peers.png: the share of targets solved over the time that each may take.

python benchmarks/peers/plot.py                       # from benchmarks/results/peers.json
python benchmarks/peers/plot.py RECORD PICTURE
"""

import json
import sys
from pathlib import Path
from typing import Any

import matplotlib
from matplotlib.figure import Figure

from ikde.plot.images import INK, to_png
from ikde.plot.style import _STYLE, COLORS, DASHES, format_tick, pick

ROOT = Path(__file__).parents[2]
CASES = ("pose", "hard pose")
WIDTH_IN, HEIGHT_IN, LEGEND_LINE_IN = 9.0, 3.4, 0.2
COLUMNS = 3


def draw(record: dict[str, Any]) -> Figure:
    """A panel a case, a curve a solver; ikde in ink."""
    cases = [name for name in CASES if name in record["cases"]] or list(record["cases"])[:2]
    names = sorted({name for case in cases for name, row in record["cases"][case].items() if "curve" in row}, key=rank)
    lines = -(-len(names) // COLUMNS)
    with matplotlib.rc_context(_STYLE):
        figure = Figure(figsize=(WIDTH_IN, HEIGHT_IN + LEGEND_LINE_IN * lines), layout="constrained")
        panels = figure.subplots(1, len(cases), sharex=True, sharey=True, squeeze=False)[0]
        for axes, case in zip(panels, cases, strict=True):
            draw_case(axes, case, names, record)
        panels[0].set_ylabel("share solved [%]")
        handles, labels = panels[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=COLUMNS, handlelength=2.6)
    return figure


def draw_case(axes: Any, case: str, names: list[str], record: dict[str, Any]) -> None:
    """One panel: each curve climbs at the times of its solved targets and runs on to the time limit."""
    limit_ms = record["options"]["limit"] * 1e3
    for k, name in enumerate(names):
        curve = record["cases"][case].get(name, {}).get("curve") or [[limit_ms, 0.0]]
        x = [curve[0][0], *(point[0] for point in curve), max(limit_ms, curve[-1][0])]
        y = [0.0, *(100.0 * point[1] for point in curve), 100.0 * curve[-1][1]]
        ours = name.startswith("ikde")
        color = INK if name == "ikde" else pick(COLORS, k)
        width = 2.6 if ours else 1.4
        axes.plot(x, y, label=name, color=color, linestyle=DASHES[(k // len(COLORS)) % len(DASHES)], linewidth=width)
    axes.set(xscale="log", xlabel="time for a target [ms]", title=case, ylim=(-2, 102))
    axes.xaxis.set_major_formatter(lambda value, _: format_tick(value))
    axes.grid(axis="both")


def rank(name: str) -> tuple[bool, str]:
    """Our own first."""
    return not name.startswith("ikde"), name.lower()


def main() -> None:
    """Read the record, write the picture."""
    record, picture = [*sys.argv[1:], None, None][:2]
    source = Path(record) if record else ROOT / "benchmarks" / "results" / "peers.json"
    place = Path(picture) if picture else ROOT / "docs" / "peers.png"
    place.write_bytes(to_png(draw(json.loads(source.read_text()))))


if __name__ == "__main__":
    main()

"""Where the print is wrong or puzzling, and what was chosen inside what it leaves free."""

from collections.abc import Mapping
from typing import Any

from ikde.report.page import Column, Section, Table, Text

Data = Mapping[str, Any]


def make_misprints(data: Data) -> Section:
    """Misprints, puzzles and calibrated numbers, each with its evidence."""
    exact = data["exact"]
    return Section(
        "Misprints, puzzles and what was calibrated",
        (
            _introduce(exact),
            _make_entries(exact["misprints"], "Misprints", "meant"),
            _make_entries(exact["puzzles"], "Puzzles", "what ikde does"),
            _make_calibrated(exact),
        ),
        anchor="misprints",
    )


def _introduce(exact: Data) -> Text:
    counts = exact["provenance_counts"]
    papers = list(dict.fromkeys(entry["paper"] for entry in (*exact["misprints"], *exact["puzzles"])))
    return Text(
        f"{len(exact['misprints'])} misprints and {len(exact['puzzles'])} puzzles of {len(papers)} papers: "
        f"{', '.join(papers)}. Of the robot's numbers {counts['published']} entries are published, "
        f"{counts['derived']} derived from published ones, and {counts['calibrated']} calibrated. Tests named in the "
        "evidence recompute it."
    )


def _make_entries(entries: list[Data], caption: str, meant: str) -> Table:
    return Table(
        columns=(
            Column("paper", align="left"),
            Column("place", align="left"),
            Column("printed", align="left", mark="published"),
            Column(meant, align="left", mark="ours"),
            Column("evidence", align="left"),
        ),
        rows=tuple((e["paper"], e["place"], e["printed"], e["meant"], _unquote(e["evidence"])) for e in entries),
        caption=caption,
    )


def _unquote(evidence: str) -> str:
    """Cells are plain text, where a name needs no code marks."""
    return evidence.replace("`", "")


def _make_calibrated(exact: Data) -> Table:
    return Table(
        columns=(Column("number of the robot", align="left"), Column("why", align="left")),
        rows=tuple((entry["number"], _unquote(entry["why"])) for entry in exact["calibrated"]),
        caption="Calibrated",
        note="`python benchmarks/calibrate.py` shows what each observation leaves free.",
    )

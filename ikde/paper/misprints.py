"""Where the print is wrong or puzzling, and what was chosen inside what it leaves free."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from ikde.paper.columns import label, make_table
from ikde.paper.inputs import Inputs
from ikde.paper.section import Computed
from ikde.report.page import Section, Table, Text

Entries = Sequence[Mapping[str, str]]


@dataclass(frozen=True, slots=True, kw_only=True)
class Misprints(Computed):
    """Misprints and puzzles as `misprints.yaml` has them, and what was calibrated."""

    misprints: Entries
    puzzles: Entries
    calibrated: Entries  # numbers of the robot that the print does not force: number, kind, why
    provenance_counts: dict[str, int]


def compute_misprints(inputs: Inputs) -> Misprints:
    """Every misprint and puzzle of the papers, and every number of the robot that the print does not force."""
    sources = inputs.robot.provenance
    kinds = Counter(source.kind for source in sources.values())
    return Misprints(
        misprints=[dict(entry) for entry in inputs.misprints if entry["kind"] == "misprint"],
        puzzles=[dict(entry) for entry in inputs.misprints if entry["kind"] == "puzzle"],
        calibrated=[
            {"number": ".".join(map(str, path)), "kind": source.kind, "why": source.text}
            for path, source in sources.items()
            if source.kind == "calibrated"
        ],
        provenance_counts={kind: kinds[kind] for kind in ("published", "derived", "calibrated")},
        settings={"robot": inputs.robot.name, "evidence": "tests/test_published.py, benchmarks/calibrate.py"},
    )


def show_misprints(data: Misprints, _: Inputs) -> Section:
    """Misprints, puzzles and calibrated numbers, each with its evidence."""
    return Section(
        "Misprints, puzzles and what was calibrated",
        (
            _introduce(data),
            _make_entries(data.misprints, "Misprints", "meant"),
            _make_entries(data.puzzles, "Puzzles", "what ikde does"),
            _make_calibrated(data),
        ),
        anchor="misprints",
    )


def _introduce(data: Misprints) -> Text:
    counts = data.provenance_counts
    papers = list(dict.fromkeys(entry["paper"] for entry in (*data.misprints, *data.puzzles)))
    return Text(
        f"{len(data.misprints)} misprints and {len(data.puzzles)} puzzles of {len(papers)} papers: "
        f"{', '.join(papers)}. Of the robot's numbers {counts['published']} entries are published, "
        f"{counts['derived']} derived from published ones, and {counts['calibrated']} calibrated. Tests named in the "
        "evidence recompute it."
    )


def _make_entries(entries: Entries, caption: str, meant: str) -> Table:
    return make_table(
        entries,
        label("paper", lambda entry: entry["paper"]),
        label("place", lambda entry: entry["place"]),
        label("printed", lambda entry: entry["printed"], mark="published"),
        label(meant, lambda entry: entry["meant"], mark="ours"),
        label("evidence", lambda entry: _unquote(entry["evidence"])),
        caption=caption,
    )


def _unquote(evidence: str) -> str:
    """Cells are plain text, where a name needs no code marks."""
    return evidence.replace("`", "")


def _make_calibrated(data: Misprints) -> Table:
    return make_table(
        data.calibrated,
        label("number of the robot", lambda entry: entry["number"]),
        label("why", lambda entry: _unquote(entry["why"])),
        caption="Calibrated",
        note="`python benchmarks/calibrate.py` shows what each observation leaves free.",
    )

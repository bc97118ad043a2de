"""One set of misprints: the data, the page, and the places that the published numbers point at."""

import re
from pathlib import Path

from ikde.paper.inputs import load_misprints, load_published, meant
from ikde.paper.misprints import compute_misprints, show_misprints
from ikde.report.page import Table, Text
from tests.paper.conftest import is_plain

PAGE = Path(__file__).parents[2] / "docs" / "misprints.md"
COLUMNS = ("place", "printed", "meant", "evidence")


def page_rows():
    lines = PAGE.read_text(encoding="utf-8").splitlines()
    rows = [line[2:-2].split(" | ") for line in lines if re.match(r"\| (?!place )", line)]
    return [dict(zip(COLUMNS, row, strict=True)) for row in rows]


def places_pointed_at(data):
    """Every value of a `see`, however deep."""
    if isinstance(data, dict):
        for key, value in data.items():
            if key == "see":
                yield from value.values() if isinstance(value, dict) else [value]
            else:
                yield from places_pointed_at(value)
    elif isinstance(data, list):
        for value in data:
            yield from places_pointed_at(value)


def test_the_page_and_the_data_have_the_same_entries():
    assert page_rows() == [{key: entry[key] for key in COLUMNS} for entry in load_misprints()]


def test_published_numbers_point_at_entries():
    places = {entry["place"] for entry in load_misprints()}
    pointed = set(places_pointed_at(load_published()))
    assert len(pointed) > 8
    assert pointed <= places


def test_an_entry_as_meant_keeps_what_is_right():
    assert meant({"d_mm": 109.15, "a_mm": 0, "misprint": {"d_mm": 89.15}})["d_mm"] == 89.15
    assert meant({"d_mm": 109.15, "a_mm": 0, "misprint": {"d_mm": 89.15}})["a_mm"] == 0
    assert meant({"d_mm": 89.2}) == {"d_mm": 89.2}


def test_every_calibrated_number_is_named(inputs):
    section = compute_misprints(inputs)
    assert is_plain(section)
    numbers = {entry["number"] for entry in section.calibrated}
    assert {"frames.load_centre", "frames.platform_rear", "joints.d_x.upper", "adjacent"} <= numbers
    assert section.provenance_counts["calibrated"] == len(section.calibrated)
    assert {entry["kind"] for entry in section.misprints} == {"misprint"}


def test_every_entry_is_shown(results, inputs):
    data = results.sections["misprints"]
    blocks = show_misprints(data, inputs).blocks
    misprints, puzzles, calibrated = [block for block in blocks if isinstance(block, Table)]
    assert len(misprints.rows) == len(data.misprints) > 20
    assert len(puzzles.rows) == len(data.puzzles) > 10
    assert len(calibrated.rows) == data.provenance_counts["calibrated"]
    assert misprints.rows[0][1:4] == ("Formula 23, point 6", "z = 1488.1", "1481.1")
    assert not any("`" in cell for row in misprints.rows for cell in row)


def test_the_text_counts_them(results, inputs):
    data = results.sections["misprints"]
    text = next(b for b in show_misprints(data, inputs).blocks if isinstance(b, Text)).markup
    assert text.startswith(f"{len(data.misprints)} misprints and {len(data.puzzles)} puzzles")
    papers = {entry["paper"] for entry in (*data.misprints, *data.puzzles)}
    assert f"of {len(papers)} papers" in text
    assert all(paper in text for paper in papers)

"""The page of misprints: every entry with its evidence, every calibrated number."""

from ikde.report.page import Table, Text
from ikde.report.paper.misprints import make_misprints


def test_every_entry_is_there(results):
    exact = results["sections"]["misprints"]["exact"]
    section = make_misprints(results["sections"]["misprints"])
    misprints, puzzles, calibrated = [block for block in section.blocks if isinstance(block, Table)]
    assert len(misprints.rows) == len(exact["misprints"]) > 20
    assert len(puzzles.rows) == len(exact["puzzles"]) > 10
    assert len(calibrated.rows) == exact["provenance_counts"]["calibrated"]
    assert misprints.rows[0][1:4] == ("Formula 23, point 6", "z = 1488.1", "1481.1")
    assert not any("`" in cell for row in misprints.rows for cell in row)


def test_the_text_counts_them(results):
    exact = results["sections"]["misprints"]["exact"]
    text = next(b for b in make_misprints(results["sections"]["misprints"]).blocks if isinstance(b, Text)).markup
    assert text.startswith(f"{len(exact['misprints'])} misprints and {len(exact['puzzles'])} puzzles")
    papers = {entry["paper"] for entry in (*exact["misprints"], *exact["puzzles"])}
    assert f"of {len(papers)} papers" in text
    assert all(paper in text for paper in papers)

"""Table 5's section: every printed row graded again, what disagrees marked, free and colliding ones drawn."""

import pytest

from ikde.report.page import Cell, Gallery
from ikde.report.paper.solutions import make_solutions
from tests.report.batch_page.blocks import tables


@pytest.fixture(scope="module")
def section(results, robots):
    return make_solutions(results["sections"]["solutions"], robots["key_point"])


def test_every_printed_row_is_graded(section):
    published = tables(section)[0]
    assert [(row[0], row[1]) for row in published.rows] == [
        *[("1", name) for name in ("s1", "s2", "s3", "f1", "f2")],
        *[("2", name) for name in ("s1", "s2", "s3", "f1", "f2")],
    ]
    assert published.rows[0][2:4] == ("0.0359", "0.0359")


def test_misprints_are_marked_and_explained(section):
    published = tables(section)[0]
    assert published.rows[3][2:4] == (Cell("0.0129", "off"), "0.0028")
    assert published.rows[8][5] == Cell("typical collides", "off")
    assert "0.0028 mm is meant" in published.note


def test_joint_values_stand_as_printed(section):
    joints = tables(section)[2]
    assert joints.rows[0][2:] == (
        *("-0.0008", "0.8659", "1.6368", "1.0156", "0.9326", "-0.0388", "0.4905", "2.8275", "0.6857"),
    )


def test_ours_are_free_and_colliding_and_drawn_as_both_detectors_see_them(section, results):
    ours = results["sections"]["solutions"]["exact"]["ours"]
    assert all(not row["detectors"]["typical"]["collides"] for row in ours if row["row"].startswith("s"))
    gallery = next(block for block in section.blocks if isinstance(block, Gallery))
    assert len(gallery.figures) == 8
    assert "target 1, s1, typical: free" in gallery.figures[0].caption
    assert "target 1, f1, typical: collision of" in gallery.figures[2].caption
    assert all(len(figure.image) < 200_000 for figure in gallery.figures)

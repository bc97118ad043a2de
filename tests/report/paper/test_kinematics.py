"""Formula 23's section: every printed point beside both models, the misprint marked, two pictures."""

from ikde.report.page import Cell, Gallery, Table
from ikde.report.paper.kinematics import make_kinematics


def test_every_point_stands_beside_both_models(results, robots):
    section = make_kinematics(results["sections"]["kinematics"], robots)
    table = next(block for block in section.blocks if isinstance(block, Table))
    assert [row[1] for row in table.rows] == ["O1", "Oc23", "O3", "O4", "O5", "O6"]
    assert table.rows[0][2:5] == ("540.0, 0.0, 569.2", "540.00, 0.00, 569.20", "540.00, 0.00, 569.20")
    assert table.rows[5][5] == Cell("7.000", "off")
    assert "point 6 is printed 711.5, 0.0, 1,488.1, meant 711.5, 0.0, 1,481.1" in table.note


def test_both_models_are_drawn(results, robots):
    section = make_kinematics(results["sections"]["kinematics"], robots)
    gallery = next(block for block in section.blocks if isinstance(block, Gallery))
    assert len(gallery.figures) == 2
    assert all(figure.image.startswith(b"\x89PNG") for figure in gallery.figures)

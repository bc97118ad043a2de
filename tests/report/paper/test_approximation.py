"""Table 2's section: eleven parts in two tables, misprints marked, three approximations drawn."""

from ikde.report.page import Cell, Gallery, Table
from ikde.report.paper.approximation import make_approximation


def test_volumes_degrees_and_home(results, robots):
    section = make_approximation(results["sections"]["approximation"], robots["key_point"])
    typical, improved, home = [block for block in section.blocks if isinstance(block, Table)]
    assert len(typical.rows) == len(improved.rows) == 11
    tool = typical.rows[-1]
    assert tool[3:] == ("4.3103e+06", "4.3103e+06", Cell("2.09", "off"), "20.91", "derived")
    assert [row[5] for row in improved.rows if isinstance(row[5], Cell)] == [Cell("5.90", "off")]
    assert [(row[0], row[2], row[3]) for row in home.rows] == [
        ("single", "collides", "collides"),
        ("typical", "free", "free"),
        ("improved", "free", "free"),
    ]
    gallery = next(block for block in section.blocks if isinstance(block, Gallery))
    assert len(gallery.figures) == 3

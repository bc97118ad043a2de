"""What Table 4 depends on: a row a variation and reading, the closest on top, a forest a cell."""

from ikde.report.page import Gallery, Table
from ikde.report.paper.sensitivity import make_sensitivity


def test_rows_and_forests(results):
    data = results["sections"]["sensitivity"]
    section = make_sensitivity(data)
    closest, *readings = [block for block in section.blocks if isinstance(block, Table)]
    assert sum(len(table.rows) for table in readings) == len(data["exact"]["rows"])
    assert len(closest.rows) == 5
    assert [column.title for column in readings[0].columns[2:6]] == [
        *("typical, print 73", "improved, print 63", "typical, print 86", "improved, print 65"),
    ]
    gallery = next(block for block in section.blocks if isinstance(block, Gallery))
    assert len(gallery.figures) == 4
    assert all("base range" in figure.image for figure in gallery.figures)

"""Table 2, and home with three approximations."""

import pytest

from ikde.paper.approximation import describe_spheres, find_provenance, show_approximation
from ikde.report.page import Cell, Gallery, Table
from tests.paper.conftest import is_plain


@pytest.fixture(scope="module")
def section(results):
    return results.sections["approximation"]


def test_every_cell_agrees_with_the_print_as_meant(section):
    cells = section.volumes
    assert len(cells) == 22
    assert all(cell.agrees for cell in cells)
    assert all(cell.volume_mm3.ours == pytest.approx(cell.volume_mm3.printed, rel=5e-5) for cell in cells)


def test_the_tools_degrees_are_the_only_misprints(section):
    wrong = [row for row in section.components if row.typical.misprint or row.improved.misprint]
    assert [row.component for row in wrong] == ["LT"]


@pytest.mark.parametrize(("name", "meant", "ours"), [("typical", 20.91, "20.91"), ("improved", 59.03, "59.02")])
def test_the_tools_degrees_as_meant_are_those_of_the_printed_volumes(section, name, meant, ours):
    tool = next(row for row in section.components if row.component == "LT")
    degree = tool.volume(name).degree_pct
    assert degree.meant == meant == round(100 * tool.original_mm3 / tool.volume(name).volume_mm3.printed, 2)
    assert f"{degree.ours:.2f}" == ours  # of the spheres themselves, within what the printed volume leaves open
    assert tool.volume(name).agrees


def test_single_spheres_alone_collide_at_home(section):
    home = {entry.detector: entry for entry in section.home}
    assert {name: entry.collides for name, entry in home.items()} == {
        "single": True,
        "typical": False,
        "improved": False,
    }
    assert all(entry.collides == (entry.printed == "collides") for entry in home.values())
    assert home["single"].colliding_pairs == [["M", "L1"]]
    assert 0 < home["typical"].clearance_mm < home["improved"].clearance_mm


def test_spheres_are_told_by_count_and_radius(qiao, section):
    assert describe_spheres(qiao, "improved", "L2") == "5 x R45 + 1 x R80"
    assert section.sphere_counts == {"single": 11, "typical": 32, "improved": 36}
    assert is_plain(section)


def test_what_was_calibrated_is_said(qiao):
    assert find_provenance(qiao, "typical", "M") == ["calibrated"]
    assert find_provenance(qiao, "typical", "L1") == ["derived"]
    assert find_provenance(qiao, "improved", "J5") == ["calibrated", "derived"]  # its place, its radius


def test_volumes_degrees_and_home_are_shown(section, inputs):
    blocks = show_approximation(section, inputs).blocks
    typical, improved, home = [block for block in blocks if isinstance(block, Table)]
    assert len(typical.rows) == len(improved.rows) == 11
    tool = typical.rows[-1]
    assert tool[3:] == ("4.3103e+06", "4.3103e+06", Cell("2.09", "off"), "20.91", "derived")
    assert [row[5] for row in improved.rows if isinstance(row[5], Cell)] == [Cell("5.90", "off")]
    assert [(row[0], row[2], row[3]) for row in home.rows] == [
        ("single", "collides", "collides"),
        ("typical", "free", "free"),
        ("improved", "free", "free"),
    ]
    gallery = next(block for block in blocks if isinstance(block, Gallery))
    assert len(gallery.figures) == 3

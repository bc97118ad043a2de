"""Table 2, and who is free at home."""

import pytest

from ikde.bench.approximation import compute_approximation, describe_spheres, find_provenance
from tests.bench.conftest import is_plain


@pytest.fixture(scope="module")
def section(qiao, published):
    return compute_approximation(qiao, published)


def test_every_cell_agrees_with_the_print_as_meant(section):
    cells = [row[name] for row in section["exact"]["components"] for name in ("typical", "improved")]
    assert len(cells) == 22
    assert all(cell["agrees"] for cell in cells)
    assert all(cell["volume_mm3"]["ours"] == pytest.approx(cell["volume_mm3"]["printed"], rel=5e-5) for cell in cells)


def test_the_tools_degrees_are_the_only_misprints(section):
    wrong = [row for row in section["exact"]["components"] if row["typical"]["misprint"] or row["improved"]["misprint"]]
    assert [row["component"] for row in wrong] == ["LT"]


@pytest.mark.parametrize(("name", "meant", "ours"), [("typical", 20.91, "20.91"), ("improved", 59.03, "59.02")])
def test_the_tools_degrees_as_meant_are_those_of_the_printed_volumes(section, name, meant, ours):
    tool = next(row for row in section["exact"]["components"] if row["component"] == "LT")
    degree = tool[name]["degree_pct"]
    assert degree["meant"] == meant == round(100 * tool["original_mm3"] / tool[name]["volume_mm3"]["printed"], 2)
    assert f"{degree['ours']:.2f}" == ours  # of the spheres themselves, within what the printed volume leaves open
    assert tool[name]["agrees"]


def test_single_spheres_alone_collide_at_home(section):
    home = {entry["detector"]: entry for entry in section["exact"]["home"]}
    assert {name: entry["collides"] for name, entry in home.items()} == {
        "single": True,
        "typical": False,
        "improved": False,
    }
    assert all(entry["collides"] == (entry["printed"] == "collides") for entry in home.values())
    assert home["single"]["colliding_pairs"] == [["M", "L1"]]
    assert 0 < home["typical"]["clearance_mm"] < home["improved"]["clearance_mm"]


def test_spheres_are_told_by_count_and_radius(qiao, section):
    assert describe_spheres(qiao, "improved", "L2") == "5 x R45 + 1 x R80"
    assert section["exact"]["sphere_counts"] == {"single": 11, "typical": 32, "improved": 36}
    assert is_plain(section)


def test_what_was_calibrated_is_said(qiao):
    assert find_provenance(qiao, "typical", "M") == ["calibrated"]
    assert find_provenance(qiao, "typical", "L1") == ["derived"]
    assert find_provenance(qiao, "improved", "J5") == ["calibrated", "derived"]  # its place, its radius

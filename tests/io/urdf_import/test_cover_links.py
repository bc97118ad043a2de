"""Spheres for the shapes of links."""

from types import SimpleNamespace

import numpy as np
import pytest

from ikde.errors import FileError
from ikde.io.urdf_import import cover_links
from ikde.io.urdf_import.chain import find_tree
from ikde.io.urdf_import.description import read_description
from ikde.io.urdf_import.options import ImportOptions
from tests.urdf_texts import change, write


def cover_file(folder, text, **options):
    description = read_description(write(folder, text))
    return cover_links.cover_links(description, find_tree(description), ImportOptions(**options))


def test_spheres_are_taken_as_they_are(tmp_path):
    second = '<collision><origin xyz="1 2 3"/><geometry><sphere radius="0.2"/></geometry></collision><inertial>'
    covered = cover_file(tmp_path, change("<inertial>", second))
    assert list(covered) == ["base_link", "upper", "fore"]
    upper = covered["upper"]
    np.testing.assert_array_equal(upper.centres, [[1, 2, 3], [0, 0, 0.3]])
    np.testing.assert_array_equal(upper.radii, [0.2, 0.05])
    report = upper.report
    assert (report.link, report.shapes, report.spheres, report.protrusion_m) == ("upper", "2 spheres", 2, 0.0)
    assert (report.covered, report.how) == (None, "as they are")


def test_a_mesh_that_is_missing_is_refused_with_its_line(tmp_path):
    text = change('<sphere radius="0.05"/>', '<mesh filename="package://arm/a.stl"/>')
    with pytest.raises(FileError, match=r"arm\.urdf:9: the mesh 'package://arm/a.stl' is not in this folder"):
        cover_file(tmp_path, text)


def test_other_shapes_are_covered_as_asked_and_that_is_said(tmp_path, monkeypatch):
    cover = SimpleNamespace(
        centres=np.array([[0.0, 0, 1]]),
        radii=np.array([0.4]),
        covered=0.999,
        protrusion_m=0.015,
        how="as a test does",
        warnings=("large",),
    )
    asked = []
    monkeypatch.setattr(cover_links, "cover_shapes", lambda shapes, most: (asked.append((shapes, most)), cover)[1])
    second = '<collision><geometry><box size="1 2 3"/></geometry></collision><inertial>'
    upper = cover_file(tmp_path, change("<inertial>", second))["upper"]
    np.testing.assert_array_equal(upper.centres, [[0, 0, 0.3], [0, 0, 1]])
    np.testing.assert_array_equal(upper.radii, [0.05, 0.4])
    report = upper.report
    assert (report.shapes, report.covered, report.protrusion_m) == ("1 box, 1 sphere", 0.999, 0.015)
    assert (report.spheres, report.how) == (2, "as a test does")
    assert upper.warnings == ("link upper: large",)
    ((shapes, most),) = asked
    assert ([shape.kind for shape in shapes], most) == (["box"], 0.02)


def test_a_mesh_is_handed_on_with_its_file_and_scale(tmp_path, monkeypatch):
    (tmp_path / "a.stl").write_text("solid", encoding="utf-8")
    asked = []
    cover = SimpleNamespace(
        centres=np.zeros((0, 3)), radii=np.zeros(0), covered=1.0, protrusion_m=0.0, how="", warnings=()
    )
    monkeypatch.setattr(cover_links, "cover_shapes", lambda shapes, most: (asked.extend(shapes), cover)[1])
    cover_file(tmp_path, change('<sphere radius="0.05"/>', '<mesh filename="a.stl" scale="1 -1 2"/>'), mesh_scale=0.5)
    assert [(shape.mesh, shape.scale) for shape in asked] == [(tmp_path / "a.stl", (0.5, -0.5, 1.0))]


def test_a_link_that_takes_too_many_spheres_is_named(tmp_path):
    second = '<collision><geometry><box size="9 9 9"/></geometry></collision><inertial>'
    with pytest.raises(FileError, match=r"arm\.urdf → link\.upper: a box would take more than 2,000 spheres"):
        cover_file(tmp_path, change("<inertial>", second), protrusion_m=0.01)

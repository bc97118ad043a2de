"""Spheres for the shapes of links."""

import numpy as np
import pytest

from ikde.errors import FileError
from ikde.io.urdf_import.chain import find_tree
from ikde.io.urdf_import.cover_links import cover_links
from ikde.io.urdf_import.description import read_description
from ikde.io.urdf_import.options import ImportOptions
from tests.urdf_texts import change, write


def cover(folder, text):
    description = read_description(write(folder, text))
    return cover_links(description, find_tree(description), ImportOptions())


def test_spheres_are_taken_as_they_are(tmp_path):
    second = '<collision><origin xyz="1 2 3"/><geometry><sphere radius="0.2"/></geometry></collision><inertial>'
    covered = cover(tmp_path, change("<inertial>", second))
    assert list(covered) == ["base_link", "upper", "fore"]
    upper = covered["upper"]
    np.testing.assert_array_equal(upper.centres, [[1, 2, 3], [0, 0, 0.3]])
    np.testing.assert_array_equal(upper.radii, [0.2, 0.05])
    report = upper.report
    assert (report.link, report.shapes, report.spheres, report.protrusion_m) == ("upper", "2 spheres", 2, 0.0)
    assert (report.covered, report.how) == (None, "as they are")


def test_a_mesh_that_is_missing_is_refused_with_its_line(tmp_path):
    text = change('<sphere radius="0.05"/>', '<mesh filename="package://arm/a.stl"/>')
    with pytest.raises(FileError, match=r"arm\.urdf:9: the mesh 'package://arm/a.stl' is not in its folder"):
        cover(tmp_path, text)

"""Spheres of links from another program's file."""

from pathlib import Path

import numpy as np
import pytest

from ikde.errors import FileError
from ikde.io.sphere_files import SphereFile
from ikde.io.urdf_import.given_spheres import give_spheres

LINKS = {"base": True, "upper": True, "tip": False}
BALL = ((0.0, 1.0, 2.0, 0.1),)


def make(spheres, notes=()):
    return SphereFile(path=Path("arm.yml"), kind="cuRobo", spheres=spheres, notes=notes)


def test_links_get_what_the_file_has_for_them_and_nothing_is_silent():
    found, notes = give_spheres(make({"tip": BALL, "upper": BALL * 2, "base": (), "hand": BALL}, ("a note",)), LINKS)
    assert list(found) == ["upper", "tip"]
    np.testing.assert_array_equal(found["tip"].centres, [[0, 1, 2]])
    np.testing.assert_array_equal(found["upper"].radii, [0.1, 0.1])
    report = found["upper"].report
    assert (report.spheres, report.covered, report.protrusion_m) == (2, None, None)
    assert report.how == "as in arm.yml (cuRobo)"
    assert notes == [
        "arm.yml has spheres for links that there are not: hand",
        "arm.yml has no spheres for links with shapes, which are not checked: base",
        "arm.yml: a note",
    ]


def test_links_of_our_own_urdf_are_known_by_their_components():
    found, _ = give_spheres(make({"component_upper": BALL}), LINKS)
    assert list(found) == ["upper"]
    found, _ = give_spheres(make({"component_upper": BALL}), {**LINKS, "component_upper": True})
    assert list(found) == ["component_upper"]  # a link of that very name


def test_a_file_for_another_robot_is_refused():
    with pytest.raises(FileError, match=r"arm\.yml: no link of the robot has spheres here: 'uper' \(did"):
        give_spheres(make({"uper": BALL}), LINKS)

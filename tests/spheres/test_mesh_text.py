"""OBJ and text STL: each face counts, however it is written, or the file is refused with its line."""

from pathlib import Path

import numpy as np
import pytest

from ikde.errors import FileError
from ikde.spheres.mesh_text import read_obj, read_text_stl

PATH = Path("a.obj")
POINTS = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
CORNERS = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
TRIANGLE = CORNERS[None, :3]
STL = "solid a\n facet normal 0 0 1\n  outer loop\n{}  endloop\n endfacet\nendsolid a\n"
STL = STL.format("".join(f"   vertex {x} {y} {z}\n" for x, y, z in CORNERS[:3]))


@pytest.mark.parametrize(
    ("text", "faces"),
    [
        ("f 1 2 3", [(0, 1, 2)]),
        ("  f\t1/1/1  2//2 3/3 # a comment", [(0, 1, 2)]),
        ("f 1 2 3 4", [(0, 1, 2), (0, 2, 3)]),
        ("f -4 -3 -1", [(0, 1, 3)]),
        ("fo 1 \\\n2 3", [(0, 1, 2)]),
        ("f 1 2\\\n 3", [(0, 1, 2)]),
        ("l 1 2\nf 1 2\np 3\nvt 5 5\nvn 0 0 1\nusemtl ../x\nmtllib /etc/passwd\nf +1 +2 +3", [(0, 1, 2)]),
        ("f 1 2 3\nv 9 9 9", [(0, 1, 2)]),
        ("o nothing", []),
    ],
)
def test_faces_of_an_obj(text, faces):
    np.testing.assert_array_equal(read_obj(PATH, POINTS + text), CORNERS[np.array(faces, dtype=int).reshape(-1, 3)])


def test_negative_indices_count_back_from_their_face():
    far = POINTS.replace("v 0", "v 5")
    triangles = read_obj(PATH, f"{POINTS}f -4 -3 -2\n{far}f -4 -3 -2\n")
    np.testing.assert_array_equal(triangles, [CORNERS[:3], [[5, 0, 0], [1, 0, 0], [5, 1, 0]]])


def test_corners_may_stand_behind_faces_and_be_indented():
    np.testing.assert_array_equal(read_obj(PATH, f"f 1 2 3\n{POINTS.replace('v', ' v ')}"), TRIANGLE)
    np.testing.assert_array_equal(read_obj(PATH, f"{POINTS}f 1 2 3\n".replace("\n", " 1 0 0\n", 4)), TRIANGLE)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("f 0 1 2", "5: expected the number of a corner, got '0'"),
        ("f -5 1 2", "5: expected the number of a corner, got '-5'"),
        ("f 1 2 5", "5: expected corners 1 to 4, got 5"),
        ("f 1 2 3\n\nf 1 2 9", "7: expected corners 1 to 4, got 9"),
        (f"f 1 2 {'9' * 30}", "5: expected the number of a corner, got '999"),
        ("f 1.5 2 3", "5: expected the number of a corner, got '1.5'"),
        ("v 1 2", "5: expected three numbers, got '1 2'"),
        ("v 1 2 x", "5: expected three numbers, got '1 2 x'"),
        ("surf 0 1 0 1 1 2 3", "5: a free-form surface is not read"),
        ("call other.obj", "5: another file is not read"),
        ("csh touch ran", "5: a command is not read"),
    ],
)
def test_an_obj_that_would_lose_a_face_is_refused(text, message):
    with pytest.raises(FileError) as caught:
        read_obj(PATH, POINTS + text)
    assert str(caught.value).startswith(f"a.obj:{message}")


def test_facets_of_a_text_stl():
    for text in (STL, STL.upper(), STL.replace("\n", "\r\n"), STL.replace("solid a", "solid vertex facet")):
        np.testing.assert_array_equal(read_text_stl(PATH, text), TRIANGLE)
    assert len(read_text_stl(PATH, STL + STL)) == 2
    assert read_text_stl(PATH, "solid\nendsolid\n").shape == (0, 3, 3)


def test_an_stl_that_breaks_off_is_refused_wherever_it_does():
    lines = (STL + STL).splitlines()
    for count in range(1, len(lines)):
        if count != len(lines) // 2:
            with pytest.raises(FileError, match=r"it breaks off|expected three"):
                read_text_stl(PATH, "\n".join(lines[:count]))


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("vertex 1.0 0.0 0.0", "", "8: expected three corners of a facet before"),
        ("vertex 1.0 0.0 0.0", "vertex 1 0", "5: expected three numbers, got '1 0'"),
        ("vertex 1.0 0.0 0.0", "vertex 1 0 x", "5: expected three numbers"),
        ("vertex 1.0 0.0 0.0", "vertex 1 0 0\nvertex 1 0 0", "9: expected three corners"),
        ("endsolid a", "", "8: is no STL that can be read: it breaks off"),
    ],
)
def test_a_facet_without_three_corners_is_refused(old, new, message):
    assert old in STL
    with pytest.raises(FileError) as caught:
        read_text_stl(PATH, STL.replace(old, new))
    assert f"a.obj:{message}" in str(caught.value)

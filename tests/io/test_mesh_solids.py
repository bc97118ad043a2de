"""Meshes as obstacles: hulls of closed parts, one of all that is open, and what is said of them."""

import numpy as np
import pytest

from ikde.errors import FileError, InputError
from ikde.io import mesh_solids
from ikde.io.mesh_solids import make_inline_hull, measure_volume, read_mesh_hulls
from ikde.io.scene_values import Reading

CUBE = np.array([[x, y, z] for x in (0.0, 1.0) for y in (0.0, 1.0) for z in (0.0, 1.0)])
FACES = [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4]]
FACES += [[1, 5, 7], [1, 7, 3]]
IDENTITY = np.eye(4)[:3]


def obj(points, faces):
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in points.tolist()]
    return "\n".join(lines + [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in faces]) + "\n"


def ell():
    """An L of 3 m3 whose hull holds 3.5."""
    outline = np.array([[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]], float)
    points = np.concatenate([np.column_stack([outline, np.full(6, z)]) for z in (0.0, 1.0)])
    floor = [[0, 2, 1], [0, 3, 2], [0, 4, 3], [0, 5, 4]]
    walls = [face for k in range(6) for j in [(k + 1) % 6] for face in ([k, j, j + 6], [k, j + 6, k + 6])]
    return points, [*floor, *([c + 6 for c in face[::-1]] for face in floor), *walls]


@pytest.fixture
def read(tmp_path):
    pytest.importorskip("trimesh")

    def read(points, faces, scale=(1.0, 1.0, 1.0)):
        (tmp_path / "a.obj").write_text(obj(points, faces))
        reading = Reading(tmp_path)
        return read_mesh_hulls("a.obj", np.array(scale), IDENTITY, reading), reading.notes

    return read


def test_a_convex_mesh_is_its_hull(read):
    (solid,), notes = read(CUBE, FACES, (1.0, 2.0, -3.0))
    assert notes == []
    assert sorted(map(tuple, solid.points)) == sorted(map(tuple, CUBE * [1, 2, -3]))
    assert measure_volume(solid.points, solid.triangles) == pytest.approx(6.0)


def test_each_closed_part_has_a_hull(read):
    solids, notes = read(np.concatenate([CUBE, CUBE + 3.0]), FACES + [[c + 8 for c in face] for face in FACES])
    assert notes == []
    assert [solid.points.min() for solid in solids] == [0.0, 3.0]


def test_a_hull_that_is_larger_is_said_so(read):
    (solid,), notes = read(*ell())
    assert measure_volume(solid.points, solid.triangles) == pytest.approx(3.5)
    assert notes == ["a.obj is not convex: its convex hull is taken, 1.17 times its volume"]


def test_an_open_mesh_is_said_to_be_open(read):
    (solid,), notes = read(CUBE, FACES[:-2])
    assert len(solid.points) == 8
    assert notes == ["a.obj is not closed: its convex hull is taken"]


def test_what_is_flat_is_refused(read):
    with pytest.raises(InputError, match="enclose a volume"):
        read(CUBE, FACES[:2])


def test_many_parts_of_triangles_are_one_hull(read, monkeypatch):
    monkeypatch.setattr(mesh_solids, "MAX_PARTS", 3)
    points = np.random.default_rng(1).normal(size=(60, 3))
    solids, notes = read(points, np.arange(60).reshape(20, 3).tolist())
    assert (len(solids), len(notes)) == (1, 1)
    cubes = np.concatenate([CUBE + 3 * k for k in range(4)])
    with pytest.raises(InputError, match="at most 3 parts"):
        read(cubes, [[c + 8 * k for c in face] for k in range(4) for face in FACES])


def test_too_large_meshes(read, tmp_path, monkeypatch):
    monkeypatch.setattr(mesh_solids, "MAX_TRIANGLES", 20)
    reading = Reading(tmp_path)
    read(CUBE, FACES)
    read_mesh_hulls("a.obj", np.ones(3), IDENTITY, reading)
    with pytest.raises(InputError, match="at most 20 triangles in all meshes together"):
        read_mesh_hulls("a.obj", np.ones(3), IDENTITY, reading)


@pytest.mark.parametrize(
    ("name", "error", "said"),
    [
        ("../a.obj", InputError, "inside the folder of this one"),
        ("/a.obj", InputError, "inside the folder of this one"),
        ("a.step", InputError, "a mesh that ends in .stl, .obj, .dae, got 'a.step'"),
        ("no.stl", FileError, "no such file"),
        ("bad.stl", InputError, "no STL that can be read: |without area|meshes need trimesh"),
    ],
)
def test_what_is_no_mesh(tmp_path, name, error, said):
    (tmp_path / "bad.stl").write_bytes(b"solid nothing")
    with pytest.raises(error, match=said):
        read_mesh_hulls(name, np.ones(3), IDENTITY, Reading(tmp_path))


def test_a_scale_of_zero(tmp_path):
    with pytest.raises(InputError, match="a scale that is not 0"):
        read_mesh_hulls("a.stl", np.array([1.0, 0.0, 1.0]), IDENTITY, Reading(tmp_path))


def test_vertices_that_stand_in_a_scene(tmp_path):
    reading = Reading(tmp_path)
    solid = make_inline_hull(CUBE.tolist(), FACES, np.full(3, 2.0), reading)
    assert solid.points.max() == 2.0
    assert reading.notes == []
    make_inline_hull(CUBE.tolist(), np.ravel(FACES).tolist(), np.ones(3), reading)
    assert reading.notes == []
    make_inline_hull(CUBE.tolist(), None, np.ones(3), reading)
    assert reading.notes == ["a mesh is not closed: its convex hull is taken"]


@pytest.mark.parametrize(
    ("vertices", "faces", "said"),
    [
        (CUBE.tolist(), [[0, 1, 8]], "faces: expected triangles by the numbers of their vertices, 0 to 7"),
        (CUBE.tolist(), [0, 1], "faces: expected triangles"),
        (CUBE.tolist(), [["a"] * 3], "faces: expected triangles"),
        ([[0, 0], [1, 1]], None, r"vertices\[0\]: expected 3 numbers"),
        ([[0, 0, np.nan]], None, r"vertices\[0\]\[2\]: expected a finite number, got nan"),
        ([], None, "vertices.points: expected points"),
        ("word", None, "vertices: expected a list, got 'word'"),
    ],
)
def test_vertices_that_are_none(tmp_path, vertices, faces, said):
    with pytest.raises(InputError, match=said):
        make_inline_hull(vertices, faces, np.ones(3), Reading(tmp_path))

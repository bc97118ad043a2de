"""Files of meshes: read to m, or refused in one line."""

import sys
from importlib.util import find_spec

import numpy as np
import pytest

from ikde.errors import FileError, InputError
from ikde.spheres import mesh_file
from ikde.spheres.mesh_file import MISSING, read_mesh
from tests.mesh_bodies import box, write_stl

OBJ = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"
DAE = """<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit meter="0.01"/><up_axis>Z_UP</up_axis></asset>
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="a" count="9">0 0 0 1 0 0 0 1 0</float_array><technique_common>
<accessor source="#a" count="3" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node><instance_geometry url="#g"/></node></visual_scene>
</library_visual_scenes>
<scene>
<instance_visual_scene url="#s"/></scene></COLLADA>"""
TRIANGLE = np.array([[[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]])

needs_trimesh = pytest.mark.skipif(find_spec("trimesh") is None, reason="needs trimesh")


@needs_trimesh
class TestRead:
    def test_an_stl_is_scaled(self, tmp_path) -> None:
        path = write_stl(tmp_path / "box.stl", box(1, 1, 1))
        triangles, warnings = read_mesh(path, (1.0, 2.0, 0.5))
        np.testing.assert_array_equal(triangles, box(1, 2, 0.5))
        assert warnings == ()

    def test_where_a_scale_mirrors_corners_are_reversed(self, tmp_path) -> None:
        path = write_stl(tmp_path / "box.STL", box(1, 1, 1))
        triangles, _ = read_mesh(path, (1.0, 1.0, -1.0))
        np.testing.assert_array_equal(triangles, (box(1, 1, 1) * (1.0, 1.0, -1.0))[:, ::-1])

    @pytest.mark.parametrize(("name", "text", "unit"), [("a.obj", OBJ, 1.0), ("a.dae", DAE, 0.01)])
    def test_other_kinds_are_read(self, tmp_path, name: str, text: str, unit: float) -> None:
        if name.endswith("dae"):
            pytest.importorskip("collada")
        (tmp_path / name).write_text(text, encoding="utf-8")
        np.testing.assert_allclose(read_mesh(tmp_path / name)[0], TRIANGLE * unit)

    def test_beyond_20_m_millimetres_are_suspected(self, tmp_path) -> None:
        path = write_stl(tmp_path / "box.stl", box(21, 1, 1))
        assert read_mesh(path)[1] == ("box.stl is 21 m large; if it is given in mm, use --mesh-scale 0.001",)
        assert read_mesh(path, (0.9, 1.0, 1.0))[1] == ()

    @pytest.mark.parametrize(
        ("triangles", "message"),
        [
            (box(1, 1, np.nan), "expected finite coordinates"),
            (TRIANGLE * (1, 0, 0), "expected a surface, got 1 triangles without area"),
            (TRIANGLE[:0], "."),
            (TRIANGLE * 1e7, "at most 1,000 km, got 1e"),
        ],
    )
    def test_no_body_is_refused(self, tmp_path, triangles: np.ndarray, message: str) -> None:
        with pytest.raises(FileError, match=message):
            read_mesh(write_stl(tmp_path / "odd.stl", triangles))

    def test_too_many_triangles_are_refused(self, tmp_path, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr(mesh_file, "MAX_TRIANGLES", 11)
        with pytest.raises(FileError, match="expected at most 11 triangles, got 12"):
            read_mesh(write_stl(tmp_path / "box.stl", box(1, 1, 1)))

    @pytest.mark.parametrize("name", ["a.stl", "a.obj", "a.dae"])
    def test_noise_is_refused(self, tmp_path, name: str) -> None:
        (tmp_path / name).write_bytes(b"\x07noise" * 40)
        with pytest.raises(FileError, match=rf"{name}: "):
            read_mesh(tmp_path / name)

    def test_a_doctype_is_refused(self, tmp_path) -> None:
        (tmp_path / "a.dae").write_text("<!DOCTYPE x>" + DAE, encoding="utf-8")
        with pytest.raises(FileError, match="expected COLLADA in UTF-8 without a DOCTYPE"):
            read_mesh(tmp_path / "a.dae")

    @pytest.mark.parametrize("encoding", ["bogus", "hex", "utf-7"])
    def test_an_encoding_that_is_none_is_refused(self, tmp_path, encoding: str) -> None:
        (tmp_path / "a.dae").write_text(f'<?xml version="1.0" encoding="{encoding}"?>{DAE}', encoding="utf-8")
        with pytest.raises(FileError, match=r"a\.dae: is no COLLADA that can be read"):
            read_mesh(tmp_path / "a.dae")

    def test_a_dae_of_which_a_part_is_missing_is_refused(self, tmp_path) -> None:
        pytest.importorskip("collada")
        (tmp_path / "a.dae").write_text(DAE.replace("0 1 2", "0 1 9"), encoding="utf-8")
        with pytest.raises(FileError, match="of its 1 triangles 0 can be read"):
            read_mesh(tmp_path / "a.dae")
        (tmp_path / "a.dae").write_text(DAE.replace("#g", "#h"), encoding="utf-8")
        with pytest.raises(FileError, match="no geometry is called '#h' in it; give the mesh as STL or OBJ"):
            read_mesh(tmp_path / "a.dae")

    def test_a_binary_stl_may_begin_like_a_text(self, tmp_path) -> None:
        path = write_stl(tmp_path / "box.stl", box(1, 1, 1))
        path.write_bytes(b"solid vertex" + path.read_bytes()[12:])
        np.testing.assert_array_equal(read_mesh(path)[0], box(1, 1, 1))
        path.write_bytes(path.read_bytes()[:-1])
        with pytest.raises(FileError, match="its header tells of 12 triangles"):
            read_mesh(path)

    @pytest.mark.parametrize("unit", ["0", "-1", "nan", "x"])
    def test_a_unit_that_is_none_is_refused(self, tmp_path, unit: str) -> None:
        (tmp_path / "a.dae").write_text(DAE.replace("0.01", unit), encoding="utf-8")
        with pytest.raises(FileError, match=r"a\.dae.*: (expected a unit|is no COLLADA)"):
            read_mesh(tmp_path / "a.dae")


def test_a_large_file_is_refused_before_it_is_read(tmp_path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(mesh_file, "MAX_BYTES", 2_000_000)
    with (tmp_path / "a.stl").open("wb") as file:
        file.truncate(3_000_000)
    with pytest.raises(FileError, match="expected at most 2 MB, got 3 MB"):
        read_mesh(tmp_path / "a.stl")


def test_other_endings_and_missing_files_are_refused(tmp_path) -> None:
    with pytest.raises(FileError, match=r"expected a mesh with the ending \.stl, \.obj, \.dae"):
        read_mesh(tmp_path / "a.ply")
    with pytest.raises(FileError, match="no such file"):
        read_mesh(tmp_path / "a.stl")


def test_without_trimesh_the_extra_is_named(tmp_path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "trimesh", None)
    with pytest.raises(InputError) as caught:
        read_mesh(write_stl(tmp_path / "box.stl", box(1, 1, 1)))
    assert caught.value.message == MISSING == "meshes need trimesh: pip install 'ikde[meshes]'"


@needs_trimesh
@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"", "is no STL that can be read: it is empty"),
        (b"x" * 83, "is no STL that can be read: 83 bytes are less than its header of 84"),
        (bytes(80) + b"\x02\0\0\0" + bytes(50), "its header tells of 2 triangles, 184 bytes, but it has 134"),
        (bytes(80) + b"\x01\0\0\0" + bytes(100), "its header tells of 1 triangles, 134 bytes, but it has 184"),
    ],
)
def test_what_is_wrong_with_a_broken_stl_is_said(tmp_path, content, said):
    (tmp_path / "a.stl").write_bytes(content)
    with pytest.raises(FileError, match=rf"a\.stl: .*{said}$"):
        read_mesh(tmp_path / "a.stl")

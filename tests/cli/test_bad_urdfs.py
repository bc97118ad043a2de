"""What is wrong with a URDF or with a mesh of it: exit code 2, one clear line with the place, nothing written."""

from importlib.util import find_spec

import numpy as np
import pytest

from ikde.io.urdf_import import description
from ikde.spheres import mesh_file
from tests.mesh_bodies import box, write_stl
from tests.urdf_texts import ARM, FINGERS, change, extend, joint, write

ENTITY = '<!DOCTYPE robot [<!ENTITY a "{}">]>\n<robot name="&a;"><link name="base_link"/></robot>'
PASSWD = '<!DOCTYPE robot [<!ENTITY a SYSTEM "file:///etc/passwd">]>\n<robot>&a;</robot>'
NO_DOCTYPE = "arm.urdf:1: a DOCTYPE is not read here: it can name other files and entities; take it out"
MESH = change('<sphere radius="0.05"/>', '<mesh filename="a.stl"/>')
TRY = "try --package-path FOLDER, or --no-spheres"

BAD = {
    "an open tag": (ARM.replace("</robot>", ""), "arm.urdf:22: not XML: no element found"),
    "no XML at all": ("solid robot", "arm.urdf:1: not XML: syntax error"),
    "another format": ('<sdf version="1.6"/>', "arm.urdf:1: expected <robot>, got <sdf>"),
    "a DOCTYPE": ("<!DOCTYPE robot>\n" + ARM.partition("\n")[2], NO_DOCTYPE),
    "an entity that grows": (ENTITY.format("&b;&b;&b;&b;"), NO_DOCTYPE),
    "an entity that is a file": (PASSWD, NO_DOCTYPE),
    "an entity of nobody": ("<robot>&a;</robot>", "arm.urdf:1: not XML: undefined entity"),
    "a cycle": (
        change('<parent link="base_link"/>', '<parent link="tip"/>'),
        "arm.urdf:13 → joint.shoulder: a cycle: following the parents never reaches a root",
    ),
    "a link that carries itself": (
        extend('<link name="a"/>' + joint("aa", "fixed", "a", "a")),
        "arm.urdf:21 → joint.aa: a cycle: following the parents never reaches a root",
    ),
    "two roots": (
        extend('<link name="loose"/>'),
        "arm.urdf:21 → link.loose: 2 links have no parent, base_link, loose; expected one",
    ),
    "two parents": (
        extend(joint("again", "fixed", "base_link", "tip")),
        "arm.urdf:21 → joint.again: its child 'tip' is that of joint 'flange' as well",
    ),
    "a mesh that is missing": (MESH, f"arm.urdf:9: the mesh 'a.stl' is not in this folder; {TRY}"),
    "a mesh outside the folder": (
        MESH.replace("a.stl", "../a.stl"),
        f"arm.urdf:9: the mesh '../a.stl' lies outside this folder; {TRY}",
    ),
    "a mesh outside a package": (
        MESH.replace("a.stl", "package://x/../../../a.stl"),
        f"arm.urdf:9: the mesh 'package://x/../../../a.stl' is not in this folder; {TRY}",
    ),
    "a mesh from the network": (
        MESH.replace("a.stl", "https://a.example/a.stl"),
        "arm.urdf:9: the mesh 'https://a.example/a.stl' is no file on this machine, and none is fetched",
    ),
    "NaN": (
        change('xyz="0.1 0 0.5"', 'xyz="0.1 0 nan"'),
        "arm.urdf:18 → joint.slide.xyz: expected 3 finite numbers, got '0.1 0 nan'",
    ),
    "a limit that is NaN": (
        change('lower="-1.5"', 'lower="nan"'),
        "arm.urdf:15 → joint.shoulder.limit.lower: expected a number, got 'nan'",
    ),
    "a radius that is NaN": (
        change('radius="0.05"', 'radius="nan"'),
        "arm.urdf:9 → link.upper.collision.radius: expected a number, got 'nan'",
    ),
    "upside-down limits": (
        change('lower="-1.5"', 'lower="2.5"'),
        "arm.urdf:15 → joint.shoulder.limit: the upper limit 2 is below the lower one, 2.5",
    ),
    "a link twice": (
        change('link name="upper"', 'link name="fore"'),
        "arm.urdf:11 → link.fore: this name is given twice, first in line 4",
    ),
    "a joint twice": (
        change('joint name="slide"', 'joint name="shoulder"'),
        "arm.urdf:17 → joint.shoulder: this name is given twice, first in line 13",
    ),
}


def import_arm(refuse, *asked):
    return refuse("robots", "import", "arm.urdf", "-o", "out.yaml", *asked)


@pytest.mark.parametrize("what", BAD)
def test_a_bad_file_is_one_line(refuse, tmp_path, what):
    text, message = BAD[what]
    write(tmp_path, text)
    assert import_arm(refuse) == f"ikde: {message}\n"


@pytest.mark.parametrize(
    ("asked", "message"),
    [
        (("--tool", "tipp"), "arm.urdf → tool: no link is called 'tipp' (did you mean 'tip'?)"),
        (("--tool", "base_link"), "arm.urdf → tool: no joint moves the tool 'base_link'; name another link or a base"),
        (
            (),
            "arm.urdf → tool: which link is the tool? it has 3 ends: tip, left, right; "
            "name one, or a link that carries them: ikde robots import --tool NAME",
        ),
        (
            ("--tool", "right"),
            "arm.urdf:25 → joint.grip_mimic: it mimics 'grip' and moves the tool; hold it (--hold grip_mimic=VALUE)",
        ),
        (("--tool", "tip", "--hold", "gripp=0"), "hold.gripp: no joint is called 'gripp' (did you mean 'grip'?)"),
        (("--tool", "tip", "--hold", "grip=nan"), "hold.grip: expected a value from 0.01 to 0.05, got nan"),
        (("--tool", "tip", "--hold", "grip=1"), "hold.grip: expected a value from 0.01 to 0.05, got 1"),
        (("--tool", "tip", "--srdf", "no.srdf"), "no.srdf: no such file"),
        (("--tool", "tip", "--mesh-scale", "0"), "mesh_scale: expected a number above 0, up to 100000"),
    ],
)
def test_what_is_asked_for_and_is_not_there_is_one_line(refuse, tmp_path, asked, message):
    write(tmp_path, extend(FINGERS))
    assert import_arm(refuse, *asked) == f"ikde: {message}\n"


def test_a_file_of_too_many_links_is_one_line(refuse, tmp_path, monkeypatch):
    monkeypatch.setattr(description, "MAX_LINKS", 3)
    write(tmp_path, ARM)
    assert import_arm(refuse) == "ikde: arm.urdf:2: expected at most 3 links, got 4\n"


# ---- meshes


def test_megabytes_of_triangles_are_refused_before_they_are_read(refuse, tmp_path, monkeypatch):
    write(tmp_path, MESH)
    path = tmp_path / "a.stl"
    with path.open("wb") as file:
        file.truncate(100_000_000)
    assert import_arm(refuse) == f"ikde: {path}: expected at most 50 MB, got 100 MB\n"


def test_a_mesh_of_another_kind_is_one_line(refuse, tmp_path):
    write(tmp_path, MESH.replace("a.stl", "arm.urdf"))
    message = "expected a mesh with the ending .stl, .obj, .dae"
    assert import_arm(refuse) == f"ikde: {tmp_path / 'arm.urdf'}: {message}\n"


@pytest.mark.skipif(find_spec("trimesh") is None, reason="needs trimesh")
class TestMeshes:
    def refuse_mesh(self, refuse, folder, triangles):
        write(folder, MESH)
        write_stl(folder / "a.stl", np.asarray(triangles))
        return import_arm(refuse).replace(str(folder), "")

    def test_many_triangles(self, refuse, tmp_path, monkeypatch):
        monkeypatch.setattr(mesh_file, "MAX_TRIANGLES", 11)
        said = self.refuse_mesh(refuse, tmp_path, box(1, 1, 1))
        assert said == "ikde: /a.stl: expected at most 11 triangles, got 12\n"

    def test_nan(self, refuse, tmp_path):
        said = self.refuse_mesh(refuse, tmp_path, box(1, 1, np.nan))
        assert said == "ikde: /a.stl: expected finite coordinates, got NaN or infinity\n"

    def test_no_surface(self, refuse, tmp_path):
        said = self.refuse_mesh(refuse, tmp_path, box(1, 0, 0))
        assert said == "ikde: /a.stl: expected a surface, got 12 triangles without area\n"

    def test_noise(self, refuse, tmp_path):
        write(tmp_path, MESH)
        (tmp_path / "a.stl").write_bytes(b"\x00" * 200)
        assert import_arm(refuse).replace(str(tmp_path), "") == (
            "ikde: /a.stl: is no STL that can be read: its header tells of 0 triangles, 84 bytes, but it has 200\n"
        )

    def test_millimetres_are_suspected_and_how_to_scale_is_said(self, cli, tmp_path):
        path = write(tmp_path, MESH)
        write_stl(tmp_path / "a.stl", box(100, 100, 300))
        asked = ("robots", "import", path, "--protrusion", "100")
        warning = "link upper: a.stl is 300 m large; if it is given in mm, use --mesh-scale 0.001"
        said = cli(*asked, "--protrusion", "100000", "--json").data
        assert warning in said["warnings"]
        assert not cli(*asked, "--mesh-scale", "0.001", "--json").data["warnings"]

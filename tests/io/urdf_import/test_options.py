"""What an import is asked for."""

from pathlib import Path

import pytest

from ikde.errors import InputError
from ikde.io.urdf_import.options import ImportOptions, read_holds
from ikde.io.urdf_import.read_urdf import import_urdf, read_urdf


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"base": "legs"}, "base: expected one of urdf, fixed, omni, differential, mecanum, got 'legs'"),
        ({"base_reach_m": 0.0}, "base_reach_m: expected a number above 0, up to 100000 m"),
        ({"mesh_scale": 0.0}, "mesh_scale: expected a number above 0, up to 100000"),
        ({"protrusion_m": -0.1}, "protrusion_m: expected a number above 0"),
        ({"protrusion_m": float("nan")}, "protrusion_m: expected a number above 0"),
        ({"protrusion_m": "20"}, "protrusion_m: expected a number above 0"),
        ({"mesh_scale": True}, "mesh_scale: expected a number above 0"),
        ({"tool": ""}, "tool: expected a link, or links by name, got ''"),
        ({"tool": 5}, "tool: expected a link, or links by name, got 5"),
        ({"tool": {}}, "tool: expected a link, or links by name, got {}"),
        ({"tool": {"left": None}}, "tool: expected a link, or links by name"),
        ({"compare": "ab"}, "compare: expected pairs of links, such as [('base', 'hand')], got 'a'"),
        ({"compare": None}, "compare: expected pairs of links, such as [('base', 'hand')], got None"),
        ({"spheres": None}, "spheres: expected the path of a file, got None"),
        ({"package_paths": "meshes"}, "package_paths: expected paths of folders"),
        ({"tool": ["left"]}, "tool: expected a link, or links by name"),
        ({"hold": ["grip"]}, "hold: expected values by joint"),
        ({"hold": {"grip": "0.1"}}, "hold.grip: expected a number by the name of a joint, got '0.1'"),
    ],
)
def test_wrong_values_are_refused_by_name(options, message):
    with pytest.raises(InputError) as caught:
        ImportOptions(**options)
    assert message in str(caught.value)


def test_held_joints_are_names_with_values():
    assert read_holds(["lift=0.3", "a=b=-1e-3"]) == {"lift": 0.3, "a=b": -0.001}
    assert read_holds([]) == {}


@pytest.mark.parametrize("word", ["lift", "=1", "lift=", "lift=high"])
def test_anything_else_is_refused(word):
    with pytest.raises(InputError, match="hold: expected JOINT=VALUE, in m or rad, got"):
        read_holds([word])


def test_texts_are_paths_as_well():
    options = ImportOptions(srdf="a.srdf", spheres="s.yml", package_paths=["meshes"])
    assert options == ImportOptions(srdf=Path("a.srdf"), spheres=Path("s.yml"), package_paths=(Path("meshes"),))
    with pytest.raises(InputError, match=r"^options: expected ImportOptions, got \{'tool': 'tip'\}"):
        read_urdf("arm.urdf", {"tool": "tip"})


def test_options_are_equal_by_value_and_may_be_keys():
    one, other = ImportOptions(hold={"grip": 0.02}), ImportOptions(hold={"grip": 0.02})
    assert {one: "found"}[other] == "found"
    assert one != ImportOptions(hold={"grip": 0.03})


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"path": 5}, "path: expected the path of a file, got 5"),
        ({"path": b"arm.urdf"}, "path: expected the path of a file"),
        ({"srdf": 5}, "srdf: expected the path of a file, got 5"),
        ({"spheres": None}, "spheres: expected the path of a file, got None"),
        ({"package_paths": "meshes"}, "package_paths: expected paths of folders, such as ['meshes'], got 'meshes'"),
        ({"package_paths": [5]}, "package_paths: expected the path of a file, got 5"),
        ({"package_paths": 5}, "package_paths: expected paths of folders"),
    ],
)
def test_what_is_no_path_is_refused_by_its_argument(arguments, message):
    with pytest.raises(InputError) as caught:
        import_urdf(**{"path": "arm.urdf", **arguments})
    assert str(caught.value).startswith(message)

"""Meshes are found in the URDF's folder and in folders that are named, and nowhere else."""

import os
from pathlib import Path

import pytest

from ikde.errors import FileError
from ikde.io.urdf_import.meshes import find_mesh


@pytest.fixture
def robot(tmp_path):
    """A package as it lies about: `arm/urdf/arm.urdf`, `arm/meshes/a.stl`, and a secret outside."""
    for name in ("arm/urdf/arm.urdf", "arm/urdf/near.stl", "arm/meshes/a.stl", "secret.stl"):
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("solid", encoding="utf-8")
    return tmp_path / "arm" / "urdf" / "arm.urdf"


def reject(urdf, name, message, *folders):
    with pytest.raises(FileError) as caught:
        find_mesh(urdf, name, folders, 7)
    assert message in str(caught.value)
    assert f"{urdf}:7: " in str(caught.value)


def test_a_relative_mesh_lies_beside_the_urdf(robot):
    assert find_mesh(robot, "near.stl", ()) == robot.parent / "near.stl"
    assert find_mesh(robot, "../urdf/near.stl", ()) == robot.parent / "near.stl"
    assert find_mesh(robot, f"file://{robot.parent}/near.stl", ()) == robot.parent / "near.stl"


def test_a_package_is_a_folder_in_one_that_is_named_or_that_folder(robot):
    top, mesh = robot.parents[2], robot.parents[1] / "meshes" / "a.stl"
    for scheme in ("package", "model"):
        assert find_mesh(robot, f"{scheme}://arm/meshes/a.stl", (top,)) == mesh
        assert find_mesh(robot, f"{scheme}://arm/meshes/a.stl", (robot.parents[1],)) == mesh


def test_a_folder_that_the_name_passes_through_holds_what_follows(robot):
    """Part of a package, copied: `package://all/robots/arm/meshes/a.stl` in a folder called arm."""
    arm, mesh = robot.parents[1], robot.parents[1] / "meshes" / "a.stl"
    assert find_mesh(robot, "package://all/robots/arm/meshes/a.stl", (arm,)) == mesh
    shown = min(str(arm), os.path.relpath(arm), key=len)
    reject(robot, "package://all/robots/arm/meshes/a.stl", f"try --package-path {shown}, or --no-spheres")
    reject(robot, "package://all/robots/other/meshes/a.stl", "is not in this folder", arm)
    reject(robot, "package://all/arm/../../secret.stl", "is not in this folder", arm)


def test_a_missing_mesh_names_the_folder_to_give(robot):
    top = robot.parents[2]
    reject(
        robot,
        "package://arm/meshes/a.stl",
        f"is not in this folder; try --package-path {min(str(top), os.path.relpath(top), key=len)}, or --no-spheres",
    )
    reject(robot, "package://other/a.stl", "try --package-path FOLDER, or")
    reject(robot, "package://other/meshes/a.stl", "is not in this folder", robot.parents[1])
    reject(robot, "package://arm/meshes/none.stl", "is not in this folder", top)
    reject(robot, "meshes", "is not in this folder", robot.parents[1])  # a folder is no mesh


@pytest.mark.parametrize("name", ["../meshes/a.stl", "../../secret.stl", "/etc/hostname", "file:///etc/hostname"])
def test_nothing_outside_is_read(robot, name):
    reject(robot, name, "lies outside this folder")


def test_dots_in_a_package_lead_nowhere(robot):
    reject(robot, "package://arm/../../secret.stl", "is not in this folder", robot.parents[1])
    reject(robot, "package://../secret.stl", "is not in this folder", robot.parents[1])


def test_a_link_that_leads_out_is_followed_before_it_is_judged(robot):
    (robot.parent / "link.stl").symlink_to(robot.parents[2] / "secret.stl")
    (robot.parent / "folder").symlink_to(robot.parents[2])
    reject(robot, "link.stl", "lies outside this folder")
    reject(robot, "folder/secret.stl", "lies outside this folder")
    assert find_mesh(robot, "link.stl", (robot.parents[2],)) == robot.parents[2] / "secret.stl"


def test_a_link_in_a_circle_and_a_name_that_is_no_path_are_one_line(robot):
    (robot.parent / "loop.stl").symlink_to(robot.parent / "loop.stl")
    reject(robot, "loop.stl", "")
    reject(robot, "a\0b.stl", "cannot be looked for")
    reject(robot, "x" * 5000, "")


def test_no_mesh_comes_from_the_network(robot):
    reject(robot, "http://example.com/a.stl", "is no file on this machine, and none is fetched")


def test_a_package_path_that_is_not_there_is_one_line(robot):
    for name in ("nowhere", robot.name, "x" * 5000):
        with pytest.raises(FileError, match="package_path: no such folder; expected one with meshes"):
            find_mesh(robot, "near.stl", (robot.parent / name,))


def test_all_of_the_disk_is_never_advised(robot):
    with pytest.raises(FileError) as caught:
        find_mesh(robot, f"package:/{robot.parents[1] / 'meshes' / 'a.stl'}", ())
    assert "--package-path /," not in str(caught.value)


def test_folders_may_be_links_and_the_one_that_we_stand_in(robot, tmp_path, monkeypatch):
    (tmp_path / "away").symlink_to(robot.parents[1])
    mesh = (robot.parents[1] / "meshes" / "a.stl").resolve()
    assert find_mesh(robot, "package://arm/meshes/a.stl", (tmp_path / "away",)) == mesh
    monkeypatch.chdir(robot.parents[1])
    assert find_mesh(robot, "package://arm/meshes/a.stl", (Path(),)) == mesh

"""URDFs by name, out of installed packages."""

from importlib.metadata import PackageNotFoundError
from pathlib import Path

import pytest

from ikde.errors import InputError
from ikde.io.urdf_import import installed
from ikde.io.urdf_import.installed import find_installed


class File:
    def __init__(self, path):
        self._path, self.suffix = path, path.suffix

    def locate(self):
        return self._path


class Distribution:
    def __init__(self, paths):
        self.files = [File(path) for path in paths]


@pytest.fixture
def packages(monkeypatch, tmp_path):
    """Two packages, the second of which has a robot of the first as well."""
    listed = {
        "example-robot-data": ["share/example/arm/urdf/arm.urdf", "share/example/arm/mesh.stl"],
        "rtb-data": ["rtb/arm.urdf", "rtb/leg.urdf"],
    }

    def distribution(name):
        if name not in listed:
            raise PackageNotFoundError
        return Distribution([tmp_path / path for path in listed[name]])

    monkeypatch.setattr(installed, "distribution", distribution)
    return listed


def test_a_name_is_a_urdf_and_the_folders_above_it(packages, tmp_path):
    path, folders = find_installed("arm")
    assert path == tmp_path / "share/example/arm/urdf/arm.urdf"
    assert folders[:3] == (tmp_path / "share/example/arm", tmp_path / "share/example", tmp_path / "share")
    assert Path("/") not in folders or len(path.parents) <= installed.MESHES_WITHIN
    assert find_installed("leg")[0] == tmp_path / "rtb/leg.urdf"


def test_an_unknown_name_is_answered_with_the_nearest(packages):
    with pytest.raises(InputError, match=r"is called 'armm' \(did you mean 'arm'\?\)"):
        find_installed("armm")
    with pytest.raises(InputError, match="is called 'zzz'; they have arm, leg and others"):
        find_installed("zzz")


def test_without_packages_that_is_said(packages):
    packages.clear()
    with pytest.raises(InputError, match="no robot 'arm': no file is called so, and neither example-robot"):
        find_installed("arm")

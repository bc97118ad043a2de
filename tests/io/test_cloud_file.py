"""Point clouds from files: every kind gives the same points; what is wrong is one line, before there is room for it."""

import io
import zipfile

import numpy as np
import pytest

from ikde.errors import FileError, InputError
from ikde.io import cloud_file, cloud_layout
from ikde.io.cloud_file import find_inside, read_cloud

POINTS = np.random.default_rng(1).normal(size=(7, 3)).astype(np.float32).astype(float)
CSV = "n,z,x,y\n" + "".join(f"{k},{p[2]!r},{p[0]!r},{p[1]!r}\n" for k, p in enumerate(POINTS.tolist()))


def npy(array):
    buffer = io.BytesIO()
    np.save(buffer, array)
    return buffer.getvalue()


def npz(**arrays):
    buffer = io.BytesIO()
    np.savez(buffer, **arrays)
    return buffer.getvalue()


@pytest.mark.parametrize(
    ("name", "data", "array"),
    [
        ("a.npy", npy(POINTS), None),
        ("a.npy", npy(POINTS.astype(np.float32)), None),
        ("a.npy", npy(np.asfortranarray(POINTS)), None),
        ("a.npz", npz(p=POINTS), None),
        ("a.NPZ", npz(p=POINTS, colors=POINTS[:, :2]), "p"),
        ("a.csv", CSV.encode(), None),
    ],
)
def test_points_are_read(tmp_path, name, data, array):
    (tmp_path / name).write_bytes(data)
    points = read_cloud(tmp_path, name, array)
    assert points.dtype == np.float64
    assert np.array_equal(points, POINTS)


@pytest.mark.parametrize(
    ("name", "data", "said"),
    [
        ("a.npy", npy(POINTS[:, :2]), r"expected points \[K, 3\], got shape \(7, 2\)"),
        ("a.npy", npy(np.array([["a"] * 3])), "points: expected numbers"),
        ("a.npy", npy(POINTS)[:-8], "are no array of shape"),
        ("a.npy", npy(np.zeros((0, 3))), "from 1 to 20,000,000 points, got 0"),
        ("a.npy", b"nothing", "not an array of numpy"),
        ("a.npz", npz(a=POINTS, b=POINTS), "the key `array` to name one of a, b"),
        ("a.npz", npz(), "to name one of none"),
        ("a.npz", b"PK", "cannot be read"),
        ("a.csv", b"a,b\n1,2\n", "expected columns x, y, z, got 'a', 'b'"),
        ("a.csv", b"x,y,z\n1,2,word\n", "row 1: z: expected a number, got 'word'"),
        ("a.csv", b"", "the first line is empty"),
    ],
)
def test_what_is_no_cloud(tmp_path, name, data, said):
    (tmp_path / name).write_bytes(data)
    with pytest.raises(FileError, match=said) as error:
        read_cloud(tmp_path, name)
    assert str(tmp_path / name) in str(error.value)


def test_objects_are_not_unpickled(tmp_path):
    (tmp_path / "a.npy").write_bytes(npy(np.array([[{}, {}, {}]])))
    with pytest.raises(FileError, match="expected numbers or text"):
        read_cloud(tmp_path, "a.npy")


@pytest.mark.parametrize("name", ["a.npy", "a.npz", "a.csv", "no.ply", "folder.pcd"])
def test_what_is_no_file(tmp_path, name):
    (tmp_path / "folder.pcd").mkdir()
    with pytest.raises(FileError, match=r"no such file|a folder"):
        read_cloud(tmp_path, name)


def test_another_kind_of_file(tmp_path):
    with pytest.raises(InputError, match=r"ends in \.npz, \.npy, \.csv, \.ply, \.pcd, got 'a\.las'"):
        read_cloud(tmp_path, "a.las")


def test_too_many_points_are_refused_before_there_is_room(tmp_path, monkeypatch):
    monkeypatch.setattr(cloud_layout, "MAX_CLOUD_POINTS", 1000)
    (tmp_path / "a.npy").write_bytes(npy(np.zeros((1001, 3), np.int8)))
    monkeypatch.setattr(cloud_file, "as_floats", None)
    with pytest.raises(FileError, match=r"expected from 1 to 1,000 points, got 1,001"):
        read_cloud(tmp_path, "a.npy")


def test_a_packed_bomb_is_refused_by_its_size(tmp_path, monkeypatch):
    """A thousand times larger once it is unpacked."""
    monkeypatch.setenv("IKDE_MAX_FILE_MB", "10")
    header = npy(np.zeros((1, 3))).split(b"\n")[0].replace(b"(1, 3), }", b"(100000000, 3), }")
    with zipfile.ZipFile(tmp_path / "a.npz", "w", zipfile.ZIP_DEFLATED) as archive, archive.open("p.npy", "w") as file:
        file.write(header + b"\n")
        for _ in range(12):
            file.write(bytes(10**6))
    with pytest.raises(FileError, match=r"would take up 12 MB"):
        read_cloud(tmp_path, "a.npz")


@pytest.mark.parametrize("name", ["../a.npy", "/etc/passwd", "link.npy", "sub/../../a.npy", "round"])
def test_a_path_that_leaves_the_folder(tmp_path, name):
    folder = tmp_path / "world"
    (folder / "sub").mkdir(parents=True)
    (tmp_path / "a.npy").write_bytes(npy(POINTS))
    (folder / "link.npy").symlink_to(tmp_path / "a.npy")
    (folder / "round").symlink_to(folder / "round")
    with pytest.raises(InputError, match=r"inside the folder of this one|cannot be looked for|ends in"):
        read_cloud(folder, name)


def test_no_path_at_all(tmp_path):
    with pytest.raises(InputError, match="cannot be looked for"):
        find_inside(tmp_path, "a\0b")
    (tmp_path / "sub").mkdir()
    (tmp_path / "sub" / "a.npy").write_bytes(npy(POINTS))
    assert np.array_equal(read_cloud(tmp_path, "sub/../sub/a.npy"), POINTS)

"""NPZ files: arrays come back as they were, and no archive, however it lies, is more than one line."""

import io
import zipfile

import numpy as np
import pytest

from ikde.errors import FileError
from ikde.formats.npz import NpzTable, parse_npy
from ikde.formats.reading import max_bytes


def npy(array):
    buffer = io.BytesIO()
    np.save(buffer, array, allow_pickle=True)
    return buffer.getvalue()


def archive(packing=zipfile.ZIP_DEFLATED, **members):
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", packing) as file:
        for name, contents in members.items():
            file.writestr(f"{name}.npy", contents)
    return buffer.getvalue()


def claiming(shape, kind="<f8"):
    """An array of 600 bytes that claims to be of this shape."""
    header = f"{{'descr': '{kind}', 'fortran_order': False, 'shape': {shape}, }}".encode()
    return b"\x93NUMPY\1\0" + len(header).to_bytes(2, "little") + header + bytes(512)


def complaint(data, name="p"):
    with pytest.raises(FileError) as caught:
        NpzTable("a.npz", data).read([name])
    assert "\n" not in str(caught.value)
    return str(caught.value)


@pytest.mark.parametrize(
    "array",
    [
        np.arange(12.0).reshape(4, 3),
        np.asfortranarray(np.arange(12.0).reshape(4, 3)),
        np.arange(3, dtype=">i2"),
        np.array(["a", "bc"]),
        np.array(1.5),
        np.zeros((0, 3)),
    ],
)
@pytest.mark.parametrize("save", [np.savez, np.savez_compressed])
def test_arrays_come_back_as_numpy_wrote_them(array, save):
    buffer = io.BytesIO()
    save(buffer, p=array, other=np.zeros(3))
    table = NpzTable("a.npz", buffer.getvalue())
    assert table.names == ["p", "other"]
    np.testing.assert_array_equal(table.read(["p"])["p"], np.atleast_1d(array))


@pytest.mark.parametrize("shape", ["(10000000000, 3)", "(-1, 3)", "(3.0,)", "'3'", "(True,)", "(1, 2)", "(65,)"])
def test_a_shape_that_the_bytes_are_not_is_refused_before_there_is_room_for_it(shape):
    assert complaint(archive(p=claiming(shape))).startswith("a.npz: p: ")


@pytest.mark.parametrize(
    "array", [np.array([{}, 1], dtype=object), np.zeros(2, dtype=[("x", "f8")]), np.zeros(2, dtype="M8[s]")]
)
def test_objects_and_records_are_refused(array):
    assert complaint(archive(p=npy(array))).startswith("a.npz: p: expected numbers or text, got")


@pytest.mark.parametrize("kind", ["O", "|O8", "f99", "V8", "<f8,<f8", "(2,)f8", "U0"])
def test_types_that_are_none_are_refused(kind):
    assert complaint(archive(p=claiming("(64,)", kind))).startswith("a.npz: p: ")


def test_a_pickle_is_never_loaded(tmp_path):
    class Evil:
        def __reduce__(self):
            return (exec, (f"open({str(tmp_path / 'ran')!r}, 'w')",))

    complaint(archive(p=npy(np.array([Evil()], dtype=object))))
    assert not (tmp_path / "ran").exists()


def test_an_archive_inside_an_archive_is_no_array():
    inner = archive(p=npy(np.zeros(3)))
    assert complaint(archive(p=inner)) == "a.npz: p: not an array of numpy, or its header is damaged"


def test_what_unpacks_to_more_than_the_limit_is_refused_by_what_it_says(monkeypatch):
    monkeypatch.setenv("IKDE_MAX_FILE_MB", "1")
    bomb = archive(p=npy(np.zeros(10**6)))
    assert len(bomb) < 10_000
    assert complaint(bomb) == "a.npz: its arrays would take up 8 MB; expected at most 1 MB ($IKDE_MAX_FILE_MB)"


def test_more_than_can_be_packed_into_so_few_bytes_is_refused():
    data = bytearray(archive(p=npy(np.zeros(3))))
    place = data.index(b"PK\1\2") + 24  # of the size that the list of members gives
    data[place : place + 4] = (max_bytes() - 1).to_bytes(4, "little")
    assert complaint(bytes(data)).endswith("bytes do not fit into the file")


def test_a_list_of_very_many_members_is_not_read():
    line = b"PK\1\2" + bytes(42)
    data = line * 100_000
    end = b"PK\5\6" + bytes(4) + (65535).to_bytes(2, "little") * 2 + len(data).to_bytes(4, "little") + bytes(6)
    with pytest.raises(FileError, match=r"a\.npz: cannot be read: too many members"):
        NpzTable("a.npz", data + end)


@pytest.mark.parametrize("packing", [zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA])
def test_other_ways_of_packing_are_refused(packing):
    assert "stored or deflated" in complaint(archive(packing, p=npy(np.zeros(3))))


@pytest.mark.parametrize("header", [b"", b"{", b"{'descr': ", b"(" * 9000, b"-" * 9000 + b"1", b"[]", b"1", b"\xff"])
def test_headers_that_are_none_are_refused(header):
    start = b"\x93NUMPY\1\0" + len(header).to_bytes(2, "little")
    with pytest.raises(ValueError, match="damaged"):
        parse_npy(start + header)


def test_any_cut_and_any_changed_byte_is_an_answer_or_one_line(rng):
    for save in (np.savez, np.savez_compressed):
        buffer = io.BytesIO()
        save(buffer, p=rng.normal(size=(40, 3)))
        for _ in range(150):
            data = bytearray(buffer.getvalue())
            data[rng.integers(len(data))] = rng.integers(256)
            try:
                table = NpzTable("a.npz", bytes(data[: rng.integers(len(data)) if rng.random() < 0.3 else None]))
                table.read(table.names)
            except FileError as error:
                assert "\n" not in str(error)

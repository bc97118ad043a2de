"""Tables give their columns whatever the kind of file, and say in one line what is wrong with it."""

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from ikde.errors import FileError, InputError
from ikde.formats.reading import errors_of
from ikde.formats.tables import as_floats, as_names, open_table

ROWS = "name,x,note\na,1.5,\nb,-2e3,ok\n"


def write(path, kind):
    path = path / f"points.{kind}"
    if kind == "csv":
        path.write_text(ROWS)
    elif kind == "parquet":
        pq.write_table(pa.table({"name": ["a", "b"], "x": [1.5, -2e3], "note": [None, "ok"]}), path)
    else:
        np.savez(path, name=["a", "b"], x=[1.5, -2e3], note=["", "ok"])
    return path


def column(path, name):
    with errors_of(path):
        return open_table(path).read([name])[name]


def complaint(path, name="x"):
    with pytest.raises(InputError) as caught:
        as_floats(path, name, column(path, name))
    assert "\n" not in str(caught.value)
    return str(caught.value).replace(str(path), path.name)


@pytest.mark.parametrize("kind", ["csv", "parquet", "npz"])
def test_every_kind_gives_its_columns(tmp_path, kind):
    path = write(tmp_path, kind)
    assert open_table(path).names == ["name", "x", "note"]
    np.testing.assert_array_equal(as_floats(path, "x", column(path, "x")), [1.5, -2e3])
    assert as_names(path, "name", column(path, "name")) == ("a", "b")


@pytest.mark.parametrize("kind", ["csv", "parquet", "npz"])
def test_text_is_no_number_and_nothing_is_no_name(tmp_path, kind):
    path = write(tmp_path, kind)
    assert "name: expected" in complaint(path, "name")
    with pytest.raises(FileError, match="row 1: note: no value"):
        as_names(path, "note", column(path, "note"))


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("x,y\n1,2\nabc,3\n", "points.csv: row 2: x: expected a number, got 'abc'"),
        ("x,y\n,2\n", "points.csv: row 1: x: expected a number, got ''"),
        ("x,y\n1,2\n\n3\n", "points.csv: row 2: expected 2 values, got 1"),
        ("x,y\n1,2\n3,4,5\n", "points.csv: row 2: expected 2 values, got 3"),
    ],
)
def test_a_wrong_row_of_a_csv_file_is_named(tmp_path, text, expected):
    path = tmp_path / "points.csv"
    path.write_text(text)
    assert complaint(path) == expected


def test_a_csv_file_is_read_as_people_write_it(tmp_path):
    path = tmp_path / "points.csv"
    path.write_bytes("\ufeffx,y\r\n +1.5 ,1\r\n1e3,2\r\n\r\n".encode())
    np.testing.assert_array_equal(as_floats(path, "x", column(path, "x")), [1.5, 1000.0])


def test_whole_numbers_may_turn_into_fractions_far_down(tmp_path):
    path = tmp_path / "points.csv"
    path.write_text("x,other\n" + "1,a\n" * 400_000 + "1.5,2\n")
    assert as_floats(path, "x", column(path, "x"))[-1] == 1.5


def test_a_missing_value_is_named(tmp_path):
    path = tmp_path / "points.parquet"
    pq.write_table(pa.table({"x": [1.0, None]}), path)
    assert complaint(path) == "points.parquet: row 2: x: no value"


def test_columns_of_other_types_are_refused(tmp_path):
    path = tmp_path / "points.parquet"
    pq.write_table(pa.table({"x": [[1.0], [2.0]]}), path)
    assert complaint(path) == "points.parquet: x: expected numbers, got list<element: double>"


@pytest.mark.parametrize("kind", ["csv", "parquet", "npz"])
def test_what_is_no_table_is_refused_in_one_line(tmp_path, kind):
    path = tmp_path / f"points.{kind}"
    path.write_bytes(b"\xff\xfe\x00 nothing \n that is a table")
    assert complaint(path).startswith(f"points.{kind}: ")


def test_missing_files_folders_and_other_kinds_are_refused(tmp_path):
    with pytest.raises(InputError, match=r"path: no such file: .*points\.csv"):
        open_table(tmp_path / "points.csv")
    (tmp_path / "folder.csv").mkdir()
    with pytest.raises(InputError, match="path: this is a folder"):
        open_table(tmp_path / "folder.csv")
    with pytest.raises(InputError, match=r"expected a file that ends in \.csv, \.parquet, \.npz, got 'points\.txt'"):
        open_table(tmp_path / "points.txt")


@pytest.mark.parametrize("text", ["", "\n", "\n1,2,3\n"])
def test_a_csv_file_without_a_header_says_so(tmp_path, text):
    path = tmp_path / "points.csv"
    path.write_text(text)
    with pytest.raises(FileError, match=r"points.csv: the first line is empty; expected the names of the columns$"):
        open_table(path)


def test_a_pipe_and_an_endless_device_are_no_tables(tmp_path):
    (tmp_path / "zero.csv").symlink_to("/dev/zero")
    with pytest.raises(InputError, match="path: this is a pipe, a device or a socket"):
        open_table(tmp_path / "zero.csv")


@pytest.mark.parametrize("kind", ["csv", "parquet", "npz"])
def test_a_file_beyond_the_limit_is_refused_at_the_key_that_names_it(tmp_path, monkeypatch, kind):
    path = write(tmp_path, kind)
    monkeypatch.setenv("IKDE_MAX_FILE_MB", "0.00001")
    with pytest.raises(InputError, match=r"path: \S+ MB; expected at most 1e-05 MB \(\$IKDE_MAX_FILE_MB\): /"):
        open_table(path)


def test_numbers_that_take_up_more_room_than_their_file_are_counted_first(tmp_path, monkeypatch):
    pq.write_table(pa.table({"x": np.zeros(200_000)}), tmp_path / "points.parquet")
    (tmp_path / "points.csv").write_text("x\n" + "0\n" * 200_000)
    np.savez_compressed(tmp_path / "points.npz", x=np.zeros(200_000, np.uint8))
    monkeypatch.setenv("IKDE_MAX_FILE_MB", "1")
    for kind in ("csv", "parquet", "npz"):
        assert "its columns would take up 2 MB; expected at most 1 MB" in complaint(tmp_path / f"points.{kind}")


def test_a_long_word_that_is_written_once_and_meant_often_is_counted_first(tmp_path, monkeypatch):
    path = tmp_path / "points.parquet"
    pq.write_table(pa.table({"x": ["1" * 900] * 10_000}), path)
    assert path.stat().st_size < 10_000
    monkeypatch.setenv("IKDE_MAX_FILE_MB", "1")
    assert "its columns would take up 9 MB" in complaint(path)


def test_words_of_a_parquet_file_are_read_as_numbers_and_as_names(tmp_path):
    path = tmp_path / "points.parquet"
    words = pa.array(["1", "2", "1"])
    pq.write_table(pa.table({"x": words, "y": words.dictionary_encode()}), path)
    for name in ("x", "y"):
        np.testing.assert_array_equal(as_floats(path, name, column(path, name)), [1.0, 2.0, 1.0])
        assert as_names(path, name, column(path, name)) == ("1", "2", "1")


@pytest.mark.parametrize(
    ("header", "words"),
    [
        ("x" * 2 * 10**6, "field larger|the first line is too long"),
        (",".join(["x" * 10**5] * 20), "the first line is too long; expected at most 1,000,000"),
        ("x," * 10_001, "expected at most 10,000 columns, got 10,002"),
    ],
)
def test_the_first_line_of_a_csv_file_has_an_end(tmp_path, header, words):
    path = tmp_path / "points.csv"
    path.write_text(header)
    with pytest.raises(FileError, match=words):
        open_table(path)


@pytest.mark.parametrize("kind", ["csv", "parquet", "npz"])
def test_a_name_without_end_is_no_name(tmp_path, kind):
    path = tmp_path / f"points.{kind}"
    names = ["a", "b" * 1001]
    if kind == "csv":
        path.write_text("n\n" + "\n".join(names))
    elif kind == "npz":
        np.savez(path, n=names)
    else:
        pq.write_table(pa.table({"n": names}), path)
    with pytest.raises(FileError, match=r"row 2: n: expected at most 1,000 characters, got 1,001"):
        as_names(path, "n", column(path, "n"))


def test_letters_that_are_none_are_one_line(tmp_path):
    path = tmp_path / "points.npz"
    np.savez(path, n=np.array([0x110000], dtype="<u4").view("<U1"))
    with pytest.raises(FileError, match="cannot be read"):
        as_names(path, "n", column(path, "n"))


def test_what_a_table_holds_is_quoted_as_text_and_in_few_words(tmp_path):
    path = tmp_path / "points.csv"
    path.write_text("x,y\n" + "\x1b[31m" * 1000 + ",2\n")
    told = complaint(path)
    assert told.startswith("points.csv: row 1: x: expected a number, got '\\x1b[31m")
    assert len(told) < 120
    assert "\x1b" not in told

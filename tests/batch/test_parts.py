"""How a run is cut, and the two files of a part."""

import pyarrow as pa
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ikde.batch.parts import (
    SOLUTIONS,
    TIMING,
    Part,
    list_parts,
    read_finished,
    read_table,
    seal_part,
    serialize,
    write_parts,
)
from ikde.errors import FileError

TABLE = pa.table({"x": [1.0, 2.0], "word": pa.array(["a", None]).dictionary_encode()})
PART = Part("a", 3, 6, 8)


@pytest.fixture
def folder(tmp_path):
    for kind in (SOLUTIONS, TIMING):
        (tmp_path / kind).mkdir()
    return tmp_path


@given(st.integers(0, 100), st.integers(1, 30))
def test_parts_cover_every_solve_of_every_arm_once(solves, chunk):
    parts = list(list_parts(["b", "a"], solves, chunk))
    covered = [(part.arm, solve) for part in parts for solve in range(part.first, part.last)]
    assert covered == [(arm, solve) for arm in "ba" for solve in range(solves)]
    assert all(1 <= part.rows <= chunk for part in parts)
    assert len({(part.arm, part.number) for part in parts}) == len(parts)


def test_a_part_has_a_file_of_each_kind(folder):
    write_parts(folder, [seal_part(PART, TABLE, TABLE.select(["x"]), recipe="ab")])
    assert PART.path(folder, SOLUTIONS) == folder / "solutions" / "a-00003.parquet"
    assert PART.path(folder, TIMING).exists()
    assert read_finished(folder, PART, "ab")


def test_a_table_has_one_form():
    assert serialize(TABLE).to_pybytes() == serialize(pa.table(TABLE.to_pydict(), schema=TABLE.schema)).to_pybytes()


@pytest.mark.parametrize("kind", [SOLUTIONS, TIMING])
@pytest.mark.parametrize("damage", ["gone", "empty", "cut", "no parquet", "too few rows"])
def test_a_damaged_part_is_not_finished(folder, kind, damage):
    write_parts(folder, [seal_part(PART, TABLE, TABLE, recipe="ab")])
    path = PART.path(folder, kind)
    data = path.read_bytes()
    if damage == "gone":
        path.unlink()
    else:
        short = serialize(TABLE.slice(0, 1)).to_pybytes()
        path.write_bytes({"empty": b"", "cut": data[:-9], "no parquet": b"x" * 99, "too few rows": short}[damage])
    assert not read_finished(folder, PART, "ab")


@pytest.mark.parametrize("kind", [SOLUTIONS, TIMING])
def test_no_byte_can_change_unseen(folder, kind):
    write_parts(folder, [seal_part(PART, TABLE, TABLE, recipe="ab")])
    path = PART.path(folder, kind)
    data, table = path.read_bytes(), read_table(path)
    for place in range(len(data)):
        path.write_bytes(data[:place] + bytes([data[place] ^ 4]) + data[place + 1 :])
        if read_finished(folder, PART, "ab"):
            assert kind == TIMING  # its statistics are nobody's answers
            assert read_table(path).equals(table)


def test_a_part_of_another_run_is_not_finished(folder, tmp_path_factory):
    other = tmp_path_factory.mktemp("other")
    for kind in (SOLUTIONS, TIMING):
        (other / kind).mkdir()
    write_parts(folder, [seal_part(PART, TABLE, TABLE, recipe="ab")])
    write_parts(other, [seal_part(PART, TABLE, TABLE, recipe="cd")])
    assert not read_finished(other, PART, "ab")
    PART.path(folder, SOLUTIONS).write_bytes(PART.path(other, SOLUTIONS).read_bytes())
    assert not read_finished(folder, PART, "ab")


def test_a_part_that_cannot_be_written_says_how_to_go_on(tmp_path):
    with pytest.raises(FileError, match=r"a-00003.parquet: cannot be written: No such file.*run the same command"):
        write_parts(tmp_path, [seal_part(PART, TABLE, TABLE, recipe="ab")])

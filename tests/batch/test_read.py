"""A run's answers as one table."""

import numpy as np
import pyarrow as pa
import pytest

import ikde
from ikde.batch.read import read_verdicts
from ikde.errors import FileError
from tests.batch.small import BLINK, make_arm, make_batch

ARMS = (make_arm("z", **BLINK), make_arm("a", detector="none", **BLINK))


@pytest.fixture
def folder(tmp_path):
    ikde.run_batch(make_batch(arms=ARMS), tmp_path)
    return tmp_path


def test_rows_stand_by_arm_target_and_repeat(folder):
    order = [(arm, target, repeat) for arm in "za" for target in range(12) for repeat in range(2)]
    for timing in (False, True):
        table = ikde.read_batch(folder, timing)
        assert list(zip(*(table[name].to_pylist() for name in ("arm", "target", "repeat")), strict=True)) == order
    assert table["solve_seconds"].null_count == 0


def test_verdicts_that_are_null_are_masked(folder):
    read = read_verdicts(pa.chunked_array([[True, None], [False]]))
    assert (read.tolist(), read.data.tolist()) == ([True, None, False], [True, False, False])
    table = ikde.read_batch(folder)
    checked = np.array([row["arm"] == "z" for row in table.to_pylist()])
    assert (~np.ma.getmaskarray(read_verdicts(table["collision"])) == checked).all()


def test_only_finished_parts_are_read(folder):
    for gone in ("z-00001", "a-00004"):
        (folder / "solutions" / f"{gone}.parquet").unlink()
    (folder / "solutions" / ".z-00001.parquet.tmp").write_bytes(b"half")
    assert len(ikde.read_batch(folder)) == len(ikde.read_batch(str(folder), timing=True)) == 48 - 5 - 4


def test_a_word_has_one_code_in_the_whole_table(folder):
    table = ikde.read_batch(folder)
    assert {tuple(chunk.dictionary.to_pylist()) for chunk in table["arm"].chunks} == {("z", "a")}


def test_a_run_without_a_finished_part_says_so(folder):
    for path in (folder / "solutions").iterdir():
        path.unlink()
    with pytest.raises(FileError, match="no part of this run is finished yet"):
        ikde.read_batch(folder)


@pytest.mark.parametrize("name", [".", "nowhere"])
def test_a_folder_that_is_no_run_is_refused(tmp_path, name):
    with pytest.raises(FileError, match="holds no run of ikde"):
        ikde.read_batch(tmp_path / name)


def test_a_damaged_part_is_named(folder):
    (folder / "solutions" / "z-00002.parquet").write_bytes(b"nothing of use")
    with pytest.raises(FileError, match=r"z-00002.parquet: cannot be read; running the batch again redoes this part"):
        ikde.read_batch(folder)

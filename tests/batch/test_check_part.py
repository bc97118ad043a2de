"""A part is what its run makes, or it is refused: pages and summaries count on its columns."""

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

import ikde
from ikde.batch.manifest import make_manifest, write_manifest
from ikde.batch.parts import SOLUTIONS, TIMING, Part, serialize
from ikde.batch.read import read_part
from ikde.batch.summary import summarise
from ikde.errors import FileError
from ikde.report.batch_page.answers import gather_answers
from tests.batch.small import ROBOT, make_batch

ROWS = 5
PART = Part("auto", 1, 5, 10)  # the second of five, of twelve targets twice


def words(*texts):
    return pa.array(texts, pa.string()).dictionary_encode()


def identity(part):
    solves = np.arange(part.first, part.last)
    return {"arm": words(*[part.arm] * part.rows), "target": solves // 2, "repeat": (solves % 2).astype(np.int32)}


def solutions(part=PART, **changes):
    graded = {"reached": [True] * part.rows, "verified": pa.nulls(part.rows, pa.bool_())}
    graded |= {"collision": [False] * part.rows}
    graded |= {"stop_reason": words(*["reached"] * part.rows), "typical_collides": [False] * part.rows}
    return {**identity(part), **graded, "clearance_m": [0.1] * part.rows, **changes}


def timing(part=PART, **changes):
    return {**identity(part), "solve_seconds": [0.1] * part.rows, "host": words(*["here"] * part.rows), **changes}


def make_run(folder, **changes):
    """A run of hand-made parts; `changes` are of one of them."""
    batch = make_batch(graders=(ROBOT.detectors["typical"],))
    manifest = make_manifest(batch)
    write_manifest(folder, manifest)
    for kind, make in ((SOLUTIONS, solutions), (TIMING, timing)):
        (folder / kind).mkdir()
        for part in manifest.list_parts():
            table = make(part, **(changes.get(kind, {}) if part == PART else {}))
            table = {name: column for name, column in table.items() if column is not None}
            part.path(folder, kind).write_bytes(serialize(pa.table(table)))
    return manifest


def test_what_a_run_makes_is_read(tmp_path):
    manifest = make_run(tmp_path)
    assert read_part(tmp_path, manifest, PART, SOLUTIONS)["target"].to_pylist() == [2, 3, 3, 4, 4]
    assert len(ikde.read_batch(tmp_path)) == len(ikde.read_batch(tmp_path, timing=True)) == 24
    assert summarise(tmp_path).unreached == 0
    assert gather_answers(tmp_path).finished


@pytest.mark.parametrize(
    ("changes", "words_of_error"),
    [
        ({"target": None}, "it has no column target"),
        ({"typical_collides": None}, "it has no column typical_collides"),
        ({"target": [2, 3, 3, 4, 10**15]}, "target counts other solves than this part's"),
        ({"target": [2, 3, 3, 4, -1]}, "target counts other solves"),
        ({"target": ["2", "3", "3", "4", "4"]}, "target holds string"),
        ({"reached": [1, 1, 1, 1, 1]}, "reached holds int64"),
        ({"reached": [True, True, None, True, True]}, "reached has no value in some row"),
        ({"stop_reason": ["reached"] * 5}, "stop_reason holds string"),
        ({"stop_reason": words(*["<script>"] * 5)}, "stop_reason holds words that are not among its own"),
        ({"arm": words(*["other"] * 5)}, "arm holds words that are not among its own"),
        ({"hint": words(*["x" * 6000] * 5)}, "hint holds words of more than 5,000 characters"),
        ({"clearance_m": [1e300] * 5}, "clearance_m holds numbers beyond 1e+12"),
        ({"clearance_m": np.full(5, 6e4, np.float16)}, "clearance_m holds halffloat"),
        ({"clearance_m": [[1.0]] * 5}, "clearance_m holds list"),
        ({"clearance_m": [{"x": 1.0}] * 5}, "clearance_m holds struct"),
    ],
)
def test_what_no_run_makes_is_one_line(tmp_path, changes, words_of_error):
    manifest = make_run(tmp_path, solutions=changes)
    with pytest.raises(FileError) as caught:
        read_part(tmp_path, manifest, PART, SOLUTIONS)
    assert str(caught.value).startswith(f"{PART.path(tmp_path, SOLUTIONS)}: is no part of this run: {words_of_error}")


@pytest.mark.parametrize("changes", [{"solve_seconds": None}, {"solve_seconds": words(*"abcde")}])
def test_times_are_checked_as_well(tmp_path, changes):
    make_run(tmp_path, timing=changes)
    for read in (summarise, gather_answers, lambda folder: ikde.read_batch(folder, timing=True)):
        with pytest.raises(FileError, match="is no part of this run"):
            read(tmp_path)


@pytest.mark.parametrize(
    "changes", [{"clearance_m": None}, {"clearance_m": pa.nulls(5, pa.int64())}, {"more": [1] * 5}]
)
def test_parts_of_different_columns_are_one_line_or_an_answer(tmp_path, changes):
    make_run(tmp_path, solutions=changes)
    for read in (gather_answers, ikde.read_batch):
        try:
            read(tmp_path)
        except FileError as error:
            assert "\n" not in str(error)


def test_a_column_that_some_parts_have_is_no_column_of_an_arm(tmp_path):
    make_run(tmp_path, solutions={"clearance_m": None})
    with pytest.raises(FileError, match="its parts of arm auto hold different columns"):
        gather_answers(tmp_path)


def test_a_part_of_other_rows_is_refused(tmp_path):
    manifest = make_run(tmp_path)
    PART.path(tmp_path, SOLUTIONS).write_bytes(serialize(pa.table(solutions(Part("auto", 1, 5, 9)))))
    with pytest.raises(FileError, match="it has 4 rows, not 5"):
        read_part(tmp_path, manifest, PART, SOLUTIONS)


def test_a_part_that_claims_very_many_rows_is_refused_before_there_is_room_for_them(tmp_path, monkeypatch):
    manifest = make_run(tmp_path)
    pq.write_table(pa.table({"target": np.zeros(200_000)}), PART.path(tmp_path, SOLUTIONS))
    monkeypatch.setenv("IKDE_MAX_FILE_MB", "1")
    with pytest.raises(FileError, match="would take up 2 MB"):
        read_part(tmp_path, manifest, PART, SOLUTIONS)


def test_a_part_that_is_a_link_is_not_read(tmp_path):
    manifest = make_run(tmp_path)
    path = PART.path(tmp_path, SOLUTIONS)
    path.rename(tmp_path / "elsewhere.parquet")
    path.symlink_to(tmp_path / "elsewhere.parquet")
    with pytest.raises(FileError, match="cannot be read"):
        read_part(tmp_path, manifest, PART, SOLUTIONS)


def test_words_that_are_no_text_are_one_line(tmp_path):
    binary = pa.array([b"\xff\xfe"])
    text = pa.Array.from_buffers(pa.string(), 1, binary.buffers())
    manifest = make_run(tmp_path, solutions={"hint": pa.DictionaryArray.from_arrays(pa.array([0] * ROWS), text)})
    with pytest.raises(FileError, match="cannot be read"):
        read_part(tmp_path, manifest, PART, SOLUTIONS)

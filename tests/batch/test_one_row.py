"""One row of a run, solved by itself: the same bits as in the run."""

from dataclasses import replace

import pytest

import ikde
from ikde.batch.manifest import read_manifest
from ikde.batch.one_row import Row, compare_row, parse_row, read_row, solve_row
from ikde.errors import FileError, InputError
from tests.batch.small import make_arm, make_batch

BATCH = make_batch(arms=(make_arm("auto"), make_arm("other", detector="typical")), repeats=3, chunk=5)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("row") / "run"
    ikde.run_batch(BATCH, folder)
    return folder


@pytest.mark.parametrize(("text", "row"), [("auto/7/2", Row("auto", 7, 2)), ("auto/7", Row("auto", 7, 0))])
def test_a_row_is_named_by_arm_target_and_repeat(text, row):
    assert parse_row(text) == row
    assert parse_row(str(row)) == row


@pytest.mark.parametrize("text", ["", "auto", "auto/x", "auto/1/2/3", "/1", "auto/-1", "auto/1/²"])
def test_other_names_are_refused(text):
    with pytest.raises(InputError, match="row: expected ARM/TARGET/REPEAT"):
        parse_row(text)


@pytest.mark.parametrize("row", [Row("auto", 0, 0), Row("auto", 7, 2), Row("other", 11, 1)])
def test_a_row_alone_is_that_of_the_run_bit_for_bit(folder, row):
    result, solution = solve_row(BATCH, row)
    there = read_row(folder, read_manifest(folder), row)
    assert there == solution.to_pylist()[0]
    assert (there["target"], there["repeat"]) == (row.target, row.repeat)
    assert [there[f"q_{name}"] for name in result.joint_names] == result.q.tolist()
    assert compare_row(folder, BATCH, row, solution)


def test_another_answer_in_the_run_is_said(folder):
    _, solution = solve_row(BATCH, Row("auto", 7, 1))
    with pytest.raises(FileError, match="holds another answer of auto/7/2"):
        compare_row(folder, BATCH, Row("auto", 7, 2), solution)


def test_a_part_that_is_not_there_compares_with_nothing(folder, tmp_path):
    _, solution = solve_row(BATCH, Row("auto", 0, 0))
    assert not compare_row(tmp_path / "nowhere", BATCH, Row("auto", 0, 0), solution)


@pytest.mark.parametrize(
    ("row", "words"),
    [
        (Row("atuo", 0, 0), "no arm is called 'atuo' (did you mean 'auto'?); there are auto, other"),
        (Row("auto", 12, 0), "there is no target 12; expected 0 to 11"),
        (Row("auto", 0, 3), "there is no repeat 3; expected 0 to 2"),
    ],
)
def test_rows_that_are_not_there_are_refused(row, words):
    with pytest.raises(InputError) as caught:
        solve_row(BATCH, row)
    assert words in str(caught.value)


def test_a_run_of_another_batch_is_refused(folder):
    _, solution = solve_row(BATCH, Row("auto", 0, 0))
    with pytest.raises(FileError):
        compare_row(folder, replace(BATCH, seed=8, recipe={"seed": 8}), Row("auto", 0, 0), solution)

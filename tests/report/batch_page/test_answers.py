"""What a page shows of a run, compared with the table of its answers."""

from collections import Counter

import numpy as np
import pytest

import ikde
from ikde.batch.statistics import Rate
from ikde.errors import FileError
from ikde.report.batch_page import answers as module
from ikde.report.batch_page.answers import gather_answers
from tests.report.batch_page.conftest import NAMES


def of_arm(rows, arm):
    return [row for row in rows if row["arm"] == arm.name]


def first_misses(rows):
    """The first row that was not reached, by target."""
    return {row["target"]: row for row in reversed(rows) if not row["reached"]}


@pytest.mark.parametrize("name", ["target", "reached", "attempts", "position_error_m"])
def test_numbers_are_those_of_the_table(answers, rows, name):
    for arm in answers.arms:
        assert arm.numbers[name].tolist() == [row[name] for row in of_arm(rows, arm)]


@pytest.mark.parametrize("name", ["collision", "verified", "typical_collides", "improved_collides"])
def test_verdicts_are_those_of_the_table(answers, rows, name):
    for arm in answers.arms:
        assert arm.verdicts[name].tolist() == [row[name] for row in of_arm(rows, arm)]


def test_what_was_checked_is_known(answers, rows, unfinished):
    free, careful = answers.arms
    assert (free.collision_checked, careful.collision_checked) == (False, True)
    for arm in answers.arms:
        graded = [row for row in of_arm(rows, arm) if row["verified"] is not None]
        assert arm.verified == Rate(len(graded), len(graded))
        assert 0 < len(graded) < 32
    assert (unfinished.arms[1].collision_checked, unfinished.arms[1].verified) == (None, Rate(0, 0))


def test_seconds_are_those_of_the_timing(answers, folder):
    seconds = ikde.read_batch(folder, timing=True)["solve_seconds"].to_numpy()
    np.testing.assert_array_equal(np.concatenate([arm.numbers["solve_seconds"] for arm in answers.arms]), seconds)


def test_words_are_counted(answers, rows):
    for arm in answers.arms:
        mine = of_arm(rows, arm)
        assert arm.stop_reasons == Counter(row["stop_reason"] for row in mine)
        assert arm.closest_pairs == Counter(
            (row["pair_a"], row["pair_b"]) for row in mine if row["reached"] and row["pair_a"]
        )
        assert arm.rate == Rate(sum(row["reached"] for row in mine), 32)
    assert [bool(arm.closest_pairs) for arm in answers.arms] == [False, True]


def test_clearance_is_there_where_there_is_a_detector(answers, rows):
    free, careful = answers.arms
    assert free.of_reached("clearance_m").size == 0
    assert careful.of_reached("clearance_m").tolist() == [
        row["clearance_m"] for row in of_arm(rows, careful) if row["reached"]
    ]


def test_the_first_miss_of_each_target_is_kept(answers, rows):
    for arm in answers.arms:
        expected = first_misses(of_arm(rows, arm))
        assert arm.missed.keys() == expected.keys()
        assert all(arm.missed[target]["reason"] == row["reason"] for target, row in expected.items())


def test_no_more_targets_are_kept_than_are_listed(folder, monkeypatch):
    monkeypatch.setattr(module, "MAX_MISSED", 1)
    assert [len(arm.missed) for arm in gather_answers(folder).arms] == [1, 1]


def test_names_are_kept_unless_there_are_very_many(answers, bare, folder, monkeypatch):
    assert answers.names == dict(enumerate(NAMES))
    assert bare.names == {}
    monkeypatch.setattr(module, "MAX_NAMED", 3)
    assert gather_answers(folder).names == {}


def test_columns_that_are_not_kept_are_missing(bare):
    (arm,) = bare.arms
    assert set(arm.numbers) == {"target", "repeat", "reached", "solve_seconds"}
    assert arm.of_reached("clearance_m").size == 0
    assert arm.closest_pairs == {}


def test_an_arm_that_has_not_begun_has_no_answers(unfinished):
    free, careful = unfinished.arms
    assert (unfinished.parts_done, unfinished.finished) == (6, False)
    assert (free.rate.total, careful.rate) == (32, Rate(0, 0))
    assert unfinished.rate == free.rate
    assert careful.collides("typical").size == careful.of_reached("solve_seconds").size == 0


def test_a_folder_without_a_run_is_refused(tmp_path):
    with pytest.raises(FileError, match="holds no run of ikde"):
        gather_answers(tmp_path)

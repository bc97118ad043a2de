"""Rates of what was reached, by arm and by target."""

from dataclasses import replace

import numpy as np
import pytest

from ikde.batch.statistics import Rate
from ikde.report.batch_page import success
from ikde.report.batch_page.success import draw_rates, format_rate, make_success
from tests.report.batch_page.blocks import column, figures, tables


@pytest.fixture(scope="module")
def section(answers):
    return make_success(answers)


def test_a_rate_is_shown_with_its_interval():
    assert format_rate(Rate(73, 100)) == "73.0 (63.6–80.7)"
    assert format_rate(Rate(0, 0)) == "–"


def test_rates_are_drawn_unless_nothing_was_counted():
    svg = draw_rates([("a & b", Rate(1, 2)), ("empty", Rate(0, 0))], "reached")
    assert ">a &amp; b</text>" in svg
    assert ">reached [%]</text>" in svg
    assert "empty" not in svg
    assert "<svg" in draw_rates([("empty", Rate(0, 0))], "reached")


def test_every_arm_has_a_row_and_every_reason_a_column(section, answers):
    table = tables(section)[0]
    assert column(table, "arm") == ["free", "careful"]
    assert column(table, "solves") == ["32", "32"]
    assert column(table, "reached") == [str(arm.rate.count) for arm in answers.arms]
    assert column(table, "rate [%]") == [format_rate(arm.rate) for arm in answers.arms]
    assert column(table, "not reached: out of reach") == ["8", "8"]
    for arm, row in zip(answers.arms, table.rows, strict=True):
        assert sum(map(int, row[4:-2])) == arm.rate.total - arm.rate.count
    assert len(figures(section)) == 1


def test_what_was_checked_is_said_with_of_how_many(section, answers, bare, unfinished):
    table = tables(section)[0]
    assert column(table, "self-collision") == ["not checked", "checked"]
    counts = [arm.verified.total for arm in answers.arms]
    assert column(table, "plain numpy agrees") == [f"{count} of {count}" for count in counts]
    arm = replace(bare.arms[0], verdicts={**bare.arms[0].verdicts, "verified": np.ma.masked_all(12, dtype=bool)})
    assert column(tables(make_success(replace(bare, arms=(arm,))))[0], "plain numpy agrees") == ["not checked"]
    assert column(tables(make_success(unfinished))[0], "self-collision") == ["not checked", "–"]


def test_targets_are_told_apart_by_name(section):
    table = tables(section)[1]
    assert table.caption == "By target"
    assert column(table, "name") == ["shelf", "<far|away>", "low", "high"]
    assert column(table, "reached by: free [%]")[1] == format_rate(Rate(0, 8))


def test_of_many_targets_those_that_were_reached_least_often_are_shown(answers, monkeypatch):
    monkeypatch.setattr(success, "MAX_TARGETS", 1)
    table = tables(make_success(answers))[1]
    assert column(table, "target") == ["1"]
    assert "reached least often" in table.caption


def test_one_arm_with_single_solves_has_one_table(bare):
    section = make_success(bare)
    assert [table.rows for table in tables(section)] == [
        (("auto", "12", "0", "0.0 (0.0–24.2)", "12", "checked", "not checked"),)
    ]
    assert figures(section) == []


def test_an_arm_that_has_not_begun_has_no_rate(unfinished):
    section = make_success(unfinished)
    arms, targets = tables(section)
    assert arms.rows[1][:4] == ("careful", "0", "0", "–")
    assert column(targets, "reached by: careful [%]") == ["–"] * 4
    assert figures(section) == []  # one share is no picture

"""The same solutions seen by further detectors."""

from dataclasses import replace

import numpy as np
import pytest

from ikde.batch.statistics import Rate
from ikde.report.batch_page.graders import make_graders
from ikde.report.batch_page.success import format_rate
from tests.report.batch_page.blocks import column, figures, tables


@pytest.fixture(scope="module")
def section(answers):
    return make_graders(answers)


def graded(rows, arm, *graders):
    """The graders' verdicts on the reached solutions of an arm."""
    return [tuple(row[f"{g}_collides"] for g in graders) for row in rows if row["arm"] == arm and row["reached"]]


def test_collisions_are_counted_by_arm_and_grader(section, rows):
    table = tables(section)[0]
    assert len(table.rows) == 4
    for arm, total, grader, count, rate in table.rows:
        verdicts = graded(rows, arm, grader)
        assert (total, count) == (str(len(verdicts)), str(sum(hit for (hit,) in verdicts)))
        assert rate == format_rate(Rate(int(count), int(total)))
    assert table.rows[3][2:4] == ("improved", "0")  # what the search looked at is free


def test_what_a_grader_did_not_check_counts_nowhere(answers):
    arm = answers.arms[0]
    typical = arm.verdicts["typical_collides"].copy()
    typical[np.flatnonzero(arm.reached)[:3]] = np.ma.masked
    blind = replace(arm, verdicts={**arm.verdicts, "typical_collides": typical})
    rates, _, pairs = tables(make_graders(replace(answers, arms=(blind,))))
    left = arm.rate.count - 3
    assert rates.rows[0][1] == str(left)
    assert sum(map(int, pairs.rows[0][3:])) == left
    nothing = replace(arm, verdicts={**arm.verdicts, "typical_collides": np.ma.masked_all(32, dtype=bool)})
    rates = tables(make_graders(replace(answers, arms=(nothing,))))[0]
    assert rates.rows[0][3:] == ("0", "–")


def test_targets_have_a_rate_a_grader(section, answers):
    table = tables(section)[1]
    assert table.caption == "In collision, by target"
    assert "<far|away>" not in column(table, "target")  # nobody reached it
    reached = [sum(map(int, (row[2] for row in table.rows if row[0] == arm.name))) for arm in answers.arms]
    assert reached == [arm.rate.count for arm in answers.arms]


def test_two_graders_are_compared_solution_by_solution(section, rows):
    table = tables(section)[2]
    cases = [(False, False), (False, True), (True, False), (True, True)]
    assert [row[1:3] for row in table.rows] == [("typical", "improved")] * 2
    for arm, a, b, *counts in table.rows:
        verdicts = graded(rows, arm, a, b)
        assert counts == [str(verdicts.count(case)) for case in cases]


def test_rates_are_drawn_with_arm_and_grader(section):
    (figure,) = figures(section)
    assert ">free: typical</text>" in figure.image
    assert ">in collision [%]</text>" in figure.image


def test_one_arm_is_not_named_in_the_drawing(answers):
    (figure,) = figures(make_graders(replace(answers, arms=answers.arms[:1])))
    assert ">typical</text>" in figure.image


def test_an_arm_that_has_not_begun_collides_nowhere(unfinished):
    table = tables(make_graders(unfinished))[0]
    assert [row[3:] for row in table.rows[2:]] == [("0", "–")] * 2


def test_a_run_without_graders_has_no_such_section(bare):
    assert make_graders(bare) is None

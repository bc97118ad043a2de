"""What solves cost, as a table and as curves."""

import numpy as np
import pytest

from ikde.plot.charts import Sample
from ikde.report.batch_page.answers import ArmAnswers
from ikde.report.batch_page.cost import MAX_CURVES, choose_curves, is_wide, make_cost
from ikde.report.numbers import fixed, seconds
from tests.report.batch_page.blocks import column, figures, tables


@pytest.fixture(scope="module")
def section(answers):
    return make_cost(answers)


def test_cost_is_that_of_all_solves(section, answers):
    (table,) = tables(section)
    for k, arm in enumerate(answers.arms):
        attempts, solve_seconds = arm.numbers["attempts"], arm.numbers["solve_seconds"]
        assert column(table, "attempts: median")[k] == fixed(np.median(attempts), 0)
        assert column(table, "attempts: at most")[k] == str(attempts.max())
        assert column(table, "time: median")[k] == seconds(np.median(solve_seconds))
        p95 = seconds(np.percentile(solve_seconds, 95))
        assert column(table, "time: 95 % within")[k] == (p95 if arm.timed_alone else "–")


def test_both_distributions_are_drawn_with_a_curve_an_arm(answers, monkeypatch):
    monkeypatch.setattr(ArmAnswers, "timed_alone", True)
    attempts, time = figures(make_cost(answers))
    for figure, title in ((attempts, "attempts"), (time, "time [ms]")):
        for text in (title, "solves done [%]", "free", "careful"):
            assert f">{text}</text>" in figure.image


def test_times_of_calls_that_several_solves_share_are_not_drawn(answers, monkeypatch):
    monkeypatch.setattr(ArmAnswers, "timed_alone", False)
    section = make_cost(answers)
    assert [figure.alt.split(": ")[1].split(",")[0] for figure in figures(section)] == ["attempts"]
    assert column(tables(section)[0], "time: at most") == ["–"] * len(answers.arms)


def test_what_was_not_kept_is_not_shown_and_nothing_is_drawn_of_nothing(bare):
    section = make_cost(bare)
    assert [column.group for column in tables(section)[0].columns] == ["", "time", "time", "time"]
    assert figures(section) == []


def test_an_arm_that_has_not_begun_costs_nothing(unfinished):
    (table,) = tables(make_cost(unfinished))
    assert table.rows[1] == ("careful", *["–"] * 6)
    assert len(figures(make_cost(unfinished))) >= 1


def test_more_curves_than_looks_are_not_drawn(answers):
    arms = answers.arms[:1] * (MAX_CURVES + 1)
    shown, few = choose_curves(arms)
    assert len(shown) == MAX_CURVES
    assert few == " The first 6 of 7 arms."
    assert choose_curves(answers.arms) == (answers.arms, "")


def test_samples_are_wide_by_their_positive_values():
    assert is_wide([Sample(label="a", values=[0.0, 1.0]), Sample(label="b", values=[31.0])])
    assert not is_wide([Sample(label="a", values=[0.0, 1.0, 30.0])])
    assert not is_wide([Sample(label="a", values=[]), Sample(label="b", values=[0.0])])

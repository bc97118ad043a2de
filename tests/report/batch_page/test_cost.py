"""What solves cost, as a table and as curves."""

import numpy as np
import pytest

from ikde.plot.charts import Sample
from ikde.report.batch_page.cost import MAX_CURVES, choose_curves, is_wide, make_cost
from ikde.report.numbers import fixed, significant
from tests.report.batch_page.blocks import column, figures, tables


@pytest.fixture(scope="module")
def section(answers):
    return make_cost(answers)


def test_cost_is_that_of_all_solves(section, answers):
    (table,) = tables(section)
    for k, arm in enumerate(answers.arms):
        attempts, milliseconds = arm.numbers["attempts"], 1e3 * arm.numbers["solve_seconds"]
        assert column(table, "attempts: median")[k] == fixed(np.median(attempts), 0)
        assert column(table, "attempts: at most")[k] == str(attempts.max())
        assert column(table, "time: 95 % within [ms]")[k] == significant(np.percentile(milliseconds, 95))


def test_both_distributions_are_drawn_with_a_curve_an_arm(section):
    attempts, time = figures(section)
    for figure, title in ((attempts, "attempts"), (time, "time [ms]")):
        for text in (title, "solves done [%]", "free", "careful"):
            assert f">{text}</text>" in figure.image


def test_what_was_not_kept_is_not_shown_and_nothing_is_drawn_of_nothing(bare):
    section = make_cost(bare)
    assert [column.group for column in tables(section)[0].columns] == ["", "time", "time", "time"]
    assert figures(section) == []


def test_an_arm_that_has_not_begun_costs_nothing(unfinished):
    (table,) = tables(make_cost(unfinished))
    assert table.rows[1] == ("careful", *["–"] * 6)
    assert len(figures(make_cost(unfinished))) == 2


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

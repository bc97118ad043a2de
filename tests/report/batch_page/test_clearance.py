"""How good the answers are."""

from dataclasses import replace

import pytest

from ikde.report.batch_page import clearance
from ikde.report.batch_page.clearance import make_clearance
from ikde.report.batch_page.cost import MAX_CURVES
from ikde.report.numbers import length
from tests.report.batch_page.blocks import column, figures, tables


@pytest.fixture(scope="module")
def section(answers):
    return make_clearance(answers)


def test_the_least_clearance_and_the_largest_error_are_shown(section, answers):
    table = tables(section)[0]
    careful = answers.arms[1]
    assert column(table, "detector") == ["none", "improved"]
    assert column(table, "clearance: smallest") == [
        "not checked",
        length(careful.of_reached("clearance_m").min()),
    ]
    assert column(table, "position error: at most") == [
        length(arm.of_reached("position_error_m").max()) for arm in answers.arms
    ]


def test_clearance_is_explained_where_it_is_shown(section, answers):
    assert "spheres" in tables(section)[0].note
    assert tables(make_clearance(replace(answers, arms=answers.arms[:1])))[0].note == ""


def test_what_has_no_error_is_not_shown(section):
    """Targets without an orientation."""
    assert {column.group for column in tables(section)[0].columns} == {"", "clearance", "position error"}
    assert len(figures(section)) == 2


def test_histograms_say_what_they_measure_and_of_whom(section, answers):
    drawn, error = figures(section)
    assert ">clearance [mm]</text>" in drawn.image
    assert ">free</text>" not in drawn.image  # it has no clearance
    assert ">position error [mm]</text>" in error.image
    assert all(f">{arm.name}</text>" in error.image for arm in answers.arms)


def test_the_curves_are_those_of_arms_that_have_something_to_show(answers):
    free, careful = answers.arms
    many = replace(answers, arms=(*[free] * MAX_CURVES, careful))
    assert ">careful</text>" in figures(make_clearance(many))[0].image


def test_closest_pairs_are_shares_of_the_reached(answers, monkeypatch):
    table = tables(make_clearance(answers))[1]
    shares = [float(cell) for cell in column(table, "closest in: careful [%]")]
    assert shares == sorted(shares, reverse=True)
    pairs = answers.arms[1].closest_pairs
    assert sum(shares) == pytest.approx(100.0, abs=0.1 * len(pairs))
    assert set(column(table, "closest in: free [%]")) == {"–"}  # it has no detector, so no pair
    assert " – " in table.rows[0][0]
    monkeypatch.setattr(clearance, "MAX_PAIRS", 1)
    table = tables(make_clearance(answers))[1]
    assert len(table.rows) == 1
    assert table.note == f"{len(pairs) - 1} more pairs are rarer."


def test_a_run_that_reached_nothing_has_no_such_section(bare):
    assert make_clearance(bare) is None

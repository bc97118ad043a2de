"""The section's data: complete, plain, with what each number rests on, and its verdict holds in the tiny report."""

import json

import pytest

from ikde.paper.null_space import load_zhang
from tests.paper.conftest import is_plain


@pytest.fixture(scope="module")
def section(results):
    return results.sections["null_space"]


def test_it_is_plain_and_says_what_each_number_rests_on(section):
    assert is_plain(section)

    def find_unsourced(value):
        if isinstance(value, dict):
            is_sourced = value.get("kind") in ("published", "derived", "calibrated")
            return [] if is_sourced else [found for item in value.values() for found in find_unsourced(item)]
        if isinstance(value, list):
            return [found for item in value for found in find_unsourced(item)]
        return [value]

    exact = section.as_json()["exact"]
    exact.pop("published")
    assert find_unsourced(exact) == []
    assert len(json.dumps(exact)) < 200_000


def test_numbers_are_those_of_the_file(section):
    numbers = load_zhang()
    assert section.published == numbers["published"]
    assert section.settings["calibrated"] == numbers["calibrated"]
    assert numbers["published"]["table_2"]["d_m"][3] == 0.133
    assert numbers["published"]["platform_m"][2] == numbers["calibrated"]["mount_m"][2]


def test_printed_laws_drag_and_exact_ones_do_not(section):
    held = {(row.law, row.first): row.tool_mm for row in section.together if row.run == "tool held"}
    assert held["printed", "platform"] > 100.0
    assert held["exact", "platform"] == pytest.approx(held["exact", "tool"], abs=1e-6)
    assert held["exact", "tool"] < 0.2 * held["printed", "platform"]
    assert len(section.together) == 12


def test_every_way_to_switch_is_there(section):
    laws = [row.law for row in section.conflict]
    assert len(laws) == 15
    assert {row.switch for row in section.conflict} == {"never", "at once", "smoothly", "by (28), 8 to 12"}
    undamped = next(row for row in section.conflict if row.law == "exact, undamped")
    assert undamped.fastest_joint is undamped.tool_m is undamped.jump_joint is None
    assert {row.switch for row in section.switching} == {"at once", "linear", "smooth"}


def test_slip_without_feedback_stays(section):
    lasting = {(row.reading, row.feedback): row for row in section.slipping}
    assert lasting["(14): 1 - s", False].platform_mm > 1000.0
    assert lasting["(15): E + S", False].platform_mm > 1000.0
    assert lasting["no slip", False].platform_mm < 1e-6
    assert lasting["(15): E + S", True].end_mm < 1.0
    assert lasting["(14): 1 - s", True].tool_mm == pytest.approx(52.0, abs=2.0)


def test_curves_have_points(section):
    assert {curve.figure for curve in section.curves} == {"held", "conflict", "singular", "slip"}
    assert all(len(curve.t_s) == len(curve.values) > 3 for curve in section.curves)

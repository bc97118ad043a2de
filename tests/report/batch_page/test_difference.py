"""In a sentence, what differs most."""

from dataclasses import replace
from types import SimpleNamespace

import pytest

from ikde.batch.statistics import Rate
from ikde.report.batch_page.difference import tell_difference


def arm(name, reached, seconds, solves=1000):
    times = {"solve_seconds": [seconds] * 3}
    return SimpleNamespace(name=name, solves=solves, rate=Rate(reached, solves), numbers=times)


MOST = "**a** reaches most, 90.0 %, **b** least, 10.0 %; **b** takes 100 times as long as **a**, 1 ms against 10 µs"
CHANCE = "**a** reaches most, 90.1 %, **b** least, 90.0 %, which may be chance; **a** takes 2.0 times as long as **b**"


@pytest.mark.parametrize(
    ("arms", "words"),
    [
        ([arm("a", 1000, 1e-5), arm("b", 1000, 1e-5)], "All arms reach every target; they take about as long."),
        ([arm("a", 500, 1e-5), arm("b", 500, 1.4e-5)], "All arms reach 50.0 %; they take about as long."),
        ([arm("a", 900, 1e-5), arm("b", 100, 1e-3)], MOST),
        ([arm("a", 901, 2e-5), arm("b", 900, 1e-5)], CHANCE),
    ],
)
def test_rates_first_then_times(arms, words):
    told = tell_difference(SimpleNamespace(arms=arms))
    assert told.startswith(words)


def test_one_arm_differs_from_none(bare, unfinished):
    assert tell_difference(bare) == ""
    assert tell_difference(unfinished) == ""  # the other has not begun
    assert tell_difference(replace(bare, arms=())) == ""

"""Rates with intervals, spreads."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import binomtest

from ikde.batch.statistics import Rate, Spread, compute_spread, wilson


@given(st.integers(1, 10_000).flatmap(lambda total: st.tuples(st.integers(0, total), st.just(total))))
def test_wilson_is_scipys(counts):
    count, total = counts
    theirs = binomtest(count, total).proportion_ci(0.95, method="wilson")
    assert wilson(count, total) == pytest.approx((theirs.low, theirs.high), abs=1e-12)


def test_wilson_of_nothing_and_of_all():
    assert wilson(0, 0) == (0.0, 1.0)
    assert wilson(0, 10)[0] == 0.0
    assert wilson(10, 10)[1] == 1.0


def test_a_rate():
    rate = Rate(30, 40)
    assert rate.share == 0.75
    assert rate.interval == wilson(30, 40)
    assert math.isnan(Rate(0, 0).share)


def test_a_rate_counts_only_what_was_checked():
    verdicts = np.ma.masked_array([True, True, False, True], mask=[False, True, False, False])
    assert Rate.of(verdicts) == Rate(2, 3)
    assert Rate.of(np.ma.masked_array([True], mask=True)) == Rate(0, 0)
    assert Rate(2, 3) + Rate(1, 1) == Rate(3, 4)


def test_a_spread():
    assert compute_spread(np.arange(101)) == Spread(50.0, 95.0, 100.0)
    assert compute_spread([]) is None

"""Table 4: its sums are right, and the shares of the paper's gain add up."""

import math
from dataclasses import asdict, replace

import numpy as np
import pytest

from ikde.paper.rejection import READINGS, RejectionRate, compute_rejection, paired_gain


@pytest.fixture(scope="module")
def small(inputs):
    return replace(inputs, budget=replace(inputs.budget, solves=120, timing_rounds=2))


@pytest.fixture(scope="module")
def table(small):
    return compute_rejection(small)


def samples(table):
    return [sample for target in table.targets for sample in target.samples]


def test_both_sample_sizes_of_both_targets(table):
    assert [sample.solves for sample in samples(table)] == [100, 120, 100, 120]
    assert all(sample.solved <= sample.solves for sample in samples(table))


def test_the_print_stands_beside(table):
    printed = [target.printed for target in table.targets]
    assert [(p["typical"].CN, p["improved"].CN) for p in printed] == [(73, 63), (86, 65)]
    assert printed[0]["typical"].interval_pct == pytest.approx([63.6, 80.7], abs=0.05)


def test_counts_rates_and_pairs_of_verdicts_agree(table):
    for sample in samples(table):
        for paired in sample.paired:
            reading = READINGS[paired.reading]
            typical, improved = (sample.rate(spheres, reading[spheres]).CN for spheres in ("typical", "improved"))
            assert paired.both_reject + paired.only_improved_free == typical
            assert paired.both_reject + paired.only_typical_free == improved
            counts = [value for key, value in asdict(paired).items() if key != "reading"]
            assert sum(counts) == sample.solved


def test_smaller_spheres_over_the_same_pairs_never_reject_more(table):
    for sample in samples(table):
        assert next(p for p in sample.paired if p.reading == "equal").only_typical_free == 0


def test_the_gain_is_split_without_a_rest_in_both_orders(table):
    for sample in samples(table):
        gain = sample.gain
        for order in gain.orders:
            assert sum(step.points for step in order.steps) == pytest.approx(gain.total.points)
        whole = [sample.rate("typical", "non_adjacent"), sample.rate("improved", "formula_22_printed")]
        assert gain.total.points == pytest.approx(whole[0].rejected_pct - whole[1].rejected_pct)


def test_a_paired_gain_has_the_interval_of_paired_proportions():
    before, after = np.array([True] * 60 + [False] * 40), np.array([True] * 45 + [False] * 50 + [True] * 5)
    gain = paired_gain(before, after)  # 15 freed, 5 lost of 100
    margin = 1.959964 * math.sqrt(15 + 5 - 10**2 / 100) / 100
    assert gain.points == pytest.approx(10.0)
    assert gain.interval_points == pytest.approx([100 * (0.1 - margin), 100 * (0.1 + margin)], abs=1e-4)
    assert paired_gain(before, before).interval_points == [0.0, 0.0]


def test_the_printed_gain_is_that_of_two_samples(table):
    gains = [target.printed_gain for target in table.targets]
    assert [gain.points for gain in gains] == pytest.approx([10.0, 21.0])
    margin = 100 * 1.959964 * math.sqrt((0.73 * 0.27 + 0.63 * 0.37) / 100)
    assert gains[0].interval_points == pytest.approx([10 - margin, 10 + margin], abs=1e-3)


def test_the_lists_of_the_unequal_reading_differ_both_ways(table):
    lists = table.settings["lists"]
    assert ["L2", "J5"] in lists["added"]
    assert {("G", "L1"), ("G", "L2"), ("G", "LT")} <= {tuple(pair) for pair in lists["dropped"]}


def test_times_are_of_search_and_detection(table):
    for row in table.measured:
        assert 0.0 < row.search_ms.median <= row.search_ms.max
        assert {cell.spheres for cell in row.detection} == {"typical", "improved"}
        for cell in row.detection:
            low, high = cell.verdict_us.quartiles
            assert 0.0 < low <= cell.verdict_us.median <= high


def test_exact_means_exact(small, table):
    assert compute_rejection(small).as_json()["exact"] == table.as_json()["exact"]


def test_a_rate_is_told_with_its_interval():
    assert RejectionRate(CN=73, SN=100, rejected_pct=73.0, interval_pct=[63.6, 80.73]).text == "73.0 (63.6–80.7)"
    assert RejectionRate(CN=0, SN=0, rejected_pct=None, interval_pct=[0, 100]).text == "–"

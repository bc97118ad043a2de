"""Table 4: its sums are right, and the shares of the paper's gain add up."""

from dataclasses import replace

import pytest

from ikde.bench.budget import QUICK
from ikde.bench.rejection import READINGS, compute_rejection, compute_waiting
from ikde.io.published import load_published

SMALL = replace(QUICK, solves=120, waits=6, timing_rounds=2)


@pytest.fixture(scope="module")
def table(qiao):
    return compute_rejection(qiao, load_published(), SMALL)


def samples(table):
    return [sample for target in table["exact"]["targets"] for sample in target["samples"]]


def rate(sample, spheres, pairs):
    return next(cell for cell in sample["rates"] if (cell["spheres"], cell["pairs"]) == (spheres, pairs))


def test_both_sample_sizes_of_both_targets(table):
    assert [sample["solves"] for sample in samples(table)] == [100, 120, 100, 120]
    assert all(sample["solved"] <= sample["solves"] for sample in samples(table))


def test_the_print_stands_beside(table):
    printed = [target["printed"] for target in table["exact"]["targets"]]
    assert [(p["typical"]["CN"], p["improved"]["CN"]) for p in printed] == [(73, 63), (86, 65)]
    assert printed[0]["typical"]["interval_pct"] == pytest.approx([63.6, 80.7], abs=0.05)


def test_counts_rates_and_pairs_of_verdicts_agree(table):
    for sample in samples(table):
        for paired in sample["paired"]:
            reading = READINGS[paired["reading"]]
            typical, improved = (rate(sample, spheres, reading[spheres])["CN"] for spheres in ("typical", "improved"))
            assert paired["both_reject"] + paired["only_improved_free"] == typical
            assert paired["both_reject"] + paired["only_typical_free"] == improved
            counts = [value for key, value in paired.items() if key != "reading"]
            assert sum(counts) == sample["solved"]


def test_smaller_spheres_over_the_same_pairs_never_reject_more(table):
    for sample in samples(table):
        assert next(p for p in sample["paired"] if p["reading"] == "equal")["only_typical_free"] == 0


def test_the_gain_is_split_without_a_rest(table):
    for sample in samples(table):
        gain = sample["gain"]
        assert gain["spheres_points"] + gain["pairs_points"] == pytest.approx(gain["total_points"])
        whole = [rate(sample, "typical", "non_adjacent"), rate(sample, "improved", "formula_22_printed")]
        assert gain["total_points"] == pytest.approx(whole[0]["rejected_pct"] - whole[1]["rejected_pct"])


def test_times_are_of_search_and_detection(table):
    for row in table["measured"]:
        assert 0.0 < row["search_ms"]["median"] <= row["search_ms"]["max"]
        assert {cell["spheres"] for cell in row["detection"]} == {"typical", "improved"}
        assert all(0.0 < cell["verdict_us"]["median"] < 1e4 for cell in row["detection"])


def test_exact_means_exact(qiao, table):
    assert compute_rejection(qiao, load_published(), SMALL)["exact"] == table["exact"]


def test_waiting_ends_with_a_free_solution(qiao):
    waiting = compute_waiting(qiao, load_published(), SMALL)
    assert len(waiting["exact"]["rows"]) == len(waiting["measured"]["rows"]) == 8
    for row in waiting["exact"]["rows"]:
        assert row["reached"] == row["solves"] == 6
        assert 1 <= row["attempts"]["median"] <= row["attempts"]["max"]

"""The whole report as data: plain, complete, and the same again."""

import json
from pathlib import Path

import numpy as np
import pytest

import ikde
from ikde.bench import paper as module
from ikde.bench.budget import FULL
from ikde.bench.paper import SECTIONS, as_json, check_paper, count_solves, list_differences
from ikde.io.report_folder import RESULTS, read_results
from tests.tiny_paper import TINY, compute_tiny, load_sources

SHIPPED = Path(__file__).parents[2] / "docs" / "paper"


@pytest.fixture(scope="module")
def sources():
    return load_sources()


@pytest.fixture(scope="module")
def record():
    return compute_tiny()[1]


@pytest.fixture(scope="module")
def results():
    return compute_tiny()[0]


def test_every_section_has_its_three_parts(results):
    assert tuple(results["sections"]) == SECTIONS
    assert results["made"]["only"] == list(SECTIONS)
    for section in results["sections"].values():
        assert set(section) == {"exact", "measured", "settings"}


def test_it_is_plain_json(results):
    assert json.loads(json.dumps(results, allow_nan=False)) == results


def test_it_says_how_it_was_made(results):
    made = results["made"]
    assert made["whole"] is False
    assert made["budget"]["solves"] == 3
    assert set(made["section_seconds"]) == set(results["sections"])
    assert made["machine"]["cores"] >= 1
    assert made["versions"]["ikde"] == ikde.__version__


def test_progress_hears_of_every_section_and_every_solve(sources, results, record):
    assert record.sections == list(results["sections"])
    assert record.solves == count_solves(sources, TINY)
    assert count_solves(sources, FULL) > 50_000


def test_what_is_exact_comes_out_again(sources, results):
    assert check_paper(results, sources) == []


def test_a_difference_is_named(sources, results, monkeypatch):
    monkeypatch.setattr(module, "compute_paper", lambda *_, **__: results)
    tampered = json.loads(json.dumps(results))
    tampered["sections"]["approximation"]["exact"]["home"][1]["clearance_mm"] += 0.001
    tampered["sections"]["older"] = tampered["sections"].pop("situations")
    del tampered["sections"]["solutions"]["exact"], tampered["sections"]["solutions"]["measured"]
    lines = check_paper(tampered, sources)
    assert lines[0].startswith("approximation.exact.home[1].clearance_mm: 9.2997")
    assert lines[1:] == ["solutions.exact: not on record", "situations: not on record", "older: only on record"]


@pytest.mark.parametrize(
    ("recorded", "again", "differ"),
    [
        (1.0, 1.0 + 1e-12, False),
        (1.0, 1.0 + 1e-6, True),
        (1, 2, True),
        (1, 1.0, True),
        (True, 1, True),
        ("a", "a", False),
        ([1, 2], [1, 2, 3], True),
        ({"a": 1}, {"b": 1}, True),
        ({"a": [{"b": None}]}, {"a": [{"b": None}]}, False),
        (None, 0.0, True),
    ],
)
def test_plain_data_is_compared_piece_by_piece(recorded, again, differ):
    assert bool(list_differences(recorded, again, "x")) == differ


def test_a_key_that_one_side_lacks_is_named():
    assert list_differences({"a": {"b": 1, "c": 2}}, {"a": {"c": 3, "d": 4}}) == [
        "a.c: 2 on record, 3 now",
        "a.d: not on record",
        "a.b: only on record",
    ]


@pytest.mark.slow
def test_the_record_that_ships_still_holds(sources):
    if not (SHIPPED / RESULTS).exists():
        pytest.skip("no record ships yet")
    assert check_paper(read_results(SHIPPED), sources) == []


def test_numpy_becomes_plain():
    assert as_json({"a": (1, 2), "b": float(np.float64(0.5))}) == {"a": [1, 2], "b": 0.5}

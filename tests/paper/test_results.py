"""The whole report as data: plain, complete, and the same again."""

import json
from dataclasses import asdict, replace
from pathlib import Path

import pytest

import ikde
from ikde.errors import FileError
from ikde.io.report_folder import RESULTS, format_results, write_report
from ikde.paper import results as module
from ikde.paper.inputs import FULL, QUICK
from ikde.paper.results import TOPICS, check_paper, count_solves, list_differences, read_results
from tests.tiny_paper import compute_tiny

SHIPPED = Path(__file__).parents[2] / "docs" / "paper"
RECORD = {"made": {"budget": asdict(QUICK), "only": []}, "sections": {}}


@pytest.fixture(scope="module")
def data(results):
    return results.as_json()


def test_every_section_has_its_three_parts(data):
    assert list(data["sections"]) == data["made"]["only"] == list(TOPICS)
    for section in data["sections"].values():
        assert set(section) == {"exact", "measured", "settings"}


def test_it_is_plain_json(data):
    assert json.loads(json.dumps(data, allow_nan=False)) == data


def test_it_says_how_it_was_made(data):
    made = data["made"]
    assert made["whole"] is False
    assert made["budget"]["solves"] == 3
    assert set(made["section_seconds"]) == set(data["sections"])
    assert made["machine"]["cores"] >= 1
    assert made["versions"]["ikde"] == ikde.__version__


def test_progress_hears_of_every_section_and_every_solve(inputs):
    record = compute_tiny()[1]
    assert record.sections == list(TOPICS)
    assert record.solves == count_solves(inputs)
    assert count_solves(replace(inputs, budget=FULL)) > 50_000


def test_what_is_exact_comes_out_again(inputs, data):
    assert check_paper(data, inputs) == []


def test_a_difference_is_named(inputs, results, data, monkeypatch):
    monkeypatch.setattr(module, "compute_paper", lambda *_, **__: results)
    tampered = json.loads(json.dumps(data))
    tampered["sections"]["approximation"]["exact"]["home"][1]["clearance_mm"] += 0.001
    tampered["sections"]["older"] = tampered["sections"].pop("situations")
    del tampered["sections"]["solutions"]["exact"], tampered["sections"]["solutions"]["measured"]
    lines = check_paper(tampered, inputs)
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
def test_the_record_that_ships_still_holds(inputs):
    assert check_paper(read_results(SHIPPED), replace(inputs, budget=FULL)) == []


def test_a_record_comes_back(tmp_path):
    write_report(tmp_path, {RESULTS: format_results(RECORD)})
    assert read_results(tmp_path) == RECORD


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("{", "not JSON"),
        ("[]", "not a record"),
        ("{}", "not a record"),
        (json.dumps({"made": {"budget": {"solves": 1}}, "sections": {}}), "not a record"),
        (json.dumps({**RECORD, "made": 3}), "not a record"),
        (json.dumps({**RECORD, "sections": None}), "→ sections: expected a mapping, got None"),
        (
            json.dumps({**RECORD, "sections": {"a": {}, "kinematics": 3}}),
            r"→ sections\.kinematics: expected a mapping, got 3",
        ),
    ],
)
def test_something_else_is_no_record(tmp_path, text, words):
    (tmp_path / RESULTS).write_text(text)
    with pytest.raises(FileError, match=words):
        read_results(tmp_path)


@pytest.mark.parametrize("size", [0, -1, 1.0, True, "300", None])
def test_a_sample_size_is_a_whole_number(tmp_path, size):
    budget = asdict(QUICK) | {"solves": size}
    (tmp_path / RESULTS).write_text(json.dumps({**RECORD, "made": {"budget": budget, "only": []}}))
    with pytest.raises(FileError, match=r"→ made\.budget\.solves: expected a whole number of at least 1, got"):
        read_results(tmp_path)


def test_no_record_is_one_line(tmp_path):
    with pytest.raises(FileError, match="no such file"):
        read_results(tmp_path)

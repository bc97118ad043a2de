"""A batch as text and as plain data."""

import json
from dataclasses import replace
from pathlib import Path

import pytest

from ikde.batch.preview import ArmPreview, Preview
from ikde.batch.statistics import Rate, Spread
from ikde.batch.summary import ArmSummary, RunSummary, Unreached
from ikde.report.batch import (
    format_bytes,
    format_preview,
    format_rate,
    format_run,
    format_seconds,
    preview_json,
    run_json,
)

ARM = ArmSummary(
    name="plain [de]",
    method="de",
    detector="none",
    reached=Rate(1999, 2000),
    stop_reasons={"reached": 1999, "out_of_reach": 1},
    attempts=Spread(1.0, 3.0, 12.0),
    milliseconds=Spread(20.0, 30.5, 1234.5),
    collisions={"typical": Rate(30, 1999)},
)
LOST = Unreached(arm="plain [de]", target=3, name="shelf [1]", repeat=2, stop_reason="out_of_reach", reason="too far")
SUMMARY = RunSummary(
    folder=Path("runs/a"),
    name="demo",
    robot="qiao2021",
    seed=1,
    hash="ab",
    parts_done=2,
    parts=2,
    arms=(ARM,),
    unreached=1,
    listed=(LOST,),
)
PREVIEW = Preview(
    name="demo",
    robot="qiao2021",
    targets=1000,
    repeats=1,
    seed=1,
    arms=(ArmPreview(name="auto", method="auto", detector="improved", sample=32, sample_reached=31, seconds=20.0),),
    solves=1000,
    parts=1,
    threads=2,
    columns=("arm", "target"),
    bytes=123456,
)


def test_a_run_opens_with_the_verdict_and_ends_with_what_is_next():
    text = format_run(SUMMARY)
    assert text.startswith("1 of 2,000 solves not reached\n")
    assert text.endswith("answers    runs/a\nnext       ikde report runs/a")


def test_each_arm_has_its_figures():
    text = format_run(SUMMARY)
    row = next(line for line in text.splitlines() if line.strip().startswith("plain [de]"))
    for words in ("1,999 / 2,000", "100.0 % (99.7 to 100.0)", "1 / 3 / 12", "20.0 / 30.5 / 1,230"):
        assert words in row
    assert "30 / 1,999" in text


def test_who_was_not_reached_is_named_with_the_reason():
    text = format_run(replace(SUMMARY, unreached=5))
    assert "not reached: 1 out of reach (arm plain [de])" in text
    assert "  plain [de], target 3 shelf [1], repeat 2: too far" in text
    assert "  and 4 more" in text


def test_without_a_reason_the_word_for_it_is_given():
    assert "repeat 2: out_of_reach" in format_run(replace(SUMMARY, listed=(replace(LOST, reason=None),)))


def test_all_reached_is_said_in_a_line():
    arm = replace(ARM, reached=Rate(1, 1), collisions={}, attempts=None, milliseconds=None)
    text = format_run(replace(SUMMARY, arms=(arm,), unreached=0, listed=()))
    assert text.startswith("all reached: 1 solve\n")
    assert "not reached" not in text
    assert "graded" not in text


def test_json_of_a_run_is_plain_data():
    data = json.loads(json.dumps(run_json(SUMMARY), allow_nan=False))
    assert (data["solves"], data["unreached"], data["folder"]) == (2000, 1, "runs/a")
    assert data["arms"][0]["collisions"]["typical"]["count"] == 30
    assert data["listed"][0]["name"] == "shelf [1]"
    nothing = replace(ARM, reached=Rate(0, 0), collisions={}, attempts=None, milliseconds=None)
    assert run_json(replace(SUMMARY, arms=(nothing,)))["arms"][0]["reached"]["share"] is None


def test_a_preview_says_how_much_and_how_long():
    text = format_preview(PREVIEW)
    assert text.startswith("demo: robot qiao2021, 1,000 targets, 1 repeat, seed 1\n")
    assert "in all     1,000 solves in 1 part, about 20 s on 2 threads" in text
    assert "on disk    about 123 kB" in text
    assert "31 / 32" in text
    assert text.endswith("nothing was written")


def test_json_of_a_preview_is_plain_data():
    data = json.loads(json.dumps(preview_json(PREVIEW), allow_nan=False))
    assert (data["seconds"], data["columns"]) == (20.0, ["arm", "target"])


@pytest.mark.parametrize(
    ("seconds", "words"),
    [
        (0.0123, "0.012 s"),
        (9.0, "9 s"),
        (59.0, "59 s"),
        (200, "3 min 20 s"),
        (18720, "5 h 12 min"),
        (4.3 * 86400, "4 d 7 h"),
    ],
)
def test_times_read_well(seconds, words):
    assert format_seconds(seconds) == words


@pytest.mark.parametrize(
    ("count", "words"), [(0, "0 B"), (999, "999 B"), (70500, "70.5 kB"), (2e9, "2 GB"), (5e15, "5e+03 TB")]
)
def test_sizes_read_well(count, words):
    assert format_bytes(count) == words


def test_a_rate_comes_with_its_interval():
    assert format_rate(Rate(73, 100)) == "73.0 % (63.6 to 80.7)"
    assert format_rate(Rate(0, 0)) == ""

"""A batch as text and as plain data."""

import json
from dataclasses import replace
from pathlib import Path

import pytest

from ikde.batch.arm_summary import ArmSummary, TargetSummary, Unreached
from ikde.batch.preview import ArmPreview, Preview
from ikde.batch.statistics import Rate, Spread
from ikde.batch.summary import RunSummary
from ikde.report.batch import (
    format_preview,
    format_rate,
    format_run,
    format_seconds,
    preview_json,
    run_json,
)

LOST = Unreached(
    arm="plain [de]", target=3, name="shelf [1]", repeat=2, missed=1, stop_reason="out_of_reach", reason="too far"
)
ARM = ArmSummary(
    name="plain [de]",
    method="de",
    detector="none",
    world=None,
    reached=Rate(1999, 2000),
    collision_checked=2000,
    verified=Rate(31, 32),
    stop_reasons={"reached": 1999, "out_of_reach": 1},
    blockers={},
    attempts=Spread(1.0, 3.0, 12.0),
    milliseconds=Spread(20.0, 30.5, 1234.5),
    collisions={"typical": Rate(30, 1999)},
    by_target=(),
    unreached_targets=1,
    listed=(LOST,),
)
SUMMARY = RunSummary(
    folder=Path("runs/a"),
    name="demo",
    robot="qiao2021",
    seed=1,
    hash="ab",
    repeats=4,
    parts_done=2,
    parts=2,
    arms=(ARM,),
)
PREVIEW = Preview(
    name="demo",
    robot="qiao2021",
    targets=1000,
    repeats=1,
    seed=1,
    arms=(
        ArmPreview(
            name="auto",
            method="auto",
            detector="improved",
            sample=32,
            sample_reached=31,
            seconds=20.0,
            load_seconds=1.5,
            compile_seconds=0.0,
        ),
    ),
    solves=1000,
    parts=1,
    threads=2,
    columns=("arm", "target"),
    compiles_again=False,
    bytes=123456,
)


def test_a_run_opens_with_the_verdict_and_ends_with_what_is_next():
    text = format_run(SUMMARY)
    assert text.startswith("1 of 2,000 solves not reached by qiao2021\n")
    assert text.endswith("wrote runs/a (2 parts)\nnext: ikde report runs/a")


def test_each_arm_has_its_figures():
    text = format_run(SUMMARY)
    row = next(line for line in text.splitlines() if line.strip().startswith("plain [de]"))
    for words in ("1,999 / 2,000", "100.0 % (99.7 to 100.0)", "1 / 3 / 12", "20 ms / 30.5 ms / 1.23 s"):
        assert words in row
    assert "30 / 1,999" in text
    assert "31 / 32" in row


def test_what_was_not_checked_is_said():
    blind = replace(ARM, name="blind", collision_checked=0, verified=Rate(0, 0))
    text = format_run(replace(SUMMARY, arms=(ARM, blind)))
    assert text.splitlines()[1] == "self-collision not checked: arm blind"
    assert "not checked" in next(line for line in text.splitlines() if line.strip().startswith("blind"))
    assert "self-collision not checked" not in format_run(SUMMARY)
    many = replace(SUMMARY, arms=tuple(replace(blind, name=f"a{k}") for k in range(12)))
    assert "not checked: arms a0, a1, a2, a3, a4, a5, a6, a7, a8, a9 and 2 more\n" in format_run(many)
    checked, unchecked = run_json(replace(SUMMARY, arms=(ARM, blind)))["arms"]
    assert (checked["collision_checked"], checked["verified"]) == (2000, {"count": 31, "total": 32})
    assert (unchecked["collision_checked"], unchecked["verified"]) == (0, None)


def test_unreached_targets_are_named_with_their_reason():
    text = format_run(SUMMARY)
    assert "not reached: 1 out of reach\n" in text
    assert "  target 3 shelf [1], 1 of 4 repeats, first repeat 2: too far" in text
    assert "  and " not in text
    assert "  target 3 shelf [1]: too far" in format_run(replace(SUMMARY, repeats=1))


def test_of_many_unreached_targets_twenty_are_named():
    many = replace(ARM, unreached_targets=1234, listed=tuple(replace(LOST, target=k) for k in range(30)))
    lines = format_run(
        replace(SUMMARY, arms=(many, replace(ARM, name="other", listed=(replace(LOST, arm="other", target=0),))))
    ).splitlines()
    named = [line for line in lines if "too far" in line]
    assert len(named) == 20
    assert "  and 0 to 1,214 more an arm" in lines
    assert "  and 1,214 more targets" in format_run(replace(SUMMARY, arms=(many,))).splitlines()
    silent = replace(many, listed=())
    assert "  and 1,234 more an arm" in format_run(replace(SUMMARY, arms=(silent, silent))).splitlines()


def test_a_target_is_named_once_for_all_arms_that_missed_it_alike():
    arms = [replace(ARM, name=name, listed=(replace(LOST, arm=name),)) for name in "abc"]
    other = replace(ARM, name="d", stop_reasons={"world": 2}, listed=(replace(LOST, arm="d", reason="shelf"),))
    text = format_run(replace(SUMMARY, repeats=1, arms=(*arms, other)))
    assert "  target 3 shelf [1], arms a, b, c: too far\n  target 3 shelf [1], arm d: shelf\n" in text
    table = [line.split() for line in text.splitlines()]
    assert ["arm", "out", "of", "reach", "world"] in table
    assert ["a", "1", "0"] in table
    assert ["d", "0", "2"] in table
    assert "  target 3 shelf [1]: too far" in format_run(replace(SUMMARY, repeats=1, arms=tuple(arms)))


def test_a_few_targets_are_shown_one_by_one():
    rows = tuple(
        TargetSummary(target=k, name=f"t{k}", reached=Rate(40, 50), collisions={"typical": Rate(10 * k, 40)})
        for k in range(7)
    )
    text = format_run(replace(SUMMARY, arms=(replace(ARM, by_target=rows[:5]),)))
    assert "rates and intervals of just these 5 targets" in text
    row = next(line for line in text.splitlines() if " t2 " in line)
    for words in ("40 / 50", "80.0 % (67.0 to 88.8)", "50.0 % (35.2 to 64.8)"):
        assert words in row
    text = format_run(replace(SUMMARY, arms=(replace(ARM, by_target=rows),)))
    assert "rates and intervals of just these 7 targets" in text
    assert " t2 " not in text
    assert "just these" not in format_run(SUMMARY)


def test_without_a_reason_the_word_for_it_is_given():
    arm = replace(ARM, listed=(replace(LOST, reason=None),))
    assert "repeat 2: out_of_reach" in format_run(replace(SUMMARY, arms=(arm,)))


def test_all_reached_is_said_in_a_line():
    arm = replace(ARM, reached=Rate(1, 1), collisions={}, attempts=None, milliseconds=None, listed=())
    text = format_run(replace(SUMMARY, arms=(arm,)))
    assert text.startswith("all reached by qiao2021: 1 solve\n")
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
    assert "in all     1,000 solves in 1 part, about 22 s on 2 threads, 1.5 s of it to load" in text
    assert "on disk    about 123.5 kB" in text
    assert "31 / 32" in text
    assert text.endswith("nothing was written")


@pytest.mark.parametrize(
    ("compiled", "again", "words"),
    [
        (0.0, False, "nothing: all that the sample needed was compiled already"),
        (0.0, True, "nothing: all that the sample needed was compiled already"),
        (95.0, False, "took 1 min 35 s, is not counted above, and is done: the run need not do it again"),
        (95.0, True, "took 1 min 35 s, is not counted above, and will be done once more"),
    ],
)
def test_a_preview_tells_compiling_apart(compiled, again, words):
    arms = (replace(PREVIEW.arms[0], compile_seconds=compiled),)
    text = format_preview(replace(PREVIEW, arms=arms, compiles_again=again))
    assert f"compiling  {words}\n" in text
    assert "about 22 s on 2 threads, 1.5 s of it to load kernels and seeds\n" in text


def test_json_of_a_preview_is_plain_data():
    data = json.loads(json.dumps(preview_json(PREVIEW), allow_nan=False))
    assert (data["seconds"], data["compile_seconds"], data["columns"]) == (21.5, 0.0, ["arm", "target"])


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


def test_a_rate_comes_with_its_interval():
    assert format_rate(Rate(73, 100)) == "73.0 % (63.6 to 80.7)"
    assert format_rate(Rate(0, 0)) == ""


def test_worlds_and_what_blocked_are_named():
    arm = replace(ARM, world="kitchen [a]", blockers={f"pan {k}": 9 - k for k in range(7)})
    text = format_run(replace(SUMMARY, arms=(arm,)))
    assert "kitchen [a]" in text
    assert "blocked most often by: pan 0 9, pan 1 8, pan 2 7, pan 3 6, pan 4 5 and 2 more\n" in text
    assert "kitchen" not in format_run(SUMMARY)

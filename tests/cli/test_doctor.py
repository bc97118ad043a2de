"""`ikde doctor`."""

import re
from types import SimpleNamespace

import pytest

from ikde import __version__
from ikde.cli.doctor import PACKAGES, describe_machine, judge

FACTS = {
    "ikde",
    "python",
    "machine",
    "cores",
    "usable_cores",
    *PACKAGES,
    "compiling",
    "cache_folder",
    "cache_is_writable",
    "import_seconds",
    "compile_seconds",
    "load_seconds",
    "solve_seconds",
    "solve_reached",
}


def test_json_has_every_fact(cli):
    outcome = cli("doctor", "--json")
    assert outcome.code == 0
    assert set(outcome.data) == FACTS
    assert outcome.data["ikde"] == __version__
    assert outcome.data["solve_reached"] is True
    assert outcome.data["usable_cores"] >= 1


def test_text_names_every_fact(cli):
    outcome = cli("doctor")
    assert outcome.code == 0
    for name in FACTS:
        assert f"\n {name.removesuffix('_seconds').replace('_', ' ')} " in outcome.out
    assert outcome.out.startswith("all good: what this solve needs was compiled before, and the next")
    assert re.search(r"^ cache is writable +yes$", outcome.out, re.MULTILINE)
    assert re.search(r"^ solve +[\d.]+ [µm]s$", outcome.out, re.MULTILINE)


WELL = {
    "solve_reached": True,
    "compiling": "background",
    "cache_is_writable": True,
    "compile_seconds": 0.0,
    "solve_seconds": 2.3e-5,
}


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({}, "all good: what this solve needs was compiled before, and the next one takes 23 µs"),
        ({"compile_seconds": 8.0}, "all good: what this solve needs is compiled now, and need not be again, and"),
        (
            {"cache_is_writable": False},
            "not good: the cache folder cannot be used, so every process compiles anew; set IKDE_CACHE_DIR",
        ),
        ({"compiling": "never", "solve_seconds": 0.0305}, "good, but slow: IKDE_COMPILE=never, so nothing is compiled"),
        ({"solve_reached": False, "cache_is_writable": False}, "not good: a target"),
    ],
)
def test_the_first_line_is_a_verdict(changes, words):
    assert judge(WELL | changes).startswith(words)


def test_the_times_are_told_apart(monkeypatch):
    """Imported in 1 s; of the 8 s of the first call 5 were spent compiling and 1 solving."""
    ticks = iter([10.0, 11.0, 12.0, 20.0])
    answers = iter([SimpleNamespace(compile_seconds=5.0, solve_seconds=1.0)])
    second = SimpleNamespace(compile_seconds=0.0, solve_seconds=0.25, reached=True)
    monkeypatch.setattr("ikde.cli.doctor.time", SimpleNamespace(perf_counter=lambda: next(ticks)))
    monkeypatch.setattr("ikde.solver.solve.solve", lambda *_, **__: next(answers, second))
    facts = describe_machine()
    assert [facts[f"{name}_seconds"] for name in ("import", "compile", "load", "solve")] == [1.0, 5.0, 2.0, 0.25]


def test_an_argument_is_refused(refuse):
    assert "extra" in refuse("doctor", "extra")

"""`ikde doctor`."""

from ikde import __version__
from ikde.cli.machine import PACKAGES, describe_machine

FACTS = {
    "ikde",
    "python",
    "machine",
    "cores",
    "usable_cores",
    *PACKAGES,
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
        assert name.replace("_", " ") in outcome.out


def test_the_times_are_told_apart():
    facts = describe_machine(lambda: None)
    assert facts["compile_seconds"] >= 0.0
    assert facts["load_seconds"] >= 0.0


def test_an_argument_is_refused(refuse):
    assert "extra" in refuse("doctor", "extra")

"""Settings: the defaults of each method, and what is refused."""

from dataclasses import FrozenInstanceError, fields, replace
from typing import get_args

import numpy as np
import pytest

import ikde
from ikde.errors import InputError
from ikde.kernels.mutation import REPAIRS, STRATEGIES
from ikde.solver.engine_table import ENGINES
from ikde.solver.settings import Repair, SolveSettings, Strategy, choose_settings

PAPER = ikde.DeSettings(collision="reject", update="generation")
GOOD = {
    "method": ("auto", "lm", "analytic", "memetic", "de"),
    "restarts": (1, None),
    "timeout_s": (1e-9, 5, 1e9, None),
    "position_tolerance_m": (1e-300, 1, 0.5),
    "orientation_tolerance_rad": (1e-300, 3.0, np.pi),
    "de": (None,),
}
GOOD_OF_DE = {
    "strategy": STRATEGIES,
    "bounds": REPAIRS,
    "update": ("generation", "in_place"),
    "collision": ("reject", "feasibility"),
    "population": (6, 1000),
    "generations": (1,),
    "crossover": (0.0, 0, 1.0, 1),
    "start_share": (1e-9, 0.5, 1, 1.0),
    "weight": (1e-9, 1, 2.5),
}
NO_NUMBERS = (np.nan, np.inf, -np.inf, -1, "1", True)
BAD = {
    "position_tolerance_m": (None, 0, 0.0, *NO_NUMBERS),
    "orientation_tolerance_rad": (3.15, None, 0, *NO_NUMBERS),
    "restarts": (0, 10**9 + 1, 1.0, *NO_NUMBERS),
    "timeout_s": (0, 0.0, *NO_NUMBERS),
    "method": ("", "LM", None, 0),
    "de": ("de", {"population": 50}, 0),
}
BAD_OF_DE = {
    "weight": (None, 0, 0.0, *NO_NUMBERS),
    "crossover": (None, 1.01, *NO_NUMBERS),
    "start_share": (None, 0, 1.01, *NO_NUMBERS),
    "population": (None, 5, 10**5 + 1, 10**30, 50.0, *NO_NUMBERS),
    "generations": (None, 0, 10**9 + 1, 1.0, *NO_NUMBERS),
    **dict.fromkeys(("strategy", "bounds", "update", "collision"), (None, "", "Rand/1", 0)),
}


def cases(table, of_de):
    flat = [(ikde.SolveSettings, name, value) for name, values in table.items() for value in values]
    return [*flat, *((ikde.DeSettings, name, value) for name, values in of_de.items() for value in values)]


def changed(name):
    """Settings of the DE of which one is not its default."""
    default = getattr(ikde.DeSettings(), name)
    return ikde.DeSettings(**{name: next(value for value in GOOD_OF_DE[name] if value != default)})


def test_every_setting_is_tested():
    assert {field.name for field in fields(ikde.SolveSettings)} == set(GOOD) == set(BAD)
    assert {field.name for field in fields(ikde.DeSettings)} == set(GOOD_OF_DE) == set(BAD_OF_DE)


def test_the_papers_method_has_the_papers_numbers():
    settings = ikde.SolveSettings.for_method("de")
    assert (settings.position_tolerance_m, settings.restarts, settings.de) == (5e-5, 1000, PAPER)
    assert (PAPER.strategy, PAPER.population, PAPER.weight, PAPER.crossover) == ("rand/1", 50, 0.5, 0.9)
    assert (PAPER.generations, PAPER.start_share, PAPER.bounds) == (1000, 1.0, "redraw")


@pytest.mark.parametrize("method", ["auto", "lm", "analytic", "memetic"])
def test_ikdes_own_methods_are_finer(method):
    settings = ikde.SolveSettings.for_method(method)
    assert (settings.position_tolerance_m, settings.orientation_tolerance_rad) == (1e-5, 1e-4)
    assert settings == ikde.SolveSettings(method=method)
    assert settings.de is None


@pytest.mark.parametrize("name", ["ga", "", "DE"])
def test_an_unknown_method_is_refused(name):
    with pytest.raises(InputError, match="it is one of auto, lm, analytic, memetic, de"):
        ikde.SolveSettings.for_method(name)


@pytest.mark.parametrize(("kind", "name", "value"), cases(GOOD, GOOD_OF_DE))
def test_good_values_are_kept(kind, name, value):
    assert getattr(kind(**{name: value}), name) == value


@pytest.mark.parametrize(("kind", "name", "value"), cases(BAD, BAD_OF_DE))
def test_bad_values_are_refused_by_name(kind, name, value):
    where = "settings.de" if kind is ikde.DeSettings else "settings"
    with pytest.raises(InputError, match=rf"^{where}\.{name}: expected .*, got ") as caught:
        kind(**{name: value})
    assert "\n" not in str(caught.value)


def test_the_method_de_has_its_defaults():
    assert ikde.SolveSettings(method="de").de == ikde.SolveSettings().evolution == ikde.DeSettings()


@pytest.mark.parametrize("method", ["auto", "lm", "analytic", "memetic"])
@pytest.mark.parametrize("name", GOOD_OF_DE)
def test_an_engine_refuses_what_it_would_ignore(method, name):
    if method in ENGINES and name in ENGINES[method].shared_settings:
        assert ikde.SolveSettings(method=method, de=changed(name)).evolution == changed(name)
        return
    words = rf"^settings\.de\.{name}: `{name}` is a setting of the method de; {method} does not use it"
    with pytest.raises(InputError, match=words) as caught:
        ikde.SolveSettings(method=method, de=changed(name))
    assert str(caught.value).endswith(": ask for the method de") == (method == "auto")


def test_settings_of_the_de_are_refused_even_at_their_defaults():
    with pytest.raises(InputError, match=r"^settings\.de: `de` is a setting of the method de; lm does not use it$"):
        ikde.SolveSettings(method="lm", de=ikde.DeSettings())


def test_settings_of_the_de_do_not_change_the_method():
    with pytest.raises(InputError, match="auto does not use it: ask for the method de"):
        ikde.SolveSettings().with_changes(de={"population": 80})
    assert ikde.SolveSettings().with_changes(method="de", de={"population": 80}).de.population == 80


@pytest.mark.parametrize("method", ["lm", "analytic", "memetic"])
def test_settings_of_the_de_are_refused_by_another_engine_in_a_call(method):
    with pytest.raises(InputError, match=rf"^settings\.de\.population: .* {method} does not use it"):
        choose_settings(ikde.SolveSettings(method="de", de=changed("population")), method)


def test_none_changes_nothing_and_what_is_not_named_stays():
    settings = ikde.SolveSettings.for_method("de").with_changes(de={"population": 8})
    assert settings.de == replace(PAPER, population=8)
    assert settings.with_changes(restarts=None, de=None) == settings.with_changes(de={}) == settings
    assert settings.with_changes(de={"weight": 0.7}).de == replace(PAPER, population=8, weight=0.7)
    assert settings.with_changes(de=ikde.DeSettings()).de == ikde.DeSettings()


def test_a_change_is_checked():
    with pytest.raises(InputError, match=r"settings\.de\.weight"):
        ikde.SolveSettings(method="de").with_changes(de={"weight": -1})


def test_settings_cannot_be_changed_in_place():
    with pytest.raises(FrozenInstanceError):
        ikde.SolveSettings().restarts = 1
    with pytest.raises(FrozenInstanceError):
        ikde.DeSettings().weight = 1.0


def test_defaults_of_the_de_come_and_go_with_the_method():
    paper = SolveSettings(method="de")
    assert paper.with_changes(method="auto") == SolveSettings()
    with pytest.raises(InputError, match="`population` is a setting of the method de; lm does not use it"):
        paper.with_changes(de={"population": 80}).with_changes(method="lm")


def test_an_unknown_setting_of_the_de_is_a_line():
    with pytest.raises(InputError, match=r"no setting of the DE is called 'popul' \(did you mean 'population'\?\)"):
        SolveSettings(method="de").with_changes(de={"popul": 80})


def test_settings_may_be_a_mapping():
    assert choose_settings({"timeout_s": 1.0}, "auto") == SolveSettings(timeout_s=1.0)
    own = choose_settings({"method": "de", "de": {"population": 80}}, "auto")
    assert (own.method, own.evolution.population) == ("de", 80)
    with pytest.raises(InputError, match=r"^settings: no setting is called 'timeot_s' \(did you mean 'timeout_s'\?\)"):
        choose_settings({"timeot_s": 1.0}, "auto")
    with pytest.raises(InputError, match=r"^settings: no setting is called 3; there are method"):
        choose_settings({3: 1.0}, "auto")


def test_the_words_of_type_checkers_are_those_of_the_kernels():
    assert get_args(Strategy) == STRATEGIES
    assert get_args(Repair) == REPAIRS

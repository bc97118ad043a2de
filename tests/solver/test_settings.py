"""Settings: the defaults of each method, and what is refused."""

from dataclasses import FrozenInstanceError, fields, replace

import numpy as np
import pytest

import ikde
from ikde.errors import InputError
from ikde.kernels.mutation import REPAIRS, STRATEGIES
from ikde.solver.settings import HEEDED, KNOBS, choose_settings

GOOD = {
    "method": ("auto", "lm", "analytic", "memetic", "de"),
    "strategy": STRATEGIES,
    "bounds": REPAIRS,
    "update": ("generation", "in_place"),
    "collision": ("reject", "feasibility"),
    "population": (6, 1000),
    "generations": (1,),
    "restarts": (1, None),
    "timeout_s": (1e-9, 5, 1e9, None),
    "crossover": (0.0, 0, 1.0, 1),
    "start_share": (1e-9, 0.5, 1, 1.0),
    "weight": (1e-9, 1, 2.5),
    "position_tolerance_m": (1e-300, 1, 0.5),
    "orientation_tolerance_rad": (1e-300, 3.0, np.pi),
}
NO_NUMBERS = (np.nan, np.inf, -np.inf, -1, "1", True)
BAD = {
    "position_tolerance_m": (None, 0, 0.0, *NO_NUMBERS),
    "orientation_tolerance_rad": (3.15, None, 0, *NO_NUMBERS),
    "weight": (0, 0.0, *NO_NUMBERS),
    "crossover": (1.01, *NO_NUMBERS),
    "start_share": (0, 1.01, *NO_NUMBERS),
    "population": (5, 10**5 + 1, 10**30, 50.0, *NO_NUMBERS),
    "generations": (0, 10**9 + 1, 1.0, *NO_NUMBERS),
    "restarts": (0, 10**9 + 1, 1.0, *NO_NUMBERS),
    "timeout_s": (0, 0.0, *NO_NUMBERS),
    "method": ("", "LM", None, 0),
    **dict.fromkeys(("strategy", "bounds", "update", "collision"), ("", "Rand/1", 0)),
}


def cases(table):
    return [(name, value) for name, values in table.items() for value in values]


def test_every_setting_is_tested():
    assert {field.name for field in fields(ikde.SolveSettings)} == set(GOOD) == set(BAD)


def test_the_papers_method_has_the_papers_numbers():
    settings = ikde.SolveSettings.for_method("de")
    assert (settings.position_tolerance_m, settings.collision, settings.strategy) == (5e-5, "reject", "rand/1")
    assert (settings.population, settings.weight, settings.crossover) == (50, 0.5, 0.9)
    assert (settings.generations, settings.update) == (1000, "generation")


def test_ikdes_own_method_is_finer():
    settings = ikde.SolveSettings.for_method("auto")
    assert (settings.position_tolerance_m, settings.orientation_tolerance_rad) == (1e-5, 1e-4)
    assert {getattr(settings, name) for name in KNOBS} == {None}


@pytest.mark.parametrize("name", ["ga", "", "DE"])
def test_an_unknown_method_is_refused(name):
    with pytest.raises(InputError, match="it is one of auto, lm, analytic, memetic, de"):
        ikde.SolveSettings.for_method(name)


@pytest.mark.parametrize(("name", "value"), cases(GOOD))
def test_good_values_are_kept(name, value):
    assert getattr(ikde.SolveSettings(**{name: value}), name) == value


@pytest.mark.parametrize(("name", "value"), cases(BAD))
def test_bad_values_are_refused_by_name(name, value):
    with pytest.raises(InputError, match=rf"^settings\.{name}: expected .*, got ") as caught:
        ikde.SolveSettings(**{name: value})
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(("name", "default"), KNOBS.items())
def test_a_knob_of_the_de_asks_for_it_even_at_its_default(name, default):
    assert ikde.SolveSettings(**{name: default}) == ikde.SolveSettings(method="de")
    assert ikde.SolveSettings().with_changes(**{name: default}).evolves


def test_what_is_no_knob_of_the_de_leaves_the_method_alone():
    settings = ikde.SolveSettings(restarts=3, position_tolerance_m=1e-3)
    assert settings.method == "auto"
    assert not settings.evolves
    assert not replace(settings, restarts=4).evolves
    assert ikde.SolveSettings(method="de").evolves


@pytest.mark.parametrize("method", ["lm", "analytic", "memetic"])
@pytest.mark.parametrize(("name", "default"), KNOBS.items())
def test_an_engine_refuses_the_knobs_that_it_would_ignore(method, name, default):
    if name in HEEDED.get(method, ()):
        assert getattr(ikde.SolveSettings(method=method, **{name: default}), name) == default
        return
    with pytest.raises(InputError, match=rf"^settings\.{name}: {method} has no such knob"):
        ikde.SolveSettings(method=method, **{name: default})


@pytest.mark.parametrize("method", ["lm", "analytic", "memetic"])
def test_settings_of_the_de_are_refused_by_another_engine_in_a_call(method):
    with pytest.raises(InputError, match=rf"^settings\.population: {method} has no such knob"):
        choose_settings(ikde.SolveSettings(population=8), method)


def test_none_changes_nothing():
    settings = ikde.SolveSettings(population=8)
    assert settings.with_changes(population=None, weight=None) == settings
    assert settings.with_changes(weight=0.7) == ikde.SolveSettings(population=8, weight=0.7)


def test_a_change_is_checked():
    with pytest.raises(InputError, match=r"settings\.weight"):
        ikde.SolveSettings().with_changes(weight=-1)


def test_settings_cannot_be_changed_in_place():
    with pytest.raises(FrozenInstanceError):
        ikde.SolveSettings().weight = 1.0

"""Settings of the methods: what would never end, or means nothing, is refused where it is given."""

import pytest

from ikde.errors import InputError
from ikde.track.settings import ContinuationSettings, OptimizedSettings, TypicalSettings


@pytest.mark.parametrize("kind", [OptimizedSettings, TypicalSettings])
@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"population": 5}, "settings.population: expected a whole number of at least 6, up to 100,000, got 5"),
        (
            {"population": 10**12},
            "settings.population: expected a whole number of at least 6, up to 100,000, got 1000000000000",
        ),
        ({"population": 50.0}, "settings.population: expected a whole number"),
        (
            {"generations": True},
            "settings.generations: expected a whole number of at least 1, up to 1,000,000,000, got True",
        ),
        ({"weight": "much"}, "settings.weight: expected a number from 0 to 2, got 'much'"),
        ({"crossover": 1.1}, "settings.crossover: expected a number from 0 to 1"),
        ({"crossover": float("nan")}, "settings.crossover: expected a number from 0 to 1"),
    ],
)
def test_both_differential_evolutions_check_their_numbers(kind, given, words):
    with pytest.raises(InputError) as caught:
        kind(**given)
    assert str(caught.value).startswith(words)


@pytest.mark.parametrize("strategies", [("best/1",), ("best/1", "worst/1")])
def test_strategies_are_two_that_exist(strategies):
    with pytest.raises(InputError, match="strategies: expected two of rand/1, "):
        OptimizedSettings(strategies=strategies)


@pytest.mark.parametrize(("key", "value"), [("strategy", "worst/1"), ("repair", "wish"), ("rotation_length_m", 0.0)])
def test_what_typical_does_not_know_is_refused(key, value):
    with pytest.raises(InputError, match=f"settings.{key}: expected"):
        TypicalSettings(**{key: value})


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"nullspace_weights": ()}, "settings.nullspace_weights: expected rows of three numbers"),
        ({"nullspace_weights": ((1.0, 0.3),)}, "settings.nullspace_weights: expected rows of three numbers"),
        ({"nullspace_weights": ((1.0, 0.3, -0.1),)}, "settings.nullspace_weights: expected rows of three numbers"),
        ({"nullspace_weights": "abc"}, "settings.nullspace_weights: expected rows of three numbers"),
        ({"nullspace_weights": ((1.0,), (1.0, 2.0))}, "settings.nullspace_weights: expected rows of three numbers"),
        (
            {"max_backtracks": -1},
            "settings.max_backtracks: expected a whole number of at least 0, up to 1,000,000,000, got -1",
        ),
        (
            {"max_backtracks": 2.5},
            "settings.max_backtracks: expected a whole number of at least 0, up to 1,000,000,000, got 2.5",
        ),
    ],
)
def test_continuation_checks_its_numbers(given, words):
    with pytest.raises(InputError) as caught:
        ContinuationSettings(**given)
    assert str(caught.value).startswith(words)

"""The methods that follow a path, and the settings of each, checked where they are given."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ikde.errors import InputError
from ikde.kernels.arrays import DRIFT
from ikde.kernels.mutation import MAX_DRAWN, REPAIRS, STRATEGIES
from ikde.model.numbers import is_number
from ikde.solver.settings import MAX_COUNT, MAX_POPULATION, describe_count, is_count, require
from ikde.track.spec import TRACK_METHODS

Weights = tuple[float, float, float]
NULLSPACE_WEIGHTS: tuple[Weights, ...] = (
    (0.3, 0.3, 0.3),
    (1.0, 0.3, 0.3),
    (0.0, 0.0, 0.0),
    (1.0, 1.0, 0.0),
    (0.3, 1.0, 1.0),
)
MIN_POPULATION = MAX_DRAWN + 1  # a mutation draws that many different members, and not the one it changes


@dataclass(frozen=True, slots=True, kw_only=True)
class ContinuationSettings:
    """How `continuation` uses the null space, and how hard it searches."""

    nullspace_weights: tuple[Weights, ...] = NULLSPACE_WEIGHTS
    """Objectives in the null space beside least motion (17, 19): clearance, joint ranges, manipulability, as shares of
    the largest steps; the first row that leads to the end. (0, 0, 0): least motion alone."""
    max_backtracks: int = 1000
    """How often one search backtracks from dead ends at most, on all its rollouts together."""

    def __post_init__(self) -> None:
        try:
            weights = np.array(self.nullspace_weights, dtype=float)
        except (TypeError, ValueError):
            weights = np.empty(0)
        is_good = weights.ndim == 2 and weights.shape[-1] == DRIFT
        is_good = is_good and bool((np.isfinite(weights) & (weights >= 0.0)).all())
        require(is_good, "nullspace_weights", "rows of three numbers of at least 0", self.nullspace_weights)
        _check_counts(self, {"max_backtracks": 0})


@dataclass(frozen=True, slots=True, kw_only=True)
class OptimizedSettings:
    """Numbers of the paper, and those that it does not print."""

    population: int = 50
    """NP"""
    generations: int = 1000
    """G, of one population."""
    weight: float = 0.5
    """F"""
    crossover: float = 0.9
    """CR"""
    strategies: tuple[str, str] = ("best/1", "rand/1")
    """Of odd and of even generations (31): the text's order, and best/1 as named, from the best member."""
    max_redraws: int = 20
    """How often a sample's population is drawn again at most; the paper has no end."""
    base_weight: float = 0.1
    """W1 of (34), of the square of the base's change, x, y and heading, as in (19). Calibrated, like all weights: with
    1 for W1 and W2 one seed in ten ends in a corner of task 1, with 0.1 none of 30 in any task."""
    arm_weight: float = 0.1
    """W2, of the square of each joint's, as in (17)."""
    position_weight: float = 10.0
    """W3, per m of error: large enough that no motion saved is worth an error."""
    orientation_weight: float = 3.0
    """Per rad of error, which the print forgets: 0.3 m of W3 a radian, as far as the tool is from the wrist."""

    def __post_init__(self) -> None:
        _check_counts(self, {"population": MIN_POPULATION, "generations": 1, "max_redraws": 0})
        weights = ("base_weight", "arm_weight", "position_weight", "orientation_weight")
        _check_numbers(self, {"weight": (0.0, 2.0), "crossover": (0.0, 1.0), **dict.fromkeys(weights, (0.0, 1e6))})
        is_pair = len(self.strategies) == 2 and all(name in STRATEGIES for name in self.strategies)
        require(is_pair, "strategies", f"two of {', '.join(STRATEGIES)}", self.strategies)


@dataclass(frozen=True, slots=True, kw_only=True)
class TypicalSettings:
    """Numbers of the paper, and those that it does not print."""

    population: int = 50
    """NP"""
    generations: int = 1000
    """G"""
    weight: float = 0.5
    """F"""
    crossover: float = 0.9
    """CR"""
    strategy: str = "rand/1"
    """Not printed: the first of the five, and the one that the optimized method alternates with."""
    repair: str = "redraw"
    """Of coordinates that leave their range. Not printed: drawn again, as (24) draws them."""
    base_range_m: float = 0.3
    """How far x and y may be from those of the sample before. Not printed, and the paper's have no limits to draw them
    in. The tool moves some 4 mm a sample: 0.3 m hinders nothing."""
    rotation_length_m: float = 0.3
    """What a radian of error counts beside a metre, as in `OptimizedSettings`; both sink below the position's bound."""

    def __post_init__(self) -> None:
        _check_counts(self, {"population": MIN_POPULATION, "generations": 1})
        _check_numbers(self, {"weight": (0.0, 2.0), "crossover": (0.0, 1.0), "base_range_m": (0.0, 1e5)})
        _check_numbers(self, {"rotation_length_m": (1e-6, 1e6)})
        for name, choices in (("strategy", STRATEGIES), ("repair", REPAIRS)):
            value = getattr(self, name)
            require(value in choices, name, f"one of {', '.join(choices)}", value)


TrackSettings = ContinuationSettings | OptimizedSettings | TypicalSettings
SETTINGS: dict[str, type[TrackSettings]] = {
    "continuation": ContinuationSettings,
    "optimized": OptimizedSettings,
    "typical": TypicalSettings,
}


def check_method(method: str, settings: TrackSettings | None) -> None:
    """Raises `InputError` for an unknown method, and for settings of another one."""
    if method not in TRACK_METHODS:
        raise InputError(f"expected one of {', '.join(TRACK_METHODS)}, got {method!r}", ("method",))
    expected = SETTINGS[method]
    if settings is not None and not isinstance(settings, expected):
        raise InputError(f"method {method}: expected {expected.__name__}, got {type(settings).__name__}", ("settings",))


def _check_counts(settings: Any, minimums: Mapping[str, int]) -> None:
    """Raises `InputError` for what is no whole number, too small, or too large to be meant."""
    for name, fewest in minimums.items():
        value, most = getattr(settings, name), MAX_POPULATION if name == "population" else MAX_COUNT
        require(is_count(fewest, most)(value), name, describe_count(fewest, most), value)


def _check_numbers(settings: Any, bounds: Mapping[str, tuple[float, float]]) -> None:
    """Raises `InputError` for what is no number between two."""
    for name, (low, high) in bounds.items():
        value = getattr(settings, name)
        require(is_number(value) and bool(low <= value <= high), name, f"a number from {low:g} to {high:g}", value)

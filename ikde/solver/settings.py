"""How to search: plain numbers with their defaults, checked once."""

from dataclasses import dataclass, replace
from typing import Literal, get_args

import numpy as np

from ikde.errors import InputError
from ikde.kernels.mutation import LARGEST_DRAW, REPAIRS, STRATEGIES

Method = Literal["auto", "de"]
Collision = Literal["reject", "feasibility"]
Update = Literal["generation", "in_place"]

CHOICES = {"collision": get_args(Collision), "update": get_args(Update), "strategy": STRATEGIES, "bounds": REPAIRS}


@dataclass(frozen=True, slots=True, kw_only=True)
class SolveSettings:
    """Tolerances, and the knobs of the differential evolution (DE).

    Raises:
        InputError: for a tolerance of 0, a population below 6, an unknown strategy, and so on.
    """

    position_tolerance_m: float = 1e-5
    orientation_tolerance_rad: float = 1e-4
    strategy: str = "rand/1"
    """Mutation: one of `kernels.mutation.STRATEGIES`."""
    population: int = 50
    """NP [Qiao2022]."""
    start_share: float = 1.0
    """Share of each joint's range, about its middle, that the first population is drawn from, (0, 1]."""
    weight: float = 0.5
    """F, the differential weight [Qiao2022]."""
    crossover: float = 0.9
    """CR, the crossover rate, [0, 1] [Qiao2022]."""
    generations: int = 1000
    """G, generations of one attempt [Qiao2022]."""
    restarts: int = 40
    """Attempts, each from a new population, before the budget is spent."""
    bounds: str = "redraw"
    """What happens to a coordinate out of its range: drawn again uniformly, clipped, its parent's value, the midpoint
    between parent and bound, or none (then a solution out of range counts as not reached). The paper does not say."""
    update: Update = "in_place"
    """When a better trial replaces its parent: at the end of the generation [Storn1997], or in place."""
    collision: Collision = "feasibility"
    """`reject`: search on the pose error alone, test the best, start again until it is free [Qiao2021].
    `feasibility`: Deb's rules with the penetration depth, inside the selection [Deb2000]."""

    def __post_init__(self) -> None:
        for name in ("position_tolerance_m", "orientation_tolerance_rad", "weight"):
            value = getattr(self, name)
            _require(_is_number(value) and bool(0.0 < value < np.inf), name, "a finite number above 0", value)
        _require(
            _is_number(self.crossover) and bool(0.0 <= self.crossover <= 1.0), "crossover", "0 to 1", self.crossover
        )
        start = self.start_share
        _require(_is_number(start) and bool(0.0 < start <= 1.0), "start_share", "above 0, up to 1", start)
        for name, least in (("population", LARGEST_DRAW + 1), ("generations", 1), ("restarts", 1)):
            value = getattr(self, name)
            whole = isinstance(value, int | np.integer) and not isinstance(value, bool) and value >= least
            _require(bool(whole), name, f"a whole number of at least {least}", value)
        for name, choices in CHOICES.items():
            _require(getattr(self, name) in choices, name, f"one of {', '.join(choices)}", getattr(self, name))

    @classmethod
    def for_method(cls, method: str) -> "SolveSettings":
        """Defaults of a method: `auto` is ikde's choice, `de` the paper's search at the paper's accuracy (5e-5 m)."""
        if method == "auto":
            return cls()
        if method == "de":
            return cls(position_tolerance_m=5e-5, collision="reject", update="generation", restarts=1000)
        raise InputError(f"no method is called {method!r}; expected one of {', '.join(get_args(Method))}", ("method",))

    def with_changes(self, **changes: object) -> "SolveSettings":
        """A copy with some values changed; None leaves a value as it is."""
        return replace(self, **{name: value for name, value in changes.items() if value is not None})  # type: ignore[arg-type]


def _is_number(value: object) -> bool:
    return isinstance(value, int | float | np.number) and not isinstance(value, bool)


def _require(condition: bool, name: str, expected: str, value: object) -> None:
    if not condition:
        raise InputError(f"expected {expected}, got {value!r}", ("settings", name))

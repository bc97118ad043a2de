"""How to search: plain numbers with their defaults, checked once."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any, Literal, get_args

import numpy as np

from ikde.errors import InputError, nearest
from ikde.kernels.mutation import MAX_DRAWN, REPAIRS, STRATEGIES
from ikde.model.numbers import is_number

Method = Literal["auto", "lm", "analytic", "memetic", "de"]
Collision = Literal["reject", "feasibility"]
Update = Literal["generation", "in_place"]

CHOICES = {
    "method": get_args(Method),
    "collision": get_args(Collision),
    "update": get_args(Update),
    "strategy": STRATEGIES,
    "bounds": REPAIRS,
}


@dataclass(frozen=True, slots=True, kw_only=True)
class SolveSettings:
    """Method, tolerances, attempts, and the knobs of the differential evolution (DE), whose defaults are `KNOBS`.

    Raises:
        InputError: for a tolerance of 0, a population below 6, a knob that the method has not, and so on.
    """

    method: Method = "auto"
    """The engine: `lm`, damped least squares from collision-free seeds; `analytic`, the closed form of a UR-type arm;
    `memetic`, a DE that adapts itself and is polished; `de`, that of the papers. `auto` takes the fastest that fits and
    falls back on `memetic`; if a knob of the DE is set, it becomes `de`."""
    position_tolerance_m: float = 1e-5
    """Above 0."""
    orientation_tolerance_rad: float = 1e-4
    """At most pi: no two orientations are farther apart."""
    restarts: int | None = None
    """Attempts before the budget is spent; None for the engine's own number (`RESTARTS`). Under `auto` it is
    that of the engine that comes last."""
    timeout_s: float | None = None
    """Seconds of search, compiling not counted, after which no further attempt at a target is begun; what is reached by
    then stays. Answers may then depend on the machine and on what else it does. None: on nothing but the attempts."""
    strategy: str | None = None
    """Mutation: one of `kernels.mutation.STRATEGIES`."""
    population: int | None = None
    """NP [Qiao2022]."""
    start_share: float | None = None
    """Share of each joint's range, about its middle, that the first population is drawn from, (0, 1]."""
    weight: float | None = None
    """F, the differential weight [Qiao2022]."""
    crossover: float | None = None
    """CR, the crossover rate, [0, 1] [Qiao2022]."""
    generations: int | None = None
    """G, generations of one attempt [Qiao2022]."""
    bounds: str | None = None
    """What happens to a coordinate out of its range: drawn again uniformly, clipped, its parent's value, the midpoint
    between parent and bound, or none (then a solution out of range counts as not reached). The paper does not say."""
    update: Update | None = None
    """When a better trial replaces its parent: at the end of the generation [Storn1997], or in place."""
    collision: Collision | None = None
    """`reject`: search on the pose error alone, test the best, start again until it is free [Qiao2021].
    `feasibility`: Deb's rules with the penetration depth, inside the selection [Deb2000]."""

    def __post_init__(self) -> None:
        for name, (is_good, expected) in TOLERANCES.items():
            value = getattr(self, name)
            require(is_number(value) and bool(is_good(value)), name, expected, value)
        for name, (is_good, expected) in OPTIONAL.items():
            value = getattr(self, name)
            require(value is None or is_good(value), name, expected, value)
        for name, choices in CHOICES.items():
            value = getattr(self, name)
            require(value in choices or (value is None and name in KNOBS), name, f"one of {', '.join(choices)}", value)
        self._settle_knobs()

    def _settle_knobs(self) -> None:
        """A knob under `auto` asks for `de`, whose other knobs take their defaults; other engines refuse it."""
        given = [name for name in KNOBS if getattr(self, name) is not None]
        if given and self.method == "auto":
            object.__setattr__(self, "method", "de")
        if self.method == "de":
            for name in KNOBS:
                object.__setattr__(self, name, self.knob(name))
            return
        refused = [name for name in given if name not in HEEDED.get(self.method, ())]
        if refused:
            own = next((name for name in refused if getattr(self, name) != KNOBS[name]), refused[0])
            raise InputError(f"{self.method} has no such knob; it is one of the method de", ("settings", own))

    @staticmethod
    @lru_cache
    def for_method(method: str) -> "SolveSettings":
        """Defaults of a method: 1e-5 m and 1e-4 rad; of `de` the paper's search at the paper's accuracy (5e-5 m)."""
        if method not in get_args(Method):
            known = ", ".join(get_args(Method))
            raise InputError(
                f"no method is called {method!r}{nearest(method, get_args(Method))}; it is one of {known}", ("method",)
            )
        if method == "de":
            return SolveSettings(
                method="de", position_tolerance_m=5e-5, collision="reject", update="generation", restarts=1000
            )
        return SolveSettings(method=method)  # type: ignore[arg-type]

    @property
    def evolves(self) -> bool:
        """True if the DE is what searches: asked for by name, or by one of its knobs."""
        return self.method == "de"

    def knob(self, name: str) -> Any:
        """A knob of the DE, or its default."""
        value = getattr(self, name)
        return KNOBS[name] if value is None else value

    def budget(self, engine: str) -> int:
        """Attempts of one engine before it gives up."""
        return self.restarts or RESTARTS[engine]

    def with_changes(self, **changes: object) -> "SolveSettings":
        """A copy with some values changed; None leaves a value as it is."""
        return replace(self, **{name: value for name, value in changes.items() if value is not None})  # type: ignore[arg-type]


def is_count(least: int, most: int) -> Callable[[Any], bool]:
    """A test for whole numbers of at least and at most so many."""
    return lambda value: (
        isinstance(value, int | np.integer) and not isinstance(value, bool) and bool(least <= value <= most)
    )


def describe_count(least: int, most: int) -> str:
    """What such a test asks for."""
    return f"a whole number of at least {least}, up to {most:,}"


def require(condition: bool, name: str, expected: str, value: object) -> None:
    """Raise `InputError` about a setting unless the condition holds."""
    if not condition:
        raise InputError(f"expected {expected}, got {value!r}", ("settings", name))


def check_seed(seed: int) -> int:
    """Return the seed; raises `InputError` unless it is a whole number, 0 <= seed < 2^64."""
    if type(seed) is int and 0 <= seed < 2**64:  # the common case at half a microsecond less
        return seed
    if not isinstance(seed, int | np.integer) or isinstance(seed, bool) or not 0 <= seed < 2**64:
        raise InputError(f"expected a whole number from 0 to 2^64 - 1, got {seed!r}", ("seed",))
    return int(seed)


def check_stream(stream: int) -> int:
    """Return the stream; raises `InputError` unless it is a whole number, 0 <= stream < 2^63."""
    if type(stream) is int and 0 <= stream < 2**63:
        return stream
    is_whole = isinstance(stream, int | np.integer) and not isinstance(stream, bool)
    if not (is_whole and 0 <= stream < 2**63):
        raise InputError(f"expected a whole number from 0 to 2^63 - 1, got {stream!r}", ("stream",))
    return int(stream)


def choose_settings(settings: SolveSettings | None, method: str) -> SolveSettings:
    """The settings, or the method's own; a wrong name is an error either way."""
    own = SolveSettings.for_method(method)
    if settings is None:
        return own
    return settings if method == "auto" else settings.with_changes(method=method)


MOST = 10**9
"""Of what is counted one by one."""
MOST_MEMBERS = 10**5
"""Of a population, which is all in memory."""
RESTARTS = {"de": 40, "lm": 1000, "analytic": 1000, "memetic": 20}
KNOBS: Mapping[str, Any] = {
    "strategy": "rand/1",
    "population": 50,
    "start_share": 1.0,
    "weight": 0.5,
    "crossover": 0.9,
    "generations": 1000,
    "bounds": "redraw",
    "update": "in_place",
    "collision": "feasibility",
}
"""Those of the DE, with their defaults."""
HEEDED = {"memetic": ("bounds", "collision")}
"""Knobs that another engine heeds as well."""
TOLERANCES: Mapping[str, tuple[Callable[[Any], bool], str]] = {
    "position_tolerance_m": (lambda value: 0.0 < value < np.inf, "a finite number above 0"),
    "orientation_tolerance_rad": (lambda value: 0.0 < value <= np.pi, "a number above 0, at most pi"),
}
OPTIONAL: Mapping[str, tuple[Callable[[Any], bool], str]] = {
    "restarts": (is_count(1, MOST), describe_count(1, MOST)),
    "timeout_s": (lambda value: is_number(value) and 0.0 < value < np.inf, "a finite number above 0"),
    "population": (is_count(MAX_DRAWN + 1, MOST_MEMBERS), describe_count(MAX_DRAWN + 1, MOST_MEMBERS)),
    "generations": (is_count(1, MOST), describe_count(1, MOST)),
    "weight": (lambda value: is_number(value) and 0.0 < value < np.inf, "a finite number above 0"),
    "crossover": (lambda value: is_number(value) and 0.0 <= value <= 1.0, "0 to 1"),
    "start_share": (lambda value: is_number(value) and 0.0 < value <= 1.0, "above 0, up to 1"),
}
"""Numbers that may be left out: what is accepted, and how it is asked for."""

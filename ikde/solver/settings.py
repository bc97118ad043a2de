"""How to search: plain numbers with their defaults, checked once."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields, replace
from functools import lru_cache
from typing import Any, Literal, get_args

import numpy as np

from ikde.errors import InputError, nearest, quoted
from ikde.kernels.mutation import MAX_DRAWN, REPAIRS, STRATEGIES, Repair, Strategy
from ikde.model.numbers import is_number
from ikde.solver.engine_table import AUTO, ENGINES, Method

Collision = Literal["reject", "feasibility"]
Update = Literal["generation", "in_place"]
Verify = Literal["all", "sample", "none"]
Rule = tuple[Callable[[Any], bool], str]
"""What is accepted, and how it is asked for."""

MAX_COUNT = 10**9
"""Of what is counted one by one."""
MAX_POPULATION = 10**5
"""Members, which are all in memory."""


@dataclass(frozen=True, slots=True, kw_only=True)
class DeSettings:
    """Settings of the differential evolution (DE), the method `de`.

    Raises:
        InputError: for a population below 6, a crossover rate above 1, and so on.
    """

    strategy: Strategy = "rand/1"
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
    bounds: Repair = "redraw"
    """What happens to a coordinate out of its range: drawn again uniformly, clipped, its parent's value, the midpoint
    between parent and bound, or none (then a solution out of range counts as not reached). The paper does not say."""
    update: Update = "in_place"
    """When a better trial replaces its parent: at the end of the generation [Storn1997], or in place."""
    collision: Collision = "feasibility"
    """`reject`: search on the pose error alone, test the best, start again until it is free [Qiao2021].
    `feasibility`: Deb's rules with the penetration depth, inside the selection [Deb2000]."""

    def __post_init__(self) -> None:
        check_rules(self, DE_RULES, ("settings", "de"))


@dataclass(frozen=True, slots=True, kw_only=True)
class SolveSettings:
    """Method, tolerances, attempts, and the settings that belong to the method.

    Raises:
        InputError: for a tolerance of 0, settings of a method that is not the one asked for, and so on.
    """

    method: Method = "auto"
    """The engine: `lm`, damped least squares from collision-free seeds; `analytic`, the closed form of a UR-type arm;
    `memetic`, a DE that adapts itself and is polished; `de`, that of the papers. `auto` takes the fastest that fits and
    falls back on `memetic`."""
    position_tolerance_m: float = 1e-5
    """Above 0."""
    orientation_tolerance_rad: float = 1e-4
    """At most pi: no two orientations are farther apart."""
    restarts: int | None = None
    """Attempts before the budget is spent; None for the engine's own number (`EngineRow.attempts`). Under `auto` it is
    that of the engine that comes last."""
    timeout_s: float | None = None
    """Seconds of search, compiling not counted, after which no further attempt at a target is begun; what is reached by
    then stays. Answers may then depend on the machine and on what else it does. None: on nothing but the attempts."""
    de: DeSettings | None = None
    """Of the method `de`, which has its defaults if left out. Of another method None; but `memetic` uses `bounds` and
    `collision`."""

    def __post_init__(self) -> None:
        check_rules(self, RULES, ("settings",))
        if self.de is None and self.method == "de":
            object.__setattr__(self, "de", DeSettings())
        elif self.de is not None and self.method != "de":
            self._refuse_unused(self.de)

    def _refuse_unused(self, given: DeSettings) -> None:
        shared = ENGINES[self.method].shared_settings if self.method in ENGINES else ()
        changed = [f.name for f in fields(given) if f.name not in shared and getattr(given, f.name) != f.default]
        if changed or not shared:
            ask = ": ask for the method de" if self.method == "auto" else ""
            message = f"`{(changed or ['de'])[0]}` is a setting of the method de; {self.method} does not use it{ask}"
            raise InputError(message, ("settings", "de", *changed[:1]))

    @staticmethod
    @lru_cache
    def for_method(method: str) -> "SolveSettings":
        """Defaults of a method: 1e-5 m and 1e-4 rad; of `de` the paper's search at the paper's accuracy (5e-5 m)."""
        if method not in get_args(Method):
            known = ", ".join(get_args(Method))
            raise InputError(
                f"no method is called {method!r}{nearest(method, get_args(Method))}; it is one of {known}", ("method",)
            )
        own = ENGINES[method].defaults if method in ENGINES else {}
        return SolveSettings(method=method).with_changes(**own)  # type: ignore[arg-type]

    @property
    def engines(self) -> tuple[str, ...]:
        """The engines that may search, in their order."""
        return AUTO if self.method == "auto" else (self.method,)

    @property
    def evolution(self) -> DeSettings:
        """Settings of the DE, or their defaults."""
        return self.de or DeSettings()

    def budget(self, engine: str) -> int:
        """Attempts of one engine before it gives up."""
        return self.restarts or ENGINES[engine].attempts

    def with_changes(self, **changes: object) -> "SolveSettings":
        """A copy with some values changed; None leaves a value as it is, `de={"population": 80}` the DE's others."""
        given: dict[str, Any] = {name: value for name, value in changes.items() if value is not None}
        if isinstance(given.get("de"), Mapping):
            part = given.pop("de")
            if unknown := [name for name in part if name not in DE_RULES]:
                hint = nearest(unknown[0], DE_RULES)
                raise InputError(f"no setting of the DE is called {unknown[0]!r}{hint}", ("settings", "de"))
            given |= {"de": replace(self.evolution, **part)} if part else {}
        elif given.get("method", "de") != "de" and self.de == DeSettings():
            given |= {"de": None}  # its defaults come with the method `de`, and go with it
        return replace(self, **given)


@dataclass(frozen=True, slots=True, kw_only=True)
class BulkOptions:
    """How many solves are run; answers do not depend on it, but for what is verified and explained.

    Raises:
        InputError: for less than 1 thread, or an unknown word.
    """

    threads: int | None = None
    """None for all cores."""
    explain: bool = True
    """Whether short searches find out why a target was not reached; else its counts alone tell, at no cost."""
    verify: Verify = "sample"
    """Which answers plain numpy grades as well: `all`, `sample` (the last 64 of each 4,096 streams), or `none`; beyond
    those, every unreached one that is explained."""

    def __post_init__(self) -> None:
        check_rules(self, BULK_RULES, ("bulk",))


def is_count(least: int, most: int) -> Callable[[Any], bool]:
    """A test for whole numbers of at least and at most so many."""
    return lambda value: (
        isinstance(value, int | np.integer) and not isinstance(value, bool) and bool(least <= value <= most)
    )


def describe_count(least: int, most: int) -> str:
    """What such a test asks for."""
    return f"a whole number of at least {least}, up to {most:,}"


def one_of(choices: tuple[str, ...]) -> Rule:
    """A rule for words."""
    return lambda value: value in choices, f"one of {', '.join(choices)}"


def require(condition: bool, name: str, expected: str, value: object, where: tuple[str, ...] = ("settings",)) -> None:
    """Raise `InputError` about a setting unless the condition holds."""
    if not condition:
        raise InputError(f"expected {expected}, got {value!r}", (*where, name))


def check_rules(settings: Any, rules: Mapping[str, Rule], where: tuple[str, ...]) -> None:
    """Raise `InputError` for the first setting that breaks its rule; what is None by default may be None."""
    for name, (is_good, expected) in rules.items():
        value, default = getattr(settings, name), type(settings).__dataclass_fields__[name].default
        require((value is None and default is None) or bool(is_good(value)), name, expected, value, where)


def check_seed(seed: int) -> int:
    """Return the seed; raises `InputError` unless it is a whole number, 0 <= seed < 2^64."""
    if type(seed) is int and 0 <= seed < 2**64:  # the common case at half a microsecond less
        return seed
    return _check_bits(seed, 64, "seed")


def check_stream(stream: int) -> int:
    """Return the stream; raises `InputError` unless it is a whole number, 0 <= stream < 2^63."""
    if type(stream) is int and 0 <= stream < 2**63:
        return stream
    return _check_bits(stream, 63, "stream")


def _check_bits(value: Any, bits: int, name: str) -> int:
    if not is_count(0, 2**bits - 1)(value):
        raise InputError(f"expected a whole number from 0 to 2^{bits} - 1, got {value!r}", (name,))
    return int(value)


def _read_mapping(given: Mapping[str, Any], method: str) -> SolveSettings:
    """Settings by name, the others the method's own."""
    known = [field.name for field in fields(SolveSettings)]
    for name in given:
        if name not in known:
            hint = nearest(str(name), known) or f"; there are {', '.join(known)}"
            raise InputError(f"no setting is called {quoted(name)}{hint}", ("settings",))
    own = given.get("method", method)
    if not isinstance(own, str):
        raise InputError(f"expected the name of a method, got {quoted(own)}", ("settings", "method"))
    return SolveSettings.for_method(own).with_changes(**given)


def choose_settings(settings: SolveSettings | Mapping[str, Any] | None, method: str) -> SolveSettings:
    """The settings, or the method's own; a wrong name, or what is neither, is an error either way."""
    if not isinstance(method, str):
        raise InputError(f"expected the name of a method, got {quoted(method)}", ("method",))
    if isinstance(settings, Mapping):
        settings = _read_mapping(settings, method)
    if not isinstance(settings, SolveSettings | None):
        hint = ", which take these as `de`" if isinstance(settings, DeSettings) else ""
        raise InputError(f"expected SolveSettings{hint}, or a mapping of them, got {quoted(settings)}", ("settings",))
    own = SolveSettings.for_method(method)
    if settings is None:
        return own
    return settings if method == "auto" else settings.with_changes(method=method)


POSITIVE: Rule = (lambda value: is_number(value) and 0.0 < value < np.inf, "a finite number above 0")
RULES: Mapping[str, Rule] = {
    "method": one_of(get_args(Method)),
    "position_tolerance_m": POSITIVE,
    "orientation_tolerance_rad": (
        lambda value: is_number(value) and 0.0 < value <= np.pi,
        "a number above 0, at most pi",
    ),
    "restarts": (is_count(1, MAX_COUNT), describe_count(1, MAX_COUNT)),
    "timeout_s": POSITIVE,
    "de": (lambda value: isinstance(value, DeSettings), "DeSettings"),
}
BULK_RULES: Mapping[str, Rule] = {
    "threads": (is_count(1, MAX_COUNT), describe_count(1, MAX_COUNT)),
    "explain": (lambda value: isinstance(value, bool), "True or False"),
    "verify": one_of(get_args(Verify)),
}
DE_RULES: Mapping[str, Rule] = {
    "strategy": one_of(STRATEGIES),
    "population": (is_count(MAX_DRAWN + 1, MAX_POPULATION), describe_count(MAX_DRAWN + 1, MAX_POPULATION)),
    "start_share": (lambda value: is_number(value) and 0.0 < value <= 1.0, "above 0, up to 1"),
    "weight": POSITIVE,
    "crossover": (lambda value: is_number(value) and 0.0 <= value <= 1.0, "0 to 1"),
    "generations": (is_count(1, MAX_COUNT), describe_count(1, MAX_COUNT)),
    "bounds": one_of(REPAIRS),
    "update": one_of(get_args(Update)),
    "collision": one_of(get_args(Collision)),
}

"""The engines: what each can do, its budgets, and what is said of it. A new engine is one file and one row here.

No engine is imported here: each brings its kernels along.
"""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any, Literal, NamedTuple

Method = Literal["auto", "lm", "analytic", "memetic", "de"]

POSES = ("pose",)
ALL_KINDS = ("position", "axis", "pose")


class EngineRow(NamedTuple):
    """What is known of an engine without importing it."""

    maker: str  # `module:Class` in `solver/engines`
    brief: str  # two or three words for the help of a command
    label: str  # what a result says of it; `{de}` stands for the settings of the DE
    attempts: int  # before it gives up, unless the settings say otherwise
    attempts_before_next: int | None = None  # the same under `auto`, if another engine takes over
    attempts_before_proof: int = 1  # before the reach bound is checked for unreached targets
    attempts_between_clocks: int = 1  # if there is a timeout: milliseconds
    attempts_of_probe: int = 2  # of a short search for what would help
    target_kinds: tuple[str, ...] = ALL_KINDS  # what may be asked of the tool
    is_closed_form: bool = False  # needs a UR-type arm, and shows all branches of one on a fixed base in one attempt
    stays_in_limits: bool = False  # its collision checks hold within the joint limits only
    starts_near: bool = False  # its first attempts begin near the target, where all find the same
    counts_all_pairs: bool = False  # counts every pair that collides at the target while it searches
    compiled_kinds: tuple[str, ...] = ("position",)  # kinds of target with kernels of their own, or one for all
    one_by_one: int = 0  # targets: so few are solved one after the other, by another kernel than more of them
    shared_settings: tuple[str, ...] = ()  # what it uses of `DeSettings`, if it is not the DE itself
    defaults: Mapping[str, Any] = MappingProxyType({})  # what `SolveSettings.for_method` changes


ENGINES: Mapping[str, EngineRow] = {
    "lm": EngineRow(
        maker="lm:DampedLeastSquares",
        brief="least squares",
        label="lm: damped least squares from collision-free seeds",
        attempts=1000,
        attempts_before_next=300,
        attempts_before_proof=16,
        attempts_between_clocks=64,
        stays_in_limits=True,
        starts_near=True,
        compiled_kinds=ALL_KINDS,
        one_by_one=4,
    ),
    "analytic": EngineRow(
        maker="analytic:Analytic",
        brief="closed form",
        label="analytic: closed form of a UR-type arm",
        attempts=1000,
        attempts_before_proof=64,
        attempts_between_clocks=64,
        target_kinds=POSES,
        is_closed_form=True,
        stays_in_limits=True,
        starts_near=True,
        compiled_kinds=POSES,
    ),
    "memetic": EngineRow(
        maker="memetic:Memetic",
        brief="hard problems",
        label="memetic: adaptive differential evolution, polished",
        attempts=20,
        shared_settings=("bounds", "collision"),
    ),
    "de": EngineRow(
        maker="de:DifferentialEvolution",
        brief="the paper's",
        label="de {de.strategy}, population {de.population}, {de.collision}",
        attempts=40,
        attempts_before_proof=4,
        attempts_of_probe=24,
        counts_all_pairs=True,
        defaults={
            "position_tolerance_m": 5e-5,  # the paper's accuracy
            "restarts": 1000,
            "de": {"collision": "reject", "update": "generation"},
        },
    ),
}
"""In the order of their numbers in `SearchState.engine`."""
NO_ENGINE = "none"
"""Stands for an engine where no joint may move: there is one configuration, and it is graded."""
NAMES = (*ENGINES, NO_ENGINE)
SEVERAL = 1 + max(row.one_by_one for row in ENGINES.values())
"""Targets: as many are solved side by side."""
AUTO = ("analytic", "lm", "memetic")
"""What `auto` tries, in this order, of those that fit; each takes over what the one before leaves."""


def label_engine(name: str) -> str:
    """What a result says of the engine that answered; `{de}` stands for the settings of the DE."""
    return ENGINES[name].label if name in ENGINES else "none: no joint may move"

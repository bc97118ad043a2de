"""How much of everything the paper report does: all of it in minutes, or a taste of it in seconds."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class Budget:
    """Sample sizes of the sections that have any."""

    solves: int
    """Solves of each target in Table 4."""
    variation_solves: int
    """Solves of each target for every variation of Table 4's setting."""
    waits: int
    """Solves of each target and detector until a solution is free."""
    timing_rounds: int
    """Rounds over which a time's median is taken, the things compared taking turns."""
    verdicts: int
    """Random configurations over which pair lists are compared."""
    surface_verdicts: int
    """Random configurations over which surface points and centres are compared."""
    plain_verdicts: int
    """Random configurations that are judged the paper's way, every surface point against every other; 0.4 s each."""
    timed_verdicts: int
    """Random configurations whose verdicts are timed one by one."""
    curve_points: int
    """Moments of a situation's curve."""


FULL = Budget(
    solves=10_000,
    variation_solves=500,
    waits=1_000,
    timing_rounds=21,
    verdicts=10_000,
    surface_verdicts=1_000,
    plain_verdicts=5,
    timed_verdicts=500,
    curve_points=201,
)
QUICK = Budget(
    solves=300,
    variation_solves=10,
    waits=40,
    timing_rounds=5,
    verdicts=1_000,
    surface_verdicts=100,
    plain_verdicts=1,
    timed_verdicts=50,
    curve_points=101,
)

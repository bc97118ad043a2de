"""`typical`, what the paper compares itself with: differential evolution sample by sample [Qiao2022, section 3.1].

Every joint is free, also those of a base, (d_x, d_y, q_z, q1 .. q6), and no speed, collision or drive is minded: the
motion jumps and collides, and a base with wheels would have to slide; `verify_track` counts it. What is not printed and
what we take for it: docs/track.md.
"""

import time
from dataclasses import dataclass

import numpy as np

from ikde.kernels.arrays import IGNORE, Floats, SearchArrays
from ikde.kernels.evolution import evolve_alone, make_workspace
from ikde.kernels.mutation import REPAIRS, STRATEGIES
from ikde.model.pack import pack_robot
from ikde.model.planar_base import find_planar_base
from ikde.solver.settings import require
from ikde.track.check_settings import LEAST_POPULATION, check_counts, check_numbers
from ikde.track.follower import Follower


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
        check_counts(self, {"population": LEAST_POPULATION, "generations": 1})
        check_numbers(self, {"weight": (0.0, 2.0), "crossover": (0.0, 1.0), "base_range_m": (0.0, 1e5)})
        check_numbers(self, {"rotation_length_m": (1e-6, 1e6)})
        for name, choices in (("strategy", STRATEGIES), ("repair", REPAIRS)):
            value = getattr(self, name)
            require(value in choices, name, f"one of {', '.join(choices)}", value)


def follow_typical(
    follower: Follower, start: Floats, seed: int, settings: TypicalSettings | None = None
) -> tuple[Floats, Floats]:
    """The best of every sample's last generation, whatever it is worth: q [K + 1, N], and the seconds of each [K]."""
    settings = settings or TypicalSettings()
    robot, samples = follower.robot, follower.path.samples
    packed, detector = pack_robot(robot), follower.collision.arrays
    search = pack_search(follower, settings)
    work = make_workspace(packed, detector, len(start), settings.population)
    q, seconds = np.empty((samples + 1, len(start))), np.empty(samples)

    def evolve(k: int, search: SearchArrays) -> None:
        box = bound_sample(follower, settings, q[k - 1])
        evolve_alone(packed, detector, follower.target, k, search, *box, np.uint64(seed), work, q[k])

    q[0] = start
    evolve(1, search._replace(generations=-1))  # compiled before the clock runs
    for k in range(1, samples + 1):
        started = time.perf_counter()
        evolve(k, search)
        seconds[k - 1] = time.perf_counter() - started
    return q, seconds


def bound_sample(follower: Follower, settings: TypicalSettings, q: Floats) -> tuple[Floats, Floats]:
    """Ranges [N] of the sample after `q` [N]: those of the joints; of a base, about where it is."""
    robot = follower.robot
    lower, upper = robot.lower.copy(), robot.upper.copy()
    xy = find_planar_base(robot)[:2]
    if xy[0] >= 0:
        lower[xy] = np.maximum(lower[xy], q[xy] - settings.base_range_m)
        upper[xy] = np.minimum(upper[xy], q[xy] + settings.base_range_m)
    is_frozen = np.isin(robot.joint_names, follower.frozen)
    lower[is_frozen] = upper[is_frozen] = q[is_frozen]
    return lower, upper


def pack_search(follower: Follower, settings: TypicalSettings) -> SearchArrays:
    """The settings for the kernel: the error alone, no collision."""
    robot, limits = follower.robot, follower.limits
    return SearchArrays(
        ranges=np.array([robot.lower, robot.upper, robot.home]),
        first_box=1.0,
        start_share=1.0,
        position_tolerance=limits.position_error_m,
        orientation_tolerance=min(limits.orientation_error_rad, limits.position_error_m / settings.rotation_length_m),
        population=settings.population,
        generations=settings.generations,
        strategy=STRATEGIES.index(settings.strategy),
        weight=settings.weight,
        crossover=settings.crossover,
        repair=REPAIRS.index(settings.repair),
        in_place=False,
        collision_rule=IGNORE,
    )

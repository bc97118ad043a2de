"""`typical`, what the paper compares itself with: differential evolution sample by sample [Qiao2022, section 3.1].

Every joint is free, also those of a base, (d_x, d_y, q_z, q1 .. q6), and speed, collision and drive are ignored: the
motion jumps and collides, and a base with wheels would slip sideways; `verify_track` counts it. What is not printed and
what we take for it: docs/track.md.
"""

import time

import numpy as np

from ikde.kernels.arrays import IGNORE, Floats, SearchArrays
from ikde.kernels.evolution import evolve_alone, make_workspace
from ikde.kernels.mutation import REPAIRS, STRATEGIES
from ikde.model.base_motion import find_planar_base
from ikde.model.pack import pack_robot
from ikde.track.continuation import Evolved, follow_from_start
from ikde.track.follower import Follower
from ikde.track.settings import TypicalSettings
from ikde.track.trajectory import Followed


def follow_typical(follower: Follower) -> Followed:
    """The best of every sample's last generation, whatever it is worth."""
    return follow_from_start(follower, _evolve_samples)


def _evolve_samples(follower: Follower, start: Floats) -> Evolved:
    """Sample after sample from `start` [N] at the path's first pose."""
    settings, seed = follower.plan.settings_of(TypicalSettings), np.uint64(follower.plan.seed)
    robot, collision, samples = pack_robot(follower.robot), follower.collision.arrays, follower.path.samples
    search = pack_search(follower, settings)
    work = make_workspace(robot, collision, len(start), settings.population)
    q, seconds = np.empty((samples + 1, len(start))), np.empty(samples)

    def evolve(k: int, search: SearchArrays) -> None:
        box = bound_sample(follower, settings, q[k - 1])
        evolve_alone(robot, collision, follower.target, k, search, *box, seed, work, q[k])

    q[0] = start
    evolve(1, search._replace(generations=-1))  # compiled before the clock runs
    for k in range(1, samples + 1):
        started = time.perf_counter()
        evolve(k, search)
        seconds[k - 1] = time.perf_counter() - started
    return q, seconds, None


def bound_sample(follower: Follower, settings: TypicalSettings, q: Floats) -> tuple[Floats, Floats]:
    """Ranges [N] of the sample after `q` [N]: those of the joints; of a base, or without limits, about where it is."""
    robot = follower.robot
    lower, upper = robot.finite_limits(q, 0.5)
    xy = find_planar_base(robot)[:2]
    if xy[0] >= 0:
        lower[xy] = np.maximum(lower[xy], q[xy] - settings.base_range_m)
        upper[xy] = np.minimum(upper[xy], q[xy] + settings.base_range_m)
    is_frozen = np.isin(robot.joint_names, list(follower.plan.frozen))
    lower[is_frozen] = upper[is_frozen] = q[is_frozen]
    return lower, upper


def pack_search(follower: Follower, settings: TypicalSettings) -> SearchArrays:
    """The settings for the kernel: the error alone, no collision."""
    robot, limits = follower.robot, follower.plan.limits
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

"""What may be preferred of all that meets a target, as figures with gradients: for `solve`, and for ranking."""

from collections.abc import Callable
from functools import lru_cache, partial
from typing import NamedTuple, get_args

import numpy as np

from ikde.errors import InputError, quoted
from ikde.kernels.arrays import Floats, Ints
from ikde.model.collision_model import CollisionModel
from ikde.model.robot import Robot
from ikde.solver.measures import MeasureChoice, measure, measure_gradient
from ikde.solver.motion import limit_margin, measure_motion
from ikde.solver.plain import compute_components, compute_gaps
from ikde.solver.preferred import Prefer
from ikde.solver.problem import Problem

NEAR_M, NEAR_SPHERES_M = 0.1, 0.02  # beyond the smallest gap: of pairs, and of their spheres, that are raised with it
DIFFERENCE = 1e-6  # m or rad, of the gradients of gaps
TRIED = 8  # random configurations: a robot that is singular in each is always
SINGULAR = 1e-9  # of the largest singular value, to the power of their number: below it a manipulability counts as that


class Objective(NamedTuple):
    """What is raised, in three forms, each of a configuration [N]."""

    worth: Callable[[Floats], float]
    """What is raised."""
    climb: Callable[[Floats], tuple[Floats, Floats]]
    """Numbers [K] whose smallest is the worth, and their gradients [K, N]."""
    show: Callable[[Floats], float]
    """The figure that users see."""


def check_prefer(collision: CollisionModel, prefer: str | None) -> None:
    """Raise `InputError` for what is no preference, and for what this robot, checked for this, can have none of."""
    if prefer is not None and prefer not in get_args(Prefer):
        raise InputError(f"expected one of {', '.join(get_args(Prefer))}, got {quoted(prefer)}", ("prefer",))
    if prefer == "manipulability":
        choose_measure(collision.robot)
    if prefer == "clearance" and not (collision.pairs or collision.obstacles):
        raise InputError("without a detector no clearance is known to prefer", ("prefer",))


@lru_cache(maxsize=64)
def choose_measure(robot: Robot) -> MeasureChoice:
    """Which manipulability counts where one figure is asked for: of the whole robot's pose, scaled by speed limits.

    Of a robot that is singular then in each of some random configurations, that of the translation.

    Raises:
        InputError: if that is 0 in each of them as well.
    """
    q = np.random.default_rng(0).uniform(*robot.drawn, (TRIED, len(robot.joints)))
    for rows in ("pose", "translation"):
        choice = MeasureChoice(rows=rows)
        found = measure(robot, q, choice)
        if (found.smallest > SINGULAR * found.singular_values[:, 0]).any():
            return choice
    raise InputError(f"the manipulability of {robot.name} is 0 in each of {TRIED} random configurations")


def measure_manipulability(robot: Robot, q: Floats) -> Floats:
    """Yoshikawa's manipulability [...] of `q` [..., N], that of `choose_measure`."""
    return measure(robot, q, choose_measure(robot)).manipulability


def make_objective(problem: Problem, prefer: Prefer) -> Objective:
    """What is preferred, for one problem; raises as `check_prefer`."""
    check_prefer(problem.collision, prefer)
    robot = problem.robot
    if prefer == "manipulability":
        climb = partial(_climb_manipulability, robot, choose_measure(robot))
        return Objective(partial(_smallest_of, climb), climb, partial(_show_manipulability, robot))
    if prefer == "limits":
        worth = partial(_measure_limits, robot)
        return Objective(worth, partial(_climb_limits, robot), worth)
    if prefer == "clearance":
        worth = partial(_measure_room, problem)
        return Objective(worth, partial(_climb_room, problem), worth)
    climb = partial(_climb_motion, problem)
    return Objective(partial(_smallest_of, climb), climb, partial(_show_motion, problem))


def _smallest_of(climb: Callable[[Floats], tuple[Floats, Floats]], q: Floats) -> float:
    return float(climb(q)[0].min())


def _show_manipulability(robot: Robot, q: Floats) -> float:
    return float(measure_manipulability(robot, q))


def _climb_manipulability(robot: Robot, choice: MeasureChoice, q: Floats) -> tuple[Floats, Floats]:
    """Its logarithm, so that steps are shares of it; one that is 0 wherever the robot is has no slope but rounding."""
    found = measure(robot, q, choice)
    largest = max(float(found.singular_values[0]), SINGULAR) ** len(found.singular_values)
    here = max(float(found.manipulability), SINGULAR * largest)
    return np.array([np.log(here)]), measure_gradient(robot, q, choice, "manipulability")[None] / here


def _measure_limits(robot: Robot, q: Floats) -> float:
    return float(limit_margin(robot.lower, robot.upper, q))


def _climb_limits(robot: Robot, q: Floats) -> tuple[Floats, Floats]:
    """Both shares of each joint that `limit_margin` counts, and 1/2, which none exceeds."""
    widths = robot.upper - robot.lower
    counts = np.flatnonzero(np.isfinite(widths) & (widths > 0.0))
    slopes = np.zeros((len(counts), len(q)))
    slopes[np.arange(len(counts)), counts] = 1.0 / widths[counts]
    below, above = ((room[counts] / widths[counts]) for room in (q - robot.lower, robot.upper - q))
    return np.concatenate([below, above, [0.5]]), np.vstack([slopes, -slopes, np.zeros((1, len(q)))])


def _measure_room(problem: Problem, q: Floats) -> float:
    return float((compute_gaps(problem.collision, q) - problem.collision.limit_m).min())


def _climb_room(problem: Problem, q: Floats) -> tuple[Floats, Floats]:
    """Of components sphere by sphere, since which spheres are nearest changes from step to step; of obstacles whole."""
    rooms = compute_gaps(problem.collision, q) - problem.collision.limit_m
    near, own = np.flatnonzero(rooms < rooms.min() + NEAR_M), len(problem.collision.pairs)
    world = near[near >= own]
    values, slopes = _climb_spheres(problem, q, near[near < own], float(rooms.min()) + NEAR_SPHERES_M)
    return np.append(values, rooms[world]), np.vstack([slopes, differentiate_gaps(problem, q, world)])


def _climb_spheres(problem: Problem, q: Floats, pairs: Ints, below_m: float) -> tuple[Floats, Floats]:
    """The rooms [K] of all spheres of some pairs of components that have less than this, and their gradients [K, N]."""
    collision, moves = problem.collision, np.flatnonzero(problem.upper > problem.lower)
    steps = DIFFERENCE * np.eye(len(q))[moves]
    spheres = compute_components(collision, np.concatenate([q[None], q + steps, q - steps])) if len(pairs) else {}
    rooms = [np.empty((1 + 2 * len(moves), 0))]
    for pair in pairs.tolist():
        (a, radii_a), (b, radii_b) = (spheres[name] for name in collision.pairs[pair])
        less = radii_a[:, None] + radii_b + collision.limit_m
        i, j = np.nonzero(np.linalg.norm(a[0][:, None] - b[0], axis=-1) - less < below_m)
        rooms.append(np.linalg.norm(a[:, i] - b[:, j], axis=-1) - less[i, j])
    every, slopes = np.concatenate(rooms, axis=1), np.zeros((sum(own.shape[1] for own in rooms), len(q)))
    slopes[:, moves] = (every[1 : 1 + len(moves)] - every[1 + len(moves) :]).T / (2.0 * DIFFERENCE)
    return every[0], slopes


def _show_motion(problem: Problem, q: Floats) -> float:
    return float(measure_motion(problem.weights, problem.centre, q))


def _climb_motion(problem: Problem, q: Floats) -> tuple[Floats, Floats]:
    away = problem.weights * (q - problem.centre)
    return np.array([-0.5 * np.sum(away**2)]), -(problem.weights * away)[None]


def differentiate_gaps(problem: Problem, q: Floats, pairs: Ints) -> Floats:
    """Gradients [k, N] of some of the gaps of components and obstacles, by the joints that move."""
    out, moves = np.zeros((len(pairs), len(q))), np.flatnonzero(problem.upper > problem.lower)
    if not len(pairs):
        return out
    steps = DIFFERENCE * np.eye(len(q))[moves]
    gaps = compute_gaps(problem.collision, np.concatenate([q + steps, q - steps]))[:, pairs]
    out[:, moves] = (gaps[: len(moves)] - gaps[len(moves) :]).T / (2.0 * DIFFERENCE)
    return np.where(np.isfinite(out), out, 0.0)

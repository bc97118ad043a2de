"""What of a robot is always as far from an obstacle, whatever its joints do: fixed to the floor, or driving over it."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from ikde.errors import InputError
from ikde.model.arguments import RobotLike
from ikde.model.collision_model import CollisionChoice, CollisionModel
from ikde.solver.plain import compute_components, compute_world_gaps

CONFIGURATIONS = 8
SAME_M = 1e-9
NAMED = 3  # in a message about many


@dataclass(frozen=True, slots=True, kw_only=True)
class StandingObstacle:
    """A component and an obstacle whose distance no joint changes."""

    component: str
    obstacle: str
    clearance_m: float
    touches: bool
    """Nearer than is asked for, in every configuration."""


@lru_cache(maxsize=16)
def find_standing_obstacles(collision: CollisionModel) -> tuple[StandingObstacle, ...]:
    """Components and obstacles that are as far from each other in several random configurations."""
    some = (*collision.fixed_components, *_list_level(collision.own))
    if not some or not collision.obstacles:
        return ()
    gaps = compute_world_gaps(collision, _draw(collision.own), some=some)
    finite = np.isfinite(gaps[0])
    same = np.flatnonzero(finite & (np.ptp(np.where(finite, gaps, 0.0), axis=0) <= SAME_M))
    found = []
    for place in same.tolist():
        component, obstacle = divmod(place, len(collision.obstacles))
        name, pairs = some[component], len(collision.pairs)
        extra_m = collision.extra_m(pairs + collision.components.index(name) * len(collision.obstacles) + obstacle)
        known = {"clearance_m": float(gaps[0, place]) + extra_m, "touches": bool(gaps[0, place] <= collision.limit_m)}
        found.append(StandingObstacle(component=name, obstacle=collision.obstacles[obstacle].name, **known))
    return tuple(found)


@lru_cache(maxsize=64)
def _list_level(collision: CollisionModel) -> tuple[str, ...]:
    """Components of which a sphere keeps a coordinate: others change their distance from everything."""
    placed = compute_components(collision, _draw(collision))
    still = {name: bool((np.ptp(centres, axis=0) <= SAME_M).any()) for name, (centres, _) in placed.items()}
    return tuple(name for name in collision.components if still[name] and name not in collision.fixed_components)


@lru_cache(maxsize=64)
def _draw(collision: CollisionModel) -> np.ndarray:
    """Random configurations [K, N], the same every time."""
    lower, upper = collision.robot.drawn
    return np.random.default_rng(0).uniform(lower, upper, (CONFIGURATIONS, len(lower)))


def find_model(robot: RobotLike, choice: CollisionChoice) -> CollisionModel:
    """The collision model of a choice; raises `InputError` also for what always touches an obstacle."""
    model = CollisionModel.of(robot, choice)
    if model.obstacles:
        refuse_touching(model)
    return model


def refuse_touching(collision: CollisionModel) -> None:
    """Raise `InputError` where a component always touches an obstacle: no configuration would be free."""
    touching = [pair for pair in find_standing_obstacles(collision) if pair.touches]
    if not touching:
        return
    first = touching[0]
    ignored = ", ".join(pair.component for pair in touching if pair.obstacle == first.obstacle)
    raise InputError(
        f"{first.component} is {1e3 * first.clearance_m:.4g} mm from {first.obstacle} in every configuration, so "
        f"nothing is free of it; if that is meant, write `ignore: [{ignored}]` there",
        ("world", first.obstacle),
    )

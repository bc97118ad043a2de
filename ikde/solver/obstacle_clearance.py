"""How much room there is to each obstacle, by plain numpy's table of clearances."""

from dataclasses import dataclass

import numpy as np

from ikde.kernels.arrays import Floats
from ikde.model.collision_model import CollisionModel


@dataclass(frozen=True, slots=True, kw_only=True)
class ObstacleClearance:
    """Clearance between a component and an obstacle: min over its spheres of distance - R; negative is penetration."""

    component: str
    obstacle: str
    clearance_m: float
    margin_m: float
    """The distance that is asked for."""
    collides: bool


def find_nearest_obstacle(collision: CollisionModel, gaps_m: Floats) -> ObstacleClearance | None:
    """The obstacle with the least room beyond what is asked for; None where nothing is compared with any.

    Args:
        collision: the robot among obstacles.
        gaps_m: [P + C O] of `compute_gaps`, m.
    """
    pairs = len(collision.pairs)
    if gaps_m.size == pairs:
        return None
    place = pairs + int(gaps_m[pairs:].argmin())
    return _describe(collision, gaps_m, place) if gaps_m[place] < np.inf else None


def list_obstacles(collision: CollisionModel, gaps_m: Floats) -> tuple[ObstacleClearance, ...]:
    """Of every obstacle the component with the least room, worst first; not those that nothing is compared with."""
    pairs, count = len(collision.pairs), len(collision.obstacles)
    if not count:
        return ()
    components = gaps_m[pairs:].reshape(-1, count).argmin(axis=0)
    places = pairs + components * count + np.arange(count)
    worst_first = places[np.argsort(gaps_m[places], kind="stable")]
    return tuple(_describe(collision, gaps_m, place) for place in worst_first.tolist() if gaps_m[place] < np.inf)


def _describe(collision: CollisionModel, gaps_m: Floats, place: int) -> ObstacleClearance:
    component, obstacle = collision.name_pair(place)
    gap, extra_m = gaps_m.item(place), collision.extra_m(place)
    return ObstacleClearance(
        component=component,
        obstacle=obstacle,
        clearance_m=gap + extra_m,
        margin_m=collision.limit_m + extra_m,
        collides=gap <= collision.limit_m,
    )

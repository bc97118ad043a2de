"""What of a robot is always as far from an obstacle, whatever its joints do: fixed to the floor, or driving over it."""

import math
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from ikde.errors import InputError
from ikde.kernels.arrays import Floats
from ikde.model.arguments import RobotLike
from ikde.model.cloud_cells import find_sorted
from ikde.model.collision_model import CollisionChoice, CollisionModel
from ikde.model.large_worlds import KEPT
from ikde.model.pack_world import find_fixed_frames
from ikde.model.per_obstacle import PerObstacle
from ikde.model.robot import WORLD
from ikde.model.solids import IDENTITY, Solid
from ikde.model.world import Obstacle
from ikde.solver.plain import compute_components, compute_frames
from ikde.solver.plain_world import measure_solid
from ikde.solver.touching import CONFIGURATIONS as TRIED
from ikde.solver.touching import find_always_touching

CONFIGURATIONS = 8
SAME_M, CLOSE_M = 1e-9, 0.02
NAMED = 3  # in a message about many


@dataclass(frozen=True, slots=True, kw_only=True)
class StandingObstacle:
    """A component and an obstacle whose distance no joint changes."""

    component: str
    obstacle: str
    clearance_m: float
    touches: bool
    """Nearer than is asked for, in every configuration."""


@KEPT.add
@lru_cache(maxsize=64)
def find_standing_obstacles(collision: CollisionModel) -> tuple[StandingObstacle, ...]:
    """Components and obstacles that are as far from each other in several random configurations.

    Those alone that are nearer than 20 mm, or than what is asked for.
    """
    widest_m = max([collision.limit_m, collision.margin_m, *dict(collision.margins_m).values()])
    widest_m += max((thing.obstacle.margin_m for thing in collision.world.attached), default=0.0)
    found, pairs, count = [], len(collision.pairs), len(collision.obstacles)
    for place, standing in enumerate(_find_standing(collision.laden, widest_m).list(collision.obstacles)):
        for name, distance_m in standing:
            obstacle = collision.obstacles[place]
            extra_m = collision.extra_m(pairs + collision.components.index(name) * count + place)
            touches = distance_m - extra_m <= collision.limit_m
            if name not in obstacle.ignore and (touches or distance_m <= CLOSE_M):
                known = {"clearance_m": distance_m, "touches": touches}
                found.append(StandingObstacle(component=name, obstacle=obstacle.name, **known))
    return tuple(found)


class Watched:
    """Components that may keep their distance from something: what no joint moves, and what keeps a coordinate."""

    def __init__(self, own: CollisionModel) -> None:
        placed = compute_components(own, _draw(own))
        still = {name: bool((np.ptp(centres, axis=0) <= SAME_M).any()) for name, (centres, _) in placed.items()}
        fixed = own.fixed_components
        names = (*fixed, *(name for name in own.components if still[name] and name not in fixed))
        self.parts = tuple((name, *_bound(*placed[name]), *placed[name]) for name in names)
        """Name, middle and radius of a ball about all spheres, their centres [K, n, 3] and radii [n]."""
        home = compute_frames(own.robot, own.robot.home)
        self._frames = {name: T for name, T in home.items() if name in find_fixed_frames(own.robot)}

    def _place(self, obstacle: Obstacle, solid: Solid) -> list[float]:
        """Where the origin of a solid is in the world, m."""
        own, T = obstacle.T_world_obstacle, self._frames[obstacle.frame]
        p = own[:, 3] if solid.T_obstacle_solid is IDENTITY else own[:, :3] @ solid.T_obstacle_solid[:, 3] + own[:, 3]
        return (p if obstacle.frame == WORLD else T[:3, :3] @ p + T[:3, 3]).tolist()

    def list(self, obstacle: Obstacle, within_m: float) -> list[tuple[str, float]]:
        """Those that keep one distance from an obstacle, of at most `within_m`, and that distance, m."""
        T, own, found = self._frames[obstacle.frame], obstacle.T_world_obstacle, []
        balls = [(self._place(obstacle, solid), _measure_ball(solid)) for solid in obstacle.solids]
        for name, middle, radius_m, centres, radii in self.parts:
            near = [
                solid
                for solid, (place, ball_m) in zip(obstacle.solids, balls, strict=True)
                if math.dist(place, middle) <= ball_m + radius_m + within_m
            ]
            if near:
                P = ((centres - T[:3, 3]) @ T[:3, :3] - own[:, 3]) @ own[:, :3]
                gap_m = _find_same(near, P, radii, within_m)
                if gap_m is not None:
                    found.append((name, gap_m))
        return found


def _find_same(solids: list[Solid], P: Floats, radii: Floats, within_m: float) -> float | None:
    """The distance that spheres keep from solids in all configurations, if it is one of at most `within_m`, m.

    `P` [K, n, 3] in the obstacle's frame, m. One configuration is measured first, and clouds one after the other.
    """
    first_m = _measure(solids, P[0], radii, within_m)
    if first_m > within_m:
        return None
    least_m = most_m = first_m
    for own in P[1:]:
        gap_m = _measure(solids, own, radii, within_m)
        least_m, most_m = min(least_m, gap_m), max(most_m, gap_m)
        if most_m - least_m > SAME_M:
            return None
    return first_m


def _measure(solids: list[Solid], P: Floats, radii: Floats, within_m: float) -> float:
    """Smallest distance of spheres at `P` [n, 3] from solids, m; that of clouds only if it is at most `within_m`."""
    least_m = math.inf
    for solid in solids:
        near = _thin(solid, P, radii, within_m) if solid.kind == "cloud" else solid
        if near is not None:
            least_m = min(least_m, float((measure_solid(near, P) - radii).min()))
    return least_m


def _thin(cloud: Solid, P: Floats, radii: Floats, within_m: float) -> Solid | None:
    """What is left of a cloud within a distance of the box about some spheres, by its cells."""
    assert cloud.points is not None
    own, reach = (P - cloud.T_obstacle_solid[:, 3]) @ cloud.T_obstacle_solid[:, :3], radii[:, None]
    low, high, wide_m = (own - reach).min(axis=0), (own + reach).max(axis=0), within_m + cloud.size_m[0]
    points = find_sorted(cloud.points).find_within(low - wide_m, high + wide_m)
    return replace(cloud, points=points) if len(points) else None


def _bound(centres: Floats, radii: Floats) -> tuple[list[float], float]:
    """Middle and radius of a ball that holds spheres with centres [K, n, 3], m."""
    middle = 0.5 * (centres.min(axis=(0, 1)) + centres.max(axis=(0, 1)))
    return middle.tolist(), float((np.linalg.norm(centres - middle, axis=-1) + radii).max())


def _measure_ball(solid: Solid) -> float:
    """Radius of a ball about a solid's origin that holds it, m."""
    if solid.kind == "half_space":
        return math.inf
    if solid.kind == "cloud" and solid.points is not None:
        return find_sorted(solid.points).radius_m + solid.size_m[0]
    if solid.points is not None:
        return float(np.linalg.norm(solid.points, axis=1).max())
    return sum(solid.size_m) if solid.kind == "capsule" else math.hypot(*_halve(solid))


def _halve(solid: Solid) -> tuple[float, ...]:
    """From a solid's middle to what is farthest, along each of its directions, m."""
    if solid.kind == "box":
        return tuple(0.5 * edge for edge in solid.size_m)
    return (solid.size_m[0], *(0.5 * height for height in solid.size_m[1:]))


@lru_cache(maxsize=64)
def _find_watched(own: CollisionModel) -> Watched:
    """Those of a robot."""
    return Watched(own)


@lru_cache(maxsize=64)
def _find_standing(own: CollisionModel, widest_m: float) -> PerObstacle[list[tuple[str, float]]]:
    """Of each obstacle what keeps one distance from it that is at most 20 mm, or `widest_m` and its own margin."""
    watched = _find_watched(own)
    return PerObstacle(lambda obstacle: watched.list(obstacle, max(CLOSE_M, widest_m + obstacle.margin_m)))


def _draw(collision: CollisionModel) -> np.ndarray:
    """Random configurations [K, N], the same every time."""
    lower, upper = collision.robot.drawn
    return np.random.default_rng(0).uniform(lower, upper, (CONFIGURATIONS, len(lower)))


def find_model(robot: RobotLike, choice: CollisionChoice) -> CollisionModel:
    """The collision model of a choice; raises `InputError` also for what always touches an obstacle, and for what is
    attached and always touches the robot.
    """
    model = CollisionModel.of(robot, choice)
    if model.is_in_world:
        refuse_touching(model)
    return model


@lru_cache(maxsize=64)
def _list_touched(laden: CollisionModel, name: str) -> tuple[str, ...]:
    """Components that an attached object touches in every configuration that is tried."""
    touching = find_always_touching(laden)
    return () if touching is None else tuple(a if b == name else b for a, b in touching.pairs if name in (a, b))


def refuse_attached(collision: CollisionModel) -> None:
    """Raise `InputError` where an attached object touches the robot in every configuration that is tried."""
    for thing in collision.world.attached:
        touched = _list_touched(collision.laden, thing.name)
        if touched:
            may_touch = ", ".join((*thing.may_touch, *touched))
            raise InputError(
                f"{thing.name} touches {', '.join(touched)} in each of {TRIED:,} random configurations, so "
                f"nothing is free of it; if that is meant, write may_touch: [{may_touch}]",
                ("attached", thing.name),
            )


def refuse_touching(collision: CollisionModel) -> None:
    """Raise `InputError` where a component always touches an obstacle, or an attached object the robot: no
    configuration would be free.
    """
    refuse_attached(collision)
    touching = [pair for pair in find_standing_obstacles(collision) if pair.touches]
    if not touching:
        return
    first = touching[0]
    ignored = ", ".join(pair.component for pair in touching if pair.obstacle == first.obstacle)
    margin_m = collision.kept_m(first.component) + collision.world[first.obstacle].margin_m
    held = first.component in (thing.name for thing in collision.world.attached)
    line = f"may_touch: [{first.obstacle}]` for it" if held else f"ignore: [{ignored}]` there"
    asked = f", and {1e3 * margin_m:,.6g} mm are asked for" if first.clearance_m > 0.0 else ""
    raise InputError(
        f"{first.component} is {1e3 * first.clearance_m:.4g} mm from {first.obstacle} in every configuration{asked}, "
        f"so nothing is free of it; if that is meant, write `{line}",
        ("world", first.obstacle),
    )

"""Obstacles as plain data to draw: polygons and points, lengths in m, world frame."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from ikde.kernels.arrays import Floats
from ikde.model.robot import WORLD
from ikde.model.solids import Solid
from ikde.model.world import Obstacle, World

SIDES = 32  # corners of a circle
RINGS = 8  # of a half sphere
MAX_OBSTACLES = 1_000  # that are drawn
MAX_POINTS = 4_000  # of a cloud that are drawn
MIN_PLANE_M = 0.2  # half edge of what is drawn of a half-space, at least


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class DrawnSolid:
    """What is drawn of one solid."""

    polygons_m: tuple[Floats, ...] = ()
    """[k, 3] each, in the world."""
    points_m: Floats
    """[K, 3]; none but of a cloud."""
    is_endless: bool = False
    """True for a half-space: only a part of its surface is drawn."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class DrawnObstacle:
    """An obstacle by its name."""

    name: str
    solids: tuple[DrawnSolid, ...]
    is_on: bool
    """False if its group is off."""
    is_touched: bool = False
    """True if the robot is nearer than is asked for."""

    def place(self, T: Floats) -> "DrawnObstacle":
        """The same, drawn in a frame of its own, at a pose [3, 4]."""
        solids = []
        for solid in self.solids:
            polygons = tuple(P @ T[:, :3].T + T[:, 3] for P in solid.polygons_m)
            solids.append(replace(solid, polygons_m=polygons, points_m=solid.points_m @ T[:, :3].T + T[:, 3]))
        return replace(self, solids=tuple(solids))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class DrawnWorld:
    """All obstacles, and what a drawing says about them."""

    title: str
    obstacles: tuple[DrawnObstacle, ...]

    box_m: Floats
    """Lower and upper corner [2, 3] around the world's origin and all that has an end."""


def draw_world(world: World, title: str) -> DrawnWorld:
    """Every obstacle; those in a frame of the robot as if it stood where the world's does, which the title says.

    Of a half-space a square is drawn, as large as what is drawn of the others.
    """
    shown = world.obstacles[:MAX_OBSTACLES]
    box_m = _compute_box(shown)
    obstacles = []
    for obstacle in shown:
        solids = tuple(draw_solid(solid, obstacle.T_world_obstacle, box_m) for solid in obstacle.solids)
        obstacles.append(
            DrawnObstacle(name=obstacle.name, solids=solids, is_on=obstacle.group not in world.switched_off)
        )
    frames = dict.fromkeys(o.frame for o in shown if o.frame != WORLD)
    said = [title, *([f"frame {', '.join(frames)}"] if frames else [])]
    said += [f"the first {len(shown):,} of {len(world):,} obstacles"] if len(shown) < len(world) else []
    return DrawnWorld(title="  ·  ".join(said), obstacles=tuple(obstacles), box_m=box_m)


def _compute_box(obstacles: Sequence[Obstacle]) -> Floats:
    parts = [np.zeros((1, 3))]
    for obstacle in obstacles:
        for solid in obstacle.solids:
            if solid.kind != "half_space":
                drawn = draw_solid(solid, obstacle.T_world_obstacle, np.zeros((2, 3)))
                parts += [*drawn.polygons_m, drawn.points_m]
    points = np.concatenate(parts)
    return np.array([points.min(axis=0), points.max(axis=0)])


def draw_solid(solid: Solid, T_world_obstacle: Floats, box_m: Floats) -> DrawnSolid:
    """A solid where its obstacle stands; of a half-space a square, as large as the box [2, 3]."""

    def place(P: Floats) -> Floats:
        for T in (solid.T_obstacle_solid, T_world_obstacle):
            P = P @ T[:, :3].T + T[:, 3]
        return P

    if solid.points is not None and solid.triangles is None:
        step = -(-len(solid.points) // MAX_POINTS)
        return DrawnSolid(points_m=place(solid.points[::step]))
    if solid.kind == "half_space":
        half_m = max(0.5 * float(np.ptp(box_m, axis=0).max()), MIN_PLANE_M)
        square = place(half_m * np.array([[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]]))
        normal = np.cross(square[1] - square[0], square[2] - square[0]) / (4.0 * half_m**2)
        away = box_m.mean(axis=0) - square.mean(axis=0)
        square += away - (away @ normal) * normal
        return DrawnSolid(polygons_m=(square,), points_m=np.empty((0, 3)), is_endless=True)
    return DrawnSolid(polygons_m=tuple(map(place, _list_polygons(solid))), points_m=np.empty((0, 3)))


def _list_polygons(solid: Solid) -> list[Floats]:
    """Faces [k, 3] in the solid's own frame."""
    match solid.kind:
        case "box":
            return _list_box(0.5 * np.array(solid.size_m))
        case "hull":
            assert solid.points is not None
            assert solid.triangles is not None
            return list(solid.points[solid.triangles])
    return _revolve(_list_profile(solid))


def _list_box(half_m: Floats) -> list[Floats]:
    square = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    faces = []
    for axis in range(3):
        for side in (-1.0, 1.0):
            face = np.full((4, 3), side)
            face[:, [(axis + 1) % 3, (axis + 2) % 3]] = square
            faces.append(face * half_m)
    return faces


def _list_profile(solid: Solid) -> Floats:
    """Distance from the axis and height [k, 2] along the outline, from below."""
    radius, height = solid.size_m[0], 0.0 if solid.kind == "sphere" else solid.size_m[1]
    bottom, top = [0.0, -0.5 * height], [0.0, 0.5 * height]
    if solid.kind == "cylinder":
        return np.array([bottom, [radius, -0.5 * height], [radius, 0.5 * height], top])
    if solid.kind == "cone":
        return np.array([bottom, [radius, -0.5 * height], top])
    angles = np.linspace(-0.5 * np.pi, 0.0, RINGS + 1)
    lower = radius * np.column_stack([np.cos(angles), np.sin(angles)])
    return np.concatenate([lower + bottom, (lower * [1.0, -1.0])[::-1] + top])


def _revolve(profile: Floats) -> list[Floats]:
    """A surface of revolution: discs where the outline is level, else strips of four corners."""
    angles = np.linspace(0.0, 2.0 * np.pi, SIDES, endpoint=False)
    ring = np.column_stack([np.cos(angles), np.sin(angles)])

    def circle(radius: float, z: float) -> Floats:
        return np.column_stack([radius * ring, np.full(SIDES, z)])

    faces = []
    for (r_low, low), (r_high, high) in pairwise(profile):
        if low == high:
            faces.append(circle(max(r_low, r_high), low))
            continue
        below, above = circle(r_low, low), circle(r_high, high)
        for k in range(SIDES):
            faces.append(np.array([below[k], below[k - SIDES + 1], above[k - SIDES + 1], above[k]]))
    return faces

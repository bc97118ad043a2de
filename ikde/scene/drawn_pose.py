"""A robot as plain data to draw: spheres with their roles, links, frames, marks and labels; lengths in m, world frame.

Renderers place these things in the colours of their roles; they compute no geometry of the robot and no collisions.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from ikde.kernels.arrays import Floats
from ikde.model.base_motion import base_joints
from ikde.model.collision_model import CollisionModel
from ikde.model.pairs import component_bodies
from ikde.model.region import Region
from ikde.model.robot import WORLD, Robot
from ikde.model.target import Target
from ikde.model.tree import build_tree
from ikde.scene.drawn_near import draw_near, reach_obstacle
from ikde.scene.drawn_region import Outline, draw_region
from ikde.scene.drawn_world import DrawnObstacle
from ikde.solver.plain import compute_components, compute_frames, compute_gaps, compute_sphere_gaps

NOT_CHECKED = "self-collision not checked"
BASE_MARK_M = 0.15
SAME_PLACE_M = 1e-3  # frames nearer than this share their label


class Role(StrEnum):
    """What a thing in a drawing means."""

    ARM = "arm"
    BASE = "base"
    COLLIDING = "colliding"
    CLOSEST = "closest pair"
    TARGET = "target"
    REGION = "region"
    LINK = "link"
    OBSTACLE = "obstacle"
    TOUCHED = "obstacle that is too near"
    HELD = "held object"


COLORS: Mapping[Role, str] = {  # as the paper draws it: arm red, platform blue, collisions black
    Role.ARM: "#d1352b",
    Role.BASE: "#3568b8",
    Role.COLLIDING: "#1a1a1a",
    Role.CLOSEST: "#0b8a3c",
    Role.TARGET: "#e69f00",
    Role.REGION: "#b36b00",
    Role.LINK: "#333333",
    Role.OBSTACLE: "#6f7f8f",
    Role.TOUCHED: "#8e24aa",
    Role.HELD: "#9c6b1c",
}
AXIS_COLORS = ("#c00000", "#008000", "#0000c0")  # of a frame's x, y and z


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class DrawnRobot:
    """Links and spheres at one configuration, or at as many as the leading axes `...` hold."""

    links_m: Floats
    """Key points [..., n, 3] of the arm, from where it stands on its base to the tool, each joined to the next."""
    centres_m: Floats
    """Of all spheres [..., S, 3]; none without a detector."""
    radii_m: Floats
    """[S]."""
    components: tuple[str, ...]
    """Names of the C components."""
    parts: NDArray[np.intp]
    """Index of each sphere's component [S]."""
    roles: NDArray[np.str_]
    """`Role.ARM`, `BASE`, `HELD` or `COLLIDING` of each component [..., C]."""

    def list_spheres(self, component: str) -> tuple[Floats, Floats]:
        """Centres [..., S, 3] and radii [S] of a component, m."""
        own = self.parts == self.components.index(component)
        return self.centres_m[..., own, :], self.radii_m[own]

    def compute_box(self, directions: Floats) -> Floats:
        """Lower and upper corner [2, k] in m around everything, along unit `directions` [k, 3]."""
        links, centres = self.links_m @ directions.T, self.centres_m @ directions.T
        shown = [links, centres - self.radii_m[:, None], centres + self.radii_m[:, None]]
        points = np.concatenate([part.reshape(-1, len(directions)) for part in shown])
        return np.array([points.min(axis=0), points.max(axis=0)])


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Mark:
    """A point, or points joined by a line, with what a legend says about it."""

    points_m: Floats
    """[n, 3]."""
    role: Role
    text: str


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class DrawnPose:
    """A robot at one configuration, with all that a drawing says about it."""

    title: str
    robot: DrawnRobot
    Ts_world_frame: Floats
    """Frames shown by their axes [k, 4, 4]."""
    labels: tuple[tuple[str, Floats], ...] = ()
    """Texts and their places [3]."""
    marks: tuple[Mark, ...] = ()
    heading_rad: float = 0.0
    """About the world's z axis, of the base."""
    obstacles: tuple[DrawnObstacle, ...] = ()
    """What of them is near."""
    region: tuple[Outline, ...] = ()
    """Of a goal with freedom."""

    def compute_box(self) -> Floats:
        """Lower and upper corner [2, 3] in m around robot and marks, and what is drawn of obstacles."""
        solids = [solid for obstacle in self.obstacles for solid in obstacle.solids]
        parts = [self.robot.compute_box(np.eye(3)), *(mark.points_m for mark in self.marks)]
        parts += [line for outline in self.region for line in outline.lines_m]
        points = np.concatenate([*parts, *(part for solid in solids for part in (*solid.polygons_m, solid.points_m))])
        return np.array([points.min(axis=0), points.max(axis=0)])


def draw_pose(
    collision: CollisionModel,
    q: Floats,
    *,
    target: Target | None = None,
    region: Region | None = None,
    alternative: int | None = None,
) -> DrawnPose:
    """The robot at `q` [N] with the spheres that are compared, the closest pair, its tool's axes, and the target.

    Of a goal with freedom, its outlines, too, the alternative that was reached before the others.
    """
    robot, gaps_m = collision.robot, compute_gaps(collision, q)
    Ts_world = compute_frames(robot, q)
    drawn = draw_robot(collision, q, gaps_m)
    marks = _find_closest(collision, drawn, gaps_m, Ts_world) if collision.pairs else []
    if target is not None:
        marks.append(Mark(points_m=target.p_world_tool[None, :], role=Role.TARGET, text="target"))
    base = Ts_world[_list_chain(robot)[0]]
    heading_rad = float(np.arctan2(base[1, 0], base[0, 0]))
    if base_joints(robot):
        marks.append(_mark_base(base[:2, 3], heading_rad))
    pose = DrawnPose(
        title=f"{robot.name}  ·  {_describe(collision, gaps_m)}",
        robot=drawn,
        Ts_world_frame=Ts_world[robot.tool][None],
        marks=tuple(marks),
        heading_rad=heading_rad,
        region=() if region is None else draw_region(region, alternative),
    )
    if not collision.obstacles:
        return pose
    hits = collision.fold(gaps_m <= collision.limit_m)[len(collision.pairs) :]
    touched = {obstacle.name for obstacle, hit in zip(collision.obstacles, hits.tolist(), strict=True) if hit}
    near = draw_near(collision.world, Ts_world, pose.compute_box(), touched)
    return replace(pose, obstacles=near)


def draw_frames(robot: Robot, q: Floats, names: Sequence[str], *, title: str) -> DrawnPose:
    """The frames `names` at `q` [N], in their order along the arm; frames that share their origin share a label."""
    Ts_world = compute_frames(robot, q)
    frames = np.array([Ts_world[name] for name in names])
    labels: list[tuple[str, Floats]] = []
    for name, point in zip(names, frames[:, :3, 3], strict=True):
        if labels and np.allclose(labels[-1][1], point, atol=SAME_PLACE_M):
            labels[-1] = (f"{labels[-1][0]}, {name}", point)
        else:
            labels.append((name, point))
    drawn = draw_robot(CollisionModel(robot=robot, detector=None), q, np.empty(0), names)
    return DrawnPose(title=title, robot=drawn, Ts_world_frame=frames, labels=tuple(labels))


def draw_robot(collision: CollisionModel, q: Floats, gaps_m: Floats, links: Sequence[str] = ()) -> DrawnRobot:
    """The robot at `q` [..., N], whose pairs are `gaps_m` [..., P] apart (`compute_gaps`), links through frames."""
    Ts_world = compute_frames(collision.robot, q)
    spheres = compute_components(collision, q)
    components = tuple(spheres)
    centres_m = [np.empty((*q.shape[:-1], 0, 3)), *(centres for centres, _ in spheres.values())]
    radii_m = [np.empty(0), *(radii for _, radii in spheres.values())]
    return DrawnRobot(
        links_m=np.stack([Ts_world[name][..., :3, 3] for name in links or _list_links(collision.robot)], axis=-2),
        centres_m=np.concatenate(centres_m, axis=-2),
        radii_m=np.concatenate(radii_m),
        components=components,
        parts=np.repeat(np.arange(len(components)), [len(radii) for radii in radii_m[1:]]),
        roles=_choose_roles(collision, components, gaps_m),
    )


def _choose_roles(collision: CollisionModel, components: Sequence[str], gaps_m: Floats) -> NDArray[np.str_]:
    """The role of each component [..., C]."""
    base, pairs = base_components(collision), [*collision.pairs]
    held = {thing.name for thing in collision.world.attached}
    pairs += [(name, "") for name, _ in collision.all_pairs[len(pairs) :]]  # an obstacle may be called like a component
    pairs = pairs[: gaps_m.shape[-1]]
    involved = np.array([[name in pair for name in components] for pair in pairs], bool)
    touching = (gaps_m <= collision.limit_m)[..., None] & involved.reshape(len(pairs), len(components))
    own = np.where([name in base for name in components], Role.BASE, Role.ARM)
    own = np.where([name in held for name in components], Role.HELD, own)
    return np.where(touching.any(axis=-2), Role.COLLIDING, own)


def _list_chain(robot: Robot) -> list[str]:
    """Frames from the base to the tool, without the rails that a mobile base moves along."""
    frames = {frame.name: frame for frame in robot.frames}
    kinds = {joint.name: joint.kind for joint in robot.joints}
    chain = [robot.tool]
    while frames[chain[-1]].parent != WORLD:
        chain.append(frames[chain[-1]].parent)
    while len(chain) > 1 and kinds.get(frames[chain[-1]].joint or "") == "prismatic":
        chain.pop()
    return chain[::-1]


def _list_links(robot: Robot) -> list[str]:
    """Frames of the arm: of a base that drives, the last one alone, so that no line runs through its body."""
    chain, joints = _list_chain(robot), {frame.name: frame.joint for frame in robot.frames}
    driven = [k for k, name in enumerate(chain) if joints[name] in base_joints(robot)]
    if not driven:
        return chain
    arm = next((k for k in range(driven[-1] + 1, len(chain)) if joints[chain[k]]), driven[-1] + 1)
    return chain[max(arm - 1, driven[-1] + 1) :] or chain[-1:]


def base_components(collision: CollisionModel) -> set[str]:
    """Components that no other component carries: the platform and what is fixed to it."""
    tree = build_tree(collision.robot)
    bodies = component_bodies(collision.rows, tree)
    carrying = {body: {tree.bodies[body].parent} for body in range(1, len(tree.bodies))}
    for body in carrying:  # parents come first
        carrying[body] |= carrying.get(tree.bodies[body].parent, set())
    return {name for name, body in bodies.items() if not set(bodies.values()) & carrying.get(body, set())}


def _describe(collision: CollisionModel, gaps_m: Floats) -> str:
    if not collision.pairs:
        return NOT_CHECKED
    touching, pairs = gaps_m <= collision.limit_m, len(collision.pairs)
    own, world = bool(touching[:pairs].any()), bool(touching[pairs:].any())
    if not collision.obstacles:
        return f"detector {collision.name}: {'' if own else 'free of '}self-collision"
    said = {(False, False): "free of self-collision and of the world", (True, True): "self-collision, and in the world"}
    said |= {(True, False): "self-collision; free of the world", (False, True): "in collision with the world"}
    return f"detector {collision.name}: {said[own, world]}"


def _mark_base(place_m: Floats, heading_rad: float) -> Mark:
    """A triangle on the floor where the base is, pointing forward."""
    angles = heading_rad + np.array([0.0, 2.5, -2.5, 0.0])
    corners_m = place_m + BASE_MARK_M * np.column_stack([np.cos(angles), np.sin(angles)])
    return Mark(points_m=np.column_stack([corners_m, np.zeros(4)]), role=Role.BASE, text="base, pointing forward")


def _find_closest(
    collision: CollisionModel, drawn: DrawnRobot, gaps_m: Floats, Ts_world: Mapping[str, Floats]
) -> list[Mark]:
    """The mark of what has the least room; in a world of two components, and of a component and an obstacle."""
    closest, pairs = int(np.argmin(gaps_m[: len(collision.pairs)])), len(collision.pairs)
    a, b = collision.name_pair(closest)
    own = _mark_closest(drawn, a, b, float(gaps_m[closest]) + collision.extra_m(closest))
    if not (collision.obstacles and np.isfinite(gaps_m[pairs:]).any()):
        return [own]
    place = pairs + int(np.argmin(gaps_m[pairs:]))
    a, b = collision.name_pair(place)
    gap_m, kept_m = float(gaps_m[place]) + collision.extra_m(place), collision.extra_m(place) + collision.limit_m
    obstacle = collision.obstacles[(place - pairs) % len(collision.obstacles)]
    points_m = reach_obstacle(obstacle, drawn.list_spheres(a), Ts_world)
    kept = f", {kept_m * 1e3:.4g} mm asked for" if kept_m > 0.0 else ""
    return [own, Mark(points_m=points_m, role=Role.CLOSEST, text=f"closest, {a} - {b}: {gap_m * 1e3:.1f} mm{kept}")]


def _mark_closest(drawn: DrawnRobot, a: str, b: str, gap_m: float) -> Mark:
    """A line between the two nearest spheres of two components."""
    spheres = [drawn.list_spheres(name) for name in (a, b)]
    sphere_gaps_m = compute_sphere_gaps(*spheres)
    i, j = np.unravel_index(int(np.argmin(sphere_gaps_m)), sphere_gaps_m.shape)
    points_m = np.array([spheres[0][0][i], spheres[1][0][j]])
    return Mark(points_m=points_m, role=Role.CLOSEST, text=f"closest pair, {a}-{b}: {gap_m * 1e3:.1f} mm")

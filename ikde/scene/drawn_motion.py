"""A motion as plain data to draw: the robot at some of its samples, and the path; lengths in m, world frame."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ikde.kernels.arrays import Floats
from ikde.model.collision_model import CollisionModel
from ikde.model.solids import IDENTITY
from ikde.model.world import Obstacle, World
from ikde.scene.drawn_near import draw_near, reach_obstacle
from ikde.scene.drawn_pose import DrawnRobot, Role, draw_robot
from ikde.scene.drawn_world import DrawnObstacle, draw_solid
from ikde.solver.plain import compute_frames, compute_gaps
from ikde.track.summary import TrackSummary

MAX_OBSTACLES = 60  # that are drawn of a motion's world: the nearest
BOX_FRAMES = 64  # of a motion, whose box is what is near it
AROUND = 0.1  # how far beyond the motion obstacles are drawn, of its size


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Nearest:
    """The moment at which a motion has the least room of a world."""

    sample: int
    component: str
    obstacle: str
    clearance_m: float
    kept_m: float
    """What is asked for there."""
    points_m: Floats
    """[2, 3] middle of the sphere that is nearest, and the point of the obstacle next to it."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class DrawnMotion:
    """The robot at F samples of a motion."""

    robot: DrawnRobot
    """Its leading axis is [F]."""
    samples: NDArray[np.intp]
    """[F], ascending; the tool should be at point `samples[k]` of the path."""
    times_s: Floats
    """[F]."""
    duration_s: float
    """Of the whole path, which the motion may not have followed to its end."""
    path_m: Floats
    """What the tool was asked to follow [P, 3]."""
    clearances_m: Floats
    """[F], the smallest there is; inf where nothing is compared."""
    obstacles: tuple[DrawnObstacle, ...] = ()
    """What of a world is near, if the motion is in one."""
    moved: tuple[tuple[DrawnObstacle, Floats], ...] = ()
    """What moves, drawn in a frame of its own, and its poses [F, 3, 4]."""
    touched: tuple[frozenset[str], ...] = ()
    """[F] names of obstacles that are too near."""
    nearest: Nearest | None = None
    """In a world, where there is the least room of all samples, drawn or not."""

    def list_obstacles(self, frame: int) -> tuple[DrawnObstacle, ...]:
        """All that is drawn of a world in a frame, what moves where it is then."""
        return (*self.obstacles, *(obstacle.place(poses[frame]) for obstacle, poses in self.moved))

    def list_colliding(self, frame: int) -> list[str]:
        """Names of the components that collide in frame 0 .. F - 1, sorted."""
        roles = self.robot.roles[frame]
        return sorted(name for name, role in zip(self.robot.components, roles, strict=True) if role == Role.COLLIDING)


def draw_motion(motion: TrackSummary, samples: Sequence[int] | NDArray[np.intp]) -> DrawnMotion:
    """The robot at `samples` of a motion, coloured by what plain numpy measured there."""
    trajectory, chosen = motion.trajectory, np.asarray(samples, np.intp)
    gaps_m = motion.grade.gaps_m[chosen]
    is_checked = gaps_m.shape[1] > 0
    robot = draw_robot(motion.collision, trajectory.q[chosen], gaps_m)
    return DrawnMotion(
        robot=robot,
        samples=chosen,
        times_s=trajectory.times_s[chosen],
        duration_s=trajectory.path.duration_s,
        path_m=trajectory.path.p_world_tool,
        clearances_m=motion.grade.clearances_m[chosen] if is_checked else np.full(len(chosen), np.inf),
        obstacles=_draw_obstacles(motion),
        moved=_draw_moving(motion, chosen),
        touched=tuple(frozenset(motion.touched[sample]) for sample in chosen),
        nearest=_find_nearest(motion),
    )


def list_nearest(motion: TrackSummary) -> tuple[Obstacle, ...]:
    """The obstacles that come nearest to the motion, in their order; all of them if they are few."""
    obstacles, pairs = motion.collision.obstacles, len(motion.collision.pairs)
    if len(obstacles) <= MAX_OBSTACLES:
        return obstacles
    nearest_m = motion.grade.gaps_m[:, pairs:].min(axis=0).reshape(-1, len(obstacles)).min(axis=0)
    chosen = np.sort(np.argsort(nearest_m, kind="stable")[:MAX_OBSTACLES])
    return tuple(obstacles[k] for k in chosen)


def _draw_obstacles(motion: TrackSummary) -> tuple[DrawnObstacle, ...]:
    """What of the nearest obstacles lies about the whole motion and its path."""
    collision, trajectory = motion.collision, motion.trajectory
    if not collision.obstacles or not motion.started:
        return ()
    some = trajectory.q[spread_samples(motion, BOX_FRAMES)]
    shown = draw_robot(collision, some, motion.grade.gaps_m[: len(some)]).compute_box(np.eye(3))
    points = np.concatenate([shown, trajectory.path.p_world_tool])
    box_m = np.array([points.min(axis=0), points.max(axis=0)])
    still = compute_frames(collision.robot, trajectory.q[0])
    standing = (obstacle for obstacle in list_nearest(motion) if obstacle.name not in trajectory.moving)
    return draw_near(World(obstacles=tuple(standing)), still, box_m, set(), AROUND)


def _draw_moving(motion: TrackSummary, samples: NDArray[np.intp]) -> tuple[tuple[DrawnObstacle, Floats], ...]:
    """What moves, and where it is at some samples."""
    drawn, trajectory = [], motion.trajectory
    for name, moves in trajectory.moving.items():
        solids = tuple(draw_solid(solid, IDENTITY, np.zeros((2, 3))) for solid in motion.collision.world[name].solids)
        R, p = moves.place(trajectory.times_s[samples])
        poses = np.concatenate([R, p[:, :, None]], axis=2)
        drawn.append((DrawnObstacle(name=name, solids=solids, is_on=True), poses))
    return tuple(drawn)


def _find_nearest(motion: TrackSummary) -> Nearest | None:
    """Where the motion has the least room of a world; None without one, or where nothing was compared with it."""
    if motion.closest_obstacle is None:
        return None
    collision, (sample, place) = motion.collision, motion.closest_obstacle
    q, (name, of_world) = motion.trajectory.q[sample], collision.name_pair(place)
    gaps_m, extra_m = motion.grade.gaps_m[sample], collision.extra_m(place)
    spheres, obstacle = draw_robot(collision, q, gaps_m).list_spheres(name), collision.world[of_world]
    if of_world in motion.trajectory.moving:
        R, p = motion.trajectory.moving[of_world].place(motion.trajectory.times_s[[sample]])
        obstacle = replace(obstacle, T_world_obstacle=np.column_stack([R[0], p[0]]))
    return Nearest(
        sample=sample,
        component=name,
        obstacle=of_world,
        clearance_m=float(gaps_m[place]) + extra_m,
        kept_m=collision.limit_m + extra_m,
        points_m=reach_obstacle(obstacle, spheres, compute_frames(collision.robot, q)),
    )


def draw_still(collision: CollisionModel, q: Floats, target_m: Sequence[float]) -> DrawnMotion:
    """The robot at one configuration [N], as a motion that takes no time; its path is the target [3], or empty."""
    gaps_m = compute_gaps(collision, q)[None]
    return DrawnMotion(
        robot=draw_robot(collision, q[None], gaps_m),
        samples=np.zeros(1, np.intp),
        times_s=np.zeros(1),
        duration_s=0.0,
        path_m=np.array(target_m, dtype=float).reshape(-1, 3),
        clearances_m=gaps_m.min(axis=1, initial=np.inf),
    )


def spread_samples(motion: TrackSummary, count: int) -> NDArray[np.intp]:
    """At most `count` samples from the first to the last, evenly spaced."""
    return np.unique(np.linspace(0, len(motion.trajectory.q) - 1, count).round().astype(np.intp))


def choose_frames(motion: TrackSummary, count: int) -> NDArray[np.intp]:
    """The same, and in a world the sample with the least room beside them."""
    spread, closest = spread_samples(motion, count), motion.closest_obstacle
    return spread if closest is None else np.union1d(spread, closest[:1])


def choose_moments(motion: TrackSummary, count: int) -> list[int]:
    """Evenly spaced samples; where one nearby collides the worst of those is shown instead, and in a world the sample
    with the least room.
    """
    even = spread_samples(motion, count)
    edges = np.concatenate([[0], (even[1:] + even[:-1] + 1) // 2, [len(motion.trajectory.q)]])
    gaps = motion.grade.gaps_m.min(axis=1, initial=np.inf)
    chosen = []
    for sample, first, end in zip(even, edges[:-1], edges[1:], strict=True):
        wrong = [k for k in range(first, end) if motion.colliding[k]]
        if not wrong and motion.closest_obstacle is not None:
            wrong = [k for k in range(first, end) if k == motion.closest_obstacle[0]]
        chosen.append(int(min(wrong, key=lambda k: gaps[k])) if wrong else int(sample))
    return chosen

"""A motion as plain data to draw: the robot at some of its samples, and the path; lengths in m, world frame."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ikde.kernels.arrays import Floats
from ikde.model.collision_model import CollisionModel
from ikde.scene.drawn_pose import DrawnRobot, Role, draw_robot
from ikde.solver.plain import compute_gaps
from ikde.track.summary import TrackSummary


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

    def list_colliding(self, frame: int) -> list[str]:
        """Names of the components that collide in frame 0 .. F - 1, sorted."""
        roles = self.robot.roles[frame]
        return sorted(name for name, role in zip(self.robot.components, roles, strict=True) if role == Role.COLLIDING)


def draw_motion(motion: TrackSummary, samples: Sequence[int] | NDArray[np.intp]) -> DrawnMotion:
    """The robot at `samples` of a motion, coloured by what plain numpy measured there."""
    trajectory, chosen = motion.trajectory, np.asarray(samples, np.intp)
    gaps_m = motion.grade.gaps_m[chosen]
    is_checked = gaps_m.shape[1] > 0
    return DrawnMotion(
        robot=draw_robot(motion.collision, trajectory.q[chosen], gaps_m),
        samples=chosen,
        times_s=trajectory.times_s[chosen],
        duration_s=trajectory.path.duration_s,
        path_m=trajectory.path.p_world_tool,
        clearances_m=motion.grade.clearances_m[chosen] if is_checked else np.full(len(chosen), np.inf),
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


def choose_moments(motion: TrackSummary, count: int) -> list[int]:
    """Evenly spaced samples; where one nearby collides the worst of those is shown instead."""
    even = spread_samples(motion, count)
    edges = np.concatenate([[0], (even[1:] + even[:-1] + 1) // 2, [len(motion.trajectory.q)]])
    gaps = motion.grade.gaps_m.min(axis=1, initial=np.inf)
    chosen = []
    for sample, first, end in zip(even, edges[:-1], edges[1:], strict=True):
        wrong = [k for k in range(first, end) if motion.colliding[k]]
        chosen.append(int(min(wrong, key=lambda k: gaps[k])) if wrong else int(sample))
    return chosen

"""What a motion is like: every figure that its page and its table show, measured by plain numpy."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ikde.kernels.arrays import Floats
from ikde.model.base_motion import find_wheels
from ikde.model.collision_model import CollisionModel
from ikde.model.robot import Robot
from ikde.solver.jacobian import smallest_singular_values
from ikde.track.certify import Certificate
from ikde.track.drive import implied_wheel_speed
from ikde.track.limits import MotionLimits
from ikde.track.trajectory import Trajectory
from ikde.track.verify_track import ROUNDING, TrackGrade

Worst = tuple[str, float, float]
"""A joint, its value, and its limit."""


@dataclass(frozen=True, kw_only=True, eq=False)
class TrackSummary:
    """A motion with its figures, at its samples 0 .. M and between them."""

    collision: CollisionModel
    trajectory: Trajectory
    singular_values: Floats
    """[M + 1] smallest of the arm's Jacobian, m and rad, in what the path asks for."""

    @property
    def robot(self) -> Robot:
        """The robot that moves."""
        return self.collision.robot

    @property
    def grade(self) -> TrackGrade:
        """What plain numpy says about the samples."""
        return self.trajectory.grade

    @property
    def certificate(self) -> Certificate | None:
        """What is certain about self-collision between them; None where it was not checked."""
        return self.trajectory.certificate

    @property
    def limits(self) -> MotionLimits:
        """What the motion was made under."""
        return self.trajectory.limits

    @property
    def started(self) -> bool:
        """False if not even the first pose was met."""
        return len(self.trajectory.q) > 0

    @property
    def arm(self) -> list[int]:
        """Joints that do not drive the base."""
        return [k for k, name in enumerate(self.robot.joint_names) if name not in self.trajectory.base_joints]

    @property
    def largest_axis_errors_m(self) -> Floats:
        """Along x, y and z, at any sample [3]."""
        return np.abs(self.grade.error_m).max(axis=0, initial=0.0)

    @property
    def met_points(self) -> int:
        """Samples after the start where the tool is within its tolerances."""
        graded, limits = self.grade, self.limits
        near = (np.abs(graded.error_m) <= limits.position_error_m).all(axis=1)
        near &= graded.orientation_error_rad <= limits.orientation_error_rad
        return int(near[1:].sum())

    @cached_property
    def colliding(self) -> list[set[str]]:
        """What is seen within the safe distance of another, for each sample, components and obstacles; none without a
        detector.
        """
        pairs = self.collision.all_pairs
        touching = self.grade.gaps_m <= self.collision.limit_m
        return [{name for pair in np.flatnonzero(row) for name in pairs[pair]} for row in touching]

    @cached_property
    def touched(self) -> list[set[str]]:
        """Obstacles that anything is too near to, for each sample."""
        collision, pairs = self.collision, len(self.collision.pairs)
        names = [obstacle.name for obstacle in collision.obstacles]
        hits = self.grade.gaps_m[:, pairs:] <= collision.limit_m
        return [{names[place % len(names)] for place in np.flatnonzero(row)} for row in hits]

    @property
    def closest_pair(self) -> tuple[str, str] | None:
        """What has the least room at any sample: two components, or a component and an obstacle."""
        return None if self.closest_place is None else self.collision.name_pair(self.closest_place)

    @property
    def closest_place(self) -> int | None:
        """Its place in the table of clearances; None where nothing was checked."""
        gaps = self.grade.gaps_m
        return int(np.argmin(gaps.min(axis=0))) if gaps.size else None

    @cached_property
    def closest_obstacle(self) -> tuple[int, int] | None:
        """Sample and place in the table of clearances where the motion has the least room of a world.

        None without a world, and where nothing is compared with it.
        """
        gaps, pairs = self.grade.gaps_m, len(self.collision.pairs)
        of_world = gaps[:, pairs:]
        if not of_world.size or not np.isfinite(of_world.min()):
            return None
        sample, place = np.unravel_index(int(np.argmin(of_world)), of_world.shape)
        return int(sample), pairs + int(place)

    @property
    def steps(self) -> Floats:
        """Change of every joint from sample to sample [M, N], m and rad; of a base with wheels along its arc."""
        return self.grade.driven * self.trajectory.path.dt_s

    def largest_step(self, kind: str) -> float:
        """Largest change of a joint of a kind between two samples, m or rad."""
        chosen = self.robot.is_prismatic if kind == "prismatic" else ~self.robot.is_prismatic
        return float(np.abs(self.steps[:, chosen]).max(initial=0.0))

    @property
    def fastest(self) -> Worst | None:
        """The joint nearest to its speed limit, or farthest beyond it; None without a limit or a motion."""
        return self._worst(np.abs(self.grade.driven), self.limits.speed)

    @property
    def wheel_limit_rad_s(self) -> float:
        """The wheels' own limit, else what the base's speed limits imply; inf without either."""
        own, base = self.limits.wheel_speed_rad_s, find_wheels(self.robot, self.trajectory.drive)
        if own is not None:
            return own
        speed, wheels = self.limits.speed, self.robot.wheels
        return np.inf if speed is None or wheels is None or base[0] < 0 else implied_wheel_speed(wheels, speed, base)

    @property
    def largest_acceleration(self) -> Worst | None:
        """The joint nearest to its acceleration limit."""
        changes = np.diff(self.grade.driven, axis=0)
        return self._worst(np.abs(changes) / self.trajectory.path.dt_s, self.limits.acceleration)

    def _worst(self, values: Floats, limit: Floats | None) -> Worst | None:
        if limit is None or not len(values):
            return None
        largest = values.max(axis=0)
        share = np.divide(largest, limit, out=np.where(largest > 0.0, np.inf, 0.0), where=limit > 0.0)
        joint = int(np.argmax(share))
        return self.robot.joint_names[joint], float(largest[joint]), float(limit[joint])

    @property
    def range_left(self) -> Worst | None:
        """The joint with the least share of its range left: what is left (negative: beyond), and to which end.

        The base's x and y do not count, nor do joints without a range or with one of a single value, unless they
        leave it. None if no joint counts.
        """
        q, ends = self.trajectory.q, np.stack([self.robot.lower, self.robot.upper])
        if not len(q):
            return None
        left = np.stack([q - ends[0], ends[1] - q]).min(axis=1)
        width = ends[1] - ends[0]
        share = np.where(left < -ROUNDING, -np.inf, np.inf)
        np.divide(left, width, out=share, where=(width > 0.0) & np.isfinite(width))
        share[:, np.isin(self.robot.joint_names, self.trajectory.base_joints[:2])] = np.inf
        end, joint = np.unravel_index(int(np.argmin(share)), share.shape)
        if share[end, joint] == np.inf:
            return None
        return self.robot.joint_names[joint], float(left[end, joint]), float(ends[end, joint])

    @property
    def largest_distance_m(self) -> float | None:
        """Largest distance of the tool from the centre that it is held near, m; None if it is not, or did not start."""
        asked = self.limits.max_distance_m is not None and self.started
        return float(self.grade.distance_m.max()) if asked else None


def summarise_track(collision: CollisionModel, trajectory: Trajectory) -> TrackSummary:
    """A motion with its singular values, of the collision model that it was made with."""
    base, orientation = trajectory.base_joints, trajectory.path.orientation
    values = smallest_singular_values(collision.robot, trajectory.q, base, orientation)
    return TrackSummary(collision=collision, trajectory=trajectory, singular_values=values)

"""A path made ready for the kernels, and one attempt to follow it."""

import time
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ikde.errors import InputError
from ikde.kernels.arrays import DRIFT, DriveArrays, Floats, TargetArrays, TrackArrays
from ikde.kernels.tracking import make_sample, track_span
from ikde.model.collision_model import CollisionModel
from ikde.model.pack import pack_robot, pack_targets
from ikde.model.planar_base import base_carries
from ikde.model.robot import FARTHEST, Robot
from ikde.solver.engines.pool import rotation_length_m
from ikde.track.drive import pack_drive
from ikde.track.limits import MotionLimits
from ikde.track.path import ToolPath

REACH_M = 0.08  # pairs nearer than this are looked at, and pushed apart
MARGIN_M = 1e-4  # what every pair keeps above the safe distance, so that curved motion between samples keeps some
GOAL_M, GOAL_RAD = 1e-9, 1e-8  # a sample is refined until it is met
SHARE = 0.5  # of the tolerances, within which a sample is accepted that can't be refined
ROUNDING = 1e-12  # m, rad: ranges are kept this far from their ends
MOST_ROUNDS = 30  # of one sample: 2 are usual, 10 in a twofold singularity


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Course:
    """A motion along the first samples of a path, and what its null space was used for."""

    q: Floats
    """[K + 1, N]; rows beyond `last` say nothing."""
    steps: Floats
    """[K + 1, D] shares of the largest step; row 0 is 0."""
    weights: Floats
    """[K + 1, 3 + D] clearance, limits, manipulability, drift (`kernels/nullspace.py`)."""
    least: Floats
    """[K + 1] what the nearest pair keeps beyond the margin, m; inf beyond the reach."""
    last: int
    """The last sample that was reached."""

    @property
    def clearance_m(self) -> float:
        """Smallest clearance above the margin at samples 1 .. last, at most the reach."""
        return float(min(self.least[1 : self.last + 1].min(initial=np.inf), REACH_M))

    @property
    def motion(self) -> float:
        """Sum of the squared shares of the largest steps."""
        return float(np.sum(self.steps[1 : self.last + 1] ** 2))

    def copy(self) -> "Course":
        """The same with arrays of its own."""
        arrays = {name: getattr(self, name).copy() for name in ("q", "steps", "weights", "least")}
        return replace(self, **arrays)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Follower:
    """Everything that following one path depends on but the start and the use of the null space."""

    collision: CollisionModel
    path: ToolPath
    limits: MotionLimits
    frozen: tuple[str, ...]
    drive: DriveArrays
    track: TrackArrays
    target: TargetArrays
    room: Any

    @property
    def robot(self) -> Robot:
        """The robot of the collision model."""
        return self.collision.robot

    @property
    def size(self) -> int:
        """D: entries of a step."""
        return len(self.drive.largest)

    def with_track(self, **changes: Any) -> "Follower":
        """The same path with other numbers for the kernels."""
        return replace(self, track=self.track._replace(**changes))

    def with_drive(self, **changes: Any) -> "Follower":
        """The same path with another drive."""
        return replace(self, drive=self.drive._replace(**changes))

    def begin(self, start: Floats, weights: Floats) -> Course:
        """A course that stands at its start; `weights` [3] of clearance, limits and manipulability."""
        samples = self.path.samples + 1
        rows = np.zeros((samples, DRIFT + self.size))
        rows[:, :DRIFT] = weights
        q = np.zeros((samples, len(start)))
        q[0] = start
        least = np.full(samples, np.inf)
        return Course(q=q, steps=np.zeros((samples, self.size)), weights=rows, least=least, last=0)

    def follow(self, course: Course, end: int | None = None) -> Course:
        """Go on from the last sample to `end`, by default the path's, or as far as it goes. Arrays are written to."""
        last = self.path.samples if end is None else end
        return replace(course, last=self._run(course, course.last, last))

    def follow_timed(self, course: Course) -> Floats:
        """Take the steps to samples 1 .. last again one by one, as a controller would; the seconds of each [last]."""
        seconds, again = np.empty(max(course.last, 0)), course.copy()
        for k in range(len(seconds)):
            started = time.perf_counter()
            self._run(again, k, k + 1)
            seconds[k] = time.perf_counter() - started
        return seconds

    def _run(self, course: Course, first: int, last: int) -> int:
        reached, _ = track_span(
            pack_robot(self.robot),
            self.collision.arrays,
            self.drive,
            self.track,
            self.target,
            first,
            last,
            course.weights,
            course.q,
            course.steps,
            self.room,
            np.empty(len(course.q), dtype=np.int64),  # rounds, which nobody asks for
            course.least,
        )
        return reached


def make_follower(
    collision: CollisionModel,
    path: ToolPath,
    *,
    drive: str,
    limits: MotionLimits,
    frozen: tuple[str, ...] = (),
) -> Follower:
    """Pack robot, path and limits; raises `InputError` for what does not fit the robot."""
    robot = collision.robot
    limits.check(robot)
    packed = pack_drive(robot, drive, limits, path.dt_s, frozen)
    if packed.base[0] >= 0 and not base_carries(collision):
        message = "a base on arcs must carry all that can collide; say omnidirectional, or leave out the rest"
        raise InputError(message, ("detector",))
    return Follower(
        collision=collision,
        path=path,
        limits=limits,
        frozen=frozen,
        drive=packed,
        track=pack_track(collision, limits),
        target=pack_targets(path.targets()),
        room=make_sample(pack_robot(robot), collision.arrays, len(robot.joints), len(packed.largest)),
    )


def pack_track(collision: CollisionModel, limits: MotionLimits) -> TrackArrays:
    """What the kernels are told about limits and tolerances."""
    robot, safe = collision.robot, collision.limit_m
    ranges = np.array([robot.lower, robot.upper])
    if limits.ranges:
        inside = np.minimum(ROUNDING, 0.5 * (ranges[1] - ranges[0]))
        ranges = ranges + np.array([inside, -inside])
    else:
        ranges = np.array([np.full_like(robot.lower, -FARTHEST), np.full_like(robot.upper, FARTHEST)])
    return TrackArrays(
        ranges=ranges,
        reach=safe + REACH_M if collision.pairs else -np.inf,
        margin=safe + MARGIN_M,
        rotation_length=rotation_length_m(robot),
        position_goal=min(GOAL_M, SHARE * limits.position_error_m),
        orientation_goal=min(GOAL_RAD, SHARE * limits.orientation_error_rad),
        position_tolerance=SHARE * limits.position_error_m,
        orientation_tolerance=SHARE * limits.orientation_error_rad,
        max_rounds=MOST_ROUNDS,
    )

"""A path made ready for the kernels, and one attempt to follow it."""

import time
from dataclasses import dataclass, replace
from typing import Any, Self

import numpy as np

from ikde.kernels.arrays import DRIFT, CollisionArrays, DriveArrays, Floats, TargetArrays, TrackArrays
from ikde.kernels.tracking import make_sample, track_span
from ikde.model.collision_model import CollisionModel
from ikde.model.pack import pack_robot, pack_targets
from ikde.model.robot import MAX_MAGNITUDE, Robot
from ikde.solver.engines.pool import rotation_length_m
from ikde.solver.plain import compute_gaps
from ikde.track.drive import pack_drive
from ikde.track.limits import MotionLimits
from ikde.track.moving import Around, MovingWorld
from ikde.track.path import ToolPath
from ikde.track.plan import TrackPlan
from ikde.track.trajectory import TrackStop

REACH_M = 0.08  # pairs nearer than this are constraints, and pushed apart
MARGIN_M = 1e-4  # what every pair keeps above the safe distance, so that curved motion between samples keeps some
GOAL_M, GOAL_RAD = 1e-9, 1e-8  # a sample is refined until it is met
SHARE = 0.5  # of the tolerances, within which a sample is accepted that can't be refined
ROUNDING = 1e-12  # m, rad: ranges are kept this far from their ends
MAX_ROUNDS = 30  # of one sample: 2 are usual, 10 in a twofold singularity


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Follower:
    """A plan packed for the kernels: everything that a rollout depends on but its start and its null space."""

    plan: TrackPlan
    drive: DriveArrays
    track: TrackArrays
    target: TargetArrays
    room: Any
    moving: MovingWorld | None = None
    """Obstacles that are elsewhere from sample to sample."""

    @property
    def robot(self) -> Robot:
        """The plan's."""
        return self.plan.robot

    @property
    def collision(self) -> CollisionModel:
        """The plan's."""
        return self.plan.collision

    @property
    def path(self) -> ToolPath:
        """The plan's."""
        return self.plan.path

    def arrays_at(self, sample: int) -> CollisionArrays:
        """What is compared at a sample; where obstacles move, until this is called again."""
        return self.collision.arrays if self.moving is None else self.moving.set_sample(sample)

    def compute_gaps(self, q: Floats, sample: int) -> Floats:
        """Of all pairs [P + C O] at `q` [N] at a sample, as `compute_gaps`."""
        gaps = compute_gaps(self.collision, q)
        if self.moving is not None:
            gaps[len(self.collision.pairs) :] = self.moving.compute_gaps(q[None], self.path.times_s[[sample]])[0]
        return gaps

    def around(self, first: int, count: int) -> Around | None:
        """What moves about so many samples from the `first` on; None where nothing does."""
        return None if self.moving is None else Around(self.moving, self.path.times_s[first : first + count])

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

    def begin(self, start: Floats, weights: Floats) -> "Rollout":
        """A rollout that stands at its start; `weights` [3] of clearance, limits and manipulability."""
        samples = self.path.samples + 1
        rows = np.zeros((samples, DRIFT + self.size))
        rows[:, :DRIFT] = weights
        q = np.zeros((samples, len(start)))
        q[0] = start
        steps, spare = np.zeros((samples, self.size)), np.full(samples, np.inf)
        return Rollout(follower=self, rows=q, steps=steps, weights=rows, spare_m=spare, last=0)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Rollout:
    """A candidate motion along the first samples of a path, what its null space was used for, and why it ends."""

    follower: Follower
    """What it is followed with."""
    rows: Floats
    """[K + 1, N] joint values; rows beyond `last` say nothing."""
    steps: Floats
    """[K + 1, D] shares of the largest step; row 0 is 0."""
    weights: Floats
    """[K + 1, 3 + D] clearance, limits, manipulability, drift (`kernels/nullspace.py`)."""
    spare_m: Floats
    """[K + 1] what the nearest pair keeps beyond the margin; inf beyond the reach."""
    last: int
    """The last sample that was reached; -1: not even the first."""
    stop: TrackStop | None = None
    """Why it ends before its path, where that is known."""

    @property
    def q(self) -> Floats:
        """[M + 1, N] joint values of the samples that were reached."""
        return self.rows[: self.last + 1]

    @property
    def clearance_m(self) -> float:
        """Smallest clearance above the margin at samples 1 .. last, at most the reach."""
        return float(min(self.spare_m[1 : self.last + 1].min(initial=np.inf), REACH_M))

    @property
    def motion(self) -> float:
        """Sum of the squared shares of the largest steps."""
        return float(np.sum(self.steps[1 : self.last + 1] ** 2))

    def copy(self) -> Self:
        """The same with arrays of its own."""
        arrays = {name: getattr(self, name).copy() for name in ("rows", "steps", "weights", "spare_m")}
        return replace(self, **arrays)

    def resume(self, end: int | None = None) -> Self:
        """Follow on from the last sample to `end`, by default the path's, or as far as it goes. Arrays are written."""
        last = self.follower.path.samples if end is None else end
        return replace(self, last=self._run(self.last, last))

    def time_steps(self) -> Floats:
        """Take the steps to samples 1 .. last again one by one, as a controller would; the seconds of each [last]."""
        seconds, again = np.empty(max(self.last, 0)), self.copy()
        for k in range(len(seconds)):
            started = time.perf_counter()
            again._run(k, k + 1)
            seconds[k] = time.perf_counter() - started
        return seconds

    def _run(self, first: int, last: int) -> int:
        if self.follower.moving is None or last <= first:
            return self._run_among(self.follower.collision.arrays, first, last)
        for sample in range(first, last):
            if self._run_among(self.follower.arrays_at(sample + 1), sample, sample + 1) == sample:
                return sample
        return last

    def _run_among(self, collision: CollisionArrays, first: int, last: int) -> int:
        follower = self.follower
        reached, _ = track_span(
            pack_robot(follower.robot),
            collision,
            follower.drive,
            follower.track,
            follower.target,
            first,
            last,
            self.weights,
            self.rows,
            self.steps,
            follower.room,
            np.empty(len(self.rows), dtype=np.int64),  # rounds of each sample, not used here
            self.spare_m,
        )
        return reached


def make_follower(plan: TrackPlan) -> Follower:
    """Pack robot, path and limits."""
    robot = plan.robot
    drive = pack_drive(robot, plan.base_drive, plan.limits, plan.path.dt_s, plan.frozen)
    return Follower(
        plan=plan,
        drive=drive,
        track=pack_track(plan.collision, plan.limits),
        target=pack_targets(plan.path.targets()),
        moving=plan.make_moving(),
        room=make_sample(pack_robot(robot), plan.collision.arrays, len(robot.joints), len(drive.largest)),
    )


def pack_track(collision: CollisionModel, limits: MotionLimits) -> TrackArrays:
    """Limits and tolerances for the kernels."""
    robot, safe = collision.robot, collision.limit_m
    ranges = np.array([robot.lower, robot.upper])
    if limits.ranges:
        inside = np.minimum(ROUNDING, 0.5 * (ranges[1] - ranges[0]))
        ranges = np.clip(ranges + np.array([inside, -inside]), -MAX_MAGNITUDE, MAX_MAGNITUDE)
    else:
        ranges = np.array([np.full_like(robot.lower, -MAX_MAGNITUDE), np.full_like(robot.upper, MAX_MAGNITUDE)])
    return TrackArrays(
        ranges=ranges,
        reach=safe + REACH_M if collision.pairs else -np.inf,
        margin=safe + MARGIN_M,
        rotation_length=rotation_length_m(robot),
        position_goal=min(GOAL_M, SHARE * limits.position_error_m),
        orientation_goal=min(GOAL_RAD, SHARE * limits.orientation_error_rad),
        position_tolerance=SHARE * limits.position_error_m,
        orientation_tolerance=SHARE * limits.orientation_error_rad,
        max_rounds=MAX_ROUNDS,
    )

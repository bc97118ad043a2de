"""What a track gives back, as plain data: joint values, the base's twist, figures, and why it stopped."""

from dataclasses import dataclass, field
from enum import StrEnum

import numpy as np

from ikde.kernels.arrays import Floats
from ikde.model.robot import Drive
from ikde.track.certify import Certificate
from ikde.track.limits import MotionLimits
from ikde.track.moving import Moving
from ikde.track.path import ToolPath
from ikde.track.verify_track import TrackGrade, Violations


class TrackStopReason(StrEnum):
    """What stands in the way of the rest of a path: proved out of reach, or what trying found without a limit."""

    OUT_OF_REACH = "out_of_reach"
    """A bound proves that no joint values bring the tool there, or orient it so."""
    SPEED_LIMIT = "speed_limit"
    """A joint or the base moves faster than it may in the step that was found."""
    ACCELERATION_LIMIT = "acceleration_limit"
    """It changes its speed faster than it may."""
    WHEEL_LIMIT = "wheel_limit"
    """A wheel would exceed its speed limit."""
    JOINT_LIMIT = "joint_limit"
    """A joint leaves its range."""
    DISTANCE_LIMIT = "distance_limit"
    """The tool is too far from the platform's centre."""
    COLLISION = "collision"
    """Components collide, or it can't be excluded that they do between samples."""
    BUDGET = "budget"
    """The attempts were spent without a reason that was found."""


@dataclass(frozen=True, slots=True, kw_only=True)
class TrackStop:
    """Where a motion ends before its path does, and why."""

    sample: int
    """The first sample that was not reached."""
    reason: TrackStopReason
    text: str
    """One line: what happened."""
    pair: tuple[str, str] | None = None
    """The components in the way, or a component and an obstacle."""
    limit: str | None = None
    """Whose limit is in the way: a joint by name, `the base`, `wheels`, or the frame of a largest distance."""
    hint: str | None = None
    """What was tried among obstacles and helped; None where nothing was tried, or nothing helped."""

    @property
    def line(self) -> str:
        """What happened, and what would help, in one line."""
        return f"{self.text}; {self.hint}" if self.hint else self.text


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Followed:
    """A motion as far as a method followed its path, and what that took; not graded yet."""

    q: Floats
    """[M + 1, N]"""
    stop: TrackStop | None
    """Why it ends before its path does."""
    seconds: Floats
    """[M] of each sample after the start."""
    search_seconds: float
    """Of the whole motion."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Trajectory:
    """A motion through the samples 0 .. M of a path of K: all of them, M = K, or those before the stop.

    Between samples joints run linearly; the base of a differential drive runs on an arc of constant `v` and `omega`,
    that of an omnidirectional or mecanum one linearly in x, y and heading.
    """

    path: ToolPath
    joint_names: tuple[str, ...]
    base_joints: tuple[str, ...]
    """Those of them that drive the base: x, y and heading; none for a robot that stands still."""
    drive: Drive
    method: str
    limits: MotionLimits
    """The `MotionLimits` that the motion was made under."""
    q: Floats
    """[M + 1, N] in the robot's own convention, m and rad."""
    v: Floats
    """[M] m/s, forward, from sample k to k + 1; of any other drive [M, 2], along x and y of the world."""
    omega: Floats
    """[M] rad/s, to the left."""
    wheel_speeds: Floats | None
    """[M, 2] rad/s, left and right, of a differential drive; None for any other, and for a robot without `wheels`."""
    stop: TrackStop | None
    """Why the motion ends before its path does; None if it does not."""
    seconds: Floats
    """[M] wall time of each sample after the start, without compiling. Of `continuation`, the steps of the motion that
    was found, taken once more one by one as a controller would take them: `search_seconds` is what finding it took."""
    search_seconds: float
    """Wall time of the whole motion: starts, all rollouts, backtracking; without compiling and grading. Of the paper's
    methods it holds `continuation`'s search for a start, if none was given."""
    grade: TrackGrade
    """What plain numpy says about the samples."""
    certificate: Certificate | None
    """What is certain about collisions between them, with itself and a world; None: not checked, without a detector or
    a motion."""
    deviation_m: Floats
    """[M] distance of the tool from the path half-way between samples."""
    deviation_rad: Floats
    """[M] the same of its orientation, of what the path asks for."""
    moving: Moving = field(default_factory=dict)
    """Obstacles that moved meanwhile."""

    def __repr__(self) -> str:
        text = f"{self.method}, {self.drive}, {self.reached_points} of {self.path.samples} points"
        return f"<Trajectory of {self.path.name}: {text}{', stopped' if self.stop else ''}>"

    @property
    def error_m(self) -> Floats:
        """[M + 1, 3] tool minus path, along x, y, z."""
        return self.grade.error_m

    @property
    def orientation_error_rad(self) -> Floats:
        """[M + 1] of what the path asks for."""
        return self.grade.orientation_error_rad

    @property
    def clearance_m(self) -> Floats | None:
        """[M + 1] smallest over the detector's pairs, in a world of what has the least room; None without any pairs:
        not checked."""
        return self.grade.clearances_m if self.grade.gaps_m.shape[1] else None

    @property
    def certified_clearance_m(self) -> float | None:
        """What no pair falls below at any moment, samples or between; None without pairs, or a motion."""
        sampled, proof = self.grade.clearance_m, self.certificate
        return sampled if sampled is None or proof is None else min(proof.clearance_m, sampled)

    @property
    def violations(self) -> Violations:
        """How often each limit is broken."""
        return self.grade.violations

    @property
    def reached_points(self) -> int:
        """M: samples reached after the start."""
        return max(len(self.q) - 1, 0)

    @property
    def reached(self) -> bool:
        """True if the whole path was followed and no limit is broken, self-collision among them if it was checked."""
        return self.stop is None and self.reached_points == self.path.samples and self.grade.accepted

    @property
    def times_s(self) -> Floats:
        """When the samples 0 .. M are due, s."""
        return self.path.times_s[: len(self.q)]

    @property
    def joint_speeds(self) -> Floats:
        """[M, N] m/s and rad/s from sample k to k + 1: what linear motion between them needs."""
        return np.diff(self.q, axis=0) / self.path.dt_s

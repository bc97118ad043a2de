"""What will be tracked: a track file with every name resolved, in m, rad and s."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Self

import numpy as np

from ikde.errors import InputError, nearest
from ikde.files.entries import UnitsEntry
from ikde.files.placed import placed
from ikde.files.robot_entries import read_collision, to_si, with_ranges
from ikde.kernels.arrays import Floats
from ikde.model.collision_model import CollisionModel
from ikde.model.robot import WORLD, Robot
from ikde.solver.joints import JointValues, joints_outside
from ikde.track.drive import find_wheels, usual_drive
from ikde.track.limits import MotionLimits
from ikde.track.make_path import make_path
from ikde.track.path import ToolPath
from ikde.track.spec import Drive, LimitsEntry, TrackMethod, TrackSpec
from ikde.track.starts import read_start

NO_WHEELS = "an omnidirectional drive has no such wheels"
KINDS = ("prismatic", "revolute")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class TrackPlan:
    """Everything about a track but where its motion goes."""

    name: str
    collision: CollisionModel
    """What counts as self-collision, of the robot with the ranges that the file asks for."""
    path: ToolPath
    drive: Drive
    method: TrackMethod
    limits: MotionLimits
    start: Floats | None
    """Configuration to start in [N], m and rad; None to choose one."""
    seed: int
    file: str | None
    """The file it was read from, for the record only."""
    blame: Callable[[str, tuple[str | int, ...]], InputError] = InputError
    """What is wrong at a key of the file, as an error in its place."""
    replaced: tuple[str, ...] = ()
    """Keys of which it no longer has what the file says."""

    @property
    def robot(self) -> Robot:
        """The robot of the collision model."""
        return self.collision.robot

    def __repr__(self) -> str:
        told = f"{self.robot.name}, {self.method}, {self.drive}, {self.path.samples} points"
        return f"<TrackPlan {self.name}: {told}>"

    def with_changes(
        self,
        *,
        method: TrackMethod | None = None,
        drive: Drive | None = None,
        seed: int | None = None,
        start: JointValues | None = None,
    ) -> Self:
        """The plan with this instead of what its file says; None for what stays. `start` is in m and rad.

        Raises:
            InputError: for a start that does not fit the robot, and a drive without wheels whose speed is limited.
        """
        q = None if start is None else read_start(self.robot, start)
        given = {"method": method, "drive": drive, "seed": seed, "start": q}
        changes = {key: value for key, value in given.items() if value is not None}
        plan = replace(self, **changes, replaced=tuple(dict.fromkeys((*self.replaced, *changes))))
        has_limit = plan.limits.wheel_speed_rad_s is not None and plan.method != "typical"  # which keeps none
        if plan.drive == "omnidirectional" and has_limit:
            raise self.blame(NO_WHEELS, ("limits", "wheel_speed"))
        return plan


def make_plan(spec: TrackSpec, robot: Robot, *, folder: Path, file: str | None = None) -> TrackPlan:
    """Resolve a track file.

    Args:
        spec: the track file.
        robot: the robot that it names.
        folder: paths in the track file start here.
        file: the track file's name, for the record.

    Raises:
        InputError: with the path of the key inside the track file.
        FileError: for what is wrong inside a table.
    """
    robot = with_ranges(robot, spec.ranges, spec.units)
    drive = _read_drive(spec, robot)
    name = spec.name or (Path(file).stem if file else "track")
    with placed("detector"):
        collision = read_collision(robot, spec.detector, spec.units)
    return TrackPlan(
        name=name,
        collision=collision,
        path=make_path(spec, name, folder),
        drive=drive,
        method=spec.method,
        limits=_read_limits(spec, robot, drive),
        start=_read_start(spec, robot),
        seed=spec.seed,
        file=file,
    )


def _read_drive(spec: TrackSpec, robot: Robot) -> Drive:
    """What the file says; else arcs for a robot that has a base."""
    drive = spec.drive or usual_drive(robot)
    try:
        find_wheels(robot, drive)
    except InputError as error:
        raise InputError(f"{error.message}; leave it out, or say omnidirectional", ("drive",)) from None
    return drive


def _read_limits(spec: TrackSpec, robot: Robot, drive: Drive) -> MotionLimits:
    """Those of the file; what it leaves out is as in the paper (`MotionLimits.of`)."""
    limits, units, usual = spec.limits, spec.units, MotionLimits.of(robot)
    with placed("limits"):
        if limits.wheel_speed is not None and robot.wheels is None:
            raise InputError(f"{robot.name} has no wheels: its file has no `wheels`", ("wheel_speed",))
        if limits.wheel_speed is not None and drive == "omnidirectional":
            raise InputError(NO_WHEELS, ("wheel_speed",))
        _check_center(limits, robot)
        accelerations = _by_joint(robot, "acceleration", limits.acceleration, units, np.inf)
        return MotionLimits(
            ranges=limits.ranges,
            speed=_by_joint(robot, "speed", limits.speed, units, usual.speed),
            acceleration=accelerations if limits.acceleration else None,
            wheel_speed_rad_s=_scaled(limits.wheel_speed, units.angle_rad),
            farthest_m=_scaled(limits.farthest, units.length_m),
            center=limits.center,
            position_error_m=_scaled(limits.position_error, units.length_m) or usual.position_error_m,
            orientation_error_rad=_scaled(limits.orientation_error, units.angle_rad) or usual.orientation_error_rad,
        )


def _check_center(limits: LimitsEntry, robot: Robot) -> None:
    """A distance and the frame that it is measured from go together."""
    frames = [WORLD, *(frame.name for frame in robot.frames)]
    if limits.center is not None and limits.center not in frames:
        raise InputError(f"{robot.name} has no frame {limits.center!r}{nearest(limits.center, frames)}", ("center",))
    if (limits.farthest is None) != (limits.center is None):
        missing = "center" if limits.center is None else "farthest"
        raise InputError("`farthest` and `center` go together: one of them is missing", (missing,))


def _scaled(value: float | None, unit: float) -> float | None:
    return None if value is None else value * unit


def _by_joint(
    robot: Robot, key: str, given: Mapping[str, float | None], units: UnitsEntry, usual: Floats | float | None
) -> Floats:
    """Limits by joint [N], `usual` where none is given; a joint's own comes before that of its kind."""
    for name in given:
        if name not in (*robot.joint_names, *KINDS):
            known = nearest(name, (*robot.joint_names, *KINDS))
            raise InputError(f"{robot.name} has no joint {name!r}{known}; or say prismatic or revolute", (key, name))
    row = np.broadcast_to(np.asarray(usual, dtype=float), len(robot.joints)).copy()
    for index, joint in enumerate(robot.joints):
        name = joint.name if joint.name in given else joint.kind
        if name in given:
            value = given[name]
            unit = units.length_m if joint.kind == "prismatic" else units.angle_rad
            row[index] = np.inf if value is None else value * unit
    return row


def _read_start(spec: TrackSpec, robot: Robot) -> Floats | None:
    if spec.start is None:
        return None
    given = to_si(robot, "start", spec.start, spec.units)
    start = np.array([given.get(joint.name, joint.home) for joint in robot.joints])
    for name in joints_outside(robot, start)[: int(spec.limits.ranges)]:
        raise InputError(f"{start[robot.joint_names.index(name)]:g} is outside the range", ("start", name))
    return start

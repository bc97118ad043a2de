"""From a track file to a `TrackPlan`: every name resolved, and what is wrong placed at its key."""

from collections.abc import Callable, Mapping
from contextlib import AbstractContextManager
from pathlib import Path

import numpy as np

from ikde.errors import InputError, nearest
from ikde.formats.attached import list_held, pick_up
from ikde.formats.entries import UnitsEntry
from ikde.formats.error_path import prefix_errors
from ikde.formats.margins import read_margins
from ikde.formats.poses import read_orientation, read_position
from ikde.formats.robot_entries import read_collision, to_si, with_ranges
from ikde.kernels.arrays import Floats
from ikde.model.base_motion import find_wheels, usual_drive
from ikde.model.collision_model import CollisionModel
from ikde.model.robot import WORLD, Drive, Robot
from ikde.model.world import World
from ikde.solver.joints import joints_outside
from ikde.solver.standing import refuse_touching
from ikde.track.limits import MotionLimits
from ikde.track.make_path import make_path
from ikde.track.moving import POSES, Moving, ObjectMotion, place_at
from ikde.track.plan import NO_MECANUM_LIMIT, TrackPlan
from ikde.track.spec import LimitsEntry, TrackSpec
from ikde.track.starts import settle_start

KINDS = ("prismatic", "revolute")
ReadWorld = Callable[[str], tuple[World, Callable[[], AbstractContextManager[None]]]]
"""Reads a world file, whose path starts where the track file is; and a block in which what does not fit the robot is
said at its place in that file. Raises `FileError`."""


def make_plan(
    spec: TrackSpec, robot: Robot, *, folder: Path, file: str | None = None, read_world: ReadWorld | None = None
) -> TrackPlan:
    """Resolve a track file.

    Args:
        spec: the track file.
        robot: the robot that it names.
        folder: paths in the track file start here.
        file: the track file's name, for the record.
        read_world: reads the world file that it names.

    Raises:
        InputError: with the path of the key inside the track file.
        FileError: for what is wrong inside a table, or a world file.
    """
    robot = with_ranges(robot, spec.ranges, spec.units)
    drive = _read_drive(spec, robot)
    name = spec.name or (Path(file).stem if file else "track")
    with prefix_errors("detector"):
        collision = read_collision(robot, spec.detector, spec.units)
    moving = _read_moving(spec)
    collision = _place_in_world(collision, spec, moving, read_world)
    plan = TrackPlan(
        name=name,
        collision=collision,
        path=make_path(spec, name, folder),
        drive=drive,
        method=spec.method,
        limits=_read_limits(spec, robot, drive),
        start=_read_start(spec, robot),
        seed=spec.seed,
        file=file,
        world_file=spec.world,
        moving=moving,
    )
    if plan.start is not None:
        settle_start(plan, plan.start)
    return plan


def _place_in_world(
    collision: CollisionModel, spec: TrackSpec, moving: Moving, read: ReadWorld | None
) -> CollisionModel:
    """The robot among the obstacles of the world that the file names, if it names one."""
    if spec.world is None:
        if spec.margin is not None:
            raise InputError("a margin needs a `world` to be kept from", ("margin",))
        if spec.attached:
            raise InputError("what is picked up is an obstacle of a `world`: name one", ("attached",))
        return collision
    if not collision.pairs:
        message = "a world needs a detector: without spheres nothing can be compared with it"
        raise InputError(message, ("detector" if spec.detector is not None else "world",))
    assert read is not None, "`read_world` reads what `world` names"
    world, errors = read(spec.world)
    margin = None if spec.margin is None else str(spec.margin)
    start, held = _read_start(spec, collision.robot), list_held(spec.attached)
    with errors():
        world = pick_up(world, held, collision, start, "attached")
        model = collision.in_world(world, *read_margins(margin, spec.units.length_m))
        known = {name: motion for name, motion in moving.items() if name in model.world}
        refuse_touching(place_at(model, known, 0.0))
    return model


def _read_moving(spec: TrackSpec) -> dict[str, ObjectMotion]:
    """How obstacles move, in m; poses that give no orientation are those of the world."""
    if spec.moving and spec.world is None:
        raise InputError("what moves is an obstacle of a `world`: name one", ("moving",))
    moving = {}
    for name, entry in spec.moving.items():
        with prefix_errors("moving", name):
            poses = []
            for k, place in enumerate(entry.poses):
                with prefix_errors("poses", k):
                    p = read_position("position", place.position, spec.units)
                    given = read_orientation(place, spec.units)
                    if "axis_world_tool" in given:
                        raise InputError("expected rpy or quat_wxyz: an axis leaves a turn open", ("axis",))
                    poses.append(np.column_stack([given.get("R_world_tool", np.eye(3)), p]))
            try:
                moving[name] = ObjectMotion(np.array(entry.times_s), np.array(poses))
            except InputError as error:
                where = ("poses", *error.where[1:]) if error.where[:1] == (POSES,) else error.where
                raise InputError(error.message, where) from None
    return moving


def _read_drive(spec: TrackSpec, robot: Robot) -> Drive:
    """What the file says; else arcs for a robot that has a base."""
    drive = spec.drive or usual_drive(robot)
    try:
        find_wheels(robot, drive)
    except InputError as error:
        raise InputError(f"{error.message}; leave it out, or say omnidirectional", ("drive",)) from None
    return drive


def _read_limits(spec: TrackSpec, robot: Robot, drive: Drive) -> MotionLimits:
    """Those of the file; what it leaves out is the robot's own, or as in the paper (`MotionLimits.of`)."""
    limits, units, usual = spec.limits, spec.units, MotionLimits.of(robot)
    with prefix_errors("limits"):
        if limits.wheel_speed is not None and robot.wheels is None:
            raise InputError(f"{robot.name} has no wheels: its file has no `wheels`", ("wheel_speed",))
        if limits.wheel_speed is not None and drive == "omnidirectional":
            raise InputError("an omnidirectional drive has no such wheels", ("wheel_speed",))
        if limits.wheel_speed is not None and drive == "mecanum":
            raise InputError(NO_MECANUM_LIMIT, ("wheel_speed",))
        _check_center(limits, robot)
        return MotionLimits(
            ranges=limits.ranges,
            speed=_by_joint(robot, "speed", limits.speed, units, usual.speed),
            acceleration=_by_joint(robot, "acceleration", limits.acceleration, units, usual.acceleration),
            wheel_speed_rad_s=_scaled(limits.wheel_speed, units.angle_rad),
            max_distance_m=_scaled(limits.max_distance, units.length_m),
            center=limits.center,
            position_error_m=_scaled(limits.position_error, units.length_m) or usual.position_error_m,
            orientation_error_rad=_scaled(limits.orientation_error, units.angle_rad) or usual.orientation_error_rad,
        )


def _check_center(limits: LimitsEntry, robot: Robot) -> None:
    """A distance and the frame that it is measured from go together."""
    frames = [WORLD, *(frame.name for frame in robot.frames)]
    if limits.center is not None and limits.center not in frames:
        raise InputError(f"{robot.name} has no frame {limits.center!r}{nearest(limits.center, frames)}", ("center",))
    if (limits.max_distance is None) != (limits.center is None):
        missing = "center" if limits.center is None else "max_distance"
        raise InputError("`max_distance` and `center` go together: one of them is missing", (missing,))


def _scaled(value: float | None, unit: float) -> float | None:
    return None if value is None else value * unit


def _by_joint(
    robot: Robot, key: str, given: Mapping[str, float | None], units: UnitsEntry, usual: Floats | None
) -> Floats | None:
    """Limits by joint [N], the `usual` ones where none is given; a joint's own comes before that of its kind."""
    if not given:
        return usual
    for name in given:
        if name not in (*robot.joint_names, *KINDS):
            known = nearest(name, (*robot.joint_names, *KINDS))
            raise InputError(f"{robot.name} has no joint {name!r}{known}; or say prismatic or revolute", (key, name))
    row = np.full(len(robot.joints), np.inf) if usual is None else usual.copy()
    for index, joint in enumerate(robot.joints):
        kind = "prismatic" if joint.kind == "prismatic" else "revolute"
        name = joint.name if joint.name in given else kind
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

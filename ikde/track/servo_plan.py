"""What a servo's kernel takes beside target and state: laid out once for a robot and its limits, and for each world."""

from dataclasses import dataclass

import numpy as np

from ikde.errors import InputError
from ikde.kernels.arrays import Floats, Ints, read_only
from ikde.kernels.flat_arguments import GRID_COLUMNS, HEADER, flatten_models
from ikde.model.base_motion import base_carries
from ikde.model.collision_model import CollisionModel
from ikde.model.pack import pack_robot
from ikde.model.robot import Drive, Robot
from ikde.track.certify import travel_radii
from ikde.track.certify_world import reach_radii
from ikde.track.drive import by_step, max_steps, pack_drive
from ikde.track.follower import pack_track
from ikde.track.limits import MotionLimits
from ikde.track.settings import NULLSPACE_WEIGHTS

NO_WORLD = read_only(np.zeros(HEADER + GRID_COLUMNS + 1))  # as a packed world without obstacles


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ServoPlan:
    """A robot and its limits for the kernel; entries of a step are those of `DriveArrays`."""

    base: Ints
    """[3 + others] coordinates of a base on arcs, or -1; then those that move by themselves."""
    plan: Floats
    """[13] as `kernels/servo.py` numbers them."""
    ranges: Floats
    """[2, N]"""
    rates: Floats
    """[3, D] speeds and accelerations, m/s, rad/s and per s, and the largest step of any time."""

    @classmethod
    def of(cls, collision: CollisionModel, limits: MotionLimits, drive: Drive) -> "ServoPlan":
        """Lay it out; raises `InputError` for a drive or limits that do not fit the robot."""
        robot = collision.robot
        limits.check(robot)
        arrays, track = pack_drive(robot, drive, limits, 1.0), pack_track(collision, limits)
        if drive == "differential" and not base_carries(collision):
            message = "a base on arcs must carry all that can collide; say omnidirectional, or leave out the rest"
            raise InputError(message, ("collision",))
        endless = np.full(len(robot.joints), np.inf)
        speed = endless if limits.speed is None else np.where(robot.upper <= robot.lower, 0.0, limits.speed)
        acceleration = endless if limits.acceleration is None else limits.acceleration
        rates = [by_step(values, arrays.base, arrays.others) for values in (speed, acceleration, max_steps(robot))]
        numbers = [track.reach, track.margin, track.rotation_length, arrays.half_track, arrays.wheel_travel]
        numbers += [arrays.max_distance, arrays.centre_body, *arrays.p_body_centre, *NULLSPACE_WEIGHTS[0]]
        return cls(
            base=np.concatenate([arrays.base, arrays.others]).astype(np.int64),
            plan=np.array(numbers, dtype=float),
            ranges=np.ascontiguousarray(track.ranges),
            rates=np.array(rates, dtype=float),
        )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ServoModels:
    """A collision model for the kernel, but for the world itself."""

    numbers: Floats
    whole: Ints
    radii: Floats
    """[P + C, N] by how much a joint changes the gap of each pair, moves each component at most: m a rad, or 1."""

    @classmethod
    def of(cls, collision: CollisionModel) -> "ServoModels":
        """Lay it out; it is the same for all worlds in which the robot holds the same things."""
        robot, arrays = collision.robot, collision.arrays
        numbers, whole = flatten_models(pack_robot(robot), arrays._replace(world=np.empty(0)))
        radii = np.zeros((len(arrays.pairs) + len(arrays.components), len(robot.joints)))
        if collision.pairs:
            largest = np.maximum(np.abs(robot.lower), np.abs(robot.upper))
            radii[: len(arrays.pairs)] = travel_radii(collision, largest)
            if collision.is_in_world:
                radii[len(arrays.pairs) :] = reach_radii(collision, largest)
        return cls(numbers=numbers, whole=whole, radii=radii)


def world_of(collision: CollisionModel) -> Floats:
    """The packed world, or one without obstacles."""
    world = collision.arrays.world
    return world if world.size else NO_WORLD


def list_entries(robot: Robot, base: Ints) -> tuple[str, ...]:
    """Names of the entries of a step [D]: joints, and of a base on arcs `v` and the joint of its heading."""
    others = [robot.joint_names[k] for k in base[3:]]
    return tuple(others) if base[0] < 0 else ("v", robot.joint_names[base[2]], *others)

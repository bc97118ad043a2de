"""Bases that drive in the plane: which joints drive one, how it moves between samples, and its twist.

`differential`: two driven wheels, whether the robot's file describes them or not. Between samples the speeds v and
omega stay, so the base runs along an exact arc and never slips sideways [Qiao2022, eq. 5]. `omnidirectional`: x, y and
heading run linearly. So does every joint of an arm. `mecanum`: the same, on four wheels whose speeds follow from the
twist (`model/wheels.py`).
"""

from functools import lru_cache

import numpy as np

from ikde.errors import InputError
from ikde.kernels.arrays import COORDINATE, PARENT, PRISMATIC, Floats, Ints, read_only
from ikde.model.collision_model import CollisionModel
from ikde.model.pack import pack_robot
from ikde.model.pairs import component_bodies
from ikde.model.robot import DRIVES, Drive, Robot
from ikde.model.tree import build_tree

NO_BASE = read_only(np.array([-1, -1, -1]))
HEADING = 3  # the body that a base's third joint rotates


@lru_cache(maxsize=64)
def find_planar_base(robot: Robot) -> Ints:
    """Coordinates [3] of x, y and heading of a planar base and carries all that can collide.

    -1 thrice for any other robot; read-only.
    """
    arrays = pack_robot(robot)
    bodies, T = arrays.bodies, arrays.T_parent_body
    if len(bodies) < 4 or bodies[1:4, PARENT].tolist() != [0, 1, 2] or bodies[1:4, PRISMATIC].tolist() != [1, 1, 0]:
        return NO_BASE
    x, y, heading = bodies[1:4, COORDINATE].tolist()
    steps = np.eye(4)
    axes = []
    for k in (1, 2, 3):
        steps = steps @ np.vstack([T[k], [0.0, 0.0, 0.0, 1.0]])
        axes.append(steps[:3, 2])
    is_plane = np.allclose(axes, np.eye(3), atol=1e-12) and np.allclose(steps[:2, 3], 0.0, atol=1e-12)
    models = (CollisionModel(robot=robot, detector=detector) for detector in robot.detectors.values())
    carries_all = all(map(base_carries, models))
    carries_all &= bool((bodies[4:, PARENT] >= HEADING).all())
    if not (is_plane and carries_all):
        return NO_BASE
    return read_only(np.array([x, y, heading]))


def need_base(robot: Robot) -> tuple[int, int, int]:
    """The same of a robot that must have such a base; raises `InputError`, at `base`, for any other."""
    x, y, heading = find_planar_base(robot).tolist()
    if x < 0:
        raise InputError(f"{robot.name} has no planar base (x, y, yaw) to stand in it", ("base",))
    return x, y, heading


def find_base_frame(robot: Robot) -> str:
    """The frame that the heading of a planar base rotates: its origin is where the base stands; as `need_base`."""
    heading = robot.joint_names[need_base(robot)[2]]
    return next(frame.name for frame in robot.frames if frame.joint == heading)


def base_joints(robot: Robot) -> tuple[str, ...]:
    """Names of x, y and heading of a planar base; none for a robot without."""
    return tuple(robot.joint_names[k] for k in find_planar_base(robot) if k >= 0)


def base_carries(collision: CollisionModel) -> bool:
    """Whether all that is compared rides on a planar base: where the base is does not matter then."""
    bodies = component_bodies(collision.rows, build_tree(collision.robot))
    return all(bodies[component] >= HEADING for pair in collision.pairs for component in pair)


def usual_drive(robot: Robot) -> Drive:
    """What the robot's file says, else what its wheels are for; `omnidirectional` without a base to drive."""
    if find_planar_base(robot)[0] < 0:
        return "omnidirectional"
    is_mecanum = robot.wheels is not None and robot.wheels.half_wheelbase_m is not None
    return robot.drive or ("mecanum" if is_mecanum else "differential")


def find_wheels(robot: Robot, drive: str) -> Ints:
    """Coordinates [3] of x, y and heading of a base that runs on arcs; -1 thrice for a drive without.

    Raises `InputError` for an unknown drive, a robot that has no base to drive, and wheels that drive otherwise.
    """
    if drive not in DRIVES:
        raise InputError(f"expected one of {', '.join(DRIVES)}, got {drive!r}", ("drive",))
    if drive == "omnidirectional":
        return np.full(3, -1)
    base = find_planar_base(robot).copy()
    if base[0] < 0:
        raise InputError(f"{robot.name} has no planar base (x, y, yaw)", ("drive",))
    check_wheels(robot, drive)
    return base if drive == "differential" else np.full(3, -1)


def check_wheels(robot: Robot, drive: str | None) -> None:
    """Raise `InputError`, at `drive`, if the wheels of the robot's file are not those of this drive."""
    if robot.wheels is None or drive in (None, "omnidirectional"):
        return
    is_mecanum = robot.wheels.half_wheelbase_m is not None
    if drive == "mecanum" and not is_mecanum:
        raise InputError(f"the wheels of {robot.name} give no `half_wheelbase`, which mecanum wheels have", ("drive",))
    if drive == "differential" and is_mecanum:
        raise InputError(f"{robot.name} has mecanum wheels: expected mecanum or omnidirectional", ("drive",))


def move_base(start: Floats, twist: Floats, dt_s: Floats | float) -> Floats:
    """Where a base [..., 3] is after `dt_s` of a constant `twist` [..., 3]: the end of the exact arc, x, y and heading.

    The twist is that of the base in its own frame: m/s forward and to the left, rad/s to the left. In whatever steps
    one constant twist is added up, it ends at the same place.
    """
    angle = twist[..., 2] * dt_s
    share, middle = np.sinc(0.5 * angle / np.pi) * dt_s, start[..., 2] + 0.5 * angle
    along, aside, cos, sin = twist[..., 0] * share, twist[..., 1] * share, np.cos(middle), np.sin(middle)
    return start + np.stack([along * cos - aside * sin, along * sin + aside * cos, angle], axis=-1)


def dead_reckon(start: Floats, twists: Floats, dt_s: float) -> Floats:
    """Places of a base [K + 1, 3] from `start` [3] on, after `dt_s` of each of the `twists` [K, 3] (`move_base`)."""
    places = np.empty((len(twists) + 1, 3))
    places[0] = start
    for k, twist in enumerate(twists):
        places[k + 1] = move_base(places[k], twist, dt_s)
    return places


def twist_at(twist: Floats, p_base_point: Floats) -> Floats:
    """The twist [..., 3] of the base as a point that rides on it has it, `p_base_point` [2] m from its middle.

    A point M that lies l_m behind the middle of a differential base, (-l_m, 0), moves sideways by -l_m omega
    [DongZhao, eq. 1, 2].
    """
    omega = twist[..., 2]
    return np.stack([twist[..., 0] - omega * p_base_point[1], twist[..., 1] + omega * p_base_point[0], omega], axis=-1)


def step_base(start: Floats, v: Floats, omega: Floats, dt_s: Floats | float) -> Floats:
    """Where a base [..., 3] is after `dt_s` of constant `v` m/s and `omega` rad/s [...]: the end of the exact arc."""
    angle = omega * dt_s
    chord, middle = v * dt_s * np.sinc(0.5 * angle / np.pi), start[..., 2] + 0.5 * angle
    return start + np.stack([chord * np.cos(middle), chord * np.sin(middle), angle], axis=-1)


def base_twist(start: Floats, end: Floats, dt_s: float) -> tuple[Floats, Floats, Floats]:
    """The arc between two places of a base [..., 3]: v in m/s, omega in rad/s, and what no arc explains in m/s.

    That residual is the chord's velocity across the mid heading: (5) along the motion, 0 on an arc.
    """
    shift = end - start
    middle, angle = 0.5 * (start[..., 2] + end[..., 2]), shift[..., 2]
    along = shift[..., 0] * np.cos(middle) + shift[..., 1] * np.sin(middle)
    across = shift[..., 1] * np.cos(middle) - shift[..., 0] * np.sin(middle)
    return along / np.sinc(0.5 * angle / np.pi) / dt_s, angle / dt_s, across / dt_s

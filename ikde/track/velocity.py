"""Speeds of base and arm for tasks in order of priority, inside the limits of every joint."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple, TypeVar

import numpy as np

from ikde.errors import InputError, nearest, quoted
from ikde.kernels.arrays import Floats, read_only
from ikde.model.arguments import RobotLike, read_robot
from ikde.model.base_motion import find_planar_base, usual_drive
from ikde.model.numbers import is_number
from ikde.model.robot import Robot
from ikde.model.value import MadeAnew
from ikde.model.wheels import wheels_by_twist
from ikde.solver.jacobian import find_frame
from ikde.solver.joints import JointValues, read_configuration, read_joints
from ikde.solver.motion import MAX_WEIGHT, MIN_WEIGHT
from ikde.solver.plain import compute_frames
from ikde.solver.priority import SOFTEST, Speeds
from ikde.track.limits import MotionLimits
from ikde.track.task_rows import TaskRows, make_rows
from ikde.track.velocity_bounds import Motion, NamedBounds, make_bounds
from ikde.track.velocity_levels import Problem, find_way, solve_tasks
from ikde.track.velocity_task import VelocityTask

MIN_DT_S, MAX_DT_S = 1e-6, 10.0
MAX_TASKS, MAX_SHARED = 20, 4
MET = 1e-6  # m/s or rad/s
Made = TypeVar("Made")
CLOSE = 1e-7  # m/s, rad/s: what counts as at a limit


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class TaskSpeeds(MadeAnew):
    """What became of one task."""

    wanted: Floats
    """[m] m/s, rad/s: gain x error and the given velocity. Rows are x, y, z of the frame along the world's axes, then
    its angular velocity along these (of an axis: about the frame's own x and y); of a base x, y and heading; of joints
    as they were given."""
    got: Floats
    """[m] what the speeds make of it."""
    error: Floats
    """[m] m, rad: how far it was from where it should be, before moving."""
    smallest_singular_value: float
    """Of what the levels before leave to this one, in m for a unit of speed: 0 where a row cannot be served at all."""
    damped: bool
    """Whether the task is slowed down because it is near a singularity."""
    held_by: tuple[str, ...]
    """Limits that keep its level from doing better, such as `elbow: speed`; empty where only the levels before do, or
    the robot's shape."""

    @property
    def left(self) -> Floats:
        """[m] m/s, rad/s: what is missing, wanted - got."""
        return self.wanted - self.got

    @property
    def met(self) -> bool:
        """Whether all of it is done, to 1e-6 m/s and rad/s."""
        return bool(np.abs(self.left).max(initial=0.0) <= MET)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class VelocityResult(MadeAnew):
    """Speeds of the joints, and of the wheels of a base that has some."""

    q_dot: Floats
    """[N] m/s, rad/s in the order of q."""
    twist: Floats | None
    """[3] of a planar base in its own frame: m/s forward and to the left, rad/s to the left; None without a base."""
    wheels: Floats | None
    """[2] left and right, or [4] front left, rear left, rear right, front right, rad/s; None without known wheels."""
    tasks: tuple[TaskSpeeds, ...]
    """In the order in which they were given."""
    at_limit: tuple[str, ...]
    """All speeds that are at a limit, and which, such as `elbow: range`."""
    broken: tuple[str, ...]
    """Joints that change their speed faster than they may: their range or speed leaves no other way, or their limits
    and those of the wheels together leave none."""

    def __repr__(self) -> str:
        met = sum(task.met for task in self.tasks)
        fastest = float(np.abs(self.q_dot).max(initial=0.0))
        return f"<VelocityResult: {met} of {len(self.tasks)} tasks met, fastest {fastest:.3g}>"


def velocity(
    robot: RobotLike,
    q: JointValues,
    tasks: VelocityTask | Sequence[VelocityTask],
    *,
    dt_s: float = 0.01,
    limits: MotionLimits | None = None,
    before: JointValues | None = None,
    weights: Mapping[str, float] | None = None,
    softest: float = SOFTEST,
) -> VelocityResult:
    """Speeds of base and arm together that serve tasks in order of priority, inside all limits.

    Each task gets what those before it leave, by least squares, and disturbs none of them. Of what no task needs the
    speeds are the least. A base is sought by its twist, so wheels never work against each other.

    Args:
        robot: the robot, its name or the path of its file.
        q: joint values [N] in the robot's order, or a mapping by joint name; m and rad.
        tasks: one or several (`VelocityTask.tool`, `.base`, `.joints`), the first most important unless they have
            levels.
        dt_s: how long these speeds are kept: what a range and an acceleration leave depends on it.
        limits: of speed, acceleration, range and wheels; None for the joints' own (`MotionLimits.of`). Its other fields
            do not matter here.
        before: speeds [N] of the instant before, m/s and rad/s, from which accelerations count; None: not limited.
        weights: what a unit of speed of a joint counts where the least are sought, by joint name, per m/s or rad/s;
            1 where none is given.
        softest: damping begins where a singular value falls below this, in m for a unit of speed; a task then asks for
            at most |wanted| / softest of speed. 0 damps nothing.

    Raises:
        InputError: for a wrong `q` or `before`, an unknown frame or joint, a base task of a robot without a base, tasks
            of which some have a level and some none, and numbers out of range. What cannot be done is no error: see
            `TaskSpeeds`.
    """
    robot = read_robot(robot)
    q = read_configuration(robot, q)
    read = _read_tasks(tasks)
    last = None if before is None else read_joints(robot, before, argument="before")
    if last is not None and last.shape != q.shape:
        raise InputError(f"expected one speed a joint, got shape {last.shape}", ("before",))
    if not (is_number(dt_s) and MIN_DT_S <= dt_s <= MAX_DT_S):
        raise InputError(f"expected a time from {MIN_DT_S:g} to {MAX_DT_S:g} s, got {quoted(dt_s)}", ("dt_s",))
    if not (is_number(softest) and 0.0 <= softest <= MAX_WEIGHT):
        raise InputError(f"expected a number from 0 to {MAX_WEIGHT:g}, got {quoted(softest)}", ("softest",))
    limits = _own_limits(robot) if limits is None else limits.check(robot)
    given = _Given(robot, q, limits, float(dt_s), last)
    way = find_way(robot, q, limits, _read_weights(robot, weights))
    problem = Problem(_make_all_rows(robot, q, read), _list_levels(read), way, None, float(softest))
    return _answer(given, problem, [float(task.share) for task in read])


_own_limits = lru_cache(maxsize=64)(MotionLimits.of)


class _Given(NamedTuple):
    """What was given, as it was read."""

    robot: Robot
    q: Floats
    limits: MotionLimits
    dt_s: float
    before: Floats | None


def _answer(given: _Given, problem: Problem, shares: list[float]) -> VelocityResult:
    """Speeds within the bounds; accelerations are given up where the others leave no speeds with them."""
    named = make_bounds(given.robot, given.limits, Motion(given.q, problem.way.mapping, given.dt_s, given.before))
    speeds = solve_tasks(problem._replace(bounds=named.bounds), shares)
    if not speeds.within:
        named = make_bounds(given.robot, given.limits, Motion(given.q, problem.way.mapping, given.dt_s, None))
        speeds = solve_tasks(problem._replace(bounds=named.bounds), shares)
    q_dot = _clip(given.robot, speeds.x, named)
    twist = _find_twist(given.robot, given.q, q_dot)
    return VelocityResult(
        q_dot=read_only(q_dot),
        twist=twist,
        wheels=_find_wheel_speeds(given.robot, twist),
        tasks=_describe_tasks(problem, speeds, q_dot, named),
        at_limit=_list_limits(named, named.rows_by_joint @ q_dot),
        broken=_list_broken(given, q_dot),
    )


def _read_tasks(tasks: VelocityTask | Sequence[VelocityTask]) -> list[VelocityTask]:
    """Tasks as a list; raises `InputError` for what is none, for too many, and for levels of some alone."""
    expected = f"expected 1 to {MAX_TASKS} of `VelocityTask`"
    if isinstance(tasks, VelocityTask):
        return [tasks]
    if isinstance(tasks, str | bytes | Mapping) or not isinstance(tasks, Iterable):
        raise InputError(f"{expected}, got {quoted(tasks)}", ("tasks",))
    read = list(tasks)
    if not 1 <= len(read) <= MAX_TASKS:
        raise InputError(f"{expected}, got {len(read)}", ("tasks",))
    for place, task in enumerate(read):
        if not isinstance(task, VelocityTask):
            raise InputError(f"expected a `VelocityTask`, got {quoted(task)}", ("tasks", place))
    if len({task.level is None for task in read}) > 1:
        place = next(place for place, task in enumerate(read) if task.level is None)
        raise InputError("it has no level, while others have one", ("tasks", place))
    if sum(0.0 < task.share < 1.0 for task in read) > MAX_SHARED:
        raise InputError(f"at most {MAX_SHARED} tasks may have a share between 0 and 1 at a time", ("tasks",))
    return read


def _list_levels(tasks: list[VelocityTask]) -> list[list[int]]:
    """Which tasks stand on each level, the first first."""
    numbers = [place if task.level is None else task.level for place, task in enumerate(tasks)]
    return [[place for place, own in enumerate(numbers) if own == number] for number in sorted(set(numbers))]


def _make_all_rows(robot: Robot, q: Floats, tasks: list[VelocityTask]) -> list[TaskRows]:
    frames = _for_each(tasks, lambda task: find_frame(robot, task.frame) if task.kind == "tool" else None)
    Ts_world = compute_frames(robot, q, tuple(frame for frame in frames if frame is not None))
    return _for_each(tasks, lambda task: make_rows(robot, q, task, Ts_world))


def _for_each(tasks: list[VelocityTask], make: Callable[[VelocityTask], Made]) -> list[Made]:
    """What is made of each task; an `InputError` says which it was."""
    made = []
    for place, task in enumerate(tasks):
        try:
            made.append(make(task))
        except InputError as error:
            raise InputError(error.message, ("tasks", place, *error.where)) from None
    return made


def _read_weights(robot: Robot, weights: Mapping[str, float] | None) -> Floats:
    """Weights [N], 1 for all that are not given, the least scaled to 1: so they do not move where damping begins."""
    read, names = np.ones(len(robot.joints)), robot.joint_names
    if weights is not None and not isinstance(weights, Mapping):
        raise InputError(f"expected weights by joint name, got {quoted(weights)}", ("weights",))
    for name, value in (weights or {}).items():
        if name not in names:
            raise InputError(f"{robot.name} has no joint {quoted(name)}{nearest(str(name), names)}", ("weights",))
        if not (is_number(value) and MIN_WEIGHT <= value <= MAX_WEIGHT):
            wrong = f"expected a number from {MIN_WEIGHT:g} to {MAX_WEIGHT:g}, got {quoted(value)}"
            raise InputError(wrong, ("weights", name))
        read[names.index(name)] = value
    return read / read.min()


def _clip(robot: Robot, q_dot: Floats, named: NamedBounds) -> Floats:
    """Speeds exactly inside: what the solver's tolerance may leave is cut off; a base on two wheels is slowed down.

    So is one that a wheel's limit holds: along its own direction, wherever standing still is inside.
    """
    q_dot, held, base = q_dot.copy(), named.joints >= 0, find_planar_base(robot)
    is_free = base[0] < 0 or usual_drive(robot) != "differential"
    if not is_free:
        held &= ~np.isin(named.joints, base)
    places = named.joints[held]
    q_dot[places] = np.clip(q_dot[places], named.bounds.lower[held], named.bounds.upper[held])
    if base[0] >= 0:
        values = named.rows_by_joint[~held] @ q_dot
        ends = np.where(values > 0.0, named.bounds.upper[~held], named.bounds.lower[~held])
        over = (np.abs(values) > np.abs(ends)) & (ends * values >= 0.0)
        over &= (np.abs(ends) > MET) | (np.abs(values) > MET)  # a trace of speed at an end of a range stops nothing
        q_dot[base] *= np.min(ends[over] / values[over], initial=1.0)
    return q_dot


def _find_twist(robot: Robot, q: Floats, q_dot: Floats) -> Floats | None:
    base = find_planar_base(robot)
    if base[0] < 0:
        return None
    (x, y, turn), heading = q_dot[base], float(q[base[2]])
    cos, sin = np.cos(heading), np.sin(heading)
    return read_only(np.array([cos * x + sin * y, cos * y - sin * x, turn]))


def _find_wheel_speeds(robot: Robot, twist: Floats | None) -> Floats | None:
    if twist is None or robot.wheels is None or usual_drive(robot) == "omnidirectional":
        return None
    return read_only(wheels_by_twist(robot.wheels) @ twist)


def _describe_tasks(problem: Problem, speeds: Speeds, q_dot: Floats, named: NamedBounds) -> tuple[TaskSpeeds, ...]:
    found, values = {}, named.rows_by_joint @ q_dot
    for level, places in enumerate(problem.levels):
        held_by = tuple(_name_limit(named, k, values) for k in speeds.holding[level])
        for place in places:
            rows = problem.rows[place]
            found[place] = TaskSpeeds(
                wanted=read_only(rows.wanted),
                got=read_only(rows.matrix @ q_dot),
                error=read_only(rows.error),
                smallest_singular_value=speeds.smallest[level],
                damped=speeds.damped[level],
                held_by=held_by,
            )
    return tuple(found[place] for place in range(len(found)))


def _name_limit(named: NamedBounds, k: int, values: Floats) -> str:
    """The limit at the nearer end of one bound."""
    is_low = abs(values[k] - named.bounds.lower[k]) <= abs(values[k] - named.bounds.upper[k])
    return f"{named.names[k]}: {named.low[k] if is_low else named.high[k]}"


def _list_limits(named: NamedBounds, values: Floats) -> tuple[str, ...]:
    """All limits that speeds are at."""
    room = np.minimum(values - named.bounds.lower, named.bounds.upper - values)
    return tuple(_name_limit(named, int(k), values) for k in np.flatnonzero(room <= CLOSE))


def _list_broken(given: _Given, q_dot: Floats) -> tuple[str, ...]:
    """Joints whose speed changes faster than it may."""
    if given.before is None or given.limits.acceleration is None:
        return ()
    change = np.abs(q_dot - given.before) - given.limits.acceleration * given.dt_s
    return tuple(name for name, excess in zip(given.robot.joint_names, change, strict=True) if excess > CLOSE)

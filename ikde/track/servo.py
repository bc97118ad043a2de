"""Towards a target that may be another at every step: one step at a time, each with a stop behind it that is free."""

from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike

from ikde.errors import InputError, quoted
from ikde.kernels.arrays import Floats
from ikde.kernels.servo import P_LENGTH, servo_step
from ikde.kernels.servo_room import (
    CLEARANCE,
    CODES,
    ERROR,
    IS_BRAKING,
    IS_FREE,
    IS_PROVED,
    MEMORY,
    NEAREST,
    NUMBERS,
    ORIENTATION_ERROR,
    POSITION_ERROR,
)
from ikde.model.arguments import RobotLike, TargetLike, read_robot, read_target
from ikde.model.base_motion import usual_drive
from ikde.model.collision_model import CollisionChoice, CollisionModel
from ikde.model.numbers import is_number
from ikde.model.robot import Drive, Robot
from ikde.model.target import KINDS, Target
from ikde.model.world import World
from ikde.solver.compile_note import name_work, note_compile
from ikde.solver.joints import JointValues, read_configuration
from ikde.track.held import Holding, no_target, tell_held
from ikde.track.limits import MotionLimits
from ikde.track.servo_plan import ServoModels, ServoPlan, list_entries, world_of
from ikde.track.servo_result import ServoStep

LONGEST_S = 1.0  # a step is found near its start
OUTSIDE = 1e-9  # m, rad: rounding of a file's or a controller's
TAKES = "a minute or so"
NO_POSE = np.zeros((3, 4))
NO_TARGET = np.append(-1.0, np.zeros(MEMORY - 1))


class Servo:
    """Moves a robot towards a target, step by step: inside its limits, free of collision, able to stop.

    After every step the robot could brake, all speeds shrinking together as fast as the acceleration limits allow, and
    would stay inside its ranges, clear of itself and of the world, all the way. Making one loads its machine code, or
    compiles it, once on a machine (`ikde warmup` does so ahead); no step compiles, whatever target or world.

    Args:
        robot: a robot, the name of one that ships with ikde, or a file.
        q: where it stands, [N] or by joint name, m and rad. It may be in collision: then it moves out.
        limits: what is kept; by default `MotionLimits.of(robot)`.
        world: what stands around; `servo.world = other` exchanges it.
        collision: as for `solve`: a detector, or a model whose margins are kept. With "none" nothing is checked.
        drive: `differential` or `omnidirectional`, of a base; by default as the robot's file says.

    Raises:
        InputError: for an unknown robot, what does not fit it, and a `q` outside its ranges.
    """

    def __init__(
        self,
        robot: RobotLike,
        q: JointValues,
        *,
        limits: MotionLimits | None = None,
        world: World | None = None,
        collision: CollisionChoice = None,
        drive: Drive | None = None,
    ) -> None:
        robot = read_robot(robot)
        model = CollisionModel.of(robot, collision)
        if world is not None:
            model = model.own.in_world(world, model.margin_m, dict(model.margins_m))
        self._robot, self._limits = robot, MotionLimits.of(robot) if limits is None else limits
        self._drive: Drive = usual_drive(robot) if drive is None else drive
        self._plan = ServoPlan.of(model, self._limits, self._drive)
        self._entries = list_entries(robot, self._plan.base)
        self._size = len(self._entries)
        self._q, self._speeds = _read_q(robot, q, self._limits), np.zeros(self._size)
        self._memory = NO_TARGET
        self._models: dict[Any, ServoModels] = {}
        self._set_model(model)
        with note_compile(lambda: name_work("servos", model), TAKES):
            self._call(NO_POSE, -1, 0.01)

    def __repr__(self) -> str:
        return f"<Servo {self._robot.name}: {self._drive}, {self._collision.world!r}>"

    @property
    def robot(self) -> Robot:
        """The robot."""
        return self._robot

    @property
    def q(self) -> Floats:
        """[N] where it stands, m and rad."""
        return self._q.copy()

    @property
    def limits(self) -> MotionLimits:
        """What is kept."""
        return self._limits

    @property
    def collision(self) -> CollisionModel:
        """What is compared."""
        return self._collision

    @property
    def world(self) -> World:
        """What stands around. Another one takes its place at once: setting it compiles nothing."""
        return self._collision.world

    @world.setter
    def world(self, world: World) -> None:
        model = self._collision
        self._set_model(model.own.in_world(world, model.margin_m, dict(model.margins_m)))
        self._memory = _unproved(self._memory)

    @property
    def rotation_length_m(self) -> float:
        """What a rad of the tool's rotation counts beside a metre of its position, in `ServoStep.error_m`."""
        return float(self._plan.plan[P_LENGTH])

    @property
    def state(self) -> dict[str, list[float]]:
        """All that the next step depends on beside target, time and world, as plain numbers.

        `q` [N], the `speeds` of the last step, and its `target` with how fast that moved (-1: there was none).
        """
        return {"q": self._q.tolist(), "speeds": self._speeds.tolist(), "target": _unproved(self._memory).tolist()}

    @state.setter
    def state(self, state: Mapping[str, Sequence[float]]) -> None:
        _check_state(state)
        q = _read_q(self._robot, state["q"], self._limits)  # type: ignore[arg-type]
        speeds = _read_row(state["speeds"], "speeds", self._size)
        self._q, self._speeds, self._memory = q, speeds, _unproved(_read_row(state["target"], "target", MEMORY))

    @classmethod
    def from_state(cls, robot: RobotLike, state: Mapping[str, Sequence[float]], **options: Any) -> Self:
        """A servo that goes on from another one's `state`, bit for bit; `options` as for `Servo`.

        Raises:
            InputError: for what is no state of this robot.
        """
        robot = read_robot(robot)
        _check_state(state)
        servo = cls(robot, state["q"], **options)
        servo.state = state
        return servo

    def step(self, target: TargetLike | None, dt_s: float) -> ServoStep:
        """Take the next step towards a target.

        Args:
            target: a `Target` (pose, position or axis), a position [3] in m, or a pose [4, 4]; another one at any step.
                None: brake. So does a target with NaN, or a matrix that is no rotation; the result says so.
            dt_s: how long the step takes, s; above 0, 1 at most.

        Returns:
            Where it leads. The servo is there then.

        Raises:
            InputError: for a time that is none, and for what has not the form of a target.
        """
        if not (is_number(dt_s) and 0.0 < dt_s <= LONGEST_S):
            raise InputError(f"expected a time above 0 s and up to {LONGEST_S:g} s, got {quoted(dt_s)}", ("dt_s",))
        wrong = None
        if type(target) is not Target:
            target, wrong = _read_target(target)
        dt_s = float(dt_s)
        if target is None:
            out, numbers, codes = self._call(NO_POSE, -1, dt_s)
        else:
            out, numbers, codes = self._call(target.T_world_tool.copy(), KINDS.index(target.kind), dt_s)
        joints = len(self._q)
        q, self._speeds, self._memory = out[:joints], out[3 * joints : -MEMORY], out[-MEMORY:]
        self._q, limits, is_there = q.copy(), self._limits, False
        position, orientation, error = None, None, None
        if target is not None:
            position, orientation, error = (
                numbers.item(POSITION_ERROR),
                numbers.item(ORIENTATION_ERROR),
                numbers.item(ERROR),
            )
            is_there = position <= limits.position_error_m and orientation <= limits.orientation_error_rad
        holding = Holding(
            self._collision, self._entries, self._limits, self._plan, numbers, codes, self._speeds, q, dt_s
        )
        return ServoStep(
            q=q,
            dq=out[joints : 2 * joints],
            position_error_m=position,
            orientation_error_rad=orientation,
            error_m=error,
            reached=is_there,
            is_braking=codes.item(IS_BRAKING) == 1,
            stop_is_free=codes.item(IS_PROVED) == 1,
            q_stop=out[2 * joints : 3 * joints],
            _collision=self._collision,
            _least=(numbers.item(CLEARANCE), codes.item(NEAREST)),
            _hold=partial(no_target, wrong) if target is None else partial(tell_held, holding, is_there),
        )

    def _call(self, T_world_tool: Floats, kind: int, dt_s: float) -> tuple[Floats, Floats, Any]:
        plan, models = self._plan, self._packed
        out, numbers = np.empty(3 * len(self._q) + self._size + MEMORY), np.empty(NUMBERS)
        codes = np.empty(CODES, dtype=np.int64)
        self._kernel(
            models.numbers,
            models.whole,
            self._world,
            plan.plan,
            plan.base,
            plan.ranges,
            plan.rates,
            models.radii,
            T_world_tool,
            kind,
            dt_s,
            self._q,
            self._speeds,
            self._memory,
            out,
            numbers,
            codes,
        )
        return out, numbers, codes

    @property
    def _kernel(self) -> Any:
        return servo_step.compiled

    def _set_model(self, model: CollisionModel) -> None:
        key = (model.laden if model.is_in_world else model.own, model.is_in_world)
        if key not in self._models:
            self._models = {key: ServoModels.of(model)}
        self._collision, self._packed, self._world = model, self._models[key], world_of(model)


def _read_target(target: Any) -> tuple[Target | None, str | None]:
    """A target, or why it is none; raises `InputError` for what has not even its form."""
    if target is None:
        return None, None
    try:
        return read_target(target), None
    except InputError as error:
        numbers = np.asarray(target) if isinstance(target, np.ndarray | list | tuple) else np.empty(0)
        if numbers.dtype.kind in "biuf" and numbers.shape in ((3,), (4, 4)):
            return None, error.message
        raise


def _read_q(robot: Robot, q: JointValues, limits: MotionLimits) -> Floats:
    """A configuration [N] inside the ranges; raises `InputError` at `q`."""
    row = np.array(read_configuration(robot, q), dtype=float)
    if not limits.ranges:
        return row
    outside = np.flatnonzero((row < robot.lower - OUTSIDE) | (row > robot.upper + OUTSIDE))
    for k in outside[:1].tolist():
        message = f"{robot.joint_names[k]} stands at {row[k]:.6g}, outside {robot.lower[k]:.6g} .. {robot.upper[k]:.6g}"
        raise InputError(message, ("q", robot.joint_names[k]))
    return np.clip(row, robot.lower, robot.upper)


def _unproved(memory: Floats) -> Floats:
    """The same of a servo whose stop is not known to be free."""
    other = memory.copy()
    other[IS_FREE] = 0.0
    return other


def _check_state(state: object) -> None:
    """Raise `InputError` at `state` for what is none."""
    if not isinstance(state, Mapping) or set(state) != {"q", "speeds", "target"}:
        message = f"expected q, speeds and target, as `Servo.state` gives them, got {quoted(state)}"
        raise InputError(message, ("state",))


def _read_row(given: ArrayLike, name: str, size: int) -> Floats:
    """Numbers [size] of a state; raises `InputError`."""
    try:
        row = np.array(given, dtype=float)
    except (TypeError, ValueError):
        row = np.empty(0)
    if row.shape != (size,) or not np.isfinite(row).all():
        raise InputError(f"expected {size} finite numbers, got {quoted(given)}", ("state", name))
    return row

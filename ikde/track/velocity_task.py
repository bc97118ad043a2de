"""What a robot's speeds are for: one task of `ikde.velocity`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal, Self

import numpy as np
from numpy.typing import ArrayLike

from ikde.errors import InputError, quoted
from ikde.kernels.arrays import Floats
from ikde.model.arguments import TargetLike, read_target
from ikde.model.numbers import is_number, read_numbers
from ikde.model.robot import TOOL
from ikde.model.target import Target
from ikde.model.value import ReadOnlyValue

TaskKind = Literal["tool", "base", "joints"]
MAX_GAIN, MAX_RATE = 1e4, 1e6
NO_VALUES: Mapping[str, float] = {}


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class VelocityTask(ReadOnlyValue):
    """Where something should be, how fast it should move, or both: the speed wanted is gain x error + given velocity.

    Make it by `tool`, `base` or `joints`. What these have in common:

    Args:
        gain: 1/s, from the error to the speed that takes it away; 0 for a given velocity alone.
        max_speed: of what the gain asks for, m/s (of joints the fastest one, m/s or rad/s); more is shortened, all
            parts alike. The given velocity comes on top.
        level: tasks of a lower level have priority over those of a higher one, tasks of one level are weighed against
            each other. None: each task comes after the one before it in the list. All tasks have a level, or none.
        share: how much of the task there is, from 0 (as if it were not there) to 1. Raise it step by step and the task
            comes in without a jump: in between it asks for a value between its own and what would be without it
            [Lee2012].

    Raises:
        InputError: for NaN, a wrong shape or range, and where neither a place nor a velocity is given.
    """

    kind: TaskKind
    frame: str = TOOL
    """Whose motion a task of kind `tool` is about."""
    target: Target | None = None
    """Where that frame should be; None: only a velocity is given."""
    place: Floats | None = None
    """[2] or [3]: x, y in m, and heading in rad of a base."""
    values: Mapping[str, float] = field(default_factory=dict)
    """Joint values by name, m or rad."""
    velocity: Floats | None = None
    """m/s, rad/s: of the frame along the world's axes [3] or [6], or of the base [2] or [3]."""
    rates: Mapping[str, float] = field(default_factory=dict)
    """Joint speeds by name, m/s or rad/s."""
    gain: float = 1.0
    max_speed: float | None = None
    level: int | None = None
    share: float = 1.0

    def __post_init__(self) -> None:
        """Keep copies, and refuse what is no task."""
        ReadOnlyValue.__post_init__(self)
        if not (is_number(self.gain) and 0.0 <= self.gain <= MAX_GAIN):
            raise InputError(f"expected a number from 0 to {MAX_GAIN:g} per second, got {quoted(self.gain)}", ("gain",))
        if self.max_speed is not None and not (is_number(self.max_speed) and 0.0 < self.max_speed < np.inf):
            raise InputError(f"expected a number above 0, or None, got {quoted(self.max_speed)}", ("max_speed",))
        if self.level is not None and (not isinstance(self.level, int) or isinstance(self.level, bool)):
            raise InputError(f"expected a whole number, or None, got {quoted(self.level)}", ("level",))
        if not (is_number(self.share) and 0.0 <= self.share <= 1.0):
            raise InputError(f"expected a number from 0 to 1, got {quoted(self.share)}", ("share",))

    @classmethod
    def tool(
        cls,
        target: TargetLike | None = None,
        *,
        twist: ArrayLike | None = None,
        frame: str = TOOL,
        gain: float = 1.0,
        max_speed: float | None = None,
        level: int | None = None,
        share: float = 1.0,
    ) -> Self:
        """The tool, or another frame, towards a target, with a given velocity, or both.

        Args:
            target: a position, a position with the direction of the z axis, or a pose, in the world.
            twist: velocity [3] of the frame's origin in m/s, or that and the angular velocity [6] in rad/s, along the
                axes of the world. With a target it is the target's own velocity; of an axis target the rotation about
                the axis stays free.
            frame: by its name; the tool if none is given.
            gain: 1/s, as for every task.
            max_speed: m/s, as for every task.
            level: as for every task.
            share: as for every task.
        """
        read = None if target is None else read_target(target)
        velocity = None if twist is None else _read_row(twist, "twist", (3, 6))
        if read is None and velocity is None:
            raise InputError("expected a target or a twist, got neither", ("target",))
        if not isinstance(frame, str):
            raise InputError(f"expected the name of a frame, got {quoted(frame)}", ("frame",))
        return cls(
            kind="tool",
            target=read,
            velocity=velocity,
            frame=frame,
            gain=gain,
            max_speed=max_speed,
            level=level,
            share=share,
        )

    @classmethod
    def base(
        cls,
        place: ArrayLike | None = None,
        *,
        velocity: ArrayLike | None = None,
        gain: float = 1.0,
        max_speed: float | None = None,
        level: int | None = None,
        share: float = 1.0,
    ) -> Self:
        """A planar base towards a place, with a given velocity, or both.

        Args:
            place: x and y in m, or x, y and heading in rad.
            velocity: as many numbers, m/s and rad/s, along the axes of the world. Alone it is that of x, y and heading,
                or of x and y.
            gain: 1/s, as for every task.
            max_speed: m/s, as for every task.
            level: as for every task.
            share: as for every task.
        """
        read = None if place is None else _read_row(place, "place", (2, 3))
        given = None if velocity is None else _read_row(velocity, "velocity", (2, 3))
        if read is None and given is None:
            raise InputError("expected a place or a velocity, got neither", ("place",))
        if read is not None and given is not None and len(read) != len(given):
            raise InputError(f"expected {len(read)} numbers, as many as of the place, got {len(given)}", ("velocity",))
        return cls(
            kind="base",
            place=read,
            velocity=given,
            gain=gain,
            max_speed=max_speed,
            level=level,
            share=share,
        )

    @classmethod
    def joints(
        cls,
        values: Mapping[str, float] = NO_VALUES,
        *,
        rates: Mapping[str, float] = NO_VALUES,
        gain: float = 1.0,
        max_speed: float | None = None,
        level: int | None = None,
        share: float = 1.0,
    ) -> Self:
        """Some joints towards values, with given speeds, or both.

        Args:
            values: m or rad by joint name, in the robot's own convention.
            rates: m/s or rad/s by joint name.
            gain: 1/s, as for every task.
            max_speed: m/s, as for every task.
            level: as for every task.
            share: as for every task.
        """
        read, given = _read_by_joint(values, "values"), _read_by_joint(rates, "rates")
        if not (read or given):
            raise InputError("expected values or rates of at least one joint, got neither", ("values",))
        return cls(
            kind="joints",
            values=read,
            rates=given,
            gain=gain,
            max_speed=max_speed,
            level=level,
            share=share,
        )


def _read_row(values: ArrayLike, name: str, sizes: tuple[int, int]) -> Floats:
    row = read_numbers(values, (name,))
    if row.ndim != 1 or len(row) not in sizes:
        raise InputError(f"expected {sizes[0]} or {sizes[1]} numbers, got shape {row.shape}", (name,))
    if not (np.abs(row) <= MAX_RATE).all():  # False for NaN
        raise InputError(f"expected finite numbers up to {MAX_RATE:g}, got {row.tolist()}", (name,))
    return row


def _read_by_joint(values: Mapping[str, float], name: str) -> dict[str, float]:
    if not isinstance(values, Mapping):
        raise InputError(f"expected numbers by joint name, got {quoted(values)}", (name,))
    for joint, value in values.items():
        if not (is_number(value) and abs(value) <= MAX_RATE):  # False for NaN
            raise InputError(f"expected a finite number, got {quoted(value)}", (name, str(joint)))
    return {joint: float(value) for joint, value in values.items()}

"""What a motion must keep, as parts that can be switched off one by one: None, or False, is off."""

from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import ArrayLike

from ikde.errors import InputError
from ikde.kernels.arrays import Floats, read_only
from ikde.model.actuators import joint_speeds
from ikde.model.robot import WORLD, Robot
from ikde.solver.settings import SolveSettings


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class MotionLimits:
    """The limits of a motion [Qiao2022, section 2.2]. Self-collision is the detector's matter.

    Raises:
        InputError: for a negative number, NaN, or a distance without a centre.
    """

    ranges: bool = True
    """Every joint stays in its range: q_L <= q <= q_U (13)."""
    speed: Floats | None
    """[N] m/s, rad/s: |dq/dt| <= this, at every moment (14, 15). The speed of a base with wheels along its heading is
    held to the lower of those of x and y. 0: frozen; infinite: any."""
    acceleration: Floats | None = None
    """[N] m/s^2, rad/s^2: the speeds of two neighbouring segments differ by no more than this times dt. The first
    segment may have any speed, and what comes after the last does not count: a path may begin and end in motion. The
    paper has no such limit."""
    wheel_speed_rad_s: float | None = None
    """Of both wheels of a differential base (6), if the robot's file describes them. The speed limits of the base imply
    (v + B omega) / r."""
    max_distance_m: float | None = None
    """Of the tool from the platform's centre, at every sample (18): D_max, which is not printed."""
    center: str | None = None
    """The frame that (18) measures from."""
    position_error_m: float = 1e-6
    """Per axis, at every sample (20, 22)."""
    orientation_error_rad: float = 1e-4
    """At every sample, of what the path asks for (21)."""

    def __post_init__(self) -> None:
        for name in ("speed", "acceleration"):
            value = getattr(self, name)
            if value is not None:
                object.__setattr__(self, name, _read_row(value, name, may_be_zero=name == "speed"))
        for name in ("wheel_speed_rad_s", "max_distance_m", "position_error_m", "orientation_error_rad"):
            value = getattr(self, name)
            if value is not None and not 0.0 < value < np.inf:
                raise InputError(f"expected a finite number above 0, got {value!r}", ("limits", name))
        if self.orientation_error_rad > np.pi:
            message = f"expected at most pi, half a turn, got {self.orientation_error_rad!r}"
            raise InputError(message, ("limits", "orientation_error_rad"))
        if self.max_distance_m is not None and self.center is None:
            raise InputError("a largest distance needs the frame that it is measured from", ("limits", "center"))

    @classmethod
    def of(cls, robot: Robot, **changes: object) -> Self:
        """The joints' own speeds and accelerations, as the robot's file gives them.

        Where it gives none: 0.5 m/s for a prismatic joint, pi/2 rad/s for a revolute one [Qiao2022], any acceleration.
        """
        acceleration = np.array([joint.max_acceleration or np.inf for joint in robot.joints])
        own = {"speed": joint_speeds(robot), "acceleration": acceleration if np.isfinite(acceleration).any() else None}
        return cls(**{**own, **changes})  # type: ignore[arg-type]

    @property
    def tolerances(self) -> SolveSettings:
        """The accepted errors as the solver's tolerances."""
        return SolveSettings(
            position_tolerance_m=self.position_error_m, orientation_tolerance_rad=self.orientation_error_rad
        )

    def check(self, robot: Robot) -> Self:
        """Return the limits; raises `InputError` if they don't fit the robot."""
        for name in ("speed", "acceleration"):
            value = getattr(self, name)
            if value is not None and len(value) != len(robot.joints):
                message = f"expected {len(robot.joints)} numbers, one a joint, got {len(value)}"
                raise InputError(message, ("limits", name))
        frames = (WORLD, *(frame.name for frame in robot.frames))
        if self.center is not None and self.center not in frames:
            raise InputError(f"{robot.name} has no frame {self.center!r}", ("limits", "center"))
        if self.wheel_speed_rad_s is not None and robot.wheels is None:
            raise InputError(f"{robot.name} has no wheels", ("limits", "wheel_speed_rad_s"))
        return self


def _read_row(value: ArrayLike, name: str, *, may_be_zero: bool) -> Floats:
    """Numbers [N], read-only."""
    try:
        row = np.array(value, dtype=float)
    except (TypeError, ValueError):
        raise InputError(f"expected numbers, got {value!r}", ("limits", name)) from None
    good = (row >= 0.0) if may_be_zero else (row > 0.0)
    if row.ndim != 1 or not good.all():
        least = "at least" if may_be_zero else "above"
        raise InputError(f"expected a number {least} 0 for each joint, got {row.tolist()}", ("limits", name))
    return read_only(row)

"""How figures are shown: lengths and angles in the user's unit, with a sensible number of digits."""

from dataclasses import dataclass

from ikde.files.entries import ANGLES_RAD, LENGTHS_M
from ikde.model.robot import Joint


@dataclass(frozen=True, slots=True)
class Units:
    """Units of a printed page."""

    length: str = "m"
    angle: str = "rad"

    def format_length(self, value_m: float) -> str:
        """`0.0401 m` or `40.1 mm`."""
        return f"{value_m / LENGTHS_M[self.length]:.6g} {self.length}"

    def format_error(self, value_m: float) -> str:
        """A small length: `7.5e-06 m` or `0.0075 mm`."""
        return f"{value_m / LENGTHS_M[self.length]:.3g} {self.length}"

    def format_angle(self, value_rad: float) -> str:
        """A small angle."""
        return f"{value_rad / ANGLES_RAD[self.angle]:.3g} {self.angle}"

    def joint_unit(self, joint: Joint) -> str:
        """Unit of one joint."""
        return self.length if joint.kind == "prismatic" else self.angle

    def joint_value(self, joint: Joint, value: float) -> float:
        """Value of one joint in its unit."""
        return value / (LENGTHS_M[self.length] if joint.kind == "prismatic" else ANGLES_RAD[self.angle])


def format_fixed(value: float, digits: int) -> str:
    """A number with fixed digits and no minus zero."""
    return f"{round(float(value), digits) + 0.0:.{digits}f}"

"""How figures are written: few digits, in the user's units, the same everywhere."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import isfinite, pi

from ikde.formats.units import ANGLES_RAD, LENGTHS_M
from ikde.model.robot import Joint


@dataclass(frozen=True, slots=True)
class Units:
    """Units that lengths and angles are shown in."""

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

    def format_limit(self, joint: Joint, limit: float, digits: int) -> str:
        """One end of a joint's range; `none` of a continuous joint."""
        return f"{self.joint_value(joint, limit):.{digits}g}" if isfinite(limit) else "none"

    def joint_value(self, joint: Joint, value: float) -> float:
        """Value of one joint in its unit."""
        return value / (LENGTHS_M[self.length] if joint.kind == "prismatic" else ANGLES_RAD[self.angle])


def fixed(value: float, digits: int) -> str:
    """A number with thousands separated and no minus zero: `1,481.10`."""
    return f"{round(value, digits) + 0.0:,.{digits}f}"


def format_fixed(value: float, digits: int) -> str:
    """A number with fixed digits and no minus zero."""
    return f"{round(float(value), digits) + 0.0:.{digits}f}"


def significant(value: float, digits: int = 3) -> str:
    """A number with so many significant digits: `0.00154`, `83.0`, `1,240`."""
    rounded = float(f"{value:.{digits - 1}e}")
    if rounded == 0.0 or abs(rounded) < 1e-4:
        return f"{rounded:.{digits - 1}e}" if rounded else "0"
    exponent = int(f"{abs(rounded):e}".split("e")[1])
    return f"{rounded:,.{max(0, digits - 1 - exponent)}f}"


def count_of(number: int, thing: str) -> str:
    """`1 target`, `1,200 targets`."""
    return f"{number:,} {thing}{'s' if number != 1 else ''}"


def seconds(value_s: float) -> str:
    """`< 1 ns`, `23 ns`, `7.9 µs`, `1.4 ms`, `2.1 s` or `1,250 s`."""
    return _in_unit(value_s, ((1e9, "ns"), (1e6, "µs"), (1e3, "ms"), (1.0, "s")), (1e-6, 1e-3, 1.0))


def length(value_m: float) -> str:
    """`0`, `< 1 nm`, `51 nm`, `7.9 µm`, `0.05 mm`, `-1.51 mm`, `1,240 mm` or `12.4 m`."""
    return _in_unit(value_m, ((1e9, "nm"), (1e6, "µm"), (1e3, "mm"), (1.0, "m")), (1e-6, 1e-5, 10.0))


def angle(value_rad: float) -> str:
    """`0`, `< 1 nrad`, `51 nrad`, `7.9 µrad`, `0.05 deg` or `-120 deg`."""
    return _in_unit(value_rad, ((1e9, "nrad"), (1e6, "µrad"), (180.0 / pi, "deg")), (1e-6, 1e-5))


def _in_unit(value: float, units: Sequence[tuple[float, str]], ends: Sequence[float]) -> str:
    """At most three digits in the first unit whose end is not reached; below 1 of the smallest unit only the bound."""
    size, (least, smallest) = abs(value), units[0]
    if size == 0.0:
        return "0"
    if size * least < 0.9995:  # what rounds to 1 is 1
        return f"< 1 {smallest}"
    factor, unit = units[sum(float(f"{size:.2e}") >= end for end in ends)]
    return f"{float(f'{value * factor:.2e}'):,.12g} {unit}"


def percent(value_pct: float) -> str:
    """`73.0 %`."""
    return f"{fixed(value_pct, 1)} %"


def with_interval(value: float, interval: Sequence[float], digits: int = 1) -> str:
    """A number with the interval that it lies in: `73.0 (63.6–80.7)`."""
    low, high = interval
    return f"{fixed(value, digits)} ({fixed(low, digits)}–{fixed(high, digits)})"


def vector(values: Sequence[float], digits: int) -> str:
    """`540.0, 0.0, 569.2`."""
    return ", ".join(fixed(value, digits) for value in values)

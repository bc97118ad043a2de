"""How well a robot moves where it stands: `analyze`, all measures of one configuration at once."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from ikde.kernels.arrays import Floats
from ikde.model.actuators import By, actuator_names, speed_limits
from ikde.model.arguments import RobotLike, read_robot
from ikde.model.base_motion import find_planar_base
from ikde.model.robot import Robot
from ikde.solver.joints import JointValues, joints_outside, read_configuration
from ikde.solver.measures import LENGTH_M, MeasureChoice, Measures, Part, Rows, chosen_jacobian, leave_out, measure
from ikde.solver.motion import limit_margin

PARTS: tuple[Part, ...] = ("whole", "arm", "base")
KINDS: tuple[Rows, ...] = ("pose", "translation", "rotation")

SINGULAR = 1e-9  # of the largest singular value: what a smallest one below it is left of is rounding

ByPart = Mapping[Part, Mapping[Rows, Measures]]


@dataclass(frozen=True, slots=True, kw_only=True)
class LimitMargin:
    """How far a joint is from its limits, m or rad; inf where there are none."""

    joint: str
    below: float
    """From the lower limit; negative outside."""
    above: float
    """From the upper limit."""
    share: float
    """The smaller of both as a share of the range: from 0 at a limit to 1/2; 1/2 without limits."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Addition:
    """What a joint, a wheel or a direction of the base adds to the manipulability of the whole robot.

    1 - (manipulability without it) / (manipulability): 0 if the others do it all, 1 if it is needed; None in a
    singularity.
    """

    name: str
    pose: float | None
    translation: float | None
    rotation: float | None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Analysis:
    """What `analyze` finds of one configuration."""

    robot: Robot
    q: Floats
    """[N] in the robot's own convention, m and rad."""
    by: By
    names: tuple[str, ...]
    """[A] what the columns of the Jacobian are of."""
    speeds: Floats
    """[A] their speed limits, m/s or rad/s, which `scaled` counts with."""
    length_m: float
    """What a radian of the tool's rotation counts as in `scaled`."""
    scaled: ByPart
    """Measures by part (`whole`, `arm`; `base` if there is one) and rows (`pose`, `translation`, `rotation`), in m/s
    where all move at their speed limits."""
    raw: ByPart
    """The same of the Jacobian in m and rad as it is; those of `pose` depend on the unit of length."""
    jacobian: Floats
    """[6, A] the scaled one of the whole robot, in the world's axes."""
    additions: tuple[Addition, ...]
    """[A] what each column adds, scaled."""
    limits: tuple[LimitMargin, ...]
    """[N] of each joint."""
    outside_limits: tuple[str, ...]

    def __repr__(self) -> str:
        whole = self.scaled["whole"]["pose"]
        figures = f"manipulability {whole.manipulability:.6g}, {whole.smallest:.6g} from singular"
        return f"<Analysis of {self.robot.name}: {figures}>"

    @property
    def limit_margin(self) -> float:
        """The smallest share of its range that a joint is from its limits."""
        return float(limit_margin(self.robot.lower, self.robot.upper, self.q))


def analyze(
    robot: RobotLike,
    q: JointValues,
    *,
    by: By = "twist",
    length_m: float = LENGTH_M,
    convention: str | None = None,
) -> Analysis:
    """Measure how well the tool can be moved: manipulability, condition, distance to a singularity, and what limits it.

    Args:
        robot: the robot, its name or the path of its file.
        q: one configuration [N] in the robot's order, or a mapping by joint name; m and rad.
        by: what the robot is moved by: its `joints`, the `twist` of its base and its other joints, or its `actuators`,
            wheels and joints (`jacobian`).
        length_m: what a radian of the tool's rotation counts as beside a metre of its motion.
        convention: how `q` is counted; None for the robot's own.

    Raises:
        InputError: for a wrong `q`, word or length, and as `jacobian` for `by`.
    """
    robot = read_robot(robot)
    q = read_configuration(robot, q, convention)
    usual = MeasureChoice(by=by, length_m=length_m)
    return Analysis(
        robot=robot,
        q=q,
        by=by,
        names=actuator_names(robot, by),
        speeds=speed_limits(robot, by),
        length_m=float(length_m),
        scaled=_measure_parts(robot, q, usual),
        raw=_measure_parts(robot, q, replace(usual, scaled=False, length_m=1.0)),
        jacobian=chosen_jacobian(robot, q, replace(usual, length_m=1.0)),
        additions=_list_additions(robot, q, usual),
        limits=tuple(map(partial(_measure_limits, robot, q), range(len(q)))),
        outside_limits=joints_outside(robot, q),
    )


def list_parts(robot: Robot) -> tuple[Part, ...]:
    """Which parts of a robot can be measured."""
    return PARTS if find_planar_base(robot)[0] >= 0 else PARTS[:2]


def _measure_parts(robot: Robot, q: Floats, usual: MeasureChoice) -> ByPart:
    return {
        part: {rows: measure(robot, q, replace(usual, part=part, rows=rows)) for rows in KINDS}
        for part in list_parts(robot)
    }


def _list_additions(robot: Robot, q: Floats, usual: MeasureChoice) -> tuple[Addition, ...]:
    shares: dict[Rows, list[float | None]] = {}
    for rows in KINDS:
        jacobian = chosen_jacobian(robot, q, replace(usual, rows=rows))
        whole, without = measure(robot, q, replace(usual, rows=rows)), leave_out(jacobian)
        is_regular = whole.smallest > SINGULAR * whole.singular_values[0]
        shares[rows] = (
            (1.0 - without / whole.manipulability).clip(0.0, 1.0).tolist() if is_regular else [None] * len(without)
        )
    names = actuator_names(robot, usual.by)
    return tuple(Addition(name=name, **{rows: shares[rows][k] for rows in KINDS}) for k, name in enumerate(names))


def _measure_limits(robot: Robot, q: Floats, place: int) -> LimitMargin:
    joint, value = robot.joints[place], float(q[place])
    share = float(limit_margin(robot.lower[place : place + 1], robot.upper[place : place + 1], q[place : place + 1]))
    return LimitMargin(joint=joint.name, below=value - joint.lower, above=joint.upper - value, share=share)


def split_jacobian(analysis: Analysis) -> dict[str, Floats]:
    """The scaled Jacobian [6, n] by part: of all columns, and of the arm and the base if there is one, m/s, rad/s."""
    robot, base = analysis.robot, find_planar_base(analysis.robot)
    joints = [name for place, name in enumerate(robot.joint_names) if place not in base]
    is_arm = np.array([name in joints for name in analysis.names])
    whole: dict[str, Floats] = {"whole": analysis.jacobian}
    parts = {"arm": analysis.jacobian[:, is_arm], "base": analysis.jacobian[:, ~is_arm]}
    return whole if is_arm.all() else whole | parts

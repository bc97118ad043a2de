"""The judge: plain numpy, written apart from the kernels, grading the exact joint values that are returned."""

from dataclasses import dataclass

import numpy as np

from ikde.kernels.arrays import Floats
from ikde.model.robot import Detector, Robot
from ikde.model.rotation import angle_between, rotation_angle
from ikde.model.target import Target
from ikde.solver.check import compute_pairs
from ikde.solver.joints import JointValues, joints_outside, read_configuration
from ikde.solver.plain import compute_frames
from ikde.solver.settings import SolveSettings


@dataclass(frozen=True, slots=True, kw_only=True)
class Verification:
    """The figures of one configuration against one target, and the verdict."""

    position_error_m: float
    orientation_error_rad: float
    """Norm of the rotation vector; of an axis target the angle between the axes; of a position target 0."""
    clearance_m: float | None
    """None without a detector."""
    closest_pair: tuple[str, str] | None
    self_collision: bool
    colliding_pairs: tuple[tuple[str, str], ...]
    outside_limits: tuple[str, ...]
    within_tolerance: bool
    accepted: bool
    """Within both tolerances, inside all limits, free of self-collision."""


def verify(
    robot: Robot,
    target: Target,
    q: JointValues,
    *,
    settings: SolveSettings | None = None,
    detector: str | Detector | None = None,
    convention: str | None = None,
) -> Verification:
    """Grade joint values against a target.

    Args:
        robot: the robot.
        target: what the tool is asked to do.
        q: joint values [N] or a mapping by joint name; m and rad.
        settings: the tolerances (default 1e-5 m, 1e-4 rad).
        detector: a name, a `Detector`, `"none"`, or None for the robot's default.
        convention: how `q` is counted; None for the robot's own.

    Raises:
        InputError: for a wrong count, an unknown joint, detector or convention, NaN or infinity.
    """
    values = read_configuration(robot, q, convention)
    tolerances = settings or SolveSettings()
    chosen = robot.detector(detector)
    T_world_tool = compute_frames(robot, values)[robot.tool]
    position = float(np.linalg.norm(T_world_tool[:3, 3] - target.p_world_tool))
    orientation = compute_orientation_error(target, T_world_tool[:3, :3])
    pairs = compute_pairs(robot, chosen, values) if chosen else ()
    colliding = tuple((pair.a, pair.b) for pair in pairs if pair.collides)
    outside = joints_outside(robot, values)
    within = position <= tolerances.position_tolerance_m and orientation <= tolerances.orientation_tolerance_rad
    return Verification(
        position_error_m=position,
        orientation_error_rad=orientation,
        clearance_m=pairs[0].clearance_m if pairs else None,
        closest_pair=(pairs[0].a, pairs[0].b) if pairs else None,
        self_collision=bool(colliding),
        colliding_pairs=colliding,
        outside_limits=outside,
        within_tolerance=within,
        accepted=within and not colliding and not outside,
    )


def compute_orientation_error(target: Target, R_world_tool: Floats) -> float:
    """Angle in rad between the tool and what the target asks of its orientation."""
    if target.kind == "pose":
        return rotation_angle(target.R_world_tool.T @ R_world_tool)
    if target.kind == "axis":
        return angle_between(target.axis_world_tool, R_world_tool[:, 2])
    return 0.0

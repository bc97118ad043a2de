"""The grader in plain numpy, written apart from the kernels, grading the exact joint values that are returned."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ikde.kernels.arrays import Floats
from ikde.model.arguments import RobotLike, read_robot, read_target
from ikde.model.collision_model import CollisionChoice, CollisionModel
from ikde.model.region import GoalLike, Region
from ikde.model.rotation import angle_between, rotation_angle
from ikde.model.target import AXIS, POSE, Target, Targets
from ikde.solver.families import label_family
from ikde.solver.joints import JointValues, read_configuration
from ikde.solver.obstacle_clearance import ObstacleClearance, find_nearest_obstacle
from ikde.solver.plain import compute_frames, compute_gaps
from ikde.solver.region_grade import grade_frames
from ikde.solver.settings import SolveSettings, choose_settings
from ikde.solver.standing import find_model

Bools = NDArray[np.bool_]
if TYPE_CHECKING:
    MaskedBools = np.ma.MaskedArray[Any, np.dtype[np.bool_]]
else:  # one target needs none of it: 0.02 s
    MaskedBools = Any
"""A column of verdicts, masked where nothing was checked."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Grade:
    """The metrics of one configuration against one target, and the verdict."""

    position_error_m: float
    orientation_error_rad: float
    """Norm of the rotation vector; of an axis target the angle between the axes; of a position target 0."""
    clearance_m: float | None
    """None without a detector."""
    closest_pair: tuple[str, str] | None
    collision: bool | None
    """None: not checked, no pair was compared."""
    colliding_pairs: tuple[tuple[str, str], ...]
    """Worst first."""
    outside_limits: tuple[str, ...]
    within_tolerance: bool
    accepted: bool
    """Within both tolerances, inside all limits, and free of self-collision if that was checked."""
    nearest_obstacle: ObstacleClearance | None
    """The one with the least room beyond what is asked for; None without a world."""
    family: str | None
    """How a UR-type arm holds itself: shoulder/elbow/wrist, such as `left/up/no flip`; None for other arms."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Grades:
    """The metrics of T configurations against a target each, and the verdicts."""

    collision: CollisionModel
    Q: Floats  # [T, N]
    position_error_m: Floats  # [T]
    orientation_error_rad: Floats  # [T]
    gaps_m: Floats  # [T, P] clearance of every pair; no columns without a detector
    outside: Bools  # [T, N] joints outside their limits
    within_tolerance: Bools  # [T]
    accepted: Bools  # [T]

    @property
    def clearance_m(self) -> Floats:
        """Smallest clearance [T] in m; inf without a pair."""
        return self.gaps_m.min(axis=1, initial=np.inf)

    def row(self, index: int) -> Grade:
        """One configuration's."""
        robot, collision, gaps = self.collision.robot, self.collision, self.gaps_m[index]
        pairs, worst_first = collision.pairs, np.argsort(gaps, kind="stable").tolist()
        colliding = tuple(collision.name_pair(k) for k in worst_first if gaps[k] <= collision.limit_m)
        outside = zip(robot.joints, self.outside[index], strict=True)
        return Grade(
            position_error_m=float(self.position_error_m[index]),
            orientation_error_rad=float(self.orientation_error_rad[index]),
            clearance_m=float(gaps[worst_first[0]]) + collision.extra_m(worst_first[0]) if pairs else None,
            closest_pair=collision.name_pair(worst_first[0]) if pairs else None,
            collision=bool(colliding) if pairs else None,
            colliding_pairs=colliding,
            outside_limits=tuple(joint.name for joint, is_outside in outside if is_outside),
            within_tolerance=bool(self.within_tolerance[index]),
            accepted=bool(self.accepted[index]),
            nearest_obstacle=find_nearest_obstacle(collision, gaps),
            family=label_family(robot, self.Q[index]),
        )


def verify(
    robot: RobotLike,
    target: GoalLike,
    q: JointValues,
    *,
    settings: SolveSettings | Mapping[str, Any] | None = None,
    collision: CollisionChoice = None,
    convention: str | None = None,
) -> Grade:
    """Grade joint values against a target.

    Args:
        robot: the robot, its name or the path of its file.
        target: what the tool is asked to do; of a `Region` errors are how far out of it the tool is, 0 inside.
        q: joint values [N] or a mapping by joint name; m and rad.
        settings: the tolerances (default 1e-5 m, 1e-4 rad).
        collision: a detector's name, a `Detector`, a `CollisionModel`, `"none"`, or None for the robot's default.
        convention: how `q` is counted; None for the robot's own.

    Raises:
        InputError: for a wrong count, an unknown joint, detector or convention, NaN or infinity.
    """
    robot, chosen = read_robot(robot), choose_settings(settings, "auto")
    Q = read_configuration(robot, q, convention)[None]
    model = find_model(robot, collision)
    if isinstance(target, Region):
        return _verify_in_region(model, target, Q, chosen)
    return verify_many(model, [read_target(target)], Q, chosen).row(0)


def _verify_in_region(collision: CollisionModel, region: Region, Q: Floats, settings: SolveSettings) -> Grade:
    Ts_world = compute_frames(collision.robot, Q[0])
    where = grade_frames(region, collision.robot, Ts_world, settings)
    grade = verify_many(collision, [Target(Ts_world[collision.robot.tool][:3, 3])], Q, settings).row(0)
    return replace(
        grade,
        position_error_m=where.position_m,
        orientation_error_rad=where.orientation_rad,
        within_tolerance=where.is_inside,
        accepted=grade.accepted and where.is_inside,
    )


def verify_many(
    collision: CollisionModel, targets: Targets | Sequence[Target], Q: Floats, settings: SolveSettings
) -> Grades:
    """Grade configurations `Q` [T, N] in the robot's own convention, a target each; as `verify`, in bulk."""
    robot = collision.robot
    Ts_world, targets = compute_frames(robot, Q), Targets.of(targets)
    T_world_tool = Ts_world[robot.tool]
    position = np.linalg.norm(T_world_tool[:, :3, 3] - targets.p_world_tool, axis=1)
    orientation = compute_orientation_errors(targets, T_world_tool[:, :3, :3])
    gaps = compute_gaps(collision, Q, Ts_world=Ts_world)
    free = ~np.any(gaps <= collision.limit_m, axis=1)
    outside = ~((robot.lower <= Q) & (robot.upper >= Q))
    within = (position <= settings.position_tolerance_m) & (orientation <= settings.orientation_tolerance_rad)
    return Grades(
        collision=collision,
        Q=Q,
        position_error_m=position,
        orientation_error_rad=orientation,
        gaps_m=gaps,
        outside=outside,
        within_tolerance=within,
        accepted=within & free & ~outside.any(axis=1),
    )


def compute_orientation_errors(targets: Targets | Sequence[Target], R_world_tool: Floats) -> Floats:
    """Angles [T] in rad between the tool's orientations [T, 3, 3] and what each target asks of them."""
    targets = Targets.of(targets)
    asked = targets.R_world_tool
    whole = rotation_angle(np.swapaxes(asked, 1, 2) @ R_world_tool)
    axes = angle_between(asked[:, :, 2], R_world_tool[:, :, 2])
    return np.select([targets.kind == POSE, targets.kind == AXIS], [whole, axes], 0.0)

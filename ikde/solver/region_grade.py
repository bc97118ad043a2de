"""The grader of regions, in plain numpy: how far out of a region a pose of the tool is. It shares nothing with draws.

A pose is inside if some exact pose of the region is within both tolerances of it.
"""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from ikde.kernels.arrays import Floats
from ikde.model.base_motion import find_base_frame
from ikde.model.base_region import BaseRegion
from ikde.model.region import Region, RegionPart
from ikde.model.robot import Robot
from ikde.model.rotation import angle_between, quat_wxyz_from_rotation, rotation_angle
from ikde.solver.settings import SolveSettings

ON_EDGE_M = 1e-9  # what rounding may take a base that stands on an edge beyond it
Z = np.array([0.0, 0.0, 1.0])


class RegionGrade(NamedTuple):
    """How far out of a region the tool is: by the alternative that it is in, or comes nearest to."""

    alternative: int
    position_m: float
    """Beyond the edge of the box, or of the distances; 0 inside."""
    orientation_rad: float
    """Beyond the largest rotation; 0 inside."""
    is_inside: bool
    """Both within the tolerances."""


def grade_frames(region: Region, robot: Robot, Ts_world: Mapping[str, Floats], settings: SolveSettings) -> RegionGrade:
    """The grade of a configuration by the poses of its frames; where the base stands counts, too."""
    grade = grade_region(region, Ts_world[robot.tool], settings)
    if region.base is None or measure_base(region.base, Ts_world[find_base_frame(robot)][:2, 3]) <= ON_EDGE_M:
        return grade
    return grade._replace(is_inside=False)


def grade_region(region: Region, T_world_tool: Floats, settings: SolveSettings) -> RegionGrade:
    """The grade of one pose [4, 4] of the tool."""
    tol_m, tol_rad = settings.position_tolerance_m, settings.orientation_tolerance_rad
    best: RegionGrade | None = None
    for place, part in enumerate(region.parts):
        far_m, off_rad = measure_part(part, T_world_tool, tol_m)
        grade = RegionGrade(place, far_m, off_rad, far_m <= tol_m and off_rad <= tol_rad)
        if grade.is_inside:
            return grade
        if best is None or _cost(grade, settings) < _cost(best, settings):
            best = grade
    assert best is not None
    return best


def measure_part(part: RegionPart, T_world_tool: Floats, tolerance_m: float = 0.0) -> tuple[float, float]:
    """How far out of an alternative a pose is, m and rad; the place may be off by `tolerance_m` where that helps."""
    R, p = T_world_tool[:3, :3], T_world_tool[:3, 3]
    if part.rule == "look_at":
        return _measure_sight(part, R, p, tolerance_m)
    offset = part.R_world_box.T @ (p - part.target.p_world_tool)
    low, high = part.box_m.T
    far_m = float(np.linalg.norm(np.maximum(0.0, np.maximum(low - offset, offset - high))))
    return far_m, _measure_rotation(part, R)


def measure_base(region: BaseRegion, place: Floats) -> float:
    """How far out of a base region a place [2] is, m; 0 inside and on its edges."""
    turns = [_count_turns(polygon - place) for polygon in (region.corners, *region.holes)]
    if turns[0] != 0 and not any(turns[1:]):
        return 0.0
    return min(_measure_edges(polygon - place) for polygon in (region.corners, *region.holes))


def _count_turns(corners: Floats) -> int:
    """How often a polygon [C, 2] goes round the origin."""
    (ax, ay), (bx, by) = corners.T, np.roll(corners, -1, axis=0).T
    return round(float(np.sum(np.arctan2(ax * by - ay * bx, ax * bx + ay * by))) / (2.0 * np.pi))


def _measure_edges(corners: Floats) -> float:
    """How far a polygon [C, 2] is from the origin, m."""
    nearest = np.inf
    for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        along = float(np.dot(-a, b - a) / np.dot(b - a, b - a))
        nearest = min(nearest, float(np.hypot(*(a + min(max(along, 0.0), 1.0) * (b - a)))))
    return nearest


def _measure_rotation(part: RegionPart, R: Floats) -> float:
    goal = part.target.R_world_tool
    off = goal.T @ R
    if part.rule == "cone" or (part.rule == "exact" and part.target.kind == "axis"):
        angle = float(angle_between(goal[:, 2], R[:, 2]))
        return max(0.0, angle - float(part.numbers[0])) if part.rule == "cone" else angle
    if part.rule == "turn":
        return _measure_turn(part.numbers, off)
    if part.rule == "rotation":
        return _measure_vector(part.numbers, off)
    return float(rotation_angle(off)) if part.target.kind == "pose" else 0.0


def _measure_turn(numbers: Floats, off: Floats) -> float:
    """What is left of a rotation after the turn about an axis that takes away most of it."""
    axis, low, high = numbers[:3], float(numbers[3]), float(numbers[4])
    w, *vector = quat_wxyz_from_rotation(off)
    angle = 2.0 * float(np.arctan2(np.dot(vector, axis), w))
    turns = [angle + 2.0 * np.pi * k for k in (-2, -1, 0, 1, 2)]
    nearest = [min(max(turn, low), high) for turn in turns]
    return min(float(rotation_angle(_rotation(axis * turn).T @ off)) for turn in nearest)


def _measure_vector(ranges: Floats, off: Floats) -> float:
    """The angle from a rotation to the one whose vector is the nearest in a box, for either vector that it has."""
    w, *vector = quat_wxyz_from_rotation(off)
    sine = float(np.linalg.norm(vector))
    angle = 2.0 * float(np.arctan2(sine, w))
    axis = np.array(vector) / sine if sine > 0.0 else Z
    nearest = [np.clip(a * axis, ranges[:, 0], ranges[:, 1]) for a in (angle, angle - 2.0 * np.pi)]
    return min(float(rotation_angle(_rotation(each).T @ off)) for each in nearest)


def _measure_sight(part: RegionPart, R: Floats, p: Floats, tolerance_m: float) -> tuple[float, float]:
    low, high, most = part.numbers.tolist()
    sight = part.target.p_world_tool - p
    distance = float(np.linalg.norm(sight))
    far_m = max(0.0, low - distance, distance - high)
    if distance <= tolerance_m:
        return far_m, 0.0
    sight = sight / distance
    room = float(np.arcsin(min(1.0, tolerance_m / distance)))
    off = float(angle_between(sight, R[:, 2]))
    beyond = float(angle_between(sight, part.target.axis_world_tool)) - most
    return far_m, max(0.0, off - room, beyond - room)


def _rotation(vector: Floats) -> Floats:
    """The rotation [3, 3] of a rotation vector [3], by its quaternion."""
    angle = float(np.linalg.norm(vector))
    x, y, z = np.sinc(0.5 * angle / np.pi) * 0.5 * vector
    w = np.cos(0.5 * angle)
    return np.array(
        [
            [w * w + x * x - y * y - z * z, 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
            [2.0 * (x * y + w * z), w * w - x * x + y * y - z * z, 2.0 * (y * z - w * x)],
            [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), w * w - x * x - y * y + z * z],
        ]
    )


def _cost(grade: RegionGrade, settings: SolveSettings) -> float:
    """As the search weighs the two."""
    return grade.position_m + grade.orientation_rad * settings.position_tolerance_m / settings.orientation_tolerance_rad

"""The exact pose of a region that is nearest to a pose of the tool: with `near` it is tried before all draws."""

import numpy as np

from ikde.kernels.arrays import Floats
from ikde.model.region import WHOLE, RegionPart
from ikde.model.rotation import angle_between, quat_wxyz_from_rotation, rotation_about, rotation_with_z
from ikde.model.target import Target
from ikde.solver.region_draws import is_free_about_z
from ikde.solver.settings import SolveSettings

Z = np.array([0.0, 0.0, 1.0])
TINY = 1e-12


def find_nearest(part: RegionPart, T_world_tool: Floats, settings: SolveSettings) -> Target:
    """The target of an alternative with each free number as near to the tool [4, 4] as it may be.

    A tolerance from the edges, where there is room: what is found lies inside.
    """
    R, p = T_world_tool[:3, :3], T_world_tool[:3, 3]
    room_m, room_rad = settings.position_tolerance_m, settings.orientation_tolerance_rad
    if part.rule == "look_at":
        return _look_from(part, p, room_m, room_rad)
    offset = _clip(part.R_world_box.T @ (p - part.target.p_world_tool), part.box_m, room_m)
    place = part.target.p_world_tool + part.R_world_box @ offset
    goal = part.target.R_world_tool
    if part.rule == "cone":
        most = max(0.0, float(part.numbers[0]) - room_rad)
        return Target(place, axis_world_tool=_lean(goal[:, 2], R[:, 2], most))
    if part.rule == "turn" and not is_free_about_z(part):
        axis, ranges = part.numbers[:3], part.numbers[None, 3:]
        w, *vector = quat_wxyz_from_rotation(goal.T @ R)
        angle = 2.0 * float(np.arctan2(np.dot(vector, axis), w))
        turns = [angle + WHOLE * k for k in (0, -1, 1)]
        best = min(turns, key=lambda turn: abs(float(_clip(np.array([turn]), ranges, room_rad)[0]) - turn))
        return Target(place, R_world_tool=goal @ rotation_about(axis, _clip(np.array([best]), ranges, room_rad)[0]))
    if part.rule == "rotation":
        w, *vector = quat_wxyz_from_rotation(goal.T @ R)
        sine = float(np.linalg.norm(vector))
        scale = 2.0 * float(np.arctan2(sine, w)) / sine if sine > TINY else 2.0
        return Target(place, R_world_tool=goal @ _rotate(_clip(scale * np.array(vector), part.numbers, 2.0 * room_rad)))
    if part.rule == "turn" or part.target.kind == "axis":
        return Target(place, axis_world_tool=goal[:, 2])
    return Target(place, R_world_tool=goal if part.target.kind == "pose" else None)


def _look_from(part: RegionPart, p: Floats, room_m: float, room_rad: float) -> Target:
    low, high, most = part.numbers.tolist()
    point, axis = part.target.p_world_tool, part.target.axis_world_tool
    distance = float(np.linalg.norm(point - p))
    sight = (point - p) / distance if distance > TINY else axis
    sight = _lean(axis, sight, max(0.0, most - room_rad) if most < np.pi else most)
    distance = float(_clip(np.array([distance]), np.array([[low, high]]), room_m)[0])
    return Target(point - distance * sight, axis_world_tool=sight)


def _lean(axis: Floats, wanted: Floats, most: float) -> Floats:
    """The direction within an angle of `axis` that is nearest to `wanted`, unit vectors [3]."""
    angle = float(angle_between(axis, wanted))
    if angle <= most:
        return wanted
    across = wanted - (wanted @ axis) * axis
    size = float(np.linalg.norm(across))
    across = across / size if size > TINY else rotation_with_z(axis)[:, 0]
    return np.cos(most) * axis + np.sin(most) * across


def _clip(values: Floats, ranges: Floats, room: float) -> Floats:
    """Values [n] brought into ranges [n, 2], and `room` inside where that is no more than a quarter of them."""
    less = np.minimum(room, 0.25 * (ranges[:, 1] - ranges[:, 0]))
    return np.minimum(np.maximum(values, ranges[:, 0] + less), ranges[:, 1] - less)


def _rotate(vector: Floats) -> Floats:
    angle = float(np.linalg.norm(vector))
    return rotation_about(vector / angle, angle) if angle > TINY else np.eye(3)

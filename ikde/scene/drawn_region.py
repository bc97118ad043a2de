"""The outlines of a goal with freedom: its box, cone or turns, where it is looked from, and the floor of a base."""

from dataclasses import dataclass

import numpy as np

from ikde.kernels.arrays import Floats
from ikde.model.region import Region, RegionPart, has_freedom
from ikde.model.rotation import rotation_about, rotation_with_z

LENGTH_M, RADIUS_M = 0.15, 0.1  # of what shows directions, and turns
STEPS, RAYS = 48, 8
CORNERS = np.array([(0, 0), (1, 0), (1, 1), (0, 1), (0, 0)])
ANY = "region: any pose in any of them will do"
Lines = list[Floats]
"""Polylines [n, 3] in m."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Outline:
    """Lines of a goal with freedom that belong together."""

    lines_m: tuple[Floats, ...]
    """Polylines [n, 3] in m, world frame."""
    text: str
    """What they are; empty of lines that only lead to others."""
    is_faint: bool = False
    """An alternative that was not reached, or no part of the region."""
    is_base: bool = False
    """Where the base may stand."""


def draw_region(region: Region, alternative: int | None = None) -> tuple[Outline, ...]:
    """Outlines of all alternatives, of them the one that was reached, and of where a base may stand."""
    parts, outlines = region.parts, list[Outline]()
    chosen = [*range(len(parts))] if alternative is None else [alternative]
    text = "region: any pose in it will do"
    if len(parts) > 1:
        text = ANY if alternative is None else f"region: alternative {alternative + 1} of {len(parts)}"
    if any(map(has_freedom, parts)):
        lines = [line for place in chosen for line in _draw_part(parts[place])]
        outlines.append(Outline(lines_m=tuple(lines), text=text))
    if others := [line for place, part in enumerate(parts) if place not in chosen for line in _draw_part(part)]:
        outlines.append(Outline(lines_m=tuple(others), text="other alternatives", is_faint=True))
    if leading := [line for place in chosen for line in _lead_to_point(parts[place])]:
        outlines.append(Outline(lines_m=tuple(leading), text="", is_faint=True))
    if region.base is not None:
        closed = [np.concatenate([polygon, polygon[:1]]) for polygon in (region.base.corners, *region.base.holes)]
        floor = tuple(np.column_stack([edge, np.zeros(len(edge))]) for edge in closed)
        outlines.append(Outline(lines_m=floor, text="where the base may stand", is_base=True))
    return tuple(outlines)


def _lead_to_point(part: RegionPart) -> Lines:
    """A cross where the tool is to look, and lines of sight from there."""
    if part.rule != "look_at":
        return []
    point, (low, _, angle) = part.target.p_world_tool, part.numbers.tolist()
    lines = [np.array([point - 0.2 * RADIUS_M * axis, point + 0.2 * RADIUS_M * axis]) for axis in np.eye(3)]
    if angle < 0.5 * np.pi:
        near = point + low * _circle(rotation_with_z(-part.target.axis_world_tool), angle)
        lines += [np.array([point, near[k]]) for k in range(0, STEPS, STEPS // RAYS)]
    return lines


def _draw_part(part: RegionPart) -> Lines:
    R, p = part.target.R_world_tool, part.target.p_world_tool
    if part.rule == "look_at":
        return _draw_sight(part)
    lines = _draw_box(part) if part.box_m.any() else []
    if part.rule == "cone":
        angle = float(part.numbers[0])
        rim = p + LENGTH_M * _circle(R, angle)
        lines += [rim, *(np.array([p, rim[k]]) for k in range(0, STEPS, STEPS // RAYS))]
    elif part.rule == "turn":
        lines += _draw_turn(R @ part.numbers[:3], part.numbers[3:], p, R)
    elif part.rule == "rotation":
        lines += _draw_rotations(part.numbers, p, R)
    elif part.target.kind != "position":
        lines.append(np.array([p, p + LENGTH_M * R[:, 2]]))
    return lines


def _draw_box(part: RegionPart) -> Lines:
    """Its edges: bottom, top and what joins them."""
    (x, y, z), p = part.box_m, part.target.p_world_tool
    loops = [np.column_stack([x[CORNERS[:, 0]], y[CORNERS[:, 1]], np.full(5, height)]) for height in z]
    posts = [np.array([[x[i], y[j], z[0]], [x[i], y[j], z[1]]]) for i, j in CORNERS[:4]]
    return [p + line @ part.R_world_box.T for line in (*loops, *posts)]


def _circle(R: Floats, angle: float) -> Floats:
    """Unit directions [STEPS + 1, 3] at an angle from the z axis of `R`."""
    around = np.linspace(0.0, 2.0 * np.pi, STEPS + 1)
    across, along = np.sin(angle), np.full(STEPS + 1, np.cos(angle))
    return np.column_stack([across * np.cos(around), across * np.sin(around), along]) @ R.T


def _draw_turn(axis: Floats, angles: Floats, p: Floats, R: Floats) -> Lines:
    """An arc about the axis, from where the least turn takes a direction across it to where the largest does."""
    across = min((R[:, k] - (R[:, k] @ axis) * axis for k in range(3)), key=lambda v: -float(np.linalg.norm(v)))
    across = across / np.linalg.norm(across)
    arc = p + RADIUS_M * (rotation_about(axis, np.linspace(angles[0], angles[1], STEPS)) @ across)
    return [arc, np.array([p - LENGTH_M * axis, p + LENGTH_M * axis]), np.array([arc[0], p, arc[-1]])]


def _draw_rotations(ranges: Floats, p: Floats, R: Floats) -> Lines:
    """Where the z axis ends at the edges of the ranges about x and y, and an arc of the range about z."""
    x, y, (low, high) = ranges
    share = np.linspace(0.0, 1.0, STEPS // 4)[:, None]
    sides = [CORNERS[k] + share * (CORNERS[k + 1] - CORNERS[k]) for k in range(4)]
    edge = np.concatenate(sides) * [np.ptp(x), np.ptp(y)] + [x[0], y[0]]
    ends = np.array([p + LENGTH_M * R @ _rotate((*pair, 0.5 * (low + high)))[:, 2] for pair in edge])
    return [ends, np.array([p, p + LENGTH_M * R[:, 2]]), *_draw_turn(R[:, 2], ranges[2], p, R)[:1]]


def _rotate(vector: tuple[float, ...]) -> Floats:
    angle = float(np.linalg.norm(vector))
    return rotation_about(np.array(vector) / angle, angle) if angle > 0.0 else np.eye(3)


def _draw_sight(part: RegionPart) -> Lines:
    """Rims of the two distances with what joins them; from any side great circles."""
    low, high, angle = part.numbers.tolist()
    point, R = part.target.p_world_tool, rotation_with_z(-part.target.axis_world_tool)
    if angle >= 0.5 * np.pi:
        frames = [rotation_with_z(axis) for axis in np.eye(3)]
        return [point + distance * _circle(frame, 0.5 * np.pi) for distance in (low, high) for frame in frames]
    near, far = (point + distance * _circle(R, angle) for distance in (low, high))
    return [near, far, *(np.array([near[k], far[k]]) for k in range(0, STEPS, STEPS // RAYS))]

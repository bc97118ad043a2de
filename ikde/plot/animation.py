"""A drawn motion as the plain data that `report/templates/motion.js` plays: lengths in whole millimetres."""

from typing import Any

import numpy as np

from ikde.kernels.arrays import Floats
from ikde.scene.drawn_motion import DrawnMotion
from ikde.scene.drawn_pose import COLORS
from ikde.scene.drawn_world import DrawnObstacle, DrawnSolid

MAX_PATH_POINTS = 501
MAX_FACES = 12  # of a solid whose edges are drawn; of others their ends alone, and the outline
MAX_POINTS = 800  # of a cloud


def make_animation(motion: DrawnMotion) -> dict[str, Any]:
    """The motion for JSON.

    Returns:
        `times_s` [F] and `duration_s`; `path_mm` [P, 3], and how many of its points are `done` [F]; `links_mm`
        [F, n, 3]; `centres_mm` [F, S, 3], `radii_mm` [S] and `parts` [S], a sphere's component; `components` [C] by
        name, and their `roles` [F, C], each the place of a role in `colors`; `obstacles`, and which of them are
        `touched` [F]; and what is `nearest` of a world, and in which frame, or null.
    """
    robot, path = motion.robot, motion.path_m
    shown = np.unique(np.linspace(0, len(path) - 1, min(len(path), MAX_PATH_POINTS)).round().astype(int))
    listed = [(obstacle, None) for obstacle in motion.obstacles] + [*motion.moved]
    names = [obstacle.name for obstacle, _ in listed]
    return {
        "times_s": motion.times_s.round(4).tolist(),
        "duration_s": round(motion.duration_s, 4),
        "path_mm": _to_whole_mm(path[shown]),
        "done": np.searchsorted(shown, motion.samples, side="right").tolist(),
        "links_mm": _to_whole_mm(robot.links_m),
        "centres_mm": _to_whole_mm(robot.centres_m),
        "radii_mm": _to_whole_mm(robot.radii_m),
        "parts": robot.parts.tolist(),
        "components": list(robot.components),
        "roles": [[list(COLORS).index(role) for role in roles] for roles in robot.roles],
        "colors": dict(COLORS),
        "obstacles": [_list_solids(obstacle, poses) for obstacle, poses in listed],
        "touched": [[k for k, name in enumerate(names) if name in touched] for touched in motion.touched],
        "nearest": _find_nearest(motion),
    }


def _list_solids(obstacle: DrawnObstacle, poses: Floats | None) -> dict[str, Any]:
    """An obstacle by its name, its convex solids by corners and the faces whose edges are drawn, clouds by points.

    Of what moves these are in its own frame, and `poses` [F, 12] are rotations row by row and places in mm, else null.
    """
    solids, points = [], [np.empty((0, 3))]
    for solid in obstacle.solids:
        if solid.polygons_m:
            corners = np.unique(_to_whole_mm(np.concatenate(solid.polygons_m)), axis=0).tolist()
            faces = [_to_whole_mm(face) for face in list_edged(solid)]
            solids.append({"corners": corners, "faces": faces, "endless": solid.is_endless})
        else:
            points.append(solid.points_m)
    cloud = np.concatenate(points)
    thinned = cloud[:: max(1, -(-len(cloud) // MAX_POINTS))]
    known = {"name": obstacle.name, "solids": solids, "points": _to_whole_mm(thinned)}
    if poses is None:
        return {**known, "poses": None}
    rows = np.concatenate([poses[:, :, :3].reshape(-1, 9), 1e3 * poses[:, :, 3]], axis=1)
    return {**known, "poses": rows.round(4).tolist()}


def list_edged(solid: DrawnSolid) -> list[Floats]:
    """Faces of a solid [k, 3] whose edges are drawn: all of few, else the ends of what is round."""
    if len(solid.polygons_m) <= MAX_FACES:
        return list(solid.polygons_m)
    return [face for face in solid.polygons_m if len(face) > MAX_FACES]


def _find_nearest(motion: DrawnMotion) -> dict[str, Any] | None:
    """The frame, or -1 if it is not drawn; the two points; and what is said about them."""
    found = motion.nearest
    if found is None:
        return None
    frame = np.flatnonzero(motion.samples == found.sample)
    said = f"{found.component} - {found.obstacle}: {1e3 * found.clearance_m:.1f} mm"
    return {"frame": int(frame[0]) if len(frame) else -1, "points": _to_whole_mm(found.points_m), "text": said}


def _to_whole_mm(lengths_m: Floats) -> Any:
    return np.rint(1e3 * np.asarray(lengths_m)).astype(int).tolist()

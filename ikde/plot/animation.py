"""A drawn motion as the plain data that `report/templates/motion.js` plays: lengths in whole millimetres."""

from typing import Any

import numpy as np

from ikde.kernels.arrays import Floats
from ikde.scene.drawn_motion import DrawnMotion
from ikde.scene.drawn_pose import COLORS

MAX_PATH_POINTS = 501


def make_animation(motion: DrawnMotion) -> dict[str, Any]:
    """The motion for JSON.

    Returns:
        `times_s` [F] and `duration_s`; `path_mm` [P, 3], and how many of its points are `done` [F]; `links_mm`
        [F, n, 3]; `centres_mm` [F, S, 3], `radii_mm` [S] and `parts` [S], a sphere's component; `components` [C] by
        name, and their `roles` [F, C], each the place of a role in `colors`.
    """
    robot, path = motion.robot, motion.path_m
    shown = np.unique(np.linspace(0, len(path) - 1, min(len(path), MAX_PATH_POINTS)).round().astype(int))
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
    }


def _to_whole_mm(lengths_m: Floats) -> Any:
    return np.rint(1e3 * lengths_m).astype(int).tolist()

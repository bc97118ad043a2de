"""A motion as plain data that a page can play: spheres, bones and path, in whole millimetres."""

from typing import Any

import numpy as np

from ikde.kernels.arrays import Floats
from ikde.plot.pose import base_components, compute_bones
from ikde.solver.plain import compute_components
from ikde.track.summary import TrackSummary

MOST_FRAMES = 251
MOST_PATH_POINTS = 501


def make_animation(motion: TrackSummary, most_frames: int = MOST_FRAMES) -> dict[str, Any]:
    """Every so-manieth sample, the last one among them.

    Returns:
        `times` [F] s; `path` [P, 3]; `bones` [F, n, 3]; `centres` [F, S, 3], `radii` [S] and `parts` [S], a sphere's
        component; `names` of components, and which of them are the `base`; `black` [F], components that collide.
        Lengths in mm.
    """
    trajectory = motion.trajectory
    frames = np.unique(np.linspace(0, len(trajectory.q) - 1, most_frames).round().astype(int))
    q = trajectory.q[frames]
    components = compute_components(motion.collision, q)
    names, base = list(components), base_components(motion.collision)
    centres = [centres for centres, _ in components.values()]
    radii = [radii for _, radii in components.values()]
    path = trajectory.path.p_world_tool
    shown = np.unique(np.linspace(0, len(path) - 1, MOST_PATH_POINTS).round().astype(int))
    return {
        "times": [round(float(time), 4) for time in trajectory.times_s[frames]],
        "end": round(trajectory.path.duration_s, 4),
        "path": _whole_mm(path[shown]),
        "done": [int(np.searchsorted(shown, sample, side="right")) for sample in frames],
        "bones": _whole_mm(compute_bones(motion.robot, q)),
        "centres": _whole_mm(np.concatenate(centres, axis=1)) if centres else [[] for _ in frames],
        "radii": _whole_mm(np.concatenate(radii)) if radii else [],
        "parts": [part for part, row in enumerate(radii) for _ in row],
        "names": names,
        "base": [part for part, name in enumerate(names) if name in base],
        "black": [[names.index(name) for name in sorted(motion.colliding[sample])] for sample in frames],
    }


def _whole_mm(lengths_m: Floats) -> Any:
    return np.rint(1e3 * lengths_m).astype(int).tolist()

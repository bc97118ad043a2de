"""From the `orientation` of a track file to what is asked of the tool's orientation at every sample."""

from collections.abc import Sequence

import numpy as np

from ikde.errors import InputError
from ikde.formats.entries import UnitsEntry, only_key
from ikde.formats.error_path import prefix_errors
from ikde.formats.poses import make_orientation, read_orientation
from ikde.kernels.arrays import Floats
from ikde.model.rotation import length, rotation_with_z
from ikde.model.target import MIN_LENGTH, Target, Targets
from ikde.track.expression import evaluate_formula
from ikde.track.slerp import PathOrientation, slerp
from ikde.track.spec import Formula, KeyframeEntry, PathOrientationEntry

Orientations = tuple[PathOrientation, Floats]
"""What is asked of the orientation, and rotations [S, 3, 3]."""


def make_orientations(entry: PathOrientationEntry, units: UnitsEntry, k: Floats, samples: int) -> Orientations:
    """Orientations at samples `k` [S] of so many; raises `InputError` with a path inside `entry`."""
    key = only_key(entry)
    with prefix_errors(key):
        if entry.keyframes is not None:
            return _read_keyframes(entry.keyframes, units, k / samples)
        formulas: Sequence[Formula] = getattr(entry, key)
        columns = [evaluate_formula(index, formula, k, samples) for index, formula in enumerate(formulas)]
        return _read_formulas(key, np.column_stack(columns), units, k)


def _read_formulas(key: str, values: Floats, units: UnitsEntry, k: Floats) -> Orientations:
    """Orientations from values [S, 3 or 4]."""
    if key == "rpy":
        return "pose", make_orientation("rpy", values * units.angle_rad)["R_world_tool"]
    lengths = np.linalg.norm(values, axis=1)
    for (row,) in np.argwhere(~(lengths > MIN_LENGTH))[:1]:
        raise InputError(f"a length of 0 has no direction, at k = {k[row]:g}")
    units_only = values / lengths[:, None]
    if key == "axis":
        return "axis", rotation_with_z(units_only / length(units_only)[:, None])
    return "pose", make_orientation("quat_wxyz", units_only)["R_world_tool"]


def _read_keyframes(entries: Sequence[KeyframeEntry], units: UnitsEntry, share: Floats) -> Orientations:
    """Orientations at shares [S] of the path's time; before the first keyframe and after the last they stay."""
    targets = []
    for index, entry in enumerate(entries):
        with prefix_errors(index):
            targets.append(Target((0.0, 0.0, 0.0), **read_orientation(entry, units)))
            if targets[-1].kind == "position":
                raise InputError("expected one of axis, rpy, quat_wxyz")
            if targets[-1].kind != targets[0].kind:
                raise InputError("either all keyframes give an axis, or none")
            if index and not entry.at > entries[index - 1].at:
                raise InputError("expected a later moment than that of the keyframe before", ("at",))
    orientation: PathOrientation = "axis" if targets[0].kind == "axis" else "pose"
    places = np.interp(share, [entry.at for entry in entries], np.arange(len(entries)))
    return orientation, slerp(orientation, Targets.of(targets).R_world_tool, places)

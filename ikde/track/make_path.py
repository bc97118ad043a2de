"""From a track file to a tool path: formulas, curves and waypoints, in metres, at every sample and half-way."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np

from ikde.errors import InputError
from ikde.formats.entries import only_key
from ikde.formats.error_path import prefix_errors
from ikde.kernels.arrays import Floats
from ikde.track.expression import evaluate_formula
from ikde.track.orientations import Orientations, make_orientations
from ikde.track.path import MAX_SAMPLES, ToolPath
from ikde.track.segments import make_segments
from ikde.track.shapes import follow_points, follow_segments
from ikde.track.spec import CurveEntry, ExpressionsEntry, TrackSpec
from ikde.track.waypoints import Waypoints, read_waypoints


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Way:
    """Where the tool goes, before it is sampled."""

    samples: int
    positions: Callable[[Floats], Floats]
    """Samples k [S], whole or not -> positions [S, 3] in m."""
    orient: Callable[[Floats], Orientations] | None = None
    """The same for orientations, where waypoints have some."""


def make_path(spec: TrackSpec, name: str, folder: Path) -> ToolPath:
    """The path of a track file.

    Args:
        spec: the track file.
        name: what to call the path.
        folder: paths in the track file start here.

    Raises:
        InputError: with the path of the key inside the track file.
        FileError: for what is wrong inside a table of waypoints.
    """
    way = _make_way(spec, folder)
    k = np.arange(2 * way.samples + 1) / 2.0
    p, (orientation, R) = way.positions(k), _orient(spec, way, k)
    try:
        return ToolPath(
            name=name,
            dt_s=spec.dt_s,
            p_world_tool=p[::2],
            orientation=orientation,
            R_world_tool=R[::2],
            p_half=p[1::2],
            R_half=R[1::2],
        )
    except InputError as error:
        if error.where[0] == "dt_s":
            raise
        raise InputError(f"sample {error.where[-1]}: {error.message}", ("path",)) from None


def _make_way(spec: TrackSpec, folder: Path) -> Way:
    with prefix_errors("path"):
        key = only_key(spec.path)
        entry = getattr(spec.path, key)
        if not isinstance(entry, ExpressionsEntry):
            with prefix_errors(key):
                if isinstance(entry, CurveEntry):
                    return _along_curve(entry, spec)
                return _between_waypoints(read_waypoints(entry, spec.units, folder), spec)
    if spec.samples is None:
        raise InputError("this key is missing: formulas need to know how many samples there are", ("samples",))
    return Way(samples=spec.samples, positions=partial(_follow_formulas, entry, spec))


def _follow_formulas(entry: ExpressionsEntry, spec: TrackSpec, k: Floats) -> Floats:
    with prefix_errors("path", "expressions"):
        columns = [evaluate_formula(key, getattr(entry, key), k, spec.samples or 0) for key in ("x", "y", "z")]
    return np.column_stack(columns) * spec.units.length_m


def _along_curve(entry: CurveEntry, spec: TrackSpec) -> Way:
    segments = make_segments(entry, spec.units, spec.dt_s)
    samples = sum(segment.samples for segment in segments)
    if samples > MAX_SAMPLES:
        raise InputError(f"expected up to {MAX_SAMPLES:,} samples in all", ("segments",))
    if spec.samples not in (None, samples):
        raise InputError(f"these take {samples} samples, not {spec.samples}: leave `samples` out", ("segments",))
    return Way(samples=samples, positions=partial(follow_segments, segments))


def _between_waypoints(waypoints: Waypoints, spec: TrackSpec) -> Way:
    legs = len(waypoints.targets) - 1
    samples = spec.samples or legs
    points = waypoints.targets.p_world_tool
    return Way(
        samples=samples,
        positions=lambda k: follow_points(points, k * legs / samples),  # exact where they are samples
        orient=(lambda k: waypoints.orient(k * legs / samples)) if waypoints.have_orientations else None,
    )


def _orient(spec: TrackSpec, way: Way, k: Floats) -> Orientations:
    """What is asked of the orientation at samples `k` [S]."""
    if way.orient is not None:
        if spec.orientation is not None:
            raise InputError("the waypoints have orientations of their own; leave one of the two out", ("orientation",))
        with prefix_errors("path"):
            return way.orient(k)
    if spec.orientation is None or isinstance(spec.orientation, str):
        return "free", np.broadcast_to(np.eye(3), (len(k), 3, 3))
    with prefix_errors("orientation"):
        return make_orientations(spec.orientation, spec.units, k, way.samples)

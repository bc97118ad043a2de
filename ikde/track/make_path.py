"""From a track file to a tool path: formulas, curves and waypoints, in metres, at every sample and half-way."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np

from ikde.errors import FileError, InputError
from ikde.files.entries import FileEntry, InlineTarget, UnitsEntry
from ikde.files.placed import placed
from ikde.files.poses import make_orientation, read_orientation, read_position
from ikde.files.table_targets import read_targets
from ikde.files.tables import row_error
from ikde.kernels.arrays import Floats
from ikde.model.rotation import length, rotation_with_z
from ikde.model.target import AXIS, POSITION, SHORTEST, Target, Targets
from ikde.track.expression import parse_expression
from ikde.track.path import MOST_SAMPLES, ToolPath
from ikde.track.segments import make_segments
from ikde.track.shapes import follow_segments, make_polyline
from ikde.track.spec import CurveEntry, ExpressionsEntry, Formula, KeyframeEntry, PathEntry, TrackSpec, TurnEntry
from ikde.track.turning import PathOrientation, turn_between

Turn = tuple[PathOrientation, Floats]
"""What is asked of the orientation, and rotations [S, 3, 3]."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Way:
    """Where the tool goes, before it is sampled."""

    samples: int
    positions: Callable[[Floats], Floats]
    """Samples k [S], whole or not -> positions [S, 3] in m."""
    turn: Callable[[Floats], Turn] | None = None
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
    p, (orientation, R) = way.positions(k), _turn(spec, way, k)
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
    key = _only_key(spec.path, "path")
    entry = getattr(spec.path, key)
    if isinstance(entry, ExpressionsEntry):
        if spec.samples is None:
            raise InputError("this key is missing: formulas need to know how many samples there are", ("samples",))
        return Way(samples=spec.samples, positions=partial(_follow_formulas, entry, spec))
    with placed("path", key):
        if isinstance(entry, CurveEntry):
            return _along_curve(entry, spec)
        waypoints, blame = _read_waypoints(entry, spec.units, folder)
    samples = spec.samples or len(waypoints) - 1
    stretch = (len(waypoints) - 1) / samples
    turn = partial(_turn_waypoints, waypoints, stretch, blame) if waypoints.kind[0] != POSITION else None
    through = make_polyline(waypoints.p_world_tool)
    return Way(samples=samples, positions=lambda k: through(k / samples), turn=turn)


def _only_key(entry: PathEntry | TurnEntry, where: str) -> str:
    known = type(entry).model_fields
    given = [key for key in known if getattr(entry, key) is not None]
    if len(given) != 1:
        message = f"expected one of {', '.join(known)}, got {' and '.join(given) or 'none'}"
        raise InputError(message, (where, *given[1:2]))
    return given[0]


def _follow_formulas(entry: ExpressionsEntry, spec: TrackSpec, k: Floats) -> Floats:
    with placed("path", "expressions"):
        columns = [_evaluate(key, getattr(entry, key), k, spec.samples or 0) for key in ("x", "y", "z")]
    return np.column_stack(columns) * spec.units.length_m


def _evaluate(key: str | int, formula: Formula, k: Floats, samples: int) -> Floats:
    with placed(key):
        return parse_expression(formula).evaluate(k, samples)


def _along_curve(entry: CurveEntry, spec: TrackSpec) -> Way:
    segments = make_segments(entry, spec.units, spec.dt_s)
    samples = sum(segment.samples for segment in segments)
    if samples > MOST_SAMPLES:
        raise InputError(f"expected up to {MOST_SAMPLES:,} samples in all", ("segments",))
    if spec.samples not in (None, samples):
        raise InputError(f"these take {samples} samples, not {spec.samples}: leave `samples` out", ("segments",))
    return Way(samples=samples, positions=partial(follow_segments, segments))


Blame = Callable[[int, str], InputError]
"""What is wrong with a waypoint, as an error in its place."""


def _read_waypoints(
    entry: FileEntry | Sequence[InlineTarget], units: UnitsEntry, folder: Path
) -> tuple[Targets, Blame]:
    """Waypoints of one kind, two or more."""
    if isinstance(entry, FileEntry):
        path = folder / entry.path
        table = read_targets(path, entry.columns, entry.units or units)
        if table.count < 2:
            raise FileError(path, "expected 2 rows or more, got 1")
        return table.read(0, table.count), lambda row, message: row_error(path, row, message)
    targets = []
    for index, waypoint in enumerate(entry):
        with placed(index):
            position = read_position("position", waypoint.position, units)
            targets.append(Target(position, **read_orientation(waypoint, units)))
            if targets[-1].kind != targets[0].kind:
                raise InputError(f"this waypoint asks for a {targets[-1].kind}, the first one for a {targets[0].kind}")
    return Targets.of(targets), lambda row, message: InputError(message, ("path", "waypoints", row))


def _turn_waypoints(waypoints: Targets, stretch: float, blame: Blame, k: Floats) -> Turn:
    orientation: PathOrientation = "axis" if waypoints.kind[0] == AXIS else "pose"
    try:
        return orientation, turn_between(orientation, waypoints.R_world_tool, k * stretch)
    except InputError as error:
        raise blame(int(error.where[0]), error.message) from None


def _turn(spec: TrackSpec, way: Way, k: Floats) -> Turn:
    """What is asked of the orientation at samples `k` [S]."""
    if way.turn is not None:
        if spec.orientation is not None:
            raise InputError("the waypoints have orientations of their own; leave one of the two out", ("orientation",))
        return way.turn(k)
    if spec.orientation is None or isinstance(spec.orientation, str):
        return "free", np.broadcast_to(np.eye(3), (len(k), 3, 3))
    key = _only_key(spec.orientation, "orientation")
    with placed("orientation", key):
        if spec.orientation.keyframes is not None:
            return _turn_keyframes(spec.orientation.keyframes, spec.units, k / way.samples)
        formulas: Sequence[Formula] = getattr(spec.orientation, key)
        columns = [_evaluate(index, formula, k, way.samples) for index, formula in enumerate(formulas)]
        return _turn_formulas(key, np.column_stack(columns), spec.units, k)


def _turn_formulas(key: str, values: Floats, units: UnitsEntry, k: Floats) -> Turn:
    """Orientations from values [S, 3 or 4]."""
    if key == "rpy":
        return "pose", make_orientation("rpy", values * units.angle_rad)["R_world_tool"]
    lengths = np.linalg.norm(values, axis=1)
    for (row,) in np.argwhere(~(lengths > SHORTEST))[:1]:
        raise InputError(f"a length of 0 has no direction, at k = {k[row]:g}")
    units_only = values / lengths[:, None]
    if key == "axis":
        return "axis", rotation_with_z(units_only / length(units_only)[:, None])
    return "pose", make_orientation("quat_wxyz", units_only)["R_world_tool"]


def _turn_keyframes(entries: Sequence[KeyframeEntry], units: UnitsEntry, share: Floats) -> Turn:
    """Orientations at shares [S] of the path's time; before the first keyframe and after the last they stay."""
    targets = []
    for index, entry in enumerate(entries):
        with placed(index):
            targets.append(Target((0.0, 0.0, 0.0), **read_orientation(entry, units)))
            if targets[-1].kind == "position":
                raise InputError("expected one of axis, rpy, quat_wxyz")
            if targets[-1].kind != targets[0].kind:
                raise InputError("either all keyframes give an axis, or none")
            if index and not entry.at > entries[index - 1].at:
                raise InputError("expected a later moment than that of the keyframe before", ("at",))
    orientation: PathOrientation = "axis" if targets[0].kind == "axis" else "pose"
    places = np.interp(share, [entry.at for entry in entries], np.arange(len(entries)))
    return orientation, turn_between(orientation, Targets.of(targets).R_world_tool, places)

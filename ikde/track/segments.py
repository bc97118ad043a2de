"""From the segments of a track file to a chain of curves, in metres and samples."""

import numpy as np

from ikde.errors import InputError
from ikde.formats.entries import UnitsEntry, only_key
from ikde.formats.error_path import prefix_errors
from ikde.formats.poses import read_position
from ikde.kernels.arrays import Floats
from ikde.track.path import MAX_SAMPLES
from ikde.track.shapes import Curve, Segment, make_arc, make_arc_through, make_line, make_spline
from ikde.track.spec import ArcEntry, ArcThroughEntry, CurveEntry, LineEntry, SegmentEntry, SplineEntry

SHAPES = ("line", "arc", "arc_through", "spline")
ROUNDING = 1e-6  # of a sample: what a duration may be off a whole number


def make_segments(entry: CurveEntry, units: UnitsEntry, dt_s: float) -> list[Segment]:
    """The pieces of a curve, each from where the last one ends; raises `InputError` with a path inside `entry`."""
    place, segments = read_position("from", entry.start, units), []
    for index, piece in enumerate(entry.segments):
        with prefix_errors("segments", index):
            samples = _count(piece.duration_s, dt_s)
            curve = _make_curve(piece, place, units)
        segments.append(Segment(curve=curve, samples=samples, smooth=piece.pace == "smooth"))
        place = curve(np.array([1.0]))[0]
    return segments


def _count(duration_s: float, dt_s: float) -> int:
    samples = min(duration_s / dt_s, MAX_SAMPLES + 1.0)
    if round(samples) < 1 or abs(samples - round(samples)) > ROUNDING:
        message = f"expected a whole number of samples of {dt_s:g} s, got {duration_s:g} s, {samples:g} samples"
        raise InputError(message, ("duration_s",))
    return round(samples)


def _make_curve(piece: SegmentEntry, place: Floats, units: UnitsEntry) -> Curve:
    shape = only_key(piece, SHAPES)
    with prefix_errors(shape):
        return _make_shape(getattr(piece, shape), place, units)


def _make_shape(shape: LineEntry | ArcEntry | ArcThroughEntry | SplineEntry, place: Floats, units: UnitsEntry) -> Curve:
    if isinstance(shape, LineEntry):
        return make_line(place, read_position("to", shape.to, units))
    if isinstance(shape, ArcEntry):
        center = read_position("center", shape.center, units)
        return make_arc(place, center, np.array(shape.normal), shape.angle * units.angle_rad)
    if isinstance(shape, ArcThroughEntry):
        return make_arc_through(place, read_position("via", shape.via, units), read_position("to", shape.to, units))
    with prefix_errors("through"):
        points = [read_position(index, point, units) for index, point in enumerate(shape.through)]
        return _spline(np.array([place, *points]))


def _spline(points: Floats) -> Curve:
    """A spline from where the tool is: the first of the points written is number 0."""
    try:
        return make_spline(points)
    except InputError as error:
        raise InputError(error.message, (int(error.where[0]) - 1,)) from None

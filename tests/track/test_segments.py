"""Segments of a track file: units, durations, and errors in their place."""

import numpy as np
import pytest

from ikde.errors import InputError
from ikde.formats.entries import UnitsEntry
from ikde.track.segments import make_segments
from ikde.track.shapes import follow_segments
from ikde.track.spec import CurveEntry

MM_DEG = UnitsEntry(length="mm", angle="deg")
LINE = {"duration_s": 1, "line": {"to": [1000, 0, 0]}}
ARC = {"duration_s": 0.5, "arc": {"center": [1000, 500, 0], "normal": [0, 0, 1], "angle": 180}}
THROUGH = {"duration_s": 0.5, "pace": "smooth", "arc_through": {"via": [500, 1500, 0], "to": [0, 1000, 0]}}
SPLINE = {"duration_s": 2, "spline": {"through": [[0, 500, 100], [0, 0, 0]]}}


def make(*segments, dt_s=0.1):
    entry = CurveEntry.model_validate({"from": [0, 0, 0], "segments": list(segments)})
    return make_segments(entry, MM_DEG, dt_s)


def test_each_piece_starts_where_the_last_one_ends():
    chain = make(LINE, ARC, THROUGH, SPLINE)
    assert [(s.samples, s.smooth) for s in chain] == [(10, False), (5, False), (5, True), (20, False)]
    p = follow_segments(chain, np.array([0, 5, 10, 12.5, 15, 20, 40]))
    np.testing.assert_allclose(
        p, [[0, 0, 0], [0.5, 0, 0], [1, 0, 0], [1.5, 0.5, 0], [1, 1, 0], [0, 1, 0], [0, 0, 0]], atol=1e-12
    )


@pytest.mark.parametrize(
    ("segments", "words"),
    [
        ([{"duration_s": 1}], "segments[0]: expected one of line, arc, arc_through, spline, got none"),
        ([LINE, {**LINE, **ARC}], "segments[1].arc: expected one of line, arc, arc_through, spline, got line and arc"),
        (
            [{**LINE, "duration_s": 0.55}],
            "segments[0].duration_s: expected a whole number of samples of 0.1 s, got 0.55",
        ),
        ([{**LINE, "duration_s": 1e-9}], "segments[0].duration_s: expected a whole number of samples"),
        ([{**LINE, "line": {"to": [1e9, 1e9, 1e9]}}, LINE], ""),
        ([LINE, {**LINE, "line": {"to": [0, 0, -2e9 + 1e9]}}], ""),
        (
            [{**ARC, "arc": {**ARC["arc"], "center": [0, 0, 5]}}],
            "segments[0].arc.center: the arc starts on its own axis",
        ),
        ([{**ARC, "arc": {**ARC["arc"], "normal": [0, 0, 0]}}], "segments[0].arc.normal: a normal of length 0"),
        (
            [{"duration_s": 1, "arc_through": {"via": [1, 0, 0], "to": [2, 0, 0]}}],
            "segments[0].arc_through.via: start, via and to lie on one line",
        ),
        (
            [LINE, {"duration_s": 1, "spline": {"through": [[1000, 0, 0], [1, 1, 1]]}}],
            "segments[1].spline.through[0]: this point is the one before it",
        ),
    ],
)
def test_what_is_wrong_is_placed(segments, words):
    if not words:
        make(*segments)
        return
    with pytest.raises(InputError) as caught:
        make(*segments)
    assert str(caught.value).startswith(words)


@pytest.mark.parametrize("dt_s", [0.02, 1 / 3, 0.001])
def test_a_duration_may_be_off_by_rounding(dt_s):
    assert make({**LINE, "duration_s": 300 * dt_s}, dt_s=dt_s)[0].samples == 300

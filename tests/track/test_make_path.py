"""Paths of track files: the same path however it is written, and errors at their keys."""

import numpy as np
import pytest

from tests.track.conftest import LINE

ENDS = {"waypoints": [{"position": [500, 0, 900]}, {"position": [1500, 0, 900]}]}
TURNS = [{"position": [0, 0, 900], "rpy": [0, 0, 0]}, {"position": [100, 0, 900], "rpy": [0, 0, 90]}]
CURVE = {"curve": {"from": [500, 0, 900], "segments": [{"duration_s": 1.0, "line": {"to": [1500, 0, 900]}}]}}


@pytest.mark.parametrize(("path", "samples"), [(LINE, 10), (ENDS, 10), (CURVE, 10), (CURVE, None)])
def test_a_line_is_a_line_however_it_is_written(make, path, samples):
    made = make(path, samples=samples)
    assert (made.name, made.samples, made.dt_s, made.orientation) == ("mine", 10, 0.1, "free")
    np.testing.assert_allclose(made.p_world_tool[:, 0], np.linspace(0.5, 1.5, 11), atol=1e-15)
    np.testing.assert_allclose(made.p_half[:, 0], np.linspace(0.55, 1.45, 10), atol=1e-15)
    np.testing.assert_allclose(made.p_world_tool[:, 1:], np.tile([0, 0.9], (11, 1)))


def test_sample_0_is_the_start_and_a_formula_knows_what_is_half_way(make):
    made = make({"expressions": {"x": "k*k", "y": "N", "z": "1 if k < 0.5 else 2"}}, units={"length": "m"})
    np.testing.assert_array_equal(made.p_world_tool[:3], [[0, 10, 1], [1, 10, 2], [4, 10, 2]])
    np.testing.assert_array_equal(made.p_half[:2], [[0.25, 10, 2], [2.25, 10, 2]])


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ({"path": {}}, "path: expected one of expressions, curve, waypoints, file, got none"),
        ({"path": {**LINE, **ENDS}}, "path.waypoints: expected one of expressions, curve, waypoints, file, got"),
        ({"samples": None}, "samples: this key is missing: formulas need"),
        ({"path": {"expressions": {"x": 1, "y": "j", "z": 1}}}, "path.expressions.y: 'j' is not known"),
        ({"path": {"expressions": {"x": 1, "y": 1, "z": "1/k"}}}, "path.expressions.z: '1/k' is inf at k = 0"),
        ({"path": {"expressions": {"x": 1, "y": 1, "z": "1e10*k"}}}, "path: sample 1: expected finite numbers up to"),
        ({"path": CURVE, "samples": 11}, "path.curve.segments: these take 10 samples, not 11: leave `samples` out"),
        ({"path": CURVE, "dt_s": 1e-300}, "path.curve.segments: expected up to 1,000,000 samples in all"),
        ({"path": CURVE, "dt_s": 0.3}, "path.curve.segments[0].duration_s: expected a whole number of samples"),
        ({"path": {"waypoints": TURNS}, "orientation": "free"}, "orientation: the waypoints have orientations of"),
    ],
)
def test_what_is_wrong_is_placed(complaint, keys, words):
    assert complaint(**keys).startswith(words)

"""Orientations of track files: formulas and keyframes."""

import numpy as np
import pytest

from ikde.model.rotation import rotation_from_rpy


def test_the_tool_may_be_turned_by_formulas(make):
    axis = make(orientation={"axis": ["cos(pi*k/N)", "sin(pi*k/N)", 0]})
    np.testing.assert_allclose(
        axis.targets().axis_world_tool[[0, 5, 10]], [[1, 0, 0], [0, 1, 0], [-1, 0, 0]], atol=1e-15
    )
    rpy = make(orientation={"rpy": [0, 0, "360*k/N"]})
    assert rpy.orientation == "pose"
    np.testing.assert_allclose(rpy.R_half[0], rotation_from_rpy(np.radians([0, 0, 18.0])), atol=1e-15)
    quat = make(orientation={"quat_wxyz": [0, 0, 0, "1 + k"]})
    np.testing.assert_allclose(quat.R_world_tool, np.tile(np.diag([-1.0, -1, 1]), (11, 1, 1)), atol=1e-15)


def test_keyframes_turn_evenly_and_stay_before_and_after(make):
    frames = [{"at": 0.2, "rpy": [0, 0, 0]}, {"at": 0.6, "rpy": [0, 0, 80]}]
    R = make(orientation={"keyframes": frames}).R_world_tool
    turned = np.degrees(np.arctan2(R[:, 1, 0], R[:, 0, 0]))
    np.testing.assert_allclose(turned, [0, 0, 0, 20, 40, 60, 80, 80, 80, 80, 80], atol=1e-12)
    axes = [{"at": 0, "axis": [0, 0, 2]}, {"at": 1, "axis": [1, 0, 0]}]
    made = make(orientation={"keyframes": axes})
    assert made.orientation == "axis"
    np.testing.assert_allclose(made.targets()[5].axis_world_tool, [0.5**0.5, 0, 0.5**0.5], atol=1e-15)


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ({"orientation": {}}, "orientation: expected one of axis, rpy, quat_wxyz, keyframes, got none"),
        ({"orientation": {"axis": [0, 0, "k"]}}, "orientation.axis: a length of 0 has no direction, at k = 0"),
        ({"orientation": {"rpy": [0, "sqt(k)", 0]}}, "orientation.rpy[1]: no function is called 'sqt'"),
        ({"orientation": {"keyframes": [{"at": 0}]}}, "orientation.keyframes[0]: expected one of axis, rpy, quat_wxyz"),
        (
            {"orientation": {"keyframes": [{"at": 0, "rpy": [0, 0, 0]}, {"at": 1, "axis": [0, 0, 1]}]}},
            "orientation.keyframes[1]: either all keyframes give an axis, or none",
        ),
        (
            {"orientation": {"keyframes": [{"at": 0.5, "rpy": [0, 0, 0]}, {"at": 0.5, "rpy": [0, 0, 1]}]}},
            "orientation.keyframes[1].at: expected a later moment",
        ),
        (
            {"orientation": {"keyframes": [{"at": 0, "rpy": [0, 0, 0]}, {"at": 1, "rpy": [0, 0, 180]}]}},
            "orientation.keyframes[1]: half a turn from the orientation before it",
        ),
    ],
)
def test_what_is_wrong_is_placed(complaint, keys, words):
    assert complaint(**keys).startswith(words)

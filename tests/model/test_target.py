"""Targets: what is accepted, what is made of it, and one line for what is not."""

import numpy as np
import pytest

from ikde.errors import InputError
from ikde.model.target import Target

P = [0.8, 0.5, 1.0]
R = [[0, 0, 1], [1, 0, 0], [0, 1, 0]]


def test_a_position_target_asks_for_nothing_else():
    target = Target(P)
    assert target.kind == "position"
    np.testing.assert_array_equal(target.p_world_tool, P)
    np.testing.assert_array_equal(target.R_world_tool, np.eye(3))


def test_a_pose_target_keeps_its_rotation():
    target = Target(tuple(P), R_world_tool=R)
    assert target.kind == "pose"
    np.testing.assert_array_equal(target.R_world_tool, R)


@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e6])
def test_an_axis_target_takes_an_axis_of_any_length(scale):
    target = Target(P, axis_world_tool=scale * np.array([3.0, 0.0, 4.0]))
    assert target.kind == "axis"
    np.testing.assert_allclose(target.axis_world_tool, [0.6, 0.0, 0.8], rtol=1e-15)
    np.testing.assert_array_equal(target.R_world_tool[:, 2], target.axis_world_tool)


def test_a_target_is_read_only_and_keeps_its_own_copy():
    p, rotation = np.array(P), np.array(R, dtype=float)
    target = Target(p, R_world_tool=rotation)
    p[0], rotation[0, 0] = 9.0, 9.0
    assert target.p_world_tool[0] == 0.8
    assert target.R_world_tool[0, 0] == 0.0
    with pytest.raises(ValueError, match="read-only"):
        target.p_world_tool[0] = 1.0
    with pytest.raises(ValueError, match="read-only"):
        target.R_world_tool[0, 0] = 1.0


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"p_world_tool": [1.0, 2.0]}, "p_world_tool: expected 3 numbers, got 2"),
        ({"p_world_tool": []}, "p_world_tool: expected 3 numbers, got 0"),
        ({"p_world_tool": 1.0}, "p_world_tool: expected 3 numbers, got shape ()"),
        ({"p_world_tool": [[1.0, 2.0, 3.0]]}, "p_world_tool: expected 3 numbers, got shape (1, 3)"),
        (
            {"p_world_tool": [1.0, np.nan, 3.0]},
            "p_world_tool: expected finite numbers up to 1e+06, got [1.0, nan, 3.0]",
        ),
        (
            {"p_world_tool": [1.0, np.inf, 3.0]},
            "p_world_tool: expected finite numbers up to 1e+06, got [1.0, inf, 3.0]",
        ),
        ({"p_world_tool": ["a", 2.0, 3.0]}, "p_world_tool: expected numbers, got ['a', 2.0, 3.0]"),
        ({"p_world_tool": None}, "p_world_tool: expected 3 numbers"),
        ({"p_world_tool": [1.0, [2.0], 3.0]}, "p_world_tool: expected numbers"),
        ({"p_world_tool": P, "axis_world_tool": [0, 0, 0]}, "axis_world_tool: an axis of length 0 has no direction"),
        ({"p_world_tool": P, "axis_world_tool": [0, 1]}, "axis_world_tool: expected 3 numbers, got 2"),
        ({"p_world_tool": P, "axis_world_tool": [0, np.nan, 1]}, "axis_world_tool: expected finite numbers"),
        ({"p_world_tool": P, "R_world_tool": np.eye(2)}, "a rotation matrix is 3 x 3 finite numbers, got shape (2, 2)"),
        ({"p_world_tool": P, "R_world_tool": 2 * np.eye(3)}, "not a rotation matrix"),
        ({"p_world_tool": P, "R_world_tool": np.diag([1, 1, -1])}, "not a rotation matrix"),
        ({"p_world_tool": P, "R_world_tool": "east"}, "R_world_tool: expected numbers, got 'east'"),
        ({"p_world_tool": P, "R_world_tool": R, "axis_world_tool": [0, 0, 1]}, "not both"),
    ],
)
def test_a_bad_target_is_refused_in_one_line(arguments, message):
    with pytest.raises(InputError) as caught:
        Target(**arguments)
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)

"""A tool path: poses at the samples and between them, checked when it is made."""

import numpy as np
import pytest

from ikde.errors import InputError
from ikde.model.rotation import rotation_from_rpy
from ikde.track.path import ToolPath

P = np.array([[0.0, 0.0, 1.0], [0.1, 0.0, 1.0], [0.1, 0.2, 1.0]])
TURNED = rotation_from_rpy(np.array([[0, 0, 0], [0, 0, 1.0], [0.5, 0, 1.0]]))


def test_a_sample_is_due_every_dt():
    path = ToolPath.through(P, dt_s=0.02)
    assert (path.name, path.samples, path.duration_s, path.orientation) == ("path", 2, 0.04, "free")
    np.testing.assert_array_equal(path.times_s, [0.0, 0.02, 0.04])


def test_what_is_asked_are_targets():
    free = ToolPath.through(P, dt_s=1.0)
    axis = ToolPath.through(P, dt_s=1.0, axis_world_tool=[[0, 0, 2.0], [0, 1, 1], [0, 3, 0]])
    pose = ToolPath.through(P, dt_s=1.0, R_world_tool=TURNED)
    assert [path.targets()[1].kind for path in (free, axis, pose)] == ["position", "axis", "pose"]
    np.testing.assert_allclose(axis.R_world_tool[2, :, 2], [0, 1, 0])
    np.testing.assert_array_equal(pose.targets().R_world_tool, TURNED)
    np.testing.assert_array_equal(free.targets().p_world_tool, P)


def test_half_way_it_is_on_the_chord_and_on_the_shortest_turn():
    half = ToolPath.through(P, dt_s=1.0, R_world_tool=TURNED).half_targets()
    np.testing.assert_allclose(half.p_world_tool, [[0.05, 0, 1], [0.1, 0.1, 1]])
    np.testing.assert_allclose(half.R_world_tool[0], rotation_from_rpy(np.array([0, 0, 0.5])), atol=1e-15)
    axis = ToolPath.through(P, dt_s=1.0, axis_world_tool=[[1, 0, 0], [0, 1, 0], [0, 1, 0]]).half_targets()
    np.testing.assert_allclose(axis.axis_world_tool, [[0.5**0.5, 0.5**0.5, 0], [0, 1, 0]], atol=1e-15)


def test_a_formula_knows_better_what_is_half_way():
    p_half = np.array([[0.05, 0.01, 1], [0.11, 0.1, 1]])
    path = ToolPath(dt_s=1.0, p_world_tool=P, p_half=p_half)
    np.testing.assert_array_equal(path.half_targets().p_world_tool, p_half)


def test_a_path_cannot_be_changed():
    path = ToolPath.through(P, dt_s=1.0)
    with pytest.raises(ValueError, match="read-only"):
        path.p_world_tool[0, 0] = 1.0
    P[0, 0] = P[0, 0]  # the caller's own array stays the caller's


def bad(**keys):
    return lambda: ToolPath(**{"dt_s": 1.0, "p_world_tool": P, **keys})


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (bad(dt_s=0.0), "dt_s: expected 1e-09 to 1e+06 s"),
        (bad(dt_s=np.nan), "dt_s: expected 1e-09 to 1e+06 s"),
        (bad(p_world_tool=P[:1]), "p_world_tool: expected 1 to 1,000,000 samples after the start, got 0"),
        (bad(p_world_tool=P[:, :2]), "p_world_tool: expected an array [T, 3]"),
        (bad(p_world_tool=P * np.nan), "p_world_tool[0]: expected finite numbers"),
        (bad(orientation="pose"), "R_world_tool: a path of orientation 'pose' needs rotations"),
        (bad(orientation="pose", R_world_tool=np.zeros((3, 3, 3))), "R_world_tool[0]: not a rotation matrix"),
        (bad(orientation="pose", R_world_tool=TURNED[:2]), "R_world_tool: expected 3 rows"),
        (bad(p_half=P), "p_half: expected 2 poses, one fewer than samples, got 3"),
        (bad(p_half=P[:2] * np.nan), "p_half[0]: expected finite numbers"),
        (
            lambda: ToolPath.through(P, dt_s=1.0, axis_world_tool=[[0, 0, 1], [0, 0, 1], [0, 0, -1]]),
            "R_world_tool[2]: half a turn from the orientation before it",
        ),
        (lambda: ToolPath.through(P, dt_s=1.0, axis_world_tool=P * 0), "axis_world_tool[0]: an axis of length 0"),
    ],
)
def test_what_is_wrong_is_named(make, words):
    with pytest.raises(InputError) as caught:
        make()
    assert str(caught.value).startswith(words)

"""Solids: sizes, points and poses are checked; height fields are boxes."""

import numpy as np
import pytest

from ikde.errors import InputError
from ikde.model.rotation import measure_skew, rotation_from_rpy
from ikde.model.solids import KINDS, MAX_CLOUD_POINTS, SIZES, make_columns, make_solid, read_points, read_pose

CORNERS = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]


@pytest.mark.parametrize("kind", KINDS)
def test_every_kind_is_made(kind):
    solid = make_solid(kind, [0.1] * len(SIZES[kind]), None, CORNERS)
    assert solid.kind == kind
    assert solid.size_m == (0.1,) * len(SIZES[kind])
    assert (solid.points is not None) == (kind in ("hull", "cloud"))
    assert (solid.triangles is not None) == (kind == "hull")
    assert not solid.T_obstacle_solid.flags.writeable


@pytest.mark.parametrize("size", [0.0, -0.1, np.nan, np.inf, 1e9])
def test_a_size_that_is_none(size):
    with pytest.raises(InputError, match=r"^height: expected a size from 1e-06 to \S+ m, got"):
        make_solid("cylinder", [0.1, size])


def test_the_number_of_sizes():
    with pytest.raises(InputError, match=r"expected 3 sizes \(x, y, z\), got 2"):
        make_solid("box", [1, 2])
    with pytest.raises(InputError, match=r"expected one of sphere, .*, got 'torus'"):
        make_solid("torus", [1, 2])


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf, 1e9])
def test_points_are_finite(bad):
    with pytest.raises(InputError, match=r"^points\[1\]: expected finite numbers up to \S+ m, got \[.*, and 1 more"):
        read_points([[0, 0, 0], [0, bad, 0], [0, 0, bad]], MAX_CLOUD_POINTS)


def test_too_many_points():
    with pytest.raises(InputError, match="expected at most 2 points, got 4"):
        read_points(CORNERS, 2)
    with pytest.raises(InputError, match=r"expected points \[K, 3\], got shape \(0,\)"):
        make_solid("cloud", [0.1])


def test_a_pose_is_a_rotation_without_minus_zero():
    assert not np.signbit(read_pose(-np.zeros((3, 4)) + np.eye(4)[:3] * 1.0, ())).any()
    for T in (np.eye(3), 2 * np.eye(4), np.full((4, 4), np.nan), np.diag([1, 1, -1, 1])):
        with pytest.raises(InputError):
            make_solid("sphere", [1], T)


def test_a_pose_of_rounded_numbers_becomes_a_rotation():
    exact = rotation_from_rpy(np.array([0.3, -1.1, 2.0]))
    T = np.column_stack([exact, [1.0, 2.0, 3.0]])
    assert read_pose(T, ()).tobytes() == T.tobytes()
    for rounded in (T.astype(np.float32), np.round(T, 7)):
        pose = read_pose(rounded, ())
        assert measure_skew(rounded[:, :3]) > 1e-9
        assert measure_skew(pose[:, :3]) < 1e-14
        assert abs(pose[:, :3] - exact).max() < 1e-7
        assert read_pose(pose, ()).tobytes() == pose.tobytes()


def test_columns_of_one_height_are_one_box():
    solids = make_columns([[0.1, 0.0], [0.1, 0.2], [0.3, 0.2]], 0.5, base_m=-0.1)
    assert [solid.size_m for solid in solids] == [
        pytest.approx(size) for size in ((1, 0.5, 0.2), (0.5, 0.5, 0.4), (0.5, 0.5, 0.1), (1, 0.5, 0.3))
    ]
    places = np.array([solid.T_obstacle_solid[:, 3] for solid in solids])
    assert np.allclose(places, [[0.25, 0, 0], [1, 0, 0.1], [0, 0.5, -0.05], [0.75, 0.5, 0.05]])


@pytest.mark.parametrize(("heights", "cell"), [([], 1), ([[np.nan]], 1), ([[1]], 0), ([[1]], -1), ([1, 2], 1)])
def test_columns_that_are_none(heights, cell):
    with pytest.raises(InputError):
        make_columns(heights, cell)


def test_a_height_field_has_a_limit():
    with pytest.raises(InputError, match="at most 100,000 boxes, got 200,000"):
        make_columns(np.arange(200_000.0).reshape(1000, 200) / 1e3, 0.1)

"""The nearest point of a polytope, by the conditions that only it meets."""

import numpy as np
import pytest
from scipy.optimize import nnls

from ikde.kernels.nearest import find_nearest, make_walls


def make(normals, offsets):
    normals = np.array(normals, dtype=float)
    lengths = np.linalg.norm(normals, axis=1)
    walls = make_walls(len(normals), normals.shape[1])
    walls.normals[:], walls.offsets[:] = normals / lengths[:, None], np.array(offsets) / lengths
    return walls


def is_nearest(walls, start, y):
    """Inside, and y - start is a sum of pushes by walls that it stands at."""
    slack = walls.normals @ y - walls.offsets
    at = walls.normals[slack < 1e-8]
    left = nnls(at.T, y - start)[1] if len(at) else np.linalg.norm(y - start)
    return slack.min() > -1e-9 and left < 1e-7


@pytest.mark.parametrize("seed", range(60))
def test_it_is_the_nearest(seed):
    rng = np.random.default_rng(seed)
    size, count = int(rng.integers(1, 10)), int(rng.integers(1, 30))
    inside = rng.standard_normal(size)
    normals = rng.standard_normal((count, size))
    if seed % 3 == 0 and count > 3:
        normals[1], normals[2] = normals[0], -normals[0]  # parallel walls, and a pair that faces each other
    offsets = normals @ inside - rng.uniform(0, 0.5, count) * np.linalg.norm(normals, axis=1)
    walls = make(normals, offsets)
    start = 3.0 * rng.standard_normal(size)
    y = start.copy()
    assert find_nearest(walls, count, y)
    assert is_nearest(walls, start, y)


def test_inside_nothing_moves():
    y = np.array([0.25, 0.5])
    assert find_nearest(make(np.vstack([np.eye(2), -np.eye(2)]), [0, 0, -1, -1]), 4, y)
    np.testing.assert_array_equal(y, [0.25, 0.5])


def test_a_corner():
    y = np.array([3.0, -2.0])
    assert find_nearest(make(np.vstack([np.eye(2), -np.eye(2)]), [0, 0, -1, -1]), 4, y)
    np.testing.assert_allclose(y, [1, 0], atol=1e-15)


def test_walls_beyond_the_count_are_not_looked_at():
    y = np.array([3.0])
    assert find_nearest(make([[1.0], [-1.0]], [0.0, -1.0]), 1, y)
    assert y[0] == 3.0


@pytest.mark.parametrize("seed", range(20))
def test_an_empty_polytope_is_told(seed):
    rng = np.random.default_rng(seed)
    size = int(rng.integers(1, 8))
    normal = rng.standard_normal(size)
    others = rng.standard_normal((4, size))
    walls = make(np.vstack([normal, -normal, others]), [1.0, -0.9, *(-10.0 * np.ones(4))])
    assert not find_nearest(walls, 6, 3 * rng.standard_normal(size))

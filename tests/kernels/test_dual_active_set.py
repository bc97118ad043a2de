"""The nearest point of a polytope, by the conditions that only it meets."""

import numpy as np
import pytest
from scipy.optimize import nnls

from ikde.kernels.dual_active_set import find_nearest_point, make_half_spaces


def make(normals, offsets):
    normals = np.array(normals, dtype=float)
    lengths = np.linalg.norm(normals, axis=1)
    spaces = make_half_spaces(len(normals), normals.shape[1])
    spaces.normals[:], spaces.offsets[:] = normals / lengths[:, None], np.array(offsets) / lengths
    return spaces


def is_nearest(spaces, start, y):
    """Inside, and y - start is a sum of normals of active constraints, with multipliers >= 0."""
    slack = spaces.normals @ y - spaces.offsets
    at = spaces.normals[slack < 1e-8]
    left = nnls(at.T, y - start)[1] if len(at) else np.linalg.norm(y - start)
    return slack.min() > -1e-9 and left < 1e-7


@pytest.mark.parametrize("seed", range(60))
def test_it_is_the_nearest(seed):
    rng = np.random.default_rng(seed)
    size, count = int(rng.integers(1, 10)), int(rng.integers(1, 30))
    inside = rng.standard_normal(size)
    normals = rng.standard_normal((count, size))
    if seed % 3 == 0 and count > 3:
        normals[1], normals[2] = normals[0], -normals[0]  # parallel constraints, and a pair that faces each other
    offsets = normals @ inside - rng.uniform(0, 0.5, count) * np.linalg.norm(normals, axis=1)
    spaces = make(normals, offsets)
    start = 3.0 * rng.standard_normal(size)
    y = start.copy()
    assert find_nearest_point(spaces, count, y)
    assert is_nearest(spaces, start, y)


def test_inside_nothing_moves():
    y = np.array([0.25, 0.5])
    assert find_nearest_point(make(np.vstack([np.eye(2), -np.eye(2)]), [0, 0, -1, -1]), 4, y)
    np.testing.assert_array_equal(y, [0.25, 0.5])


def test_a_corner():
    y = np.array([3.0, -2.0])
    assert find_nearest_point(make(np.vstack([np.eye(2), -np.eye(2)]), [0, 0, -1, -1]), 4, y)
    np.testing.assert_allclose(y, [1, 0], atol=1e-15)


def test_constraints_beyond_the_count_are_ignored():
    y = np.array([3.0])
    assert find_nearest_point(make([[1.0], [-1.0]], [0.0, -1.0]), 1, y)
    assert y[0] == 3.0


@pytest.mark.parametrize("seed", range(20))
def test_an_empty_polytope_is_recognised(seed):
    rng = np.random.default_rng(seed)
    size = int(rng.integers(1, 8))
    normal = rng.standard_normal(size)
    others = rng.standard_normal((4, size))
    spaces = make(np.vstack([normal, -normal, others]), [1.0, -0.9, *(-10.0 * np.ones(4))])
    assert not find_nearest_point(spaces, 6, 3 * rng.standard_normal(size))

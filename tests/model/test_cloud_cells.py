"""Points by cell: all of them, each where it belongs, and how far cells are from occupied ones."""

import numpy as np
import pytest

from ikde.model import cloud_cells as module
from ikde.model.cloud_cells import find_sorted, sort_cloud

CLOUDS = {
    "one": lambda rng: rng.normal(size=(1, 3)),
    "many": lambda rng: rng.uniform(-1.0, 1.0, (500, 3)),
    "a surface": lambda rng: rng.uniform(-1.0, 1.0, (500, 3)) * [1.0, 0.0, 1.0],
    "a line": lambda rng: rng.uniform(-1.0, 1.0, (500, 1)) * [[0.0, 0.0, 6.0]],
    "on faces": lambda rng: 0.3 * rng.integers(-3, 3, (300, 3)),
}


def find_layers(numbers, P):
    return np.minimum(np.floor((P - numbers[:3]) / numbers[3]), numbers[4:] - 1).astype(int)


@pytest.mark.parametrize("name", CLOUDS)
def test_points_are_sorted_by_cell_in_their_order(rng, name):
    points = CLOUDS[name](rng)
    cells, by_cell = sort_cloud(points, 0.3)
    i, j, k = find_layers(cells.numbers, points).T
    place = (i * int(cells.numbers[5]) + j) * int(cells.numbers[6]) + k
    np.testing.assert_array_equal(by_cell.T, points[np.argsort(place, kind="stable")])
    np.testing.assert_array_equal(np.diff(cells.starts), np.bincount(place, minlength=len(cells.far)))
    assert cells.starts[-1] == len(points)


@pytest.mark.parametrize("most", [2**16, 20])  # cells that numbers of 16 bits count, and more
def test_many_cells_are_sorted_in_two_passes(rng, monkeypatch, most):
    points = rng.uniform(-1.0, 1.0, (3000, 3))
    expected = sort_cloud(points, 0.02).points
    monkeypatch.setattr(module, "COUNTED", most)
    np.testing.assert_array_equal(sort_cloud(points, 0.02).points, expected)


def test_cells_are_as_far_from_occupied_ones_as_their_boxes_are(rng):
    points = rng.uniform(-1.0, 1.0, (40, 3)) * [1.0, 0.6, 1.5]
    cells, _ = sort_cloud(points, 0.1)
    dims = cells.numbers[4:].astype(int)
    layers = np.indices(tuple(dims.tolist())).reshape(3, -1).T
    occupied = layers[np.diff(cells.starts) > 0]
    between = np.maximum(abs(layers[:, None] - occupied) - 1, 0)
    nearest = np.sqrt((between**2).sum(axis=-1)).min(axis=1)
    assert nearest.max() > 3.0
    np.testing.assert_allclose(cells.far, 0.1 * np.minimum(nearest, module.FAR_CELLS), rtol=1e-15)


def test_a_box_holds_the_points_that_are_in_it(rng):
    points = rng.uniform(-1.0, 1.0, (2000, 3))
    points.setflags(write=False)
    known = find_sorted(points)
    assert find_sorted(points) is known
    assert np.linalg.norm(points, axis=1).max() <= known.radius_m
    for _ in range(30):
        low = rng.uniform(-1.5, 1.5, 3)
        high = low + rng.uniform(0.0, 1.0, 3)
        inside = points[((points >= low) & (points <= high)).all(axis=1)]
        assert sorted(known.find_within(low, high).tolist()) == sorted(inside.tolist())


def test_few_points_have_few_cells(rng):
    cells, _ = sort_cloud(rng.uniform(-10.0, 10.0, (1000, 3)))
    assert len(cells.far) <= module.MIN_CELLS

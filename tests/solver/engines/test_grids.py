"""A grid over tool poses."""

import numpy as np
import pytest

from ikde.kernels import seeds
from ikde.kernels.arrays import SeedArrays, TargetArrays
from ikde.solver.engines.grids import find_cells, keep_few, scale_grid
from tests.uncompiled import plain_module

GRID = np.array([[11, 4], [3, 3], [8, 5]])


@pytest.fixture
def poses(rng):
    """Transforms [50, 3, 4] of any numbers, and the entries [3, 50] that the grid divides."""
    T = rng.normal(size=(50, 3, 4))
    return T, T.reshape(50, 12).T[GRID[:, 0]]


def test_a_grid_holds_what_it_was_laid_over(poses):
    _, values = poses
    scale = scale_grid(GRID, values)
    steps = (values - scale[:, :1]) * scale[:, 1:]
    np.testing.assert_allclose(steps.min(axis=1), 0.0, atol=1e-12)
    np.testing.assert_allclose(steps.max(axis=1), GRID[:, 1], rtol=1e-12)


def test_cells_are_those_that_the_search_looks_into(poses):
    T, values = poses
    scale = scale_grid(GRID, values[:, :20])  # the rest may lie outside
    target = TargetArrays(np.zeros(50, dtype=np.int64), T)
    none = np.empty(0)
    pool = SeedArrays(none, none, none, GRID, scale, none, rotation_length=1.0, first_box=1.0)
    expected = [plain_module(seeds).find_cell(pool, target, row) for row in range(50)]
    assert find_cells(GRID, scale, values).tolist() == expected
    assert len(set(expected)) > 10


def test_where_nothing_differs_there_is_one_cell():
    values = np.full((3, 8), 0.25)
    assert set(find_cells(GRID, scale_grid(GRID, values), values).tolist()) == {0}


def test_the_first_of_each_cell_are_kept_in_order():
    cells = np.array([5, 1, 5, 5, 0, 1, 5, 1])
    assert keep_few(cells, 2).tolist() == [0, 1, 2, 4, 5]
    assert keep_few(cells, 9).tolist() == list(range(8))

"""Differential evolution in plain numpy: it finds what scipy's finds, within bounds, the same in every run."""

import numpy as np
from scipy.optimize import differential_evolution

from ikde.paper.evolve import evolve


def valleys(X):
    """Many local minima; the least, 0, at (1, -2, 3)."""
    away = X - np.array([1.0, -2.0, 3.0])
    return (away**2).sum(axis=-1) + 3.0 * (1.0 - np.cos(4.0 * away)).sum(axis=-1)


def test_it_ends_in_the_deepest_valley_as_scipys_does():
    low, high = [-5.0] * 3, [5.0] * 3
    best, cost = evolve(valleys, low, high)
    np.testing.assert_allclose(best, [1, -2, 3], atol=1e-6)
    assert 0.0 <= cost < 1e-10
    theirs = differential_evolution(valleys, list(zip(low, high, strict=True)), seed=1, maxiter=60, tol=0.0)
    np.testing.assert_allclose(best, theirs.x, atol=1e-4)


def test_bounds_hold_and_a_run_comes_out_again():
    asked = []

    def cost(X):
        asked.append(X.copy())
        return -X.sum(axis=1)

    first, again = (evolve(cost, [0.0, -1.0], [1.0, 2.0], generations=30, seed=3) for _ in range(2))
    every = np.vstack(asked)
    assert (every >= [0.0, -1.0]).all()
    assert (every <= [1.0, 2.0]).all()
    assert first[0].tolist() == again[0].tolist()
    assert first[0].tolist() != evolve(cost, [0.0, -1.0], [1.0, 2.0], generations=30, seed=4)[0].tolist()
    assert first[1] < -2.9

"""Differential evolution of any function of a few variables, in plain numpy [Storn1997]: rand/1/bin."""

from collections.abc import Callable, Sequence

import numpy as np

from ikde.kernels.arrays import Floats

WEIGHT, CROSSOVER = 0.7, 0.9


def evolve(
    cost: Callable[[Floats], Floats],
    low: Sequence[float],
    high: Sequence[float],
    *,
    population: int = 40,
    generations: int = 200,
    seed: int = 1,
) -> tuple[Floats, float]:
    """The best point [N] found between `low` and `high` [N], and its cost.

    Args:
        cost: costs [P] of points [P, N]; the least is sought. All trials of a generation are asked for at once.
        low: lower bounds [N].
        high: upper bounds [N]; a trial beyond a bound is drawn anew in that variable.
        population: points P, at least 4.
        generations: after which it ends.
        seed: of numpy's generator; the same in every run.
    """
    rng, variables = np.random.default_rng(seed), len(low)
    points = rng.uniform(low, high, (population, variables))
    costs = cost(points)
    for _ in range(generations):
        draws = rng.random((population, population))
        np.fill_diagonal(draws, 2.0)  # no point is its own parent
        a, b, c = points[np.argsort(draws, axis=1)[:, :3].T]
        mutants = a + WEIGHT * (b - c)
        fresh = rng.uniform(low, high, mutants.shape)
        mutants = np.where((mutants < low) | (mutants > high), fresh, mutants)
        taken = rng.random(mutants.shape) < CROSSOVER
        taken[np.arange(population), rng.integers(variables, size=population)] = True
        trials = np.where(taken, mutants, points)
        trial_costs = cost(trials)
        better = trial_costs <= costs
        points[better], costs[better] = trials[better], trial_costs[better]
    best = int(costs.argmin())
    return points[best], float(costs[best])

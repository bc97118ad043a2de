"""Differential evolution from SciPy, pymoo and pygmo on ikde's compiled objective, depth of penetration included."""

import time
from typing import Any

import numba
import numpy as np
from objective import make_objective
from protocol import Peer, Setup

GENERATIONS, POPULATION, WEIGHT, CROSSOVER = 1000, 50, 0.5, 0.9


class _Evolution(Peer):
    """What the three share: the objective for one and for a population."""

    def prepare(self, setup: Setup) -> None:
        """Compile the objective."""
        super().prepare(setup)
        self.evaluate, self.goal = make_objective(setup)
        evaluate = self.evaluate

        @numba.njit
        def evaluate_all(X, p, R):
            out = np.empty((2, len(X)))
            for k in range(len(X)):
                out[0, k], out[1, k] = evaluate(X[k], p, R)
            return out

        self.evaluate_all = evaluate_all
        self.count = setup.seed

    def solve(self, target: Any, deadline: float) -> np.ndarray | None:
        """Runs with new seeds until one succeeds."""
        while True:
            self.count += 1
            q = self.run(*target, deadline)
            error, depth = self.evaluate(q, *target)
            if error <= self.goal and depth == 0.0 and self.setup.checker.is_free(q):
                return q
            if time.perf_counter() > deadline:
                return None

    def run(self, p: np.ndarray, R: np.ndarray, deadline: float) -> np.ndarray:
        """One run: its best [N]."""
        raise NotImplementedError


class Scipy(_Evolution):
    """`scipy.optimize.differential_evolution`."""

    def run(self, p: np.ndarray, R: np.ndarray, deadline: float) -> np.ndarray:
        """Its defaults, vectorised."""
        from scipy.optimize import differential_evolution

        def cost(X: np.ndarray) -> Any:
            if X.ndim == 1:
                return sum(self.evaluate(X, p, R))
            return self.evaluate_all(np.ascontiguousarray(X.T), p, R).sum(axis=0)

        def stop(intermediate_result: Any) -> bool:
            return intermediate_result.fun <= self.goal or time.perf_counter() > deadline

        bounds = np.column_stack([self.setup.lower, self.setup.upper])
        options = {"tol": 1e-8, "maxiter": GENERATIONS, "vectorized": True, "updating": "deferred", "rng": self.count}
        answer = differential_evolution(cost, bounds, callback=stop, **options)
        return np.clip(answer.x, self.setup.lower, self.setup.upper)


class Pymoo(_Evolution):
    """pymoo's DE with its constraint handling."""

    def run(self, p: np.ndarray, R: np.ndarray, deadline: float) -> np.ndarray:
        """A vectorised problem with one constraint."""
        from pymoo.algorithms.soo.nonconvex.de import DE
        from pymoo.core.problem import Problem
        from pymoo.optimize import minimize

        evaluate_all, goal, setup = self.evaluate_all, self.goal, self.setup

        class Reach(Problem):
            def __init__(self) -> None:
                super().__init__(n_var=len(setup.lower), n_obj=1, n_ieq_constr=1, xl=setup.lower, xu=setup.upper)

            def _evaluate(self, x: np.ndarray, out: dict[str, Any], *args: Any, **kwargs: Any) -> None:
                out["F"], out["G"] = evaluate_all(np.ascontiguousarray(x), p, R)[:, :, None]

        def stop(algorithm: Any) -> None:
            best = algorithm.opt[0]
            if (best.feas and best.F[0] <= goal) or time.perf_counter() > deadline:
                algorithm.termination.force_termination = True

        algorithm = DE(pop_size=POPULATION, variant="DE/rand/1/bin", F=WEIGHT, CR=CROSSOVER)
        options = {"seed": self.count, "callback": stop, "return_least_infeasible": True}
        return minimize(Reach(), algorithm, ("n_gen", GENERATIONS), **options).X


class Pygmo(_Evolution):
    """pygmo's DE, with the depth as penalty."""

    def run(self, p: np.ndarray, R: np.ndarray, deadline: float) -> np.ndarray:
        """Blocks of generations."""
        import pygmo

        population = pygmo.population(pygmo.problem(_Reach(self, p, R)), POPULATION, seed=self.count)
        options = {"gen": 50, "F": WEIGHT, "CR": CROSSOVER, "variant": 7, "ftol": 0.0, "xtol": 0.0}
        algorithm = pygmo.algorithm(pygmo.de(**options, seed=self.count))
        for _ in range(GENERATIONS // 50):
            population = algorithm.evolve(population)
            if population.champion_f[0] <= self.goal or time.perf_counter() > deadline:
                break
        return population.champion_x


class _Reach:
    """pygmo's kind of problem."""

    def __init__(self, peer: _Evolution, p: np.ndarray, R: np.ndarray) -> None:
        self.parts = peer.evaluate, p, R, peer.setup

    def __deepcopy__(self, memo: Any) -> "_Reach":
        return self

    def fitness(self, x: np.ndarray) -> list[float]:
        """Error and depth together."""
        evaluate, p, R, _ = self.parts
        return [sum(evaluate(x, p, R))]

    def get_bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """The joint limits."""
        setup = self.parts[3]
        return setup.lower, setup.upper

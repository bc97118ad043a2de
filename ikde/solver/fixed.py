"""Where no joint may move there is nothing to search: the one configuration is looked at, and that is the answer."""

import time

import numpy as np

from ikde.kernels.arrays import ATTEMPTS, COLLIDING, EVALUATIONS, REACHED
from ikde.model.target import Targets
from ikde.solver.engine_table import NAMES, NO_ENGINE
from ikde.solver.engines.search_state import SearchState
from ikde.solver.metrics import compute_metrics
from ikde.solver.plain import compute_gaps
from ikde.solver.problem import Problem


def look(problem: Problem, targets: Targets, found: SearchState) -> None:
    """Fill `found`: every target is tried once, with one evaluation, by no engine; what it is off by is exact."""
    settings, collision = problem.settings, problem.collision
    found.q[:] = problem.lower
    # No target at all: the grader is compiled or loaded, and no clock counts it.
    compute_metrics(collision, targets.take(slice(0)), found.q[:0], settings)
    began = time.perf_counter()
    metrics = compute_metrics(collision, targets, found.q, settings)
    found.metrics.put(slice(None), metrics)
    far_m, off_rad = metrics.position_error_m, metrics.orientation_error_rad
    found.excess_m[:] = np.where(far_m > settings.position_tolerance_m, far_m, 0.0)
    found.excess_rad[:] = np.where(off_rad > settings.orientation_tolerance_rad, off_rad, 0.0)
    hits = compute_gaps(collision, problem.lower[None])[0] <= collision.limit_m
    is_met = ~found.is_excluded()
    found.score[:] = np.column_stack([~is_met, np.where(is_met, 0.0, far_m)])
    found.counts[:, [ATTEMPTS, EVALUATIONS]] = 1
    found.counts[:, REACHED] = metrics.accepted
    found.counts[:, COLLIDING] = is_met & hits.any()
    found.pair_counts[:] = is_met[:, None] & hits
    found.engine[:] = NAMES.index(NO_ENGINE)
    found.seconds[:] = (time.perf_counter() - began) / max(1, len(targets))


def tell_fixed(far_m: float, off_rad: float, pair: tuple[str, str] | None) -> str:
    """One line: by how much the tool misses the target, m and rad, and which pair collides, if one does."""
    if pair and not (far_m or off_rad):
        return f"no joint may move: the target is met, but {pair[0]} and {pair[1]} collide"
    off = [f"{far_m:.3g} m"] if far_m > 0.0 else []
    off += [f"{off_rad:.3g} rad"] if off_rad > 0.0 else []
    collision = f", and {pair[0]} and {pair[1]} collide" if pair else ""
    return f"no joint may move: the tool stays {' and '.join(off)} off{collision}"

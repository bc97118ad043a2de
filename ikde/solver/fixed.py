"""Where no joint may move there is nothing to search: the one configuration is graded, and that is the answer."""

import time
from dataclasses import fields

import numpy as np

from ikde.kernels.arrays import ATTEMPTS, COLLIDING, EVALUATIONS, REACHED
from ikde.kernels.grade_one import grade_one
from ikde.model.pack import pack_targets
from ikde.model.target import Targets
from ikde.solver.engine_table import NAMES, NO_ENGINE
from ikde.solver.engines.search_state import SearchState
from ikde.solver.metrics import Metrics, compute_metrics, make_metrics, pack_grader
from ikde.solver.plain import compute_gaps
from ikde.solver.problem import Problem

MAX_PLAIN = 64
"""Targets: so many are graded by the kernel in plain Python, 0.4 ms each, where compiling it takes 10 s."""


def grade_fixed(problem: Problem, targets: Targets, found: SearchState) -> None:
    """Fill `found`: every target is tried once, with one evaluation, by no engine; what it is off by is exact."""
    began, settings, collision = time.perf_counter(), problem.settings, problem.collision
    found.q[:] = problem.lower
    metrics = _grade(problem, targets)
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
    found.pair_counts.filled[:] = is_met[:, None] & collision.fold(hits)
    found.pair_counts.keep(0, np.flatnonzero(is_met))
    found.pair_counts.drop_filled()
    found.engine[:] = NAMES.index(NO_ENGINE)
    found.seconds[:] = (time.perf_counter() - began) / max(1, len(targets))


def _grade(problem: Problem, targets: Targets) -> Metrics:
    """Metrics of the one configuration for every target; the same bits whether machine code or Python computes them."""
    collision, settings, count = problem.collision, problem.settings, len(targets)
    if count > MAX_PLAIN:
        return compute_metrics(collision, targets, np.tile(problem.lower, (count, 1)), settings)
    metrics, (kinds, T_world_tool), grader = (
        make_metrics(count),
        pack_targets(targets),
        pack_grader(collision, settings),
    )
    with np.errstate(all="ignore"):  # as machine code does
        for row in range(count):
            one = slice(row, row + 1)
            seen = grade_one.plain(*grader, kinds[one], T_world_tool[one], problem.lower)
            for field, value in zip(fields(metrics), seen, strict=True):
                getattr(metrics, field.name)[row] = value
    return metrics


def tell_fixed(far_m: float, off_rad: float, pair: tuple[str, str] | None) -> str:
    """One line: by how much the tool misses the target, m and rad, and which pair collides, if one does."""
    if pair and not (far_m or off_rad):
        return f"no joint may move: the target is met, but {pair[0]} and {pair[1]} collide"
    off = [f"{far_m:.3g} m"] if far_m > 0.0 else []
    off += [f"{off_rad:.3g} rad"] if off_rad > 0.0 else []
    collision = f", and {pair[0]} and {pair[1]} collide" if pair else ""
    return f"no joint may move: the tool stays {' and '.join(off)} off{collision}"

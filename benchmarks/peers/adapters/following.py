"""A path followed by one of the quadratic programs: a target a sample, one step towards it or several."""

import time
from dataclasses import dataclass
from typing import Any

import numpy as np

from adapters.differential import Program
from ikde.track.path import ToolPath

MET_M, MET_RAD = 5e-7, 5e-5  # half of what counts as reached, where steps are repeated


@dataclass(frozen=True, kw_only=True)
class Followed:
    """What came of it; a program goes on to the end of the path, whatever it is worth."""

    q: np.ndarray
    """[M + 1, N], M <= K"""
    seconds: np.ndarray
    """[M] of each sample: target, steps and integration."""
    steps: int | None = None
    """Programs solved, where that is known."""
    unanswered: int = 0
    """Samples in which the program had no answer; the robot then stays where it is."""


def follow(program: Program, path: ToolPath, start: np.ndarray, dt_s: float, most_steps: int) -> Followed:
    """Go along the path from a configuration [N] at its first pose."""
    configuration = program.begin(start)
    R_start = program.rotation(configuration).copy()
    q, seconds, counts = np.tile(start, (path.samples + 1, 1)), np.empty(path.samples), np.zeros(2, dtype=int)
    for k in range(1, path.samples + 1):
        began = time.perf_counter()
        if program.span is not None:
            program.span.centre = configuration.q.copy()
        counts += step(program, configuration, path, k, R_start, dt_s, most_steps)
        seconds[k - 1] = time.perf_counter() - began
        q[k] = configuration.q
    return Followed(q=q, seconds=seconds, steps=int(counts[0]), unanswered=int(counts[1]))


def step(
    program: Program, configuration: Any, path: ToolPath, k: int, R_start: np.ndarray, dt_s: float, most: int
) -> tuple[int, bool]:
    """Towards sample k: how many programs were solved, and whether the last had no answer."""
    task = program.task
    for taken in range(most):
        # A free tool is told what it was to begin with, at no cost: told what it is, mink 1.3 errs in its Jacobian.
        R = R_start if path.orientation == "free" else aim(path, k, program.rotation(configuration))
        task.set_target(program.pose(path.p_world_tool[k], R))
        if most > 1:
            error = task.compute_error(configuration)
            if np.linalg.norm(error[:3]) <= MET_M and np.linalg.norm(task.cost[3:].astype(bool) * error[3:]) <= MET_RAD:
                return taken, False
        v = program.step(configuration)
        if v is None:
            return taken + 1, True
        configuration.integrate_inplace(v, dt_s)
    return most, False


def aim(path: ToolPath, k: int, R: np.ndarray) -> np.ndarray:
    """The orientation nearest to the tool's own, R [3, 3], that sample k allows."""
    if path.orientation == "pose":
        return path.R_world_tool[k]
    z, goal = R[:, 2], path.R_world_tool[k, :, 2]
    across, cosine = np.cross(z, goal), z @ goal
    K = np.array([[0.0, -across[2], across[1]], [across[2], 0.0, -across[0]], [-across[1], across[0], 0.0]])
    return R + (K + K @ K / (1.0 + cosine)) @ R

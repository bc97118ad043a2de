"""The seeds of the engines `lm` and `analytic`: collision-free configurations drawn once for a robot and its ranges."""

import os
from functools import lru_cache
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np

from ikde.kernels.arrays import COORDINATE, PARENT, SLIDES, Floats, Ints, SeedArrays
from ikde.kernels.jit import CACHE_IS_WRITABLE
from ikde.kernels.seeds import COMPARED_WHOLE, Z, fill_poses
from ikde.model.generate.module import load_module
from ikde.model.pack import pack_detector, pack_robot
from ikde.model.reach import arm_length_m
from ikde.model.robot import Detector, Robot
from ikde.solver.problem import NEAR_FIRST_BOX, ROUNDING, Problem

POOL_SIZE = 4096
BINS = 256
ROOMY_M = 2.0  # a base must have so much room in x and in y for it to be set freely
SHORTEST_M = 1e-3
NO_BASE = np.array([-1, -1, -1])


class SafeDistance(NamedTuple):
    """All that a generated collision check is told of its detector."""

    safe_distance: float  # m


Kernels = tuple[Any, Any, Any]


def load_kernels(robot: Robot, detector: Detector | None, kind: str) -> Kernels:
    """The module written for a robot, and what it takes in place of the robot's and the detector's tables.

    With `$IKDE_KERNELS` set to `tables`, or with no folder to write modules to, the data-driven kernels and the tables.
    """
    packed = pack_detector(robot, detector)
    safe_distance = packed.safe_distance + ROUNDING
    if os.environ.get("IKDE_KERNELS") == "tables" or not CACHE_IS_WRITABLE:
        return _load_tables(), pack_robot(robot), packed._replace(safe_distance=safe_distance)
    return load_module(robot, detector, kind), 0, SafeDistance(safe_distance)


@lru_cache
def _load_tables() -> SimpleNamespace:
    """The data-driven instance of both engines."""
    from ikde.kernels import analytic, lm

    return SimpleNamespace(**{**vars(lm), **vars(analytic)})


def make_seeds(problem: Problem, kind: str) -> SeedArrays:
    """Where attempts start: about `near` if there is one, else from the pool of the problem's ranges."""
    if problem.near is not None:
        return _pack(problem.robot, np.empty((0, len(problem.lower))), NO_BASE, NEAR_FIRST_BOX)
    ranges = tuple(zip(problem.lower.tolist(), problem.upper.tolist(), strict=True))
    return _draw_pool(problem.robot, problem.detector, kind, ranges)


@lru_cache(maxsize=32)
def _draw_pool(
    robot: Robot, detector: Detector | None, kind: str, ranges: tuple[tuple[float, float], ...]
) -> SeedArrays:
    """Some milliseconds, once for a robot, a detector and joint ranges."""
    lower, upper = np.array(ranges).T.copy()
    base = find_base(robot, lower, upper)
    if base[0] >= 0:
        lower[base] = upper[base] = 0.0
    module, *tables = load_kernels(robot, detector, kind)
    q = np.empty((POOL_SIZE, len(lower)))
    with np.errstate(over="ignore"):  # the random stream wraps around; without the JIT numpy would warn
        found = module.fill_pool(*tables, lower, upper, q)
    return _pack(robot, q[: found if found >= COMPARED_WHOLE else 0], base, 1.0)


def _pack(robot: Robot, q: Floats, base: Ints, first_box: float) -> SeedArrays:
    T_world_tool = np.empty((12, len(q)))
    fill_poses(pack_robot(robot), q, T_world_tool)
    lowest, bins_per_metre, starts = 0.0, 0.0, np.zeros(BINS + 1, dtype=np.int64)
    if base[0] >= 0 and len(q):
        order = np.argsort(T_world_tool[Z], kind="stable")
        q, T_world_tool = np.ascontiguousarray(q[order]), np.ascontiguousarray(T_world_tool[:, order])
        lowest, highest = T_world_tool[Z, [0, -1]]
        bins_per_metre = BINS / max(highest - lowest, ROUNDING)
        starts = np.searchsorted(T_world_tool[Z], lowest + np.arange(BINS + 1) / bins_per_metre)
    for array in (q, T_world_tool, starts):
        array.setflags(write=False)
    return SeedArrays(
        q=q,
        T_world_tool=T_world_tool,
        base=base if len(q) else NO_BASE,
        lowest=float(lowest),
        bins_per_metre=float(bins_per_metre),
        height_start=starts,
        rotation_length=rotation_length_m(robot),
        first_box=first_box,
    )


@lru_cache(maxsize=64)
def rotation_length_m(robot: Robot) -> float:
    """What a radian counts beside a metre, in m: a sixth of the stretched arm (calibrated; 0.2 to 1 m do as well)."""
    return max(arm_length_m(robot) / 6.0, SHORTEST_M)


def find_base(robot: Robot, lower: Floats, upper: Floats) -> Ints:
    """Coordinates [3] of x, y and turn of a base that drives in the plane, has room and carries all that can collide.

    -1 thrice for any other robot.
    """
    arrays = pack_robot(robot)
    bodies, T = arrays.bodies, arrays.T_parent_body
    if len(bodies) < 4 or bodies[1:4, PARENT].tolist() != [0, 1, 2] or bodies[1:4, SLIDES].tolist() != [1, 1, 0]:
        return NO_BASE
    x, y, turn = bodies[1:4, COORDINATE].tolist()
    steps = np.eye(4)
    axes = []
    for k in (1, 2, 3):
        steps = steps @ np.vstack([T[k], [0.0, 0.0, 0.0, 1.0]])
        axes.append(steps[:3, 2])
    is_plane = np.allclose(axes, np.eye(3), atol=1e-12) and np.allclose(steps[:2, 3], 0.0, atol=1e-12)
    has_room = (
        min(upper[x] - lower[x], upper[y] - lower[y]) >= ROOMY_M and upper[turn] - lower[turn] > 2.0 * np.pi - 0.01
    )
    components = [pack_detector(robot, detector).components[:, 0] for detector in robot.detectors.values()]
    carries_all = all((carried >= 3).all() for carried in components) and (bodies[4:, PARENT] >= 3).all()
    return np.array([x, y, turn]) if is_plane and has_room and carries_all else NO_BASE

"""The seeds of the engines `lm` and `analytic`: collision-free configurations drawn once for a robot and its ranges."""

import hashlib
import io
from functools import lru_cache
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np

from ikde.kernels import cache_folder
from ikde.kernels.arrays import Floats, Ints, SeedArrays
from ikde.kernels.cache_files import read_sealed, write_sealed
from ikde.kernels.seeds import COMPARED, X, Y, Z, fill_poses
from ikde.model.base_motion import NO_BASE, find_planar_base
from ikde.model.collision_model import CollisionModel
from ikde.model.generate.module import digest_inputs, kernel_kind, load_module, robots_folder
from ikde.model.pack import pack_robot
from ikde.model.reach import arm_length_m
from ikde.model.robot import Robot
from ikde.solver.problem import NEAR_FIRST_BOX, ROUNDING, Problem, pack_searched

DRAWN, DRAWN_NARROW = 2**16, 2**13  # configurations: within the joint limits, within ranges of a problem's own
PER_CELL = 8  # kept of each cell: poses that few configurations have would else be lost among those that many have
TILT_X, TILT_Y, TILT_Z = 8, 9, 10  # entries of the transform [3, 4] that a base which turns cannot change, beside Z
AXIS_X, AXIS_Y = 2, 6
GRIDS_DRIVING = {  # entry, bins
    "position": ((Z, 64),),
    "axis": ((Z, 32), (TILT_Z, 16)),
    "pose": ((Z, 32), (TILT_X, 5), (TILT_Y, 5), (TILT_Z, 5)),
}
GRIDS = {
    "position": ((Z, 12), (X, 12), (Y, 12)),
    "axis": ((Z, 8), (X, 8), (Y, 8), (AXIS_X, 3), (AXIS_Y, 3), (TILT_Z, 3)),
    "pose": ((Z, 8), (X, 8), (Y, 8), (AXIS_X, 3), (AXIS_Y, 3), (TILT_Z, 3)),
}
ROOMY_M = 2.0  # a base must have so much room in x and in y for it to be set freely
FULL_TURN_RAD = 2.0 * np.pi - 0.01
MIN_LENGTH_M = 1e-3


def load_kernels(collision: CollisionModel, kind: str) -> Any:
    """The module of kernels written for a robot, or with `$IKDE_KERNELS` set to `tables` the data-driven ones."""
    return _load_tables() if runs_on_tables() else load_module(collision, kind)


def runs_on_tables() -> bool:
    """True if kernels written for a robot are not wanted."""
    return kernel_kind() == "tables"


@lru_cache
def _load_tables() -> SimpleNamespace:
    """The data-driven instance of both engines."""
    from ikde.kernels import analytic, lm, tables

    return SimpleNamespace(**{**vars(tables), **vars(lm), **vars(analytic)})


def make_seeds(problem: Problem, kind: str) -> SeedArrays:
    """Where attempts start: about `near` if there is one, else from the pool of the problem's ranges."""
    if problem.near is not None:
        return sort_pool(problem.robot, kind, np.empty((0, len(problem.lower))), NO_BASE, NEAR_FIRST_BOX)
    ranges = tuple(zip(*(bound.tolist() for bound in problem.drawn), strict=True))
    return _find_pool(problem.collision, kind, ranges)


@lru_cache(maxsize=32)
def _find_pool(collision: CollisionModel, kind: str, ranges: tuple[tuple[float, float], ...]) -> SeedArrays:
    """The pool of a collision model and joint ranges; that of the joint limits lies in the cache folder."""
    robot = collision.robot
    lower, upper = np.array(ranges).T.copy()
    whole = np.array_equal([lower, upper], robot.drawn)
    if not whole or runs_on_tables() or not cache_folder.CACHE_IS_WRITABLE:
        return draw_pool(collision, kind, lower, upper, DRAWN if whole else DRAWN_NARROW)
    path = robots_folder() / f"{digest_pool(collision, kind)}.pool"
    seeds = load_pool(path)
    if seeds is None:
        seeds = draw_pool(collision, kind, lower, upper, DRAWN)
        save_pool(path, seeds)
    return seeds


def digest_pool(collision: CollisionModel, kind: str) -> str:
    """SHA-256, hex, of all that the pool within the joint limits depends on; no name is."""
    robot = collision.robot
    base, (_, searched) = find_base(robot, *robot.drawn), pack_searched(collision)
    words = (digest_inputs(collision, kind), searched.safe_distance, base.tolist(), rotation_length_m(robot))
    return hashlib.sha256(repr(words).encode() + _own_source()).hexdigest()


@lru_cache(maxsize=1)
def _own_source() -> bytes:
    """The code that draws and stores pools: other code draws others."""
    return Path(__file__).read_bytes()


def load_pool(path: Path) -> SeedArrays | None:
    """What `save_pool` wrote, or None if there is nothing whole: 3 ms, where drawing takes 100."""
    content = read_sealed(path)
    if content is None:
        return None
    with np.load(io.BytesIO(content)) as arrays:
        fields: dict[str, Any] = {name: arrays[name] for name in SeedArrays._fields}
    for name, array in fields.items():
        array.setflags(write=False)
        fields[name] = array if array.ndim else float(array)
    return SeedArrays(**fields)


def save_pool(path: Path, seeds: SeedArrays) -> None:
    """Write a pool, whole or not at all; not at all if the disk is full: it can be drawn again."""
    content = io.BytesIO()
    np.savez(content, allow_pickle=False, **{name: np.asarray(field) for name, field in seeds._asdict().items()})
    write_sealed(path, content.getvalue())


def draw_pool(collision: CollisionModel, kind: str, lower: Floats, upper: Floats, count: int) -> SeedArrays:
    """Draw `count` free configurations; a tenth of a second for 2^16."""
    robot = collision.robot
    base = find_base(robot, lower, upper)
    if base[0] >= 0:
        lower, upper = lower.copy(), upper.copy()
        lower[base] = upper[base] = 0.0
    module = load_kernels(collision, kind)
    models = module.use_models(*pack_searched(collision))
    q = np.empty((count, len(lower)))
    with np.errstate(over="ignore"):  # the random stream wraps around; without the JIT numpy would warn
        found = module.fill_pool(*models, lower, upper, q)
    return sort_pool(robot, kind, q[: found if found >= COMPARED else 0], base, 1.0)


def sort_pool(robot: Robot, kind: str, q: Floats, base: Ints, first_box: float) -> SeedArrays:
    """Lay a grid over the tool poses of configurations [K, N], and keep a few of each of its cells."""
    T_world_tool = np.empty((12, len(q)))
    fill_poses(pack_robot(robot), q, T_world_tool)
    grid = np.array((GRIDS_DRIVING if base[0] >= 0 else GRIDS)[kind])
    scale, starts = np.zeros((len(grid), 2)), np.zeros(np.prod(grid[:, 1]) + 1, dtype=np.int64)
    if len(q):
        values, bins = T_world_tool[grid[:, 0]], grid[:, 1]
        scale[:, 0] = values.min(axis=1)
        scale[:, 1] = bins / np.maximum(values.max(axis=1) - scale[:, 0], ROUNDING)
        places = ((values.T - scale[:, 0]) * scale[:, 1]).astype(np.int64).clip(0, bins - 1)
        cells = np.asarray(np.ravel_multi_index(tuple(places.T), tuple(bins)))
        kept = _keep_few(cells)
        q, T_world_tool = np.ascontiguousarray(q[kept]), np.ascontiguousarray(T_world_tool[:, kept])
        starts = np.searchsorted(cells[kept], np.arange(len(starts)))
    for array in (q, T_world_tool, base, grid, scale, starts):  # as loaded ones are: numba tells the two apart
        array.setflags(write=False)
    return SeedArrays(
        q=q,
        T_world_tool=T_world_tool,
        base=base if len(q) else NO_BASE,
        grid=grid,
        grid_scale=scale,
        cell_start=starts,
        rotation_length=rotation_length_m(robot),
        first_box=first_box,
    )


def _keep_few(cells: Ints) -> Ints:
    """Indices of the first PER_CELL of each cell, sorted by cell."""
    order = np.argsort(cells, kind="stable")
    rank = np.arange(len(cells)) - np.searchsorted(cells[order], cells[order])
    return order[rank < PER_CELL]


@lru_cache(maxsize=64)
def rotation_length_m(robot: Robot) -> float:
    """What a radian counts beside a metre, in m: a sixth of the stretched arm (calibrated; 0.2 to 1 m do as well)."""
    return max(arm_length_m(robot) / 6.0, MIN_LENGTH_M)


def find_base(robot: Robot, lower: Floats, upper: Floats) -> Ints:
    """Coordinates [3] of x, y and turn of a planar base that has room; -1 thrice for any other robot."""
    x, y, turn = base = find_planar_base(robot)
    if x < 0 or min(upper[x] - lower[x], upper[y] - lower[y]) < ROOMY_M or upper[turn] - lower[turn] < FULL_TURN_RAD:
        return NO_BASE
    return base

"""The seeds of the engines `lm` and `analytic`: collision-free configurations drawn once for a robot and its ranges."""

import hashlib
from functools import lru_cache
from pathlib import Path
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np

from ikde.kernels.arrays import FIRST, LAST, Floats, Ints, SeedArrays, read_only
from ikde.kernels.seeds import COMPARED
from ikde.model.base_motion import NO_BASE, find_planar_base
from ikde.model.collision_model import CollisionModel
from ikde.model.generate.module import kernel_kind, load_module
from ikde.model.pack import pack_robot
from ikde.model.reach import arm_length_m
from ikde.model.robot import Robot
from ikde.solver.engines import draws, grids
from ikde.solver.engines.draws import DRAWS, draw, draw_free, place_tools
from ikde.solver.engines.frozen import FrozenPools, freeze_pool, set_frozen
from ikde.solver.engines.grids import find_cells, keep_few, scale_grid, sort_cells
from ikde.solver.engines.pool_files import Kept, load_cached, load_shipped, save_cached
from ikde.solver.problem import NEAR_FIRST_BOX, Problem, pack_searched

DRAWN, DRAWN_NARROW = 2**16, 2**11  # configurations: within the joint limits, within ranges of a problem's own
MIN_DRAWN, MANY_PAIRS = (
    2**12,
    2**14,
)  # drawn at least; pairs of spheres beyond which fewer are, each of which takes longer
PER_CELL = 8  # kept of each cell: poses that few configurations have would else be lost among those that many have
X, Y, Z = 3, 7, 11  # entries of the transform [3, 4], row by row
TILT_X, TILT_Y, TILT_Z = 8, 9, 10  # those that the yaw of a base cannot change, beside Z
AXIS_X, AXIS_Y = 2, 6
KEPT = {  # what each kind of target asks of the tool, in the order of the columns of `kernels/seeds.py`
    "position": (X, Y, Z),
    "axis": (X, Y, Z, AXIS_X, AXIS_Y, TILT_Z),
    "pose": (X, Y, Z, AXIS_X, AXIS_Y, TILT_Z, 0, 4, TILT_X, 1, 5, TILT_Y),
}
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
DIGITS = 12  # decimals of a robot's numbers that a pool depends on: products of matrices differ from machine to machine


def load_kernels(collision: CollisionModel, kind: str, *, inside: bool = True) -> Any:
    """The module of kernels written for a robot: what it proves holds inside the joint limits.

    Beyond them, or with `$IKDE_KERNELS` set to `tables`, the data-driven ones.
    """
    return load_module(collision.own, kind) if inside and not runs_on_tables() else _load_tables()


def runs_on_tables() -> bool:
    """True if kernels written for a robot are not wanted."""
    return kernel_kind() == "tables"


@lru_cache
def _load_tables() -> SimpleNamespace:
    """The data-driven instance of both engines."""
    from ikde.kernels import analytic, draws, lm, tables

    return SimpleNamespace(**{**vars(tables), **vars(lm), **vars(draws), **vars(analytic)})


def make_seeds(problem: Problem, kind: str) -> SeedArrays:
    """Where attempts start: about `near` if there is one, else from the pool of the problem's ranges."""
    if problem.near is not None:
        return no_pool(problem.robot, NEAR_FIRST_BOX)
    return find_seeds(problem.collision.own, kind, *problem.drawn)


def find_seeds(collision: CollisionModel, kind: str, lower: Floats, upper: Floats) -> SeedArrays:
    """Seeds for targets of a kind within ranges [N]; those of frozen joints are made of the pool of the joint limits.

    10 us if no joint or only a base is frozen or has less room, whose joints are set for each target whatever the pool;
    0.2 ms for other joints at new values; 50 ms for other ranges.
    """
    whole, seeds = find_whole(collision, kind)
    is_frozen, base = lower == upper, whole.base.tolist()
    is_set = np.isin(np.arange(len(lower)), base) & (lower >= whole.lower) & (upper <= whole.upper)
    if not (is_frozen | is_set | ((lower == whole.lower) & (upper == whole.upper))).all():
        return _find_narrow(collision, kind, tuple(lower.tolist()), tuple(upper.tolist()))
    joints = tuple(k for k in np.flatnonzero(is_frozen).tolist() if k not in base and whole.lower[k] < whole.upper[k])
    if not joints or not len(seeds.q):
        return seeds
    return set_frozen(_find_frozen(collision, kind, joints), lower[list(joints)])


@lru_cache(maxsize=32)
def find_whole(collision: CollisionModel, kind: str) -> tuple["Pool", SeedArrays]:
    """The pool of the joint limits: it comes with ikde, is kept in the cache folder, or is drawn."""
    pool = make_whole_pool(collision, kind)
    name = f"{digest_pool(pool, collision)}.pool"
    kept = load_shipped(name, len(pool.grid)) or load_cached(name, len(pool.grid))
    if kept is None:
        kept = draw_kept(pool, collision)
        save_cached(name, kept)
    return pool, pack_pool(pool, kept)


@lru_cache(maxsize=8)  # 7 MB each
def _find_frozen(collision: CollisionModel, kind: str, joints: tuple[int, ...]) -> FrozenPools:
    """What the pools of some frozen joints share: of the largest pool, whatever the kind of target."""
    rows, seeds = find_whole(collision, "pose")[1].q, find_whole(collision, kind)[1]
    return freeze_pool(pack_robot(collision.robot), rows, joints, seeds, KEPT[kind])


@lru_cache(maxsize=32)
def _find_narrow(
    collision: CollisionModel, kind: str, lower: tuple[float, ...], upper: tuple[float, ...]
) -> SeedArrays:
    """The pool of other ranges than the joint limits, drawn for them."""
    pool = make_pool(collision, kind, np.array(lower), np.array(upper), DRAWN_NARROW)
    return pack_pool(pool, draw_kept(pool, collision))


class Pool(NamedTuple):
    """What a pool is drawn for: from which ranges, and the grid that it is sorted by."""

    robot: Robot
    lower: Floats
    upper: Floats
    """[N] m or rad"""
    wanted: int
    base: Ints
    grid: Ints
    kind: str

    @property
    def drawn(self) -> tuple[Floats, Floats]:
        """The ranges with a base that is set for each target at zero."""
        is_set = np.isin(np.arange(len(self.lower)), self.base)
        return np.where(is_set, 0.0, self.lower), np.where(is_set, 0.0, self.upper)


def make_pool(collision: CollisionModel, kind: str, lower: Floats, upper: Floats, wanted: int) -> Pool:
    """The pool of `wanted` free configurations within some ranges, not drawn yet."""
    base = find_base(collision.robot, lower, upper)
    grid = np.array((GRIDS_DRIVING if base[0] >= 0 else GRIDS)[kind])
    return Pool(robot=collision.robot, lower=lower, upper=upper, wanted=wanted, base=base, grid=grid, kind=kind)


def make_whole_pool(collision: CollisionModel, kind: str) -> Pool:
    """The pool of the joint limits: a smaller one where each draw takes long, which serves as well."""
    arrays = collision.arrays
    spheres = arrays.components[:, LAST] - arrays.components[:, FIRST]
    share = MANY_PAIRS / max(MANY_PAIRS, int(spheres[arrays.pairs].prod(axis=1).sum()))
    return make_pool(collision, kind, *collision.robot.drawn, max(int(DRAWN * share), min(MIN_DRAWN, DRAWN)))


def digest_pool(pool: Pool, collision: CollisionModel) -> str:
    """SHA-256, hex, of all that the draws kept depend on; no name is, nor are the last digits of what is computed."""
    robot, searched = pack_searched(collision)
    ranges = [bound.tolist() for bound in pool.drawn]
    words = (pool.wanted, DRAWS, PER_CELL, COMPARED, pool.grid.tolist(), ranges)
    digest = hashlib.sha256(repr(words).encode() + _own_source())
    for array in (*robot, *searched[:-1]):
        digest.update(repr(np.shape(array)).encode() + (np.round(array, DIGITS) + 0.0).tobytes())
    return digest.hexdigest()


@lru_cache(maxsize=1)
def _own_source() -> bytes:
    """The code that draws and keeps: other code draws others."""
    return b"".join(Path(str(module.__file__)).read_bytes() for module in (draws, grids))


def draw_kept(pool: Pool, collision: CollisionModel) -> Kept:
    """Draw free configurations and keep a few of each cell."""
    lower, upper = pool.drawn
    numbers = _draw_free(collision, tuple(lower.tolist()), tuple(upper.tolist()), pool.wanted)
    if len(numbers) < COMPARED:
        return Kept(numbers=numbers[:0], scale=np.zeros((len(pool.grid), 2)))
    values = place_tools(pack_robot(pool.robot), draw(numbers, lower, upper))[pool.grid[:, 0]]
    scale = scale_grid(pool.grid, values)
    return Kept(numbers=numbers[keep_few(find_cells(pool.grid, scale, values), PER_CELL)], scale=scale)


@lru_cache(maxsize=4)
def _draw_free(collision: CollisionModel, lower: tuple[float, ...], upper: tuple[float, ...], count: int) -> Ints:
    """The numbers of the first free draws: 0.1 to 2 s for 2^16, once for all kinds of target."""
    return draw_free(*pack_searched(collision), np.array(lower), np.array(upper), count)


def pack_pool(pool: Pool, kept: Kept) -> SeedArrays:
    """The configurations kept, sorted by cell, and where their tools are: 60 ms for 40,000."""
    q = draw(kept.numbers, *pool.drawn)
    return sort_pool(pool.robot, q, pool.base if len(q) else NO_BASE, pool.grid, kept.scale, pool.kind)


@lru_cache(maxsize=64)
def no_pool(robot: Robot, first_box: float) -> SeedArrays:
    """Seeds that are drawn uniformly, in boxes that grow from this share of each range."""
    grid = np.array(GRIDS["position"])
    empty = sort_pool(robot, np.empty((0, len(robot.joints))), NO_BASE, grid, np.zeros((len(grid), 2)))
    return empty._replace(first_box=first_box)


def sort_pool(
    robot: Robot, q: Floats, base: Ints, grid: Ints, scale: Floats | None = None, kind: str = "pose"
) -> SeedArrays:
    """Configurations [K, N] sorted by the cells of a grid over their tool poses; None: one that just holds them."""
    T_world_tool = place_tools(pack_robot(robot), q)
    values = T_world_tool[grid[:, 0]]
    scale = scale_grid(grid, values) if scale is None else scale
    cells = find_cells(grid, scale, values)
    order, starts = sort_cells(grid, cells)
    q, asked = np.take(q, order, axis=0), np.take(T_world_tool[list(KEPT[kind])], order, axis=1).T.copy()
    for array in (q, asked, base, grid, scale, starts):  # numba takes what can be written for another type
        read_only(array)
    return SeedArrays(
        q=q,
        T_world_tool=asked,
        base=base,
        grid=grid,
        grid_scale=scale,
        cell_start=starts,
        rotation_length=rotation_length_m(robot),
        first_box=1.0,
    )


@lru_cache(maxsize=64)
def rotation_length_m(robot: Robot) -> float:
    """What a radian counts beside a metre, in m: a sixth of the stretched arm (calibrated; 0.2 to 1 m do as well)."""
    return max(arm_length_m(robot) / 6.0, MIN_LENGTH_M)


def find_base(robot: Robot, lower: Floats, upper: Floats) -> Ints:
    """Coordinates [3] of x, y and yaw of a planar base that has room; -1 thrice for any other robot."""
    x, y, yaw = base = find_planar_base(robot)
    if x < 0 or min(upper[x] - lower[x], upper[y] - lower[y]) < ROOMY_M or upper[yaw] - lower[yaw] < FULL_TURN_RAD:
        return NO_BASE
    return base

"""Seeds made by plain numpy: what `solver/engines/pool.py` packs, for configurations of a test's own."""

import numpy as np

from ikde.kernels.arrays import SeedArrays
from ikde.solver.plain import compute_frames

NO_BASE = np.array([-1, -1, -1])
COLUMNS = [3, 7, 11, 2, 6, 10, 0, 4, 8, 1, 5, 9]  # of a pool: which entry of the transform each is
GRID = np.array([[11, 8], [8, 3], [9, 3], [10, 3]])  # entry of the transform, bins: height and tilt


def pack_seeds(robot, Q, base=NO_BASE, first_box=1.0, rotation_length=0.2):
    """`SeedArrays` of configurations [K, N], sorted by the cells of a grid over the height and tilt of their tools."""
    T = compute_frames(robot, Q)[robot.tool][:, :3].reshape(len(Q), 12)
    scale, starts = np.zeros((4, 2)), np.zeros(8 * 27 + 1, dtype=np.int64)
    if len(Q):
        scale = np.array([[-0.5, 4.0], [-1.0, 1.5], [-1.0, 1.5], [-1.0, 1.5]])
        cells = [cell_of(row, scale) for row in T]
        order = np.argsort(cells, kind="stable")
        Q, T = Q[order], T[order]
        starts = np.array([np.sum(np.array(cells) < cell) for cell in range(len(starts))])
    arrays = (np.array(Q), np.ascontiguousarray(T[:, COLUMNS]), np.array(base), GRID.copy(), scale, starts)
    for array in arrays:  # as those of a pool: numba tells the two apart
        array.setflags(write=False)
    return SeedArrays(*arrays, rotation_length=rotation_length, first_box=first_box)


def cell_of(T, scale):
    """Number of the cell that a tool pose, twelve entries, lies in; the outer cells reach to infinity."""
    cell = 0
    for (entry, bins), (lowest, per_unit) in zip(GRID, scale, strict=True):
        cell = cell * bins + int(np.clip(np.trunc((T[entry] - lowest) * per_unit), 0, bins - 1))
    return cell


def no_seeds(robot, first_box=1.0):
    """Starts are drawn uniformly, or about ranges[2]."""
    return pack_seeds(robot, np.empty((0, len(robot.joints))), first_box=first_box)

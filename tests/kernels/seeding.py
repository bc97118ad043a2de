"""Seeds made by plain numpy: what `solver/engines/pool.py` packs, for configurations of a test's own."""

import numpy as np

from ikde.kernels.arrays import SeedArrays
from ikde.kernels.seeds import Z
from ikde.solver.plain import compute_frames

NO_BASE = np.array([-1, -1, -1])
BINS = 32


def pack_seeds(robot, Q, base=NO_BASE, first_box=1.0, rotation_length=0.2):
    """`SeedArrays` of configurations [K, N]; sorted by height if there is a base, as coordinates [3]."""
    T = np.ascontiguousarray(compute_frames(robot, Q)[robot.tool][:, :3].reshape(len(Q), 12).T)
    lowest, bins_per_metre, starts = 0.0, 0.0, np.zeros(BINS + 1, dtype=np.int64)
    if base[0] >= 0:
        order = np.argsort(T[Z], kind="stable")
        Q, T = np.ascontiguousarray(Q[order]), np.ascontiguousarray(T[:, order])
        lowest = float(T[Z, 0])
        bins_per_metre = BINS / float(T[Z, -1] - lowest)
        starts = np.searchsorted(T[Z], lowest + np.arange(BINS + 1) / bins_per_metre)
    return SeedArrays(
        q=np.array(Q),
        T_world_tool=T,
        base=np.array(base),
        lowest=lowest,
        bins_per_metre=bins_per_metre,
        height_start=starts,
        rotation_length=rotation_length,
        first_box=first_box,
    )


def no_seeds(robot, first_box=1.0):
    """Starts are drawn uniformly, or about ranges[2]."""
    return pack_seeds(robot, np.empty((0, len(robot.joints))), first_box=first_box)

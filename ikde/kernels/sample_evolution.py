"""One sample of a path by differential evolution, as if it stood alone [Qiao2022, section 3.1]."""

import numpy as np

from ikde.kernels.evolution import evolve
from ikde.kernels.jit import kernel
from ikde.kernels.rng import seed_stream

FIRST = np.int64(0)


@kernel
def evolve_alone(robot, detector, target, index, search, lower, upper, seed, work, out_q):
    """The best of one population within [lower, upper] into `out_q` [N]; returns whether it meets, and evaluations."""
    state = np.empty(1, dtype=np.uint64)
    seed_stream(seed, index, FIRST, state)
    best, meets, evaluations = evolve(robot, detector, target, index, search, lower, upper, state, work)
    for k in range(out_q.size):
        out_q[k] = work.x[best, k]
    return meets, evaluations

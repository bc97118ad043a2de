"""Random free configurations: number k hangs on (seed, k) only, so that any cut into chunks gives the same bits.

`model/generate` writes this file once more for a robot, after `kernels/lm.py`, with its own collision check.
"""

import numpy as np

from ikde.kernels.jit import kernel
from ikde.kernels.rng import next_uniform, seed_stream
from ikde.kernels.tables import find_collision, make_buffers

SAMPLING = np.uint64(2**64 - 1)  # in place of an attempt's number: a stream that no search draws from
MAX_DRAWS = 100_000  # of one configuration, before there seems to be no free one


@kernel
def draw_free(robot, collision, lower, upper, seed, first, out_q):
    """Configurations first, first + 1, ... of the first draws from [lower, upper] [N] that are free, into [K, N].

    Returns how many were found in a row.
    """
    state, buffers = np.empty(1, dtype=np.uint64), make_buffers(robot, collision, lower.size)
    for row in range(out_q.shape[0]):
        seed_stream(seed, first + row, SAMPLING, state)
        pair = np.int64(0)
        for _ in range(MAX_DRAWS):
            for k in range(lower.size):
                out_q[row, k] = lower[k] + next_uniform(state) * (upper[k] - lower[k])
            pair = find_collision(robot, collision, out_q[row], buffers)
            if pair < 0:
                break
        if pair >= 0:
            return row
    return out_q.shape[0]

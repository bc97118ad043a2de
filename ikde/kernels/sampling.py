"""Random targets: number k hangs on (seed, k) only, so that any cut into chunks gives the same bits.

Only + - * / and square roots, and the kernels' own sine and cosine: the bits do not hang on a machine's libm.
"""

import math

import numpy as np

from ikde.kernels.draws import SAMPLING
from ikde.kernels.frames import compute_bodies, compute_tool
from ikde.kernels.jit import kernel
from ikde.kernels.rng import next_uniform, seed_stream

MIN_SQUARE = 1e-4  # nearer the middle, a direction would lose digits


@kernel
def place_tools(robot, q, out_T):
    """Pose of the tool at each row of `q` [K, N], into `out_T` [K, 3, 4]."""
    T_world_body = np.empty((robot.bodies.shape[0], 3, 4))
    for k in range(q.shape[0]):
        compute_bodies(robot, q[k], T_world_body)
        compute_tool(robot, T_world_body, out_T[k])


@kernel
def sample_box(lower, upper, seed, first, out_p):
    """Points first, first + 1, ... uniform in the box from `lower` to `upper` [3], into `out_p` [K, 3] m."""
    state = np.empty(1, dtype=np.uint64)
    for k in range(out_p.shape[0]):
        seed_stream(seed, first + k, SAMPLING, state)
        for i in range(3):
            out_p[k, i] = lower[i] + next_uniform(state) * (upper[i] - lower[i])


@kernel
def sample_ball(center, radius, filled, seed, first, out_p):
    """Points first, first + 1, ... uniform in a ball, or on its surface, into `out_p` [K, 3] m.

    A point is drawn from the cube around the unit ball until it falls inside; for the surface it is then stretched.
    """
    state = np.empty(1, dtype=np.uint64)
    least = 0.0 if filled else MIN_SQUARE
    for k in range(out_p.shape[0]):
        seed_stream(seed, first + k, SAMPLING, state)
        x, y, z, square = 0.0, 0.0, 0.0, 2.0
        while not least <= square <= 1.0:
            x, y, z = 2.0 * next_uniform(state) - 1.0, 2.0 * next_uniform(state) - 1.0, 2.0 * next_uniform(state) - 1.0
            square = x * x + y * y + z * z
        scale = radius if filled else radius / math.sqrt(square)
        out_p[k, 0], out_p[k, 1], out_p[k, 2] = center[0] + scale * x, center[1] + scale * y, center[2] + scale * z

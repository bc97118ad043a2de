"""Random targets: number k hangs on (seed, k) only, so that any cut into chunks gives the same bits.

Only + - * / and square roots, and the kernels' own sine and cosine: the bits do not hang on a machine's libm.
"""

import math

import numpy as np

from ikde.kernels.clearance import collides
from ikde.kernels.evolution import make_workspace
from ikde.kernels.frames import compute_bodies, compute_tool
from ikde.kernels.jit import inline_kernel, kernel
from ikde.kernels.rng import next_uniform, seed_stream
from ikde.kernels.spheres import compute_bounds, compute_centres

SAMPLING = np.uint64(2**64 - 1)  # in place of an attempt's number: a stream that no search draws from
MAX_DRAWS = 100_000  # of one target, before there seems to be no free configuration
MIN_SQUARE = 1e-4  # nearer the middle, a direction would lose digits


@inline_kernel
def is_free(robot, collision, q, work):
    """True if `q` [N] is free of self-collision; leaves the bodies' poses in `work`."""
    compute_bodies(robot, q, work.T_world_body)
    compute_bounds(collision, work.T_world_body, work.bounds)
    compute_centres(collision, work.T_world_body, work.centres)
    return not collides(collision, work.bounds, work.centres)


@kernel
def sample_free_pose(robot, collision, lower, upper, state, work, out_T):
    """The tool's pose [3, 4] in the first free configuration drawn from [lower, upper] [N]; False if none is found."""
    for _ in range(MAX_DRAWS):
        for k in range(lower.size):
            work.trial[k] = lower[k] + next_uniform(state) * (upper[k] - lower[k])
        if is_free(robot, collision, work.trial, work):
            compute_tool(robot, work.T_world_body, out_T)
            return True
    return False


@kernel
def sample_poses(robot, collision, lower, upper, seed, first, out_T):
    """Reachable poses number first, first + 1, ... into `out_T` [K, 3, 4]; returns how many were found in a row."""
    work = make_workspace(robot, collision, lower.size, 1)
    state = np.empty(1, dtype=np.uint64)
    for k in range(out_T.shape[0]):
        seed_stream(seed, first + k, SAMPLING, state)
        if not sample_free_pose(robot, collision, lower, upper, state, work, out_T[k]):
            return k
    return out_T.shape[0]


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

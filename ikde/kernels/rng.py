"""A splitmix64 stream per lane: the same numbers on any number of threads, workers or runs.

[Steele2014] Steele, Lea, Flood: Fast splittable pseudorandom number generators.
"""

import numpy as np

from ikde.kernels.jit import inline_kernel

GOLDEN = np.uint64(0x9E3779B97F4A7C15)
MIX_1 = np.uint64(0xBF58476D1CE4E5B9)
MIX_2 = np.uint64(0x94D049BB133111EB)
SHIFT_11, SHIFT_27, SHIFT_30, SHIFT_31 = np.uint64(11), np.uint64(27), np.uint64(30), np.uint64(31)
UNIT = 2.0**-53


@inline_kernel
def mix(z):
    """The splitmix64 finaliser: a bijection of 64-bit words that scatters neighbours."""
    z = (z ^ (z >> SHIFT_30)) * MIX_1
    z = (z ^ (z >> SHIFT_27)) * MIX_2
    return z ^ (z >> SHIFT_31)


@inline_kernel
def seed_stream(seed, target_index, attempt, out_state):
    """Start the stream of one attempt: a word mixed from (seed, target index, attempt). `out_state`: uint64 [1]."""
    word = mix(np.uint64(seed) + GOLDEN)
    word = mix(word ^ (np.uint64(target_index) * GOLDEN + MIX_1))
    out_state[0] = mix(word ^ (np.uint64(attempt) * GOLDEN + MIX_2))


@inline_kernel
def next_word(state):
    """The next 64 random bits; moves `state` [1] on."""
    state[0] += GOLDEN
    return mix(state[0])


@inline_kernel
def next_uniform(state):
    """The next double, uniform in [0, 1) on the grid of 2^-53."""
    return np.float64(next_word(state) >> SHIFT_11) * UNIT


@inline_kernel
def next_index(state, count):
    """The next integer, uniform in 0 .. count-1 (count far below 2^53, so the bias is below 1e-13)."""
    return np.int64(next_uniform(state) * count)

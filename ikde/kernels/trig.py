"""Sine, cosine and arc tangent of our own, so that the bits do not hang on a machine's libm.

The coefficients are fitted by `benchmarks/fit_trig.py`. Arguments are joint angles: |x| below 1e5 rad keeps the
error below 1.7e-16 (5e-16 for the arc tangent); `tests/kernels/test_trig.py` measures it.
"""

import math

import numpy as np

from ikde.kernels.jit import inline_kernel

TWO_OVER_PI = 0.6366197723675814
# pi/2 in three parts of 33, 33 and 53 bits: k * part is exact, so the reduction loses nothing (Cody and Waite).
HALF_PI_HIGH = 1.5707963267341256
HALF_PI_MIDDLE = 6.077100506303966e-11
HALF_PI_LOW = 2.0222662487959506e-21
TAN_PI_8 = 0.41421356237309503
QUARTER_PI = 0.7853981633974483
HALF_PI = 1.5707963267948966


@inline_kernel
def fold_angle(x):
    """Sine and cosine of what is left of an angle in rad beside whole quarter turns, and how many these are.

    Arithmetic alone: the same text runs on arrays (`solver/engines/draws.py`).
    """
    k = np.rint(x * TWO_OVER_PI)
    r = ((x - k * HALF_PI_HIGH) - k * HALF_PI_MIDDLE) - k * HALF_PI_LOW
    u = r * r
    p = 2.755731607860457e-06 + u * (-2.5051126871992286e-08 + u * 1.591777200235865e-10)
    p = -0.16666666666666666 + u * (0.008333333333330917 + u * (-0.00019841269836712153 + u * p))
    s = r + r * u * p
    p = -2.755731725661449e-07 + u * (2.087614312114999e-09 + u * -1.1382406353206278e-11)
    p = 0.041666666666666664 + u * (-0.0013888888888887378 + u * (2.4801587298736744e-05 + u * p))
    half = 0.5 * u
    top = 1.0 - half
    c = top + (((1.0 - top) - half) + u * u * p)  # the bracket is what rounding took from 1 - u/2
    return s, c, np.int64(k)


@inline_kernel
def sin_cos(x):
    """Return (sin x, cos x) for an angle in rad."""
    s, c, quadrant = fold_angle(x)
    if quadrant & 1:  # no branch on the quadrant's signs: a misprediction costs more than a product
        s, c = c, s
    return s * np.float64(1 - (quadrant & 2)), c * np.float64(1 - ((quadrant + 1) & 2))


@inline_kernel
def arc_tangent(t):
    """Return atan t in rad for |t| <= tan(pi/8)."""
    u = t * t
    p = 0.058577595134478064 + u * (-0.050834174416831635 + u * (0.039173098905525394 - u * 0.019105354603627347))
    p = -0.09090904439932149 + u * (0.07692179990512704 + u * (-0.06664466498253459 + u * p))
    p = 0.19999999999995316 + u * (-0.1428571428462392 + u * (0.11111111011843135 + u * p))
    return t + t * u * (-0.3333333333333333 + u * p)


@inline_kernel
def angle_from_sides(opposite, adjacent):
    """Return atan2(opposite, adjacent) in [0, pi] rad, for opposite >= 0."""
    if opposite == 0.0 and adjacent == 0.0:
        return 0.0
    near = abs(adjacent)
    flip = opposite > near
    t = near / opposite if flip else opposite / near
    shift = 0.0
    if t > TAN_PI_8:
        t = (t - 1.0) / (t + 1.0)
        shift = QUARTER_PI
    angle = shift + arc_tangent(t)
    if flip:
        angle = HALF_PI - angle
    return math.pi - angle if adjacent < 0.0 else angle


@inline_kernel
def full_angle(opposite, adjacent):
    """Return atan2(opposite, adjacent) in [-pi, pi] rad: one division, and selections instead of branches."""
    a, b = abs(opposite), abs(adjacent)
    steep = a > b
    low, high = (b, a) if steep else (a, b)
    shifted = low > TAN_PI_8 * high
    top = low - high if shifted else low
    bottom = low + high if shifted else high
    t = top / (bottom if bottom != 0.0 else 1.0)
    angle = (QUARTER_PI if shifted else 0.0) + arc_tangent(t)
    angle = HALF_PI - angle if steep else angle
    angle = math.pi - angle if adjacent < 0.0 else angle
    return math.copysign(angle, opposite)

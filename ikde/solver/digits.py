"""Numbers in words, rounded to the side on which what is said of them stays true."""

import math


def at_least(value: float) -> str:
    """A number that is not above `value` > 0: three decimals of it, or three digits if those are finer."""
    decimals = max(3, 2 - math.floor(math.log10(value)))
    rounded = math.floor(value * 10.0**decimals) / 10.0**decimals
    return f"{rounded:.3f}" if decimals == 3 else f"{rounded:.3g}"


def round_up(value: float) -> float:
    """The least number of two digits that is not below `value` > 0."""
    step = 10.0 ** (math.floor(math.log10(value)) - 1)
    return float(f"{math.ceil(value / step) * step:.2g}")

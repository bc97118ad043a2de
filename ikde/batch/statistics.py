"""Rates with their intervals, and what many numbers have in the middle and at the end.

Wilson's interval is eight lines that tests compare with scipy's. To import that takes 0.75 s, as long as all else that
`ikde batch` imports, and 143 MB; and it fails in a process in which `cli.startup` keeps numba from looking for BLAS.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ikde.solver.verify import MaskedBools

Z_95 = 1.959963984540054  # of the standard normal distribution, 95 % lie within +-Z


def wilson(count: int, total: int) -> tuple[float, float]:
    """95 % interval of the rate behind `count` out of `total` [Wilson1927]; (0, 1) if nothing was counted."""
    if total == 0:
        return 0.0, 1.0
    share, weight = count / total, Z_95**2 / total
    middle = share + 0.5 * weight
    spread = math.sqrt(weight * (share * (1.0 - share) + 0.25 * weight))
    low, high = (middle - spread) / (1.0 + weight), (middle + spread) / (1.0 + weight)
    return (0.0 if count == 0 else low), (1.0 if count == total else high)


@dataclass(frozen=True, slots=True)
class Rate:
    """So many out of so many."""

    count: int
    total: int

    @property
    def share(self) -> float:
        """The rate itself, NaN of nothing."""
        return self.count / self.total if self.total else math.nan

    @property
    def interval(self) -> tuple[float, float]:
        """Wilson's 95 % interval."""
        return wilson(self.count, self.total)

    @classmethod
    def of(cls, verdicts: MaskedBools) -> "Rate":
        """How many are true of those that were checked; masked ones do not count."""
        checked = verdicts.compressed()
        return cls(int(checked.sum()), len(checked))

    def __add__(self, other: "Rate") -> "Rate":
        """Both counted together."""
        return Rate(self.count + other.count, self.total + other.total)


@dataclass(frozen=True, slots=True)
class Spread:
    """Median, 95th percentile and maximum."""

    median: float
    p95: float
    max: float


def compute_spread(values: ArrayLike) -> Spread | None:
    """The spread of numbers; None of none."""
    numbers = np.asarray(values)
    if not numbers.size:
        return None
    median, p95 = np.percentile(numbers, [50, 95])
    return Spread(float(median), float(p95), float(numbers.max()))

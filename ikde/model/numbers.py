"""Numbers as users give them: anything that numpy reads, as long as every one of them is there."""

import numpy as np
from numpy.typing import ArrayLike

from ikde.errors import InputError, quoted
from ikde.kernels.arrays import Floats


def is_number(value: object) -> bool:
    """Whether it is a real number and no bool."""
    return isinstance(value, int | float | np.integer | np.floating) and not isinstance(value, bool)


def read_numbers(values: ArrayLike, where: tuple[str | int, ...]) -> Floats:
    """A copy as an array; raises `InputError` for text, complex numbers, dates, records, and masked values."""
    if _has_masked(values):
        raise InputError("expected numbers, but some are masked", where)
    if isinstance(values, np.ndarray) and values.dtype.kind not in "biufOSU":
        kind = {"c": "complex ones", "M": "dates", "m": "times"}.get(values.dtype.kind, "records")
        raise InputError(f"expected numbers, got {kind}", where)
    try:
        return np.array(values, dtype=float)
    except (TypeError, ValueError, OverflowError, RuntimeError):  # the last: a tensor that records its gradient
        raise InputError(f"expected numbers, got {quoted(values)}", where) from None


def _has_masked(values: object) -> bool:
    """Whether numpy would pass over a mask: that of an array, or of one in a list."""
    if isinstance(values, list | tuple):
        return any(hasattr(value, "mask") and np.ma.is_masked(value) for value in values)
    return hasattr(values, "mask") and bool(np.ma.is_masked(values))

"""Numbers as users give them: anything that numpy reads, as long as every one of them is there."""

import numpy as np
from numpy.typing import ArrayLike

from ikde.errors import InputError, quoted
from ikde.kernels.arrays import Floats


def is_number(value: object) -> bool:
    """Whether it is a real number and no bool."""
    return isinstance(value, int | float | np.integer | np.floating) and not isinstance(value, bool)


def read_numbers(values: ArrayLike, where: tuple[str | int, ...]) -> Floats:
    """A copy as an array; raises `InputError` for text, complex numbers, and masked values."""
    if hasattr(values, "mask") and np.ma.is_masked(values):
        raise InputError("expected numbers, but some are masked", where)
    if isinstance(values, np.ndarray) and values.dtype.kind == "c":
        raise InputError("expected numbers, got complex ones", where)
    try:
        return np.array(values, dtype=float)
    except (TypeError, ValueError, OverflowError):
        raise InputError(f"expected numbers, got {quoted(values)}", where) from None

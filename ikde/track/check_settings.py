"""What the numbers of a method must be, checked where they are given."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from ikde.errors import InputError
from ikde.kernels.mutation import LARGEST_DRAW

LEAST_POPULATION = LARGEST_DRAW + 1  # a mutation draws that many different members, and not the one it changes


def check_counts(settings: Any, least: Mapping[str, int]) -> None:
    """Raises `InputError` for what is no whole number of at least so many."""
    for name, fewest in least.items():
        value = getattr(settings, name)
        is_whole = isinstance(value, int | np.integer) and not isinstance(value, bool)
        require(is_whole and bool(value >= fewest), name, f"a whole number of at least {fewest}", value)


def check_numbers(settings: Any, bounds: Mapping[str, tuple[float, float]]) -> None:
    """Raises `InputError` for what is no number between two."""
    for name, (low, high) in bounds.items():
        value = getattr(settings, name)
        is_number = isinstance(value, int | float | np.number) and not isinstance(value, bool)
        require(is_number and bool(low <= value <= high), name, f"a number from {low:g} to {high:g}", value)


def require(is_good: bool, name: str, expected: str, value: object) -> None:
    """Raises `InputError` if it is not."""
    if not is_good:
        raise InputError(f"expected {expected}, got {value!r}", ("settings", name))

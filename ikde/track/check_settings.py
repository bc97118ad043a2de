"""What the numbers of a method must be, checked where they are given."""

from collections.abc import Mapping
from typing import Any

from ikde.kernels.mutation import MAX_DRAWN
from ikde.model.numbers import is_number
from ikde.solver.settings import MAX_COUNT, MAX_POPULATION, describe_count, is_count, require

LEAST_POPULATION = MAX_DRAWN + 1  # a mutation draws that many different members, and not the one it changes


def check_counts(settings: Any, least: Mapping[str, int]) -> None:
    """Raises `InputError` for what is no whole number, too small, or too large to be meant."""
    for name, fewest in least.items():
        value, most = getattr(settings, name), MAX_POPULATION if name == "population" else MAX_COUNT
        require(is_count(fewest, most)(value), name, describe_count(fewest, most), value)


def check_numbers(settings: Any, bounds: Mapping[str, tuple[float, float]]) -> None:
    """Raises `InputError` for what is no number between two."""
    for name, (low, high) in bounds.items():
        value = getattr(settings, name)
        require(is_number(value) and bool(low <= value <= high), name, f"a number from {low:g} to {high:g}", value)

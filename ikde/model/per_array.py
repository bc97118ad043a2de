"""What is made of a large array, kept as long as that is there."""

import weakref
from collections.abc import Callable
from typing import Generic, TypeVar

from ikde.kernels.arrays import Floats

Found = TypeVar("Found")


class PerArray(Generic[Found]):
    """What is made of an array, once as long as it is there; of one that may be written to, anew each time.

    What is made must not hold the array itself: it would never go.
    """

    def __init__(self, make: Callable[[Floats], Found]) -> None:
        self._make = make
        self._kept: dict[int, tuple[weakref.ref[Floats], Found]] = {}

    def find(self, array: Floats) -> Found:
        """What is made of it."""
        key, kept = id(array), self._kept
        known = kept.get(key)
        if known is not None and known[0]() is array:
            return known[1]
        made = self._make(array)
        if not array.flags.writeable:
            kept[key] = weakref.ref(array, lambda _: kept.pop(key, None)), made
        return made

    def __len__(self) -> int:
        return len(self._kept)

    def clear(self) -> None:
        """Forget all."""
        self._kept.clear()

"""What is kept of worlds with large clouds is forgotten before it fills the memory.

Caches of a few dozen entries suit worlds of a few solids. A cloud of a million points and what is made of it take
0.1 GB, and a sensor gives one after the other.
"""

from threading import Lock
from typing import Any, TypeVar

MAX_POINTS = 5_000_000
"""In clouds that were packed since caches were emptied last."""
Cached = TypeVar("Cached")


class Kept:
    """Caches that hold worlds, and how many points these have."""

    def __init__(self) -> None:
        self._caches: list[Any] = []
        self._lock, self._points = Lock(), 0

    def add(self, cache: Cached) -> Cached:
        """Empty this cache of `functools`, too; as a decorator."""
        self._caches.append(cache)
        return cache

    def note(self, points: int) -> None:
        """A world with so many points is packed: if that is too much, forget those before it."""
        with self._lock:
            is_full = points > 0 and self._points + points > MAX_POINTS
            self._points = points if is_full else self._points + points
        if is_full:
            for cache in self._caches:
                cache.cache_clear()


KEPT = Kept()
"""Of all worlds."""

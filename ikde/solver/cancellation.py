"""Searches that another thread can stop: Ctrl-C is heard by the main thread only."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from threading import Event

_STOP: ContextVar[Event | None] = ContextVar("stop", default=None)


@contextmanager
def stoppable(stop: Event) -> Iterator[None]:
    """Searches that begin inside end with `KeyboardInterrupt` soon after `stop` is set."""
    token = _STOP.set(stop)
    try:
        yield
    finally:
        _STOP.reset(token)


def get_cancel_check() -> Callable[[], None]:
    """What a search calls now and then, on whatever thread: it raises `KeyboardInterrupt` if it must stop."""
    stop = _STOP.get()

    def check_cancelled() -> None:
        if stop is not None and stop.is_set():
            raise KeyboardInterrupt

    return check_cancelled

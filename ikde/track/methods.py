"""The three ways to follow a path, from a start that is given or the one that `continuation` finds best."""

from collections.abc import Callable

import numpy as np

from ikde.errors import InputError
from ikde.kernels.arrays import Floats
from ikde.kernels.jit import compile_clock
from ikde.track.continuation import Continuation
from ikde.track.optimized import OptimizedSettings, follow_optimized
from ikde.track.spec import TRACK_METHODS, TrackMethod
from ikde.track.starts import settle_start
from ikde.track.trajectory import TrackStop
from ikde.track.typical import TypicalSettings, follow_typical

TrackSettings = OptimizedSettings | TypicalSettings

Followed = tuple[Floats, TrackStop | None, Floats]
"""Joint values [M + 1, N], why they end before the path does, and the seconds of each sample [M]."""


def check_method(method: str, settings: TrackSettings | None) -> None:
    """Raises `InputError` for an unknown method, and for settings of another one."""
    if method not in TRACK_METHODS:
        raise InputError(f"expected one of {', '.join(TRACK_METHODS)}, got {method!r}", ("method",))
    theirs = {"optimized": OptimizedSettings, "typical": TypicalSettings}.get(method)
    if settings is not None and (theirs is None or not isinstance(settings, theirs)):
        expected = f"expected {theirs.__name__}" if theirs else "it takes none"
        raise InputError(f"method {method}: {expected}, got {type(settings).__name__}", ("settings",))


def follow_by(
    method: TrackMethod,
    search: Continuation,
    start: Floats | None,
    settings: TrackSettings | None,
    announce_compile: Callable[[], None] | None,
) -> Followed:
    """The motion by one of the methods; `start` [N] is near the first pose."""
    follower = search.follower
    with compile_clock(announce_compile):
        if method == "continuation" or start is None:
            found = search.find(start)
            if isinstance(found, TrackStop):
                return np.empty((0, len(follower.robot.joints))), found, np.empty(0)
            if method == "continuation":
                return found.q, found.stop, found.follower.follow_timed(found.course)
            begin = found.q[0]
        else:
            begin = settle_start(follower, start, search.frozen)
        if method == "typical":
            assert not isinstance(settings, OptimizedSettings)  # `check_method`
            q, seconds = follow_typical(follower, begin, search.seed, settings)
            return q, None, seconds
        assert not isinstance(settings, TypicalSettings)
        evolved = follow_optimized(follower, begin, search.seed, settings)
        return evolved.q, evolved.stop, evolved.seconds

"""The three ways to follow a path, from a start that is given or the one that `continuation` finds best."""

import time
from dataclasses import dataclass

from ikde.errors import InputError
from ikde.kernels.arrays import Floats
from ikde.kernels.jit import compile_clock
from ikde.track.continuation import Continuation
from ikde.track.courses import ContinuationSettings
from ikde.track.optimized import OptimizedSettings, follow_optimized
from ikde.track.spec import TRACK_METHODS, TrackMethod
from ikde.track.starts import settle_start
from ikde.track.trajectory import TrackStop
from ikde.track.typical import TypicalSettings, follow_typical

TrackSettings = ContinuationSettings | OptimizedSettings | TypicalSettings
SETTINGS: dict[str, type[TrackSettings]] = {
    "continuation": ContinuationSettings,
    "optimized": OptimizedSettings,
    "typical": TypicalSettings,
}


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Followed:
    """A motion as far as it goes, and what it took."""

    q: Floats
    """[M + 1, N]"""
    stop: TrackStop | None
    """Why it ends before its path does."""
    seconds: Floats
    """[M] of each sample after the start."""
    search_seconds: float
    """Of the whole motion."""


def check_method(method: str, settings: TrackSettings | None) -> None:
    """Raises `InputError` for an unknown method, and for settings of another one."""
    if method not in TRACK_METHODS:
        raise InputError(f"expected one of {', '.join(TRACK_METHODS)}, got {method!r}", ("method",))
    theirs = SETTINGS[method]
    if settings is not None and not isinstance(settings, theirs):
        raise InputError(f"method {method}: expected {theirs.__name__}, got {type(settings).__name__}", ("settings",))


def follow_by(
    method: TrackMethod,
    search: Continuation,
    start: Floats | None,
    settings: TrackSettings | None,
) -> Followed:
    """The motion by one of the methods; `start` [N] is near the first pose."""
    follower = search.follower
    with compile_clock() as clock:
        began = time.perf_counter()

        def spent() -> float:
            return time.perf_counter() - began - clock.seconds

        if method == "continuation" or start is None:
            found = search.find(start)
            if method == "continuation" or not len(found.q):
                search_s, seconds = spent(), found.follower.follow_timed(found.course)
                return Followed(q=found.q, stop=found.stop, seconds=seconds, search_seconds=search_s)
            begin = found.q[0]
        else:
            begin = settle_start(follower, start, search.frozen)
        if method == "typical":
            assert settings is None or isinstance(settings, TypicalSettings)  # `check_method`
            q, seconds = follow_typical(follower, begin, search.seed, settings)
            return Followed(q=q, stop=None, seconds=seconds, search_seconds=spent())
        assert settings is None or isinstance(settings, OptimizedSettings)
        evolved = follow_optimized(follower, begin, search.seed, settings)
        return Followed(q=evolved.q, stop=evolved.stop, seconds=evolved.seconds, search_seconds=spent())

"""Many rollouts along one path, and the best of them.

Every start is tried along the whole path, which takes some tens of us a sample. Of those that reach its end the one
with the largest clearance is taken, in steps of 5 mm, and of those the one that moves least. If none reaches the end,
other null-space weights are tried; then those that came farthest backtrack some samples, drift another way, and try
again.
"""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace

import numpy as np

from ikde.kernels.arrays import DRIFT, Floats
from ikde.track.follower import Follower, Rollout
from ikde.track.settings import ContinuationSettings

BIN_M, ENOUGH_M = 0.005, 0.05  # clearance counts in such steps, and up to here
FIRST_BACK = 8  # samples to backtrack at first; twice as many each time
TRIES = 16  # at each
DRIFT_SHARE = 1.0  # of the largest steps: spread of the drift
MAX_ROLLOUTS = 8  # from different starts, that backtrack


def choose_rollout(
    follower: Follower, starts: Floats, end: int, is_possible: Callable[[int], bool], settings: ContinuationSettings
) -> Rollout:
    """The best rollout from any of the starts [S, N] to the sample `end`, or the one that came farthest.

    `is_possible` says whether any configuration meets a sample: where none does nothing else is tried.
    """
    tried: list[Rollout] = []
    for weights in settings.nullspace_weights:
        rollouts = [follower.begin(start, np.array(weights)).resume(end) for start in starts]
        tried += rollouts
        complete = [rollout for rollout in rollouts if rollout.last == end]
        if complete:
            return min(complete, key=_badness)
        if not is_possible(find_farthest(tried).last + 1):
            return find_farthest(tried)
    rng, best = np.random.default_rng(follower.plan.seed), find_farthest(tried)
    few = _farthest_few(tried)
    for number, rollout in enumerate(few):
        count = settings.max_backtracks // len(few) + (number < settings.max_backtracks % len(few))
        best = find_farthest((best, _backtrack(rollout, end, count, rng, settings)))
        if best.last == end:
            break
    return best


def find_farthest(rollouts: Iterable[Rollout]) -> Rollout:
    """The rollout that came farthest; the first of equals."""
    return max(rollouts, key=lambda rollout: rollout.last)


def _farthest_few(rollouts: Iterable[Rollout]) -> list[Rollout]:
    """The rollouts that came farthest, one a start, best first."""
    best: dict[bytes, Rollout] = {}
    for rollout in sorted(rollouts, key=lambda rollout: -rollout.last):
        best.setdefault(rollout.rows[0].tobytes(), rollout)
    return list(best.values())[:MAX_ROLLOUTS]


def _badness(rollout: Rollout) -> tuple[float, float]:
    """Little clearance first, then much motion."""
    return -np.floor(min(rollout.clearance_m, ENOUGH_M) / BIN_M), rollout.motion


def _backtrack(
    rollout: Rollout, end: int, count: int, rng: np.random.Generator, settings: ContinuationSettings
) -> Rollout:
    """Backtrack and try again until the end is reached or `count` tries are spent."""
    others = _vary(rollout, end, rng, settings)
    for _ in range(count):
        other = next(others)
        if other.last == end:
            return other
        if other.last > rollout.last:
            rollout, others = other, _vary(other, end, rng, settings)
    return rollout


def _vary(rollout: Rollout, end: int, rng: np.random.Generator, settings: ContinuationSettings) -> Iterator[Rollout]:
    """The same rollout from some samples before its end, and at last from its start, drifting at random."""
    back = FIRST_BACK
    while True:
        for _ in range(TRIES):
            yield _rewind(rollout, max(rollout.last - back, 0), back, rng, settings).resume(end)
        back = min(2 * back, max(rollout.last, FIRST_BACK))


def _rewind(
    rollout: Rollout, sample: int, back: int, rng: np.random.Generator, settings: ContinuationSettings
) -> Rollout:
    """A copy that stands at an earlier sample, with other weights of the null space from there on."""
    other, choices = replace(rollout.copy(), last=sample), settings.nullspace_weights
    ahead = other.weights[sample + 1 :]
    ahead[:, :DRIFT] = choices[int(rng.integers(len(choices)))]
    ahead[:, DRIFT:] = 0.0
    ahead[:back, DRIFT:] = DRIFT_SHARE * rng.standard_normal(rollout.steps.shape[1])
    return other

"""Many courses along one path, and the best of them.

Every start is tried along the whole path, which takes some tens of us a sample. Of those that reach its end the one
with the largest clearance is taken, in steps of 5 mm, and of those the one that moves least. If none reaches the end,
the null space is used otherwise; then those that came farthest go back some samples, drift another way, and try again.
"""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from ikde.kernels.arrays import DRIFT, Floats
from ikde.solver.settings import require
from ikde.track.check_settings import check_counts
from ikde.track.follower import Course, Follower

Use = tuple[float, float, float]
USES: tuple[Use, ...] = ((0.3, 0.3, 0.3), (1.0, 0.3, 0.3), (0.0, 0.0, 0.0), (1.0, 1.0, 0.0), (0.3, 1.0, 1.0))
BIN_M, ENOUGH_M = 0.005, 0.05  # clearance counts in such steps, and up to here
FIRST_BACK = 8  # samples to go back at first; twice as many each time
TRIES = 16  # at each
DRIFT_SHARE = 1.0  # of the largest steps: spread of the drift
MOST_COURSES = 8  # from different starts, that are gone back on


@dataclass(frozen=True, slots=True, kw_only=True)
class ContinuationSettings:
    """How `continuation` uses the freedom that the tool leaves, and how hard it looks for a way."""

    uses: tuple[Use, ...] = USES
    """What the null space is used for beside least motion (17, 19): clearance, joint ranges, manipulability, as shares
    of the largest steps; the first that leads to the end. (0, 0, 0): least motion alone."""
    returns: int = 1000
    """How often one search goes back from dead ends at most, on all its courses together."""

    def __post_init__(self) -> None:
        try:
            uses = np.array(self.uses, dtype=float)
        except (TypeError, ValueError):
            uses = np.empty(0)
        is_good = uses.ndim == 2 and uses.shape[-1] == DRIFT and bool((np.isfinite(uses) & (uses >= 0.0)).all())
        require(is_good, "uses", "rows of three numbers of at least 0", self.uses)
        check_counts(self, {"returns": 0})


def choose_course(
    follower: Follower,
    starts: Floats,
    end: int,
    seed: int,
    is_possible: Callable[[int], bool],
    settings: ContinuationSettings,
) -> Course:
    """The best course from any of the starts [S, N] to the sample `end`, or the one that came farthest.

    `is_possible` says whether any configuration meets a sample: where none does nothing else is tried.
    """
    tried: list[Course] = []
    for use in settings.uses:
        courses = [follower.follow(follower.begin(start, np.array(use)), end) for start in starts]
        tried += courses
        complete = [course for course in courses if course.last == end]
        if complete:
            return min(complete, key=_badness)
        if not is_possible(farthest(tried).last + 1):
            return farthest(tried)
    rng, best = np.random.default_rng(seed), farthest(tried)
    few = _farthest_few(tried)
    for number, course in enumerate(few):
        most = settings.returns // len(few) + (number < settings.returns % len(few))
        best = farthest((best, _return(follower, course, end, most, rng, settings.uses)))
        if best.last == end:
            break
    return best


def farthest(courses: Iterable[Course]) -> Course:
    """The course that came farthest; the first of equals."""
    return max(courses, key=lambda course: course.last)


def _farthest_few(courses: Iterable[Course]) -> list[Course]:
    """The courses that came farthest, one a start, best first."""
    best: dict[bytes, Course] = {}
    for course in sorted(courses, key=lambda course: -course.last):
        best.setdefault(course.q[0].tobytes(), course)
    return list(best.values())[:MOST_COURSES]


def _badness(course: Course) -> tuple[float, float]:
    """Little clearance first, then much motion."""
    return -np.floor(min(course.clearance_m, ENOUGH_M) / BIN_M), course.motion


def _return(
    follower: Follower, course: Course, end: int, most: int, rng: np.random.Generator, uses: tuple[Use, ...]
) -> Course:
    """Go back and try again until the end is reached or `most` returns are spent."""
    ways = _other_ways(follower, course, end, rng, uses)
    for _ in range(most):
        other = next(ways)
        if other.last == end:
            return other
        if other.last > course.last:
            course, ways = other, _other_ways(follower, other, end, rng, uses)
    return course


def _other_ways(
    follower: Follower, course: Course, end: int, rng: np.random.Generator, uses: tuple[Use, ...]
) -> Iterator[Course]:
    """The same course from some samples before its end, and at last from its start, drifting at random."""
    back = FIRST_BACK
    while True:
        for _ in range(TRIES):
            yield follower.follow(_rewind(course, max(course.last - back, 0), back, rng, uses), end)
        back = min(2 * back, max(course.last, FIRST_BACK))


def _rewind(course: Course, sample: int, back: int, rng: np.random.Generator, uses: tuple[Use, ...]) -> Course:
    """A copy that stands at an earlier sample and will use its null space otherwise from there on."""
    other = replace(course.copy(), last=sample)
    ahead = other.weights[sample + 1 :]
    ahead[:, :DRIFT] = uses[int(rng.integers(len(uses)))]
    ahead[:, DRIFT:] = 0.0
    ahead[:back, DRIFT:] = DRIFT_SHARE * rng.standard_normal(course.steps.shape[1])
    return other

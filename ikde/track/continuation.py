"""`continuation`, ours: from sample to sample by steps of the fast solver, from a start chosen along the whole path."""

from dataclasses import dataclass, field, replace

import numpy as np

from ikde.kernels.arrays import DRIFT, Floats
from ikde.model.robot import FARTHEST
from ikde.solver.result import SolveResult
from ikde.solver.solve import solve
from ikde.track.certify import bound_pairs
from ikde.track.courses import ContinuationSettings, choose_course
from ikde.track.follower import Course, Follower
from ikde.track.refusal import (
    explain_stop,
    first_out_of_reach,
    tell_out_of_reach,
    tell_static,
    tell_too_far,
    tell_uncertified,
)
from ikde.track.starts import MORE_DRAWS, Frozen, draw_starts, settle_start
from ikde.track.trajectory import TrackStop

WIDER = 8.0  # by how much what is kept above the safe distance grows if a motion is not certified between its samples
MOST_MARGINS = 4


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Found:
    """A course, and why it ends before its path, if it does."""

    course: Course
    follower: Follower
    """What it was followed with."""
    stop: TrackStop | None

    @property
    def q(self) -> Floats:
        """[M + 1, N] joint values of the samples."""
        return self.course.q[: self.course.last + 1]


@dataclass(slots=True, kw_only=True)
class Continuation:
    """The search for one course."""

    follower: Follower
    frozen: Frozen
    seed: int
    settings: ContinuationSettings = field(default_factory=ContinuationSettings)
    asked: dict[int, SolveResult] = field(default_factory=dict, init=False)
    """What the solver says about samples by themselves."""

    def find(self, start: Floats | None) -> Found:
        """A course that is certified, as far as it goes; without a sample if not even the first pose is met."""
        beyond = self._find_out_of_reach()
        if beyond is not None and beyond[0] == 0:
            return self._nowhere(tell_out_of_reach(self.follower, *beyond))
        end = self.follower.path.samples if beyond is None else beyond[0] - 1
        if start is None:
            found = self._from_any_start(end)
        else:
            found = self._certified(settle_start(self.follower, start, self.frozen)[None], end)
        if found.stop or found.course.last == self.follower.path.samples:
            return found
        if found.course.last == end and beyond is not None:
            return replace(found, stop=tell_out_of_reach(self.follower, *beyond))
        static = self._ask(found.course.last + 1) if self.follower.limits.ranges else None
        stop = explain_stop(found.follower, found.course, static)
        return replace(found, stop=stop)

    def _from_any_start(self, end: int) -> Found:
        """The best course from starts of its own; from more of them if none of the first leads to the end."""
        starts, first = draw_starts(self.follower, self.frozen, self.seed)
        if not len(starts):
            follower = self.follower
            return self._nowhere(tell_too_far(follower) if first.reached else tell_static(follower, 0, first))
        found = self._certified(starts, end)
        if found.course.last == end or not self._is_possible(found.course.last + 1):
            return found
        more, _ = draw_starts(self.follower, self.frozen, self.seed, MORE_DRAWS)
        return max(found, self._certified(more, end), key=lambda found: found.course.last)

    def _certified(self, starts: Floats, end: int) -> Found:
        """The course that comes farthest certified, with margins that grow until nothing is in doubt."""
        best, follower = None, self.follower
        for _ in range(MOST_MARGINS):
            course = choose_course(follower, starts, end, self.seed, self._is_possible, self.settings)
            found = cut_at_doubt(Found(course=course, follower=follower, stop=None))
            if best is None or found.course.last > best.course.last:
                best = found
            if found.stop is None:
                break
            safe = follower.collision.limit_m
            follower = follower.with_track(margin=safe + WIDER * (follower.track.margin - safe))
        assert best is not None
        return best

    def _nowhere(self, stop: TrackStop) -> Found:
        """No course at all, and why."""
        nothing = self.follower.begin(self.follower.robot.home, np.zeros(DRIFT))
        return Found(course=replace(nothing, last=-1), follower=self.follower, stop=stop)

    def _is_possible(self, sample: int) -> bool:
        """Whether any configuration meets it; the solver, which keeps the ranges, is not asked if they don't count."""
        return not self.follower.limits.ranges or self._ask(sample).reached

    def _ask(self, sample: int) -> SolveResult:
        """What the solver says about one sample by itself."""
        if sample not in self.asked:
            follower = self.follower
            told = {"collision": follower.collision, "freeze": self.frozen}
            settings = follower.limits.tolerances
            self.asked[sample] = solve(follower.robot, follower.path.targets()[sample], settings, **told)
        return self.asked[sample]

    def _find_out_of_reach(self) -> tuple[int, float] | None:
        """The first sample that is proved to be out of reach, and by how many m."""
        robot = self.follower.robot
        lower, upper = robot.lower.copy(), robot.upper.copy()
        if not self.follower.limits.ranges:
            lower[:], upper[:] = -FARTHEST, FARTHEST
        for name, value in self.frozen.items():
            index = robot.joint_names.index(name)
            lower[index] = upper[index] = value
        return first_out_of_reach(self.follower, lower, upper)


def cut_at_doubt(found: Found) -> Found:
    """The same up to the first segment that may touch on its way."""
    follower = found.follower
    bounds = bound_pairs(follower.collision, found.q)
    doubtful = next((k for k, bound in enumerate(bounds.min(axis=1, initial=np.inf)) if not bound > 0.0), None)
    if doubtful is None:
        return found
    pair = follower.collision.pairs[int(np.argmin(bounds[doubtful]))]
    stop = tell_uncertified(follower, doubtful + 1, pair)
    return replace(found, course=replace(found.course, last=doubtful), stop=stop)

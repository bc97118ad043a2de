"""`continuation`, ours: from sample to sample by steps of the fast solver, from a start chosen along the whole path."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from ikde.kernels.arrays import DRIFT, Floats
from ikde.model.robot import MAX_MAGNITUDE
from ikde.solver.compile_note import name_work, note_compile
from ikde.solver.result import SolveResult
from ikde.solver.solve import solve
from ikde.solver.standing import find_standing_obstacles
from ikde.track.certify import bound_all
from ikde.track.diagnosis import (
    explain_stop,
    first_out_of_reach,
    tell_out_of_reach,
    tell_static,
    tell_too_far,
    tell_uncertified,
)
from ikde.track.follower import Follower, Rollout
from ikde.track.moving import place_at
from ikde.track.remedies import advise
from ikde.track.rollouts import choose_rollout
from ikde.track.settings import ContinuationSettings
from ikde.track.starts import MORE_DRAWS, draw_starts, settle_start
from ikde.track.trajectory import Followed, TrackStop

WIDER = 8.0  # by how much what is kept above the safe distance grows if a motion is not certified between its samples
MAX_MARGINS = 4
TAKES = "a minute or two"


def follow_continuation(follower: Follower) -> Followed:
    """The motion that `continuation` finds, from the plan's start or one of its own."""
    plan = follower.plan
    with note_compile(lambda: name_work("tracks", plan.collision), TAKES) as clock:
        settings = plan.settings_of(ContinuationSettings)
        rollout = Continuation(follower=follower, settings=settings).find(plan.start)
        seconds = clock.run_seconds
    return Followed(q=rollout.q, stop=rollout.stop, seconds=rollout.time_steps(), search_seconds=seconds)


Evolved = tuple[Floats, Floats, TrackStop | None]
"""q [M + 1, N], the seconds of each sample [M], and why the motion ends before its path does."""


def follow_from_start(follower: Follower, evolve: Callable[[Follower, Floats], Evolved]) -> Followed:
    """What `evolve` makes of the plan's start, moved onto the first pose, or of the one that `continuation` finds."""
    plan = follower.plan
    with note_compile(lambda: name_work("tracks", plan.collision), TAKES) as clock:
        if plan.start is not None:
            q, stop = settle_start(plan, plan.start)[None], None
        else:
            found = Continuation(follower=follower).find(None)
            q, stop = found.q[:1], found.stop
        q, seconds, stop = evolve(follower, q[0]) if len(q) else (q, np.empty(0), stop)
        return Followed(q=q, stop=stop, seconds=seconds, search_seconds=clock.run_seconds)


@dataclass(slots=True, kw_only=True)
class Continuation:
    """The search for one rollout."""

    follower: Follower
    settings: ContinuationSettings = field(default_factory=ContinuationSettings)
    solved: dict[int, SolveResult] = field(default_factory=dict, init=False)
    """What the solver says about samples by themselves."""

    def find(self, start: Floats | None) -> Rollout:
        """A rollout that is certified, as far as it goes; without a sample if not even the first pose is met."""
        beyond = self._find_out_of_reach()
        if beyond is not None and beyond[0] == 0:
            return self._nowhere(tell_out_of_reach(self.follower, *beyond))
        end = self.follower.path.samples if beyond is None else beyond[0] - 1
        if start is None:
            found = self._from_any_start(end)
        else:
            found = self._certified(settle_start(self.follower.plan, start)[None], end)
        if found.stop:
            return replace(found, stop=advise(found, found.stop, end))
        if found.last == self.follower.path.samples:
            return found
        if found.last == end and beyond is not None:
            return replace(found, stop=tell_out_of_reach(self.follower, *beyond))
        static = self._solve(found.last + 1) if self.follower.plan.limits.ranges else None
        return replace(found, stop=advise(found, explain_stop(found, static), end))

    def _from_any_start(self, end: int) -> Rollout:
        """The best rollout from starts of its own; from more of them if none of the first leads to the end."""
        starts, first = draw_starts(self.follower.plan)
        if not len(starts):
            follower = self.follower
            return self._nowhere(tell_too_far(follower) if first.reached else tell_static(follower, 0, first))
        found = self._certified(starts, end)
        if found.last == end or not self._is_possible(found.last + 1):
            return found
        more, _ = draw_starts(self.follower.plan, MORE_DRAWS)
        return max(found, self._certified(more, end), key=lambda found: found.last)

    def _certified(self, starts: Floats, end: int) -> Rollout:
        """The rollout that comes farthest certified, with margins that grow until nothing is in doubt."""
        best, follower = None, self.follower
        for _ in range(MAX_MARGINS):
            found = cut_at_doubt(choose_rollout(follower, starts, end, self._is_possible, self.settings))
            if best is None or found.last > best.last:
                best = found
            if found.stop is None:
                break
            safe = follower.collision.limit_m
            follower = follower.with_track(margin=safe + WIDER * (follower.track.margin - safe))
        assert best is not None
        return best

    def _nowhere(self, stop: TrackStop) -> Rollout:
        """A rollout without a sample, and why."""
        nothing = self.follower.begin(self.follower.robot.home, np.zeros(DRIFT))
        return replace(nothing, last=-1, stop=stop)

    def _is_possible(self, sample: int) -> bool:
        """Whether any configuration meets it; the solver, which keeps the ranges, is not asked if they don't count."""
        static = self._solve(sample) if self.follower.plan.limits.ranges else None
        return static is None or static.reached

    def _solve(self, sample: int) -> SolveResult | None:
        """What the solver says about one sample by itself; None where what moves touches what no joint moves."""
        if sample not in self.solved:
            plan = self.follower.plan
            target, settings = plan.path.targets()[sample], plan.limits.tolerances
            model = place_at(plan.collision, plan.moving, sample * plan.path.dt_s)
            if plan.moving and any(pair.touches for pair in find_standing_obstacles(model)):
                return None
            self.solved[sample] = solve(plan.robot, target, settings, collision=model, freeze=plan.frozen)
        return self.solved[sample]

    def _find_out_of_reach(self) -> tuple[int, float] | None:
        """The first sample that is proved to be out of reach, and by how many m."""
        robot = self.follower.robot
        lower, upper = robot.lower.copy(), robot.upper.copy()
        if not self.follower.plan.limits.ranges:
            lower[:], upper[:] = -MAX_MAGNITUDE, MAX_MAGNITUDE
        for name, value in self.follower.plan.frozen.items():
            index = robot.joint_names.index(name)
            lower[index] = upper[index] = value
        return first_out_of_reach(self.follower, lower, upper)


def cut_at_doubt(rollout: Rollout) -> Rollout:
    """The same up to the first segment that may touch on its way."""
    follower = rollout.follower
    around = follower.around(0, len(rollout.q))
    bounds = bound_all(follower.collision, rollout.q, follower.plan.base_drive, around)
    doubtful = next((k for k, bound in enumerate(bounds.min(axis=1, initial=np.inf)) if not bound > 0.0), None)
    if doubtful is None:
        return rollout
    place = int(np.argmin(bounds[doubtful]))
    return replace(rollout, last=doubtful, stop=tell_uncertified(follower, doubtful + 1, place))

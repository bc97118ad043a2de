"""What came of the poses of a region that were tried, added up, and in words."""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from ikde.kernels.answer import BLOCKED, FIRST_COUNT, METRICS, SCORE
from ikde.kernels.arrays import ATTEMPTS, COLLIDING, COUNTS, EVALUATIONS, REACHED, Floats
from ikde.model.target import Target
from ikde.solver.digits import at_least
from ikde.solver.problem import Problem
from ikde.solver.region_grade import RegionGrade
from ikde.solver.region_proof import Proof
from ikde.solver.result import StopReason, count_blocking_pairs

NAMED = 3  # blockers in a reason


class Tried(NamedTuple):
    """One exact pose, and the row of numbers that a few attempts at it left (`kernels/answer.py`)."""

    problem: Problem
    target: Target
    alternative: int
    row: Floats
    engine: str
    is_reached: bool

    @property
    def score(self) -> tuple[float, ...]:
        """How good it is, the less the better: whether the pose is met, then the cost."""
        return tuple(self._whole[SCORE:BLOCKED].tolist())

    @property
    def _whole(self) -> Floats:
        return self.row[len(self.problem.lower) + METRICS :]


class Tally:
    """Counts of what was tried, and the best of it."""

    def __init__(self, problem: Problem, noun: str = "pose of the region") -> None:
        self.poses, self.out_of_reach, self.colliding = 0, 0, 0
        self.best: Tried | None = None
        self._problem, self._noun = problem, noun
        self._counts = np.zeros(COUNTS, dtype=np.int64)
        self._blocked = np.zeros(len(problem.collision.counted), dtype=np.int64)

    def add(self, tried: Tried) -> None:
        """Count a pose that was asked for."""
        whole = tried.row[len(self._problem.lower) + METRICS :].view(np.int64)
        self.poses += 1
        self.colliding += bool(whole[FIRST_COUNT + COLLIDING] and not whole[FIRST_COUNT + REACHED])
        self._counts += whole[FIRST_COUNT:SCORE]
        self._blocked += whole[BLOCKED:]
        if self.best is None or tried.score < self.best.score:
            self.best = tried

    def add_excluded(self) -> None:
        """Count a pose that a bound excludes."""
        self.poses += 1
        self.out_of_reach += 1

    @property
    def blocking(self) -> Mapping[tuple[str, str], int]:
        """How often each pair was in the way, most often first."""
        return count_blocking_pairs(self._problem.collision.counted, self._blocked)

    @property
    def spent(self) -> dict[str, object]:
        """What a result says of all that was tried for it."""
        names = {"attempts": ATTEMPTS, "evaluations": EVALUATIONS, "rejected": COLLIDING}
        counted = {name: int(self._counts[place]) for name, place in names.items()}
        return {**counted, "poses": self.poses, "blocking_pairs": self.blocking}

    def tell(self, is_late: bool) -> Proof:
        """Why there is no solution, as far as trying tells."""
        collision, blocking = self._problem.collision, dict(self.blocking)
        stop = StopReason.TIMED_OUT if is_late else StopReason.BUDGET
        if self.colliding and not is_late:
            stop = StopReason.COLLISION if blocking.keys() <= set(collision.pairs) else StopReason.WORLD
        return Proof(stop, self._describe(blocking, is_late), blocking)

    def _describe(self, blocking: Mapping[tuple[str, str], int], is_late: bool) -> str:
        rest = self.poses - self.out_of_reach - self.colliding
        parts = [f"{self.colliding} met only in collision"] if self.colliding else []
        parts += [f"{self.out_of_reach} proved to be out of reach"] if self.out_of_reach else []
        parts += [f"{rest} not met"] if rest else []
        begin = f"timed out after {self._problem.settings.timeout_s:g} s, with " if is_late else ""
        kind, _, rest_of_it = self._noun.partition(" ")
        tried = f"{self.poses:,} {kind}{'s' * (self.poses != 1)} {rest_of_it} tried"
        line = f"{begin}{tried}{': ' if parts else ''}{', '.join(parts)}"
        if not blocking:
            return line
        names = [self._name(pair, count) for pair, count in list(blocking.items())[:NAMED]]
        more = f" and {len(blocking) - NAMED} more" if len(blocking) > NAMED else ""
        return f"{line}; {int(self._counts[COLLIDING]):,} answers in collision, blocked by {', '.join(names)}{more}"

    def _name(self, pair: tuple[str, str], count: int) -> str:
        is_own = pair in set(self._problem.collision.pairs)
        return f"{'-'.join(pair) if is_own else pair[1]} ({count:,})"


def tell_still(grade: RegionGrade) -> Proof:
    """Why a robot of which no joint may move is not in a region: that is known exactly."""
    words = [f"{at_least(grade.position_m)} m"] if grade.position_m > 0.0 else []
    words += [f"{at_least(grade.orientation_rad)} rad"] if grade.orientation_rad > 0.0 else []
    reason = f"no joint may move, and the tool is {' and '.join(words)} out of the region"
    return Proof(StopReason.OUT_OF_REACH, reason, {})

"""What a solve gives back: joint values, their graded metrics, what it cost, and the reason it stopped."""

from collections.abc import Callable, Mapping, Sequence
from enum import StrEnum
from functools import cached_property, partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ikde.kernels.answer import BLOCKED, FIRST_COUNT, METRICS, PAIR
from ikde.kernels.arrays import ATTEMPTS, COLLIDING, EVALUATIONS, Floats
from ikde.model.collision_model import CollisionModel
from ikde.model.region import Region
from ikde.model.robot import Pairs
from ikde.model.target import Target
from ikde.solver.motion import measure_motion
from ikde.solver.preferred import Preferred
from ikde.solver.problem import Problem
from ikde.solver.settings import SolveSettings
from ikde.solver.verify import Grade, verify


class StopReason(StrEnum):
    """Why a solve ended."""

    REACHED = "reached"
    OUT_OF_REACH = "out_of_reach"
    """A bound, or the closed form, proves that no joint values bring the tool there, or orient it so."""
    COLLISION = "collision"
    """The pose was met, but only by configurations that collide with themselves, as far as trying tells, or as the
    reason says: proved, of all that are inside the limits."""
    LIMITS = "limits"
    """The pose is met only outside the joint limits (or with a frozen joint set free), as far as trying tells, or as
    the reason says: proved."""
    BUDGET = "budget"
    """The attempts were spent and nothing tells why."""
    TIMED_OUT = "timed_out"
    """The time was up (`SolveSettings.timeout_s`) and the target not reached."""
    UNVERIFIED = "unverified"
    """Kernels and `verify` disagree: a bug in ikde, recorded in bulk so that the run goes on."""
    WORLD = "world"
    """As `collision`, and some of these configurations collide with obstacles."""


Parts = tuple["ResultMaker", Floats, Target, int, int, float]
"""Maker, row of numbers (`kernels/answer.py`), target, seed, stream, seconds of the search."""
MADE_ANEW = ("q", "near")
"""Arrays that would arrive writable elsewhere."""
NOT_FIELDS = ("grade", "family")

STOP_REASONS = tuple(StopReason)  # in the order of their numbers in `SolveResults.stop_reasons`


class SolveResult:
    """One configuration and everything known about it. The metrics are graded on exactly this `q`.

    Made from a row of numbers (`kernels/answer.py`); what is asked for is read from it then, and kept.
    """

    __slots__ = ("__dict__", "_parts")

    def __repr__(self) -> str:
        """In a line; what else is known is an attribute each."""
        values = ", ".join(f"{name}={value:.6g}" for name, value in zip(self.joint_names, self.q, strict=True))
        return f"<SolveResult {self.stop_reason} by {self._maker.problem.robot.name}: {values}>"

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError(f"cannot assign to {name!r}: a result stays as it is")

    def __delattr__(self, name: str) -> None:
        raise AttributeError(f"cannot delete {name!r}: a result stays as it is")

    def __reduce__(self) -> tuple[Any, ...]:
        known = {name: value for name, value in self.__dict__.items() if name not in MADE_ANEW}
        return _restore, (self._parts, known)

    @cached_property
    def reached(self) -> bool:
        """Within tolerance, inside the limits, and free of self-collision if that was checked: with the detector
        `"none"` it is not. The kernels' grader decides; where plain numpy graded as well (`verified`) both must
        accept."""
        return True

    @cached_property
    def stop_reason(self) -> StopReason:
        """Why the search ended."""
        return StopReason.REACHED

    @cached_property
    def reason(self) -> str:
        """One line: what happened."""
        return reached_reason(self._maker.problem.collision) if self.reached else self._explanation.reason

    @cached_property
    def hint(self) -> str | None:
        """One line: what would help, proved by a bound or found by trying it; None if nothing was, or nothing is
        needed."""
        return None if self.reached else self._explanation.hint

    @cached_property
    def q(self) -> Floats:
        """[N] in the robot's own convention, m and rad: the solution, or the best configuration found."""
        return _freeze(self._row[: self._maker.joints])

    @cached_property
    def joint_names(self) -> tuple[str, ...]:
        """In the order of `q`."""
        return self._maker.problem.robot.joint_names

    @cached_property
    def target(self) -> Target:
        """What was asked for; of a region the exact pose that was drawn from it, and reached."""
        return self._parts[2]

    @cached_property
    def region(self) -> Region | None:
        """What was asked for, if that has freedom; None: exactly the target."""
        return None

    @cached_property
    def alternative(self) -> int | None:
        """Which part of the region was reached, or was tried last: its place in `region.parts`."""
        return None

    @cached_property
    def poses(self) -> int | None:
        """How many exact poses were drawn from the region."""
        return None

    @cached_property
    def position_error_m(self) -> float:
        """Distance of the tool from the target, m."""
        return self._row.item(self._maker.joints)

    @cached_property
    def orientation_error_rad(self) -> float:
        """Rotation-vector norm between tool and target, rad."""
        return self._row.item(self._maker.joints + 1)

    @cached_property
    def near(self) -> Floats | None:
        """[N] what `q` was to stay close to, brought inside the joint ranges; None: nothing."""
        near = self._maker.problem.near
        return None if near is None else _freeze(near)

    @cached_property
    def motion(self) -> float:
        """How far `q` is from `near`, else from home: sqrt(sum (w_j dq_j)^2), by the problem's weights."""
        problem = self._maker.problem
        start = problem.robot.home if self.near is None else self.near
        return float(measure_motion(problem.weights, start, self.q))

    @cached_property
    def clearance_m(self) -> float | None:
        """Smallest distance - R_i - R_j over the detector's pairs, m; None without a detector."""
        pair = self._counted[PAIR]
        return (
            self._row.item(self._maker.joints + 2) + self._maker.problem.collision.extra_m(pair) if pair >= 0 else None
        )

    @cached_property
    def room_m(self) -> float | None:
        """By how much that is more than what is asked for, the safe distance or an obstacle's margins, m: the smallest
        such difference of all pairs, below 0 in collision; None without a detector."""
        if self._counted[PAIR] < 0:
            return None
        return self._row.item(self._maker.joints + 2) - self._maker.problem.collision.limit_m

    @cached_property
    def closest_pair(self) -> tuple[str, str] | None:
        """The two components that the clearance lies between."""
        pair = self._counted[PAIR]
        return self._maker.problem.collision.name_pair(pair) if pair >= 0 else None

    @cached_property
    def collision(self) -> bool | None:
        """True if the clearance is not above the safe distance; None: not checked, there is no detector."""
        if self._counted[PAIR] < 0:
            return None
        return not self._row.item(self._maker.joints + 2) > self._maker.problem.collision.limit_m

    @cached_property
    def verified(self) -> bool | None:
        """True: plain numpy graded exactly this `q` and agrees with the metrics to 1e-11. False: it does not, a bug,
        which raises, or in bulk is recorded here. None: it was not asked; asking for `grade` later does not change
        it."""
        return None

    @cached_property
    def method(self) -> str:
        """The engine that answered."""
        return self._maker.method

    @cached_property
    def settings(self) -> SolveSettings:
        """What the engine was asked; with the seed and the stream it repeats the search bit for bit."""
        return self._maker.problem.settings

    @cached_property
    def detector(self) -> str:
        """Its name, or `"none"`."""
        return self._maker.problem.collision.name

    @cached_property
    def obstacles(self) -> tuple[str, ...]:
        """Names of what stands around, of what is switched on; none without a world."""
        return tuple(obstacle.name for obstacle in self._maker.problem.collision.obstacles)

    @cached_property
    def seed(self) -> int:
        """Of the random numbers."""
        return self._parts[3]

    @cached_property
    def stream(self) -> int:
        """Index of the target in its batch."""
        return self._parts[4]

    @cached_property
    def attempts(self) -> int:
        """Starts made: seeds, populations, or places of the base."""
        return self._counted[FIRST_COUNT + ATTEMPTS]

    @cached_property
    def evaluations(self) -> int:
        """Forward kinematics with pose error."""
        return self._counted[FIRST_COUNT + EVALUATIONS]

    @cached_property
    def rejected(self) -> int:
        """Attempts that met the pose but collided."""
        return self._counted[FIRST_COUNT + COLLIDING]

    @cached_property
    def blocking_pairs(self) -> Mapping[tuple[str, str], int]:
        """How often each pair blocked a pose that was met, most often first."""
        if "_explain" in self.__dict__:
            return self._explanation.blocking_pairs
        return count_blocking_pairs(self._maker.problem.collision.counted, self._counted[BLOCKED:])

    @cached_property
    def preferred(self) -> Preferred | None:
        """What the answer was moved for (`prefer`), and how much it has of that; None if nothing was preferred."""
        return None

    @cached_property
    def solve_seconds(self) -> float:
        """Wall time of this search, without compilation; in bulk, very short searches share a call and its time
        in equal parts."""
        return self._parts[5]

    @cached_property
    def compile_seconds(self) -> float:
        """Of what had to be compiled first."""
        return 0.0

    @cached_property
    def verify(self) -> Callable[[Target, Floats], Grade]:
        """Grades any target and configuration as this one was graded, by plain numpy."""
        problem = self._maker.problem
        return partial(verify, problem.robot, settings=problem.settings, collision=problem.collision)

    @cached_property
    def grade(self) -> Grade:
        """The grade of plain numpy, on exactly this `q`; computed when it is first asked for."""
        return self.verify(self.target, self.q)

    @property
    def family(self) -> str | None:
        """How a UR-type arm holds itself, such as `left/up/no flip`; None for other arms and what is not reached."""
        return self.grade.family if self.reached else None

    @cached_property
    def _explanation(self) -> Any:
        """Why it was not reached, where that was not put into words before."""
        return self.__dict__["_explain"](self._maker.problem, self.target)

    @property
    def _maker(self) -> "ResultMaker":
        return self._parts[0]

    @property
    def _row(self) -> Floats:
        return self._parts[1]

    @cached_property
    def _counted(self) -> list[int]:
        """The whole numbers of the row."""
        return self._row[self._maker.joints + METRICS :].view(np.int64).tolist()


FIELDS = tuple(name for name in vars(SolveResult) if not name.startswith("_") and name not in NOT_FIELDS)
"""All that a result says of itself, in its order."""
_new, _set_parts = object.__new__, vars(SolveResult)["_parts"].__set__


class ResultMaker:
    """Makes the results of one problem from rows of numbers (`kernels/answer.py`): reached, if no counts say otherwise.

    Nothing is computed: the words, names and pairs of a result are made when they are asked for (1.6 us of 9).
    """

    def __init__(self, problem: Problem, method: str) -> None:
        self.problem, self.method, self.joints = problem, method, len(problem.robot.joints)

    def make(self, row: Floats, target: Target, seed: int, stream: int, solve_seconds: float) -> SolveResult:
        """A result that was reached, of a row that nothing else will write to."""
        result = _new(SolveResult)
        _set_parts(result, (self, row, target, seed, stream, solve_seconds))
        return result


def change_result(result: SolveResult, **changes: Any) -> SolveResult:
    """A copy of which something else is known; its grade, unless given, is made anew."""
    known = {name: value for name, value in vars(result).items() if name != "grade"}
    return _restore(result._parts, {**known, **changes})


def _restore(parts: Parts, known: Mapping[str, Any]) -> SolveResult:
    """A result from its parts, and what is known of it beside them."""
    result = _new(SolveResult)
    _set_parts(result, parts)
    result.__dict__.update(known)
    return result


def _freeze(values: Floats) -> Floats:
    """A copy [N] that nothing makes writable: numpy gives that flag back to whoever owns the memory, bytes to none."""
    return np.frombuffer(values.tobytes())


NO_SOLUTION = "no solution, proved"
"""How a reason begins that is a proof, and no other: what follows may hold any name."""


def count_blocking_pairs(pairs: Pairs, counts: Sequence[int] | NDArray[np.int64]) -> dict[tuple[str, str], int]:
    """Pairs that blocked, with how often, most often first; `counts` may go on behind the last pair."""
    blocking = {pair: int(count) for pair, count in zip(pairs, counts, strict=False) if count}
    return dict(sorted(blocking.items(), key=lambda item: -item[1]))


def reached_reason(collision: CollisionModel) -> str:
    """One line for a target that was reached."""
    free = "free of self-collision" if collision.pairs else "self-collision not checked"
    if collision.obstacles:
        free += " and of the world"
    return f"within tolerance, inside the limits, {free}"

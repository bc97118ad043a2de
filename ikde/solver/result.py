"""What a solve gives back: joint values, their graded metrics, what it cost, and the reason it stopped."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from functools import cached_property, partial
from typing import Any

from ikde.kernels.arrays import Floats
from ikde.model.collision_model import CollisionModel
from ikde.model.target import Target
from ikde.solver.problem import Problem
from ikde.solver.settings import SolveSettings
from ikde.solver.verify import Grade, verify


class StopReason(StrEnum):
    """Why a solve ended."""

    REACHED = "reached"
    OUT_OF_REACH = "out_of_reach"
    """A bound proves that no joint values bring the tool there, or turn it so."""
    COLLISION = "collision"
    """The pose was met, but only by configurations that collide with themselves, as far as trying tells."""
    LIMITS = "limits"
    """As far as trying tells, the pose is met only outside the joint limits (or with a frozen joint set free)."""
    BUDGET = "budget"
    """The attempts were spent and nothing tells why."""
    TIMED_OUT = "timed_out"
    """The time was up (`SolveSettings.timeout_s`) and the target not reached."""
    UNVERIFIED = "unverified"
    """Kernels and `verify` disagree: a bug in ikde, recorded in bulk so that the run goes on."""


STOP_REASONS = tuple(StopReason)  # in the order of their numbers in `SolveResults.stop_reasons`


@dataclass(frozen=True, kw_only=True, eq=False)
class SolveResult:
    """One configuration and everything known about it. The metrics are graded on exactly this `q`."""

    reached: bool
    """Within tolerance, inside the limits, and free of self-collision if that was checked: with the detector `"none"`
    it is not. The kernels' grader decides; where plain numpy graded as well (`verified`) both must accept."""
    stop_reason: StopReason
    reason: str
    """One line: what happened."""
    hint: str | None
    """One line: what would help, proved by a bound or found by trying it; None if nothing was, or nothing is needed."""
    q: Floats
    """[N] in the robot's own convention, m and rad: the solution, or the best configuration found."""
    joint_names: tuple[str, ...]
    target: Target
    position_error_m: float
    """Distance of the tool from the target, m."""
    orientation_error_rad: float
    """Rotation-vector norm between tool and target, rad."""
    clearance_m: float | None
    """Smallest distance - R_i - R_j over the detector's pairs, m; None without a detector."""
    closest_pair: tuple[str, str] | None
    """The two components that the clearance lies between."""
    collision: bool | None
    """True if the clearance is not above the safe distance; None: not checked, there is no detector."""
    verified: bool | None
    """True: plain numpy graded exactly this `q` and agrees with the metrics to 1e-11. False: it does not, a bug, which
    raises, or in bulk is recorded here. None: it was not asked; asking for `grade` later does not change it."""
    method: str
    """The engine that answered."""
    settings: SolveSettings
    """What the engine was asked; with the seed and the stream it repeats the search bit for bit."""
    detector: str
    seed: int
    stream: int
    """Index of the target in its batch."""
    attempts: int
    evaluations: int
    """Forward kinematics with pose error."""
    rejected: int
    """Attempts that met the pose but collided."""
    blocking_pairs: Mapping[tuple[str, str], int]
    """How often each pair blocked a pose that was met, most often first."""
    solve_seconds: float
    """Wall time of this search, without compilation; in bulk, very short searches share a call and its time evenly."""
    compile_seconds: float
    verify: Callable[[Target, Floats], Grade] = field(repr=False)
    """Grades any target and configuration as this one was graded, by plain numpy."""

    @cached_property
    def grade(self) -> Grade:
        """The grade of plain numpy, on exactly this `q`; computed when it is first asked for."""
        return self.verify(self.target, self.q)

    @property
    def family(self) -> str | None:
        """How a UR-type arm holds itself, such as `left/up/no flip`; None for other arms and what is not reached."""
        return self.grade.family if self.reached else None


class ResultMaker:
    """Makes the results of one problem from what an engine found and a grader saw: reached, unless `others` differ.

    All fields go in at once: a frozen dataclass sets them one by one, which takes five times as long.
    """

    def __init__(self, problem: Problem, **others: Any) -> None:
        collision, settings = problem.collision, problem.settings
        self._pairs = collision.pairs
        self._shared = {
            "reached": True,
            "stop_reason": StopReason.REACHED,
            "reason": reached_reason(collision),
            "hint": None,
            "joint_names": collision.robot.joint_names,
            "collision": False if collision.pairs else None,
            "verified": None,
            "settings": settings,
            "detector": collision.name,
            "blocking_pairs": {},
            "compile_seconds": 0.0,
            "verify": partial(verify, collision.robot, settings=settings, collision=collision),
            **others,
        }

    def make(
        self,
        target: Target,
        q: Floats,
        metrics: tuple[Any, ...],
        counts: Sequence[int],
        seed: int,
        stream: int,
        solve_seconds: float,
        others: Mapping[str, Any] | None = None,
    ) -> SolveResult:
        """One result; `metrics` as `grade_one` gives them, `counts` [COUNTS] as an engine does, `others` by field."""
        position, orientation, clearance, pair, _ = metrics
        _, attempts, evaluations, rejected, _ = counts
        result = object.__new__(SolveResult)
        result.__dict__.update(
            self._shared,
            q=q,
            target=target,
            position_error_m=position,
            orientation_error_rad=orientation,
            clearance_m=clearance if pair >= 0 else None,
            closest_pair=self._pairs[pair] if pair >= 0 else None,
            attempts=attempts,
            evaluations=evaluations,
            rejected=rejected,
            seed=seed,
            stream=stream,
            solve_seconds=solve_seconds,
        )
        if others:
            result.__dict__.update(others)
        return result


def reached_reason(collision: CollisionModel) -> str:
    """One line for a target that was reached."""
    free = "free of self-collision" if collision.pairs else "self-collision not checked"
    return f"within tolerance, inside the limits, {free}"

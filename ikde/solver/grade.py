"""From what the kernels found to a `SolveResult`: the verdict is `verify`'s alone, on exactly the returned q."""

from dataclasses import dataclass

import numpy as np

from ikde.errors import VerificationError
from ikde.kernels.arrays import Floats
from ikde.kernels.figures import CLEARANCE, ORIENTATION_ERROR, POSITION_ERROR, compute_figures
from ikde.kernels.lanes import ATTEMPTS, COLLIDING, EVALUATIONS
from ikde.model.pack import pack_detector, pack_robot, pack_targets
from ikde.model.target import Target
from ikde.solver.explain import Explanation, count_blocking_pairs, explain, explain_from_counts
from ikde.solver.problem import Problem
from ikde.solver.result import SolveResult, StopReason
from ikde.solver.search import Found
from ikde.solver.verify import Verification, verify

AGREEMENT = 1e-11  # m, rad: kernels and `verify` must agree to this; farther than 1 m from the origin, relative to it


@dataclass(frozen=True, slots=True, kw_only=True)
class Run:
    """What produced a row: for the record of a result."""

    seed: int
    stream: int
    solve_seconds: float
    compile_seconds: float


def grade(
    problem: Problem, target: Target, found: Found, run: Run, *, strict: bool = True, probe: bool = True
) -> SolveResult:
    """Grade the first row of `found`.

    `strict` raises `VerificationError` where kernels and `verify` disagree; else the result is marked. `probe` lets the
    explanation of a failure make short searches.
    """
    q = found.q[0].copy()
    q.setflags(write=False)
    graded = verify(problem.robot, target, q, settings=problem.settings, detector=problem.detector or "none")
    gap = compute_disagreement(problem, target, q, graded)
    agree = gap <= AGREEMENT * max(1.0, float(np.abs(target.p_world_tool).max()))  # False for NaN
    if strict and not agree:
        raise VerificationError(f"kernels and verify disagree by {gap:.3g} on q = {q.tolist()}")
    story = _unverified(gap) if not agree else _tell(problem, target, found, run, graded, probe)
    return SolveResult(
        reached=story.stop_reason is StopReason.REACHED,
        stop_reason=story.stop_reason,
        reason=story.reason,
        hint=story.hint,
        q=q,
        joint_names=problem.robot.joint_names,
        target=target,
        verification=graded,
        verified=agree,
        method="de",
        settings=problem.settings,
        detector=problem.detector.name if problem.detector else "none",
        seed=run.seed,
        stream=run.stream,
        attempts=int(found.counts[0, ATTEMPTS]),
        evaluations=int(found.counts[0, EVALUATIONS]),
        rejected=int(found.counts[0, COLLIDING]),
        blocking_pairs=story.blocking_pairs,
        solve_seconds=run.solve_seconds,
        compile_seconds=run.compile_seconds,
    )


def _unverified(gap: float) -> Explanation:
    reason = f"kernels and verify disagree by {gap:.3g}: a bug, please report it"
    return Explanation(stop_reason=StopReason.UNVERIFIED, reason=reason, hint=None, blocking_pairs={})


def _tell(problem: Problem, target: Target, found: Found, run: Run, graded: Verification, probe: bool) -> Explanation:
    if not graded.accepted:
        if probe:
            return explain(problem, target, found, graded, run.seed)
        return explain_from_counts(problem, found)
    free = "free of self-collision" if problem.detector else "self-collision not looked at"
    return Explanation(
        stop_reason=StopReason.REACHED,
        reason=f"within tolerance, inside the limits, {free}",
        hint=None,
        blocking_pairs=count_blocking_pairs(problem, found.pair_counts[0]),
    )


def compute_disagreement(problem: Problem, target: Target, q: Floats, graded: Verification) -> float:
    """Largest gap between the kernels' figures and `verify`'s on the same `q`, in m or rad."""
    figures = np.empty(3)
    robot, detector = pack_robot(problem.robot), pack_detector(problem.robot, problem.detector)
    compute_figures(robot, detector, pack_targets([target]), 0, q, figures)
    gaps = [
        abs(figures[POSITION_ERROR] - graded.position_error_m),
        abs(figures[ORIENTATION_ERROR] - graded.orientation_error_rad),
    ]
    if graded.clearance_m is not None:
        gaps.append(abs(figures[CLEARANCE] - graded.clearance_m))
    return float(np.max(gaps))

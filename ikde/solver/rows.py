"""Many solves at once, a row each: searched on all cores, graded by plain numpy, explained."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from ikde.kernels.arrays import Floats, Ints
from ikde.kernels.jit import compile_clock
from ikde.kernels.lanes import ATTEMPTS, COLLIDING, EVALUATIONS
from ikde.model.target import Target
from ikde.solver.explain import Explanation
from ikde.solver.figures import Figures
from ikde.solver.grade import grade
from ikde.solver.problem import Problem
from ikde.solver.result import SolveResult, StopReason
from ikde.solver.search import Found, search
from ikde.solver.verify import Bools, Verdicts


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Rows:
    """Finished searches: row k belongs to target k. `row(k)` gives it as a `SolveResult`."""

    problem: Problem
    targets: Sequence[Target]
    seed: int
    first_stream: int
    found: Found
    figures: Figures
    """The kernels': the same bits on every machine."""
    verdicts: Verdicts
    """Plain numpy's: the judge."""
    verified: Bools
    """[T] both agree to 1e-11."""
    explanations: tuple[Explanation, ...]
    compile_seconds: float

    @property
    def q(self) -> Floats:
        """Joint values [T, N] in the robot's own convention, m and rad."""
        return self.found.q

    @property
    def reached(self) -> Bools:
        """Within tolerance, inside the limits, free of collision, and verified [T]."""
        return self.verdicts.accepted & self.verified

    @property
    def attempts(self) -> Ints:
        """Populations evolved [T]."""
        return self.found.counts[:, ATTEMPTS]

    @property
    def evaluations(self) -> Ints:
        """Forward kinematics with pose error [T]."""
        return self.found.counts[:, EVALUATIONS]

    @property
    def rejected(self) -> Ints:
        """Attempts that met the pose but collided [T]."""
        return self.found.counts[:, COLLIDING]

    def __len__(self) -> int:
        return len(self.targets)

    def row(self, index: int) -> SolveResult:
        """One row with everything known about it."""
        problem, story = self.problem, self.explanations[index]
        q = self.q[index].copy()
        q.setflags(write=False)
        return SolveResult(
            reached=story.stop_reason is StopReason.REACHED,
            stop_reason=story.stop_reason,
            reason=story.reason,
            hint=story.hint,
            q=q,
            joint_names=problem.robot.joint_names,
            target=self.targets[index],
            verification=self.verdicts.row(index),
            verified=bool(self.verified[index]),
            method="de",
            settings=problem.settings,
            detector=problem.detector.name if problem.detector else "none",
            seed=self.seed,
            stream=self.first_stream + index,
            attempts=int(self.attempts[index]),
            evaluations=int(self.evaluations[index]),
            rejected=int(self.rejected[index]),
            blocking_pairs=story.blocking_pairs,
            solve_seconds=float(self.found.seconds[index]),
            compile_seconds=self.compile_seconds,
        )


def solve_rows(
    problem: Problem,
    targets: Sequence[Target],
    *,
    seed: int,
    first_stream: int = 0,
    first_attempt: int = 0,
    threads: int | None = None,
    probe: bool = True,
    strict: bool = False,
    announce_compile: Callable[[], None] | None = None,
) -> Rows:
    """Solve targets, a lane each on all threads; target k searches the stream (seed, first_stream + k).

    Args:
        problem: robot, detector, settings and ranges.
        targets: what the tool is asked to do.
        seed: same seed, same bits.
        first_stream: stream of the first target.
        first_attempt: where in its stream each search begins.
        threads: how many; None for all cores.
        probe: whether short searches find out why a target was not reached; else its counts alone tell, at no cost.
        strict: raise where kernels and plain numpy disagree, instead of recording it.
        announce_compile: called once if kernels must be compiled first.

    Raises:
        VerificationError: with `strict`, for a disagreement of more than 1e-11: a bug.
    """
    streams = range(first_stream, first_stream + len(targets))
    with compile_clock(announce_compile) as clock:
        search(problem, targets[:1], seed=0, streams=[0], attempts=0)
        found = search(problem, targets, seed=seed, streams=streams, first_attempt=first_attempt, threads=threads)
        graded = grade(problem, targets, found, seed=seed, strict=strict, probe=probe)
    return Rows(
        problem=problem,
        targets=targets,
        seed=seed,
        first_stream=first_stream,
        found=found,
        figures=graded.figures,
        verdicts=graded.verdicts,
        verified=graded.verified,
        explanations=graded.explanations,
        compile_seconds=clock.seconds,
    )

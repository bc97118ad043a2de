"""An answer moved to a local optimum of what is preferred, graded again: `prefer` of `solve`.

What moves it is `solver/self_motion.py`. The kernels' grader and plain numpy both grade what comes of it, and it is
kept if it is better by what was preferred.
"""

from time import perf_counter

import numpy as np

from ikde.kernels.answer import METRICS, PAIR
from ikde.kernels.arrays import Floats
from ikde.kernels.grade_one import grade_one
from ikde.model.pack import pack_targets
from ikde.model.target import Targets
from ikde.solver.grade import confirm
from ikde.solver.metrics import pack_grader
from ikde.solver.objectives import make_objective
from ikde.solver.preferred import Prefer, Preferred
from ikde.solver.problem import Problem
from ikde.solver.result import ResultMaker, SolveResult, change_result
from ikde.solver.self_motion import Climb, SelfMotion


def move_to_preferred(problem: Problem, result: SolveResult, prefer: Prefer) -> SolveResult:
    """The answer, moved to a local optimum of what is preferred, or as it is if none is better.

    Raises:
        InputError: for clearance without a detector, for manipulability that is always 0.
        VerificationError: if kernels and plain numpy disagree on what comes of it: a bug.
    """
    began, objective, moved = perf_counter(), make_objective(problem, prefer), result
    end = Climb(result.q, 0, problem.is_fixed)
    if result.reached and not problem.is_fixed:
        end = SelfMotion(problem=problem, target=result.target).climb(result.q, objective)
    if end.steps:
        better = _regrade(problem, result, end.q)
        if better is None or objective.worth(better.q) <= objective.worth(result.q):
            end = Climb(result.q, 0, False)
        else:
            moved = better
    before, after = objective.show(result.q), objective.show(moved.q)
    preferred = Preferred(what=prefer, before=before, after=after, steps=end.steps, settled=end.settled)
    return change_result(moved, preferred=preferred, solve_seconds=result.solve_seconds + perf_counter() - began)


def _regrade(problem: Problem, result: SolveResult, q: Floats) -> SolveResult | None:
    """The result at another configuration, graded by the kernel in plain Python and by numpy; None: not accepted."""
    grader, asked = pack_grader(problem.collision, problem.settings), pack_targets(Targets.of([result.target]))
    with np.errstate(all="ignore"):  # as machine code does
        *metrics, pair, accepted = grade_one.plain(*grader, asked.kind, asked.T_world_tool, q)
    if not accepted:
        return None
    row, size = result._row.copy(), len(q)
    row[:size], row[size : size + METRICS] = q, metrics
    row[size + METRICS :].view(np.int64)[PAIR] = pair
    parts = result.target, result.seed, result.stream, result.solve_seconds
    made = ResultMaker(problem, result.method).make(row, *parts)
    confirmed = confirm(problem.robot, change_result(made, compile_seconds=result.compile_seconds))
    return confirmed if confirmed.reached else None

"""The quick way of a target with `near`, frozen joints or weights, which may be others at every call.

What stays is laid out once; ranges and `near` are written into a copy of it, in 2 us. The answer is that of the long
way (`solver.results`), bit for bit, and what this way cannot answer is left to that one.
"""

from functools import lru_cache, partial

from ikde.kernels.arrays import Floats, Ints, SeedArrays
from ikde.kernels.flat_arguments import set_ranges
from ikde.kernels.jit import Bound
from ikde.model.collision_model import CollisionModel
from ikde.model.target import Target
from ikde.solver.background import Question, answers_plainly
from ikde.solver.engines.engine import make_ranges
from ikde.solver.engines.lm import pack_answer
from ikde.solver.engines.pool import load_kernels, make_seeds, runs_on_tables
from ikde.solver.problem import Problem
from ikde.solver.quick import ENGINE, Stages, compile_first
from ikde.solver.result import ResultMaker, SolveResult
from ikde.solver.search import choose_engines, find_free
from ikde.solver.settings import SolveSettings

Block = tuple[Floats, Ints, Floats, Floats]


class QuickNear:
    """The engine `lm` and the grader, for one collision model, settings and kind of target, in ranges that change."""

    def __init__(self, collision: CollisionModel, settings: SolveSettings, kind: str) -> None:
        self._collision, self._settings, self._kind = collision, settings, kind
        self._blocks: dict[bool, tuple[SeedArrays, Block]] = {}  # with `near`, and without
        self._stages = lru_cache(maxsize=64)(self._make_stages)
        self._ready: set[bool] = set()

    def solve(self, problem: Problem, target: Target, seed: int, stream: int, started: float) -> SolveResult | None:
        """As `Stages.ask`, or None where another engine is the first to try; the first ones as those of `Quick`."""
        is_near, stages = problem.near is not None, self._stages(problem.frozen)
        if stages is None:
            return None
        answer, maker = self._prepare(problem), ResultMaker(problem, ENGINE)
        if is_near in self._ready:
            return stages.ask(answer.compiled, maker, target, seed, stream, started)
        if answers_plainly(answer, Question(self._collision, self._kind, is_near)):
            return stages.ask(answer.plain, maker, target, seed, stream, started)
        self._ready.add(is_near)
        ask = partial(stages.ask, answer.compiled, maker)
        return compile_first(ask, target, seed, stream)

    def _make_stages(self, frozen: tuple[str, ...]) -> Stages | None:
        """None without written kernels, if nothing may move, or if another engine than `lm` comes first."""
        robot = self._collision.robot
        free = {k for k in find_free(robot.lower, robot.upper) if robot.joint_names[k] not in frozen}
        if not free or runs_on_tables():
            return None
        engines = choose_engines(robot, self._settings, {self._kind}, free=free)
        return Stages(self._collision, self._settings, is_last=len(engines) == 1) if engines[0] == ENGINE else None

    def _prepare(self, problem: Problem) -> Bound:
        """The call, ready for a target."""
        kernels, is_near = load_kernels(self._collision, self._kind), problem.near is not None
        numbers, *others = self._lay_out(problem, is_near)
        numbers = set_ranges(numbers, make_ranges(problem), problem.turns)
        if is_near:
            return kernels.answer_near.bind(numbers, *others, problem.weights)
        return kernels.answer_target.bind(numbers, *others)

    def _lay_out(self, problem: Problem, is_near: bool) -> Block:
        """What the last call of this kind was laid out to, if its seeds are these."""
        kept = self._blocks.get(is_near)
        if kept and is_near:
            return kept[1]
        seeds = make_seeds(problem, self._kind)
        if kept is None or kept[0] is not seeds:
            kept = self._blocks[is_near] = seeds, pack_answer(problem, self._kind, seeds)
        return kept[1]


@lru_cache(maxsize=64)
def find_quick_near(collision: CollisionModel, settings: SolveSettings, kind: str) -> QuickNear:
    """The quick way of a question whose ranges change."""
    return QuickNear(collision, settings, kind)

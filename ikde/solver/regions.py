"""A region is solved by exact poses: one is drawn an attempt, asked of the usual search, and graded by the region."""

import time
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from ikde.kernels.answer import BLOCKED, METRICS, PAIR, SCORE, pack_row
from ikde.kernels.arrays import REACHED, Floats
from ikde.kernels.grade_one import grade_one
from ikde.model.bounds import find_bounds
from ikde.model.large_worlds import KEPT
from ikde.model.pack import pack_targets
from ikde.model.region import Region, has_freedom
from ikde.model.target import Target, Targets
from ikde.solver.ask import Ask
from ikde.solver.asker import find_asker
from ikde.solver.base_places import BasePlaces
from ikde.solver.engine_table import NAMES
from ikde.solver.grade import confirm
from ikde.solver.metrics import pack_grader
from ikde.solver.plain import compute_frames
from ikde.solver.problem import Problem
from ikde.solver.proof import prove
from ikde.solver.region_draws import Drawn, draw_poses, draw_streams
from ikde.solver.region_grade import RegionGrade, grade_frames
from ikde.solver.region_nearest import find_nearest
from ikde.solver.region_proof import Proof, prove_region
from ikde.solver.region_tally import Tally, Tried, tell_still
from ikde.solver.result import ResultMaker, SolveResult, change_result
from ikde.solver.search import search
from ikde.solver.settings import SolveSettings
from ikde.solver.way import as_word

POSES, POSES_OF_MANY = 1024, 128  # of each alternative that are tried unless `restarts` says otherwise; of many fewer
SEVERAL = 4  # alternatives that are not many
LM_ATTEMPTS, MORE_ATTEMPTS = 4, 16  # at one pose; of the closed form, which shows all branches, and of others one
QUICKLY = 32  # poses of each alternative that so few attempts are made at
QUICK, ONCE = ("lm", "analytic"), ("analytic",)  # engines; those that show all that a pose has at once
FIRST_BLOCK, MAX_BLOCK = 4, 64  # poses drawn at once
MORE_POSES = "more restarts: so many poses of the region are tried"


@dataclass(frozen=True, slots=True, eq=False)
class RegionQuestion:
    """What is asked: a region, in a problem, on a random stream."""

    problem: Problem
    region: Region
    seed: int
    stream: int


def solve_region(question: RegionQuestion) -> SolveResult:
    """The first answer, or of several alternatives the best; if there is none the best that was found, and why."""
    region, search_of = question.region, RegionSearch(question)
    if region.take == "first":
        first = next(search_of.answers(), None)
        return search_of.finish(first) if first else search_of.give_up()
    found: dict[int, SolveResult] = {}
    for answer in search_of.answers():
        found.setdefault(answer.alternative or 0, answer)
        search_of.close(answer.alternative or 0)
    best = min(found.values(), key=lambda answer: answer.motion, default=None)
    return search_of.finish(best) if best else search_of.give_up()


class RegionSearch:
    """The answers of one region, in the order in which they are found; then what there is to say if there are none."""

    def __init__(self, question: RegionQuestion) -> None:
        self._asked = question
        self._started = time.perf_counter()
        base, random = question.region.base, (question.seed, question.stream)
        self._places = None if base is None else BasePlaces(question.problem, base, *random)
        self._problem = question.problem if self._places is None else self._places.whole
        is_free = any(map(has_freedom, question.region.parts))
        self._tally = Tally(self._problem, "pose of the region" if is_free else "place of the base")
        self._budget = _find_budget(question.problem.settings, len(question.region.parts))
        self._closed: set[int] = set()
        self._ways: dict[str, Ask] = {}
        self._proof: Proof | None = None

    def answers(self) -> Iterator[SolveResult]:
        """Solutions, each graded by plain numpy and by the region."""
        region = self._asked.region
        yield from self._try_standing()
        first, count = 0, len(region.parts)
        while first < self._budget and not self._is_done():
            yield from self._try_block(self._draw(first, min(count, self._budget - first)))
            if first == 0 and not self._is_done():
                excluded, self._proof = prove_region(self._problem, region)
                self._closed |= excluded
            first, count = first + count, min(MAX_BLOCK, max(FIRST_BLOCK, first))

    def close(self, alternative: int) -> None:
        """Try no further pose of an alternative."""
        self._closed.add(alternative)

    def finish(self, answer: SolveResult) -> SolveResult:
        """An answer, with the time and all that was tried until now."""
        return change_result(
            answer, grade=answer.grade, solve_seconds=time.perf_counter() - self._started, **self._tally.spent
        )

    def give_up(self) -> SolveResult:
        """The best that was found, with the reason."""
        tally, problem = self._tally, self._problem
        if tally.best is None:  # all that was drawn is out of reach
            drawn = self._draw(0, len(self._asked.region.parts))
            tally.best = self._ask(problem, drawn.targets[0], int(drawn.parts[0]), self._asked.stream)
        stop, reason, blocking = self._proof or tally.tell(self._is_late())
        result = confirm(problem.robot, self._make(_grade_best(tally.best)))
        hint = None if self._proof else MORE_POSES
        known: dict[str, Any] = {"stop_reason": stop, "reason": reason, "hint": hint}
        return change_result(
            result, grade=result.grade, reached=False, **known, **{**tally.spent, "blocking_pairs": blocking}
        )

    def _draw(self, first: int, count: int) -> Drawn:
        asked = self._asked
        return draw_poses(asked.region, first, count, self._problem.settings, asked.seed, asked.stream)

    def _try_standing(self) -> Iterator[SolveResult]:
        """Where nothing need move: `near` is inside the region, or no joint may move."""
        problem = self._problem
        q = problem.lower if problem.is_fixed else problem.near
        if q is None:
            return
        T, grade = self._grade(q)
        if grade.is_inside or problem.is_fixed:
            target = Target.packed("pose", np.ascontiguousarray(T[:3]))
            yield from self._answer(self._try(self._problem, target, grade.alternative, self._asked.stream))
        if problem.is_fixed:
            self._budget = 0
            self._proof = None if grade.is_inside else tell_still(grade)
        elif not grade.is_inside:
            yield from self._try_nearest(T)

    def _try_nearest(self, T_world_tool: Floats) -> Iterator[SolveResult]:
        """Of each alternative the pose that is nearest to where the tool is at `near`."""
        for place, part in enumerate(self._asked.region.parts):
            target = find_nearest(part, T_world_tool, self._problem.settings)
            if place not in self._closed and prove(self._problem, target) == (0.0, 0.0):
                yield from self._answer(self._try(self._problem, target, place, self._asked.stream))

    def _try_block(self, drawn: Drawn) -> Iterator[SolveResult]:
        """Solutions among some poses; those that a bound excludes are not asked for."""
        problem, targets = self._problem, drawn.targets
        far, off = find_bounds(problem.robot, problem.lower, problem.upper).excess_of_many(targets)
        settings = problem.settings
        is_out = (far > settings.position_tolerance_m) | (off > settings.orientation_tolerance_rad)
        streams = draw_streams(self._asked.seed, self._asked.stream, drawn.numbers)
        for place, (stream, part) in enumerate(zip(streams, drawn.parts.tolist(), strict=True)):
            if self._is_done():
                return
            if part in self._closed:
                continue
            target = targets[place]
            number = int(drawn.numbers[place])
            asked = None if is_out[place] else self._place(number, target)
            if asked is None:
                self._tally.add_excluded()
                continue
            tried = self._try(asked, target, part, stream, number)
            yield from self._answer(tried)
            if tried.engine in ONCE and self._places is None and not has_freedom(self._asked.region.parts[part]):
                self._closed.add(part)

    def _place(self, number: int, target: Target) -> Problem | None:
        """The question of a draw: of a base, where it stands in that attempt; None: out of reach from there."""
        if self._places is None:
            return self._problem
        return self._places.narrow(number // len(self._asked.region.parts), target)

    def _try(self, problem: Problem, target: Target, alternative: int, stream: int, number: int = 0) -> Tried:
        tried = self._ask(problem, target, alternative, stream, number)
        self._tally.add(tried)
        return tried

    def _ask(self, problem: Problem, target: Target, alternative: int, stream: int, number: int = 0) -> Tried:
        """A few attempts at one exact pose, on a stream of its own; later draws, which others left, have more."""
        attempts = LM_ATTEMPTS if number < QUICKLY * len(self._asked.region.parts) else MORE_ATTEMPTS
        way = self._ways.get(target.kind) if problem is self._problem else None
        if way is None:
            way = find_asker(problem.collision, problem.settings, target.kind).make(problem, Ask)
        if way is None:
            return Tried(problem, target, alternative, *_search(problem, target, self._asked.seed, stream, attempts))
        if problem is self._problem:
            self._ways[target.kind] = way
        if not way.is_ready:
            way.bind()
        row, last = np.zeros(way.plan.size), 1 if way.plan.is_closed else attempts
        row[: len(problem.lower)] = np.minimum(np.maximum(problem.centre, problem.lower), problem.upper)
        is_reached = way.answer(target.T_world_tool, as_word(self._asked.seed), stream, 0, last, row)
        return Tried(problem, target, alternative, row, way.engine, bool(is_reached))

    def _answer(self, tried: Tried) -> Iterator[SolveResult]:
        """The solution, if that pose was reached, and both graders accept what was found."""
        if not tried.is_reached:
            return
        result = confirm(self._problem.robot, self._make(tried))
        _, grade = self._grade(result.q)
        if result.reached and grade.is_inside:
            yield change_result(result, grade=result.grade, alternative=grade.alternative)

    def _grade(self, q: Floats) -> tuple[Floats, RegionGrade]:
        """Where the tool is [4, 4], and how that and the place of the base are judged."""
        robot = self._problem.robot
        Ts_world = compute_frames(robot, q)
        return Ts_world[robot.tool], grade_frames(self._asked.region, robot, Ts_world, self._problem.settings)

    def _make(self, tried: Tried) -> SolveResult:
        asked = self._asked
        maker = ResultMaker(asked.problem, tried.engine)  # motions begin at its `near`, wherever the base may stand
        result = maker.make(tried.row, tried.target, asked.seed, asked.stream, time.perf_counter() - self._started)
        return change_result(result, region=asked.region, alternative=tried.alternative, **self._tally.spent)

    def _is_done(self) -> bool:
        return self._proof is not None or self._is_late() or len(self._closed) == len(self._asked.region.parts)

    def _is_late(self) -> bool:
        timeout_s = self._problem.settings.timeout_s
        return timeout_s is not None and time.perf_counter() - self._started >= timeout_s


def _find_budget(settings: SolveSettings, alternatives: int) -> int:
    """Poses of all alternatives: of slow engines, which make one attempt at each, their own number of attempts."""
    if settings.restarts is None and {*QUICK} & {*settings.engines}:
        return max(POSES * min(alternatives, SEVERAL), POSES_OF_MANY * alternatives)
    return settings.budget(settings.engines[-1]) * alternatives


def _search(problem: Problem, target: Target, seed: int, stream: int, attempts: int) -> tuple[Floats, str, bool]:
    """The same by the long way: the row (`kernels/answer.py`), the engine, and whether it is reached."""
    few = _find_few(problem)
    attempts = attempts if few.settings.method == "lm" else 1
    found = search(few, Targets.of([target]), seed=seed, streams=[stream], attempts=attempts, threads=1)
    metrics = found.metrics
    measured = metrics.position_error_m[0], metrics.orientation_error_rad[0], metrics.clearance_m[0]
    row = pack_row(found.q[0], measured, metrics.closest_pair[0], found.counts[0], found.pair_counts.row(0))
    joints = len(problem.lower)
    row[joints + METRICS + SCORE : joints + METRICS + BLOCKED] = found.score[0]  # by which the best of all is kept
    return row, NAMES[found.engine[0]], bool(metrics.accepted[0] and found.counts[0, REACHED])


def _grade_best(tried: Tried) -> Tried:
    """The same with its figures: a search does not grade what it has not reached."""
    problem, row, (kinds, T_world_tool) = tried.problem, tried.row.copy(), pack_targets([tried.target])
    joints = len(problem.lower)
    with np.errstate(all="ignore"):  # as machine code does
        seen = grade_one.plain(*pack_grader(problem.collision, problem.settings), kinds, T_world_tool, row[:joints])
    row[joints : joints + METRICS] = seen[:METRICS]
    row[joints + METRICS :].view(np.int64)[PAIR] = seen[METRICS]
    return tried._replace(row=row)


@KEPT.add
@lru_cache(maxsize=16)
def _find_few(problem: Problem) -> Problem:
    """The same question with so little search as one of many poses is worth: without the slower engines of `auto`."""
    return problem.with_settings(method="lm") if problem.settings.method == "auto" else problem

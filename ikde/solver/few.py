"""So few targets that preparing lanes takes longer than they save: a call each, one after the other.

Ten poses of qiao2021 take 90 us, where lanes take 160; from 40 on lanes are faster. Until those are compiled, for
half a minute, a thousand are answered so, in plain Python (2 ms each) or by the machine code of one target.
"""

import time
from collections.abc import Sequence
from functools import lru_cache, partial

import numpy as np

from ikde.kernels.answer import BLOCKED, FIRST_COUNT, METRICS, PAIR, SCORE, size_of
from ikde.kernels.arrays import REACHED
from ikde.model.target import KINDS, Targets
from ikde.solver.background import MANY, Question, answers_plainly
from ikde.solver.engine_table import ENGINES, NAMES
from ikde.solver.engines.lm import pack_answer, prepare
from ikde.solver.engines.pool import load_kernels, runs_on_tables
from ikde.solver.engines.search_state import SearchState
from ikde.solver.problem import Problem
from ikde.solver.way import Way, as_word

FEW, FEW_WITHOUT_LANES = 32, 1000
ENGINE = "lm"


def answer_few(
    problem: Problem, targets: Targets, found: SearchState, budget: int, *, seed: int, streams: Sequence[int]
) -> int:
    """Fill `found` with what the engine `lm` finds, graded: the attempts that each target has had, reached or not.

    0, and nothing is filled, if they are too many, or the grader refuses one. `budget`: attempts of the engine. The
    bits are those of lanes and `referee`.
    """
    if problem.near is not None or problem.settings.timeout_s is not None or runs_on_tables():
        return 0
    kinds = targets.kind.tolist()
    if len(kinds) > FEW and (len(kinds) > FEW_WITHOUT_LANES or _has_lanes(problem, kinds)):
        return 0
    rows = np.empty((len(targets), size_of(found.q.shape[1], len(problem.collision.pairs))))
    attempts = min(ENGINES[ENGINE].attempts_before_proof, budget)
    ways = {kind: find_answer(problem, KINDS[kind]) for kind in {*kinds}}
    calls = {kind: partial(way.machine, *begin.args) if way.machine else begin for kind, (way, begin) in ways.items()}
    word = as_word(seed)
    began, accepted = time.perf_counter(), []
    for row, T_world_tool, stream, kind in zip(rows, targets.T_world_tool, streams, kinds, strict=True):
        accepted.append(calls[kind](T_world_tool, word, stream, 0, attempts, row))
    waited_s = sum(way.take_waited_s()[0] for way, _ in ways.values())
    whole = rows[:, found.q.shape[1] + METRICS :].view(np.int64)
    if not all(accepted) and (whole[:, FIRST_COUNT + REACHED].astype(bool) & ~np.array(accepted, dtype=bool)).any():
        return 0
    found.seconds[:] = (time.perf_counter() - began - waited_s) / max(1, len(targets))
    found.engine[:] = NAMES.index(ENGINE)
    _unpack(rows, found)
    found.metrics.accepted[:] = accepted
    return attempts


def _has_lanes(problem: Problem, kinds: Sequence[int]) -> bool:
    """Whether machine code of lanes is loaded, kept or to be waited for; else a child is asked to compile it."""
    for kind in map(KINDS.__getitem__, {*kinds}):
        kernels, _, ready = prepare(problem, kind)
        question = Question(problem.collision, kind, MANY)
        if False not in ready and answers_plainly(kernels.solve_targets.bind(), question):
            return False
    return True


@lru_cache(maxsize=16)
def find_answer(problem: Problem, kind: str) -> tuple[Way, partial[bool]]:
    """The way of a problem and a kind of target, and how a call of it begins while there is no machine code."""
    way = Way(load_kernels(problem.collision, kind).answer_target, Question(problem.collision, kind))
    return way, partial(way.begin, *pack_answer(problem, kind))


def _unpack(rows: np.ndarray, found: SearchState) -> None:
    """Rows of numbers (`kernels/answer.py`) as columns."""
    joints, metrics = found.q.shape[1], found.metrics
    whole, score = rows[:, joints + METRICS :].view(np.int64), joints + METRICS + SCORE
    found.q[:], found.score[:], found.counts[:] = (
        rows[:, :joints],
        rows[:, score : score + 2],
        whole[:, FIRST_COUNT:SCORE],
    )
    for place, column in enumerate((metrics.position_error_m, metrics.orientation_error_rad, metrics.clearance_m)):
        column[:] = rows[:, joints + place]
    metrics.closest_pair[:] = whole[:, PAIR]
    found.pair_counts.filled[: len(rows)] = whole[:, BLOCKED:]

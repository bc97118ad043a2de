"""So few targets that preparing lanes takes longer than they save: a compiled call each, one after the other.

Ten poses of qiao2021 take 90 us, where lanes take 160; from 40 on lanes are faster.
"""

import time
from collections.abc import Callable, Sequence
from functools import lru_cache, partial

import numpy as np

from ikde.kernels.answer import BLOCKED, FIRST_COUNT, METRICS, PAIR, SCORE, size_of
from ikde.kernels.arrays import COLLIDING
from ikde.model.target import KINDS, Targets
from ikde.solver.engine_table import ENGINES, NAMES
from ikde.solver.engines.lm import pack_answer
from ikde.solver.engines.pool import load_kernels, runs_on_tables
from ikde.solver.engines.search_state import SearchState
from ikde.solver.problem import Problem

FEW = 32
ENGINE = "lm"
HALF_WORDS = 2**63


def answer_few(
    problem: Problem, targets: Targets, found: SearchState, budget: int, *, seed: int, streams: Sequence[int]
) -> bool:
    """Fill `found` with what the engine `lm` finds, graded; False, and nothing is filled, unless it reaches them all.

    `budget`: attempts of the engine. The bits are those of lanes and `referee`.
    """
    if len(targets) > FEW or problem.near is not None or problem.settings.timeout_s is not None or runs_on_tables():
        return False
    rows = np.empty((len(targets), size_of(found.q.shape[1], len(problem.collision.pairs))))
    attempts = min(ENGINES[ENGINE].attempts_before_proof, budget)
    answers = [find_answer(problem, KINDS[kind]) for kind in targets.kind.tolist()]
    word = seed if seed < HALF_WORDS else seed - 2 * HALF_WORDS
    began = time.perf_counter()
    with np.errstate(all="ignore"):  # plain Python warns of words that wrap around
        for row, T_world_tool, stream, answer in zip(rows, targets.T_world_tool, streams, answers, strict=True):
            if not answer(T_world_tool, word, stream, 0, attempts, row):
                return False
    found.seconds[:] = (time.perf_counter() - began) / max(1, len(targets))
    found.engine[:] = NAMES.index(ENGINE)
    _unpack(rows, found)
    return True


@lru_cache(maxsize=16)
def find_answer(problem: Problem, kind: str) -> Callable[..., bool]:
    """`answer_target` for a problem and a kind of target, compiled or loaded."""
    answer = partial(load_kernels(problem.collision, kind).answer_target.compiled, *pack_answer(problem, kind))
    row = np.zeros(size_of(len(problem.lower), len(problem.collision.pairs)))
    T_world_tool = np.eye(4)[:3].copy()
    T_world_tool.setflags(write=False)
    with np.errstate(all="ignore"):
        answer(T_world_tool, 0, 0, 0, 1, row)  # no clock counts it
    return answer


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
    metrics.closest_pair[:], metrics.accepted[:] = whole[:, PAIR], True
    colliding = found.counts[:, COLLIDING].nonzero()[0]
    if len(colliding):
        found.pair_counts.filled[: len(rows)] = whole[:, BLOCKED:]
        found.pair_counts.keep(0, colliding)
    found.pair_counts.drop_filled()

"""One compiled call says what a search and a grader say one after the other."""

import numpy as np
import pytest

import ikde
from ikde.kernels.answer import BLOCKED, FIRST_COUNT, METRICS, PAIR, SCORE, open_row, pack_row, size_of
from ikde.kernels.arrays import COUNTS, REACHED
from ikde.kernels.flat_arguments import flatten_answer
from ikde.kernels.grade_one import grade_one
from ikde.kernels.jit import kernel
from ikde.kernels.lm import answer_target, solve_target
from ikde.model.pack import pack_targets
from ikde.model.target import KINDS
from ikde.solver.engines.lm import pack_block
from ikde.solver.metrics import pack_grader
from tests.problems import problem_of
from tests.targets import free_q, make_target


@kernel
def open_and_fill(joints, first, out):
    """What stands in a row's parts after they were filled, or cleared."""
    q, score, counts, blocked = open_row(joints, first, out)
    seen = score[0], counts[0], blocked[0]
    q[:], score[:], counts[:], blocked[:] = 1.5, 2.5, 3, 4
    return seen


def test_a_row_is_cleared_when_a_search_begins_and_kept_when_it_goes_on():
    row = np.full(size_of(3, 2), np.nan)
    assert open_and_fill(3, 0, row) == (np.inf, 0, 0)
    assert open_and_fill(3, 5, row) == (2.5, 3, 4)
    assert (row[:3] == 1.5).all()
    whole = row[3 + METRICS :].view(np.int64)
    assert whole[FIRST_COUNT : FIRST_COUNT + COUNTS].tolist() == [3] * COUNTS
    assert whole[BLOCKED:].tolist() == [4, 4]
    assert row[3 + METRICS + SCORE :][:2].tolist() == [2.5, 2.5]


def test_a_packed_row_holds_its_parts():
    row = pack_row(np.arange(3.0), (0.1, 0.2, 0.3), 7, np.arange(COUNTS), np.array([5, 6]))
    whole = row[3 + METRICS :].view(np.int64)
    assert row[: 3 + METRICS].tolist() == [0.0, 1.0, 2.0, 0.1, 0.2, 0.3]
    assert (whole[PAIR], whole[FIRST_COUNT:SCORE].tolist(), whole[BLOCKED:].tolist()) == (7, [0, 1, 2, 3, 4], [5, 6])


@pytest.mark.parametrize("kind", KINDS)
def test_the_call_gives_the_bits_of_search_and_grader_one_after_the_other(qiao, rng, kind):
    problem = problem_of(qiao, ikde.SolveSettings())
    *search, pool, pool_T = pack_block(problem, kind)
    grader, pairs = pack_grader(problem.collision, problem.settings), len(problem.collision.pairs)
    block = flatten_answer(search, grader, KINDS.index(kind), problem.turns)
    for stream in range(4):
        target = make_target(qiao, free_q(qiao, rng), kind)
        row, packed = np.empty(size_of(9, pairs)), pack_targets([target])
        accepted = answer_target.bind(*block, pool, pool_T).plain(target.T_world_tool, 3, stream, 0, 20, row)
        q, score, counts, blocked = (
            np.empty(9),
            np.full(2, np.inf),
            np.zeros(COUNTS, np.int64),
            np.zeros(pairs, np.int64),
        )
        question = (*packed, 0, np.uint64(3), stream, 0, 20)
        solve_target.bind(*search, pool, pool_T).plain(*question, q, score, counts, blocked)
        *metrics, pair, verdict = grade_one.bind(*grader).plain(*packed, q)
        expected = pack_row(q, metrics, pair, counts, blocked)
        expected[9 + METRICS + SCORE :][:2] = score
        assert row.tobytes() == expected.tobytes()
        assert accepted == (verdict and counts[REACHED] == 1)

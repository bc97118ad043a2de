"""What engines fill."""

import numpy as np

from ikde.solver.engines.search_state import keep_pairs, make_search_state
from tests.problems import problem_of


def test_nothing_is_found_at_first(qiao):
    found = make_search_state(problem_of(qiao), 3)
    assert found.q.shape == (3, 9)
    assert np.isinf(found.score).all()
    assert not found.counts.any()
    assert [found.pair_counts.row(row).tolist() for row in range(3)] == [[0] * 35] * 3


def test_a_row_is_one_targets_share(qiao):
    found = make_search_state(problem_of(qiao), 3)
    found.counts[1, 2], found.q[1] = 7, 0.5
    assert found.row(1).counts.tolist() == [[0, 0, 7, 0, 0]]
    assert (found.row(1).q == 0.5).all()


def test_pairs_counted_piece_by_piece_are_those_of_all_rows(qiao, rng):
    counts = rng.integers(1, 9, (10, 35)) * (rng.random((10, 35)) < 0.1)
    counts[[0, 4, 7]] = 0
    found = make_search_state(problem_of(qiao), 10, 4)
    for first in (0, 4, 8):
        piece = found.piece(slice(first, first + 4))
        filled = piece.pair_counts.filled
        assert filled.shape == (4, 35)
        assert not filled.any()
        filled[: len(piece.q)] += counts[first : first + 4]
        found.pair_counts.keep(first, np.flatnonzero(counts[first : first + 4].any(axis=1)))
    found.pair_counts.drop_filled()
    for row in range(10):
        assert found.pair_counts.row(row).tolist() == counts[row].tolist()
        assert found.row(row).pair_counts.row(0).tolist() == counts[row].tolist()
        assert keep_pairs(counts).row(row).tolist() == counts[row].tolist()


def test_a_piece_shows_the_rows_themselves(qiao):
    found = make_search_state(problem_of(qiao), 5)
    piece = found.piece(slice(2, 4))
    piece.q[1], piece.metrics.accepted[0], piece.counts[0, 1] = 0.5, True, 3
    assert (found.q[3] == 0.5).all()
    assert found.metrics.accepted.tolist() == [False, False, True, False, False]
    assert found.counts[:, 1].tolist() == [0, 0, 3, 0, 0]

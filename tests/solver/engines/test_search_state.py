"""What engines fill."""

import numpy as np

from ikde.solver.engines.search_state import make_search_state
from tests.problems import problem_of


def test_nothing_is_found_at_first(qiao):
    found = make_search_state(problem_of(qiao), 3)
    assert found.q.shape == (3, 9)
    assert np.isinf(found.score).all()
    assert not found.counts.any()
    assert found.pair_counts.shape == (3, 35)


def test_a_row_is_one_targets_share(qiao):
    found = make_search_state(problem_of(qiao), 3)
    found.counts[1, 2], found.q[1] = 7, 0.5
    assert found.row(1).counts.tolist() == [[0, 0, 7, 0, 0]]
    assert (found.row(1).q == 0.5).all()

"""Candidates that cover all patches."""

import numpy as np

from ikde.spheres.greedy import cover_greedily, drop_needless


def rows(*lists: list[int]) -> list[np.ndarray]:
    return [np.array(row, dtype=np.int64) for row in lists]


def test_the_one_that_covers_most_comes_first_and_what_adds_nothing_never() -> None:
    assert cover_greedily(rows([0, 1], [1, 2, 3], [2, 3], [0]), 4) == [1, 0]


def test_gains_count_what_is_left() -> None:
    assert cover_greedily(rows([0, 1, 2, 3], [1, 2, 3], [4, 5], [3]), 6) == [0, 2]


def test_of_equals_the_first_is_taken() -> None:
    assert cover_greedily(rows([0, 1], [0, 1]), 2) == [0]


def test_patches_that_no_row_holds_are_left() -> None:
    assert cover_greedily(rows([0], []), 3) == [0]


def test_what_others_cover_is_dropped_in_the_end() -> None:
    covers = rows([1, 2, 3, 4], [0, 1, 2], [3, 4, 5], [6])
    chosen = cover_greedily(covers, 7)
    assert sorted(chosen) == [0, 1, 2, 3]
    assert sorted(drop_needless(covers, chosen, 7)) == [1, 2, 3]


def test_of_two_that_cover_each_other_one_stays() -> None:
    assert drop_needless(rows([0, 1], [0, 1]), [0, 1], 2) == [1]

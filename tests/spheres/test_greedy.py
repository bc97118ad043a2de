"""Candidates that cover all patches, and few of them."""

import numpy as np

from ikde.spheres.greedy import cover_greedily, improve


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


def test_an_exchange_finds_what_the_greedy_missed() -> None:
    covers = rows([*range(10)], [*range(10, 20)], [*range(4, 16)])
    chosen = cover_greedily(covers, 20)
    assert len(chosen) == 3
    assert sorted(improve(covers, chosen, np.eye(3), 10**7)) == [0, 1]


def test_nothing_is_bare_after_exchanges_and_they_are_the_same_every_time() -> None:
    draw = np.random.default_rng(3)
    centres, points = draw.random((300, 3)), draw.random((200, 3))
    covers = [np.flatnonzero(np.linalg.norm(points - centre, axis=1) < 0.35) for centre in centres]
    chosen = cover_greedily(covers, 200)
    better = improve(covers, chosen, centres, 10**7)
    assert len(better) < len(chosen)
    assert set(np.concatenate([covers[i] for i in better])) == set(np.concatenate(covers))
    assert better == improve(covers, chosen, centres, 10**7)


def test_without_work_nothing_is_exchanged() -> None:
    covers = rows([0, 1], [1, 2], [0, 2])
    assert improve(covers, [0, 1, 2], np.eye(3), 0) == [0, 1, 2]

"""Few candidates that cover all patches, chosen greedily."""

import heapq

import numpy as np

from ikde.kernels.arrays import Ints


def cover_greedily(covers: list[Ints], count: int) -> list[int]:
    """Rows of `covers` that together hold all of `count` patches that any row holds.

    Always the one that covers most of what is left; gains are brought up to date when they reach the top of the heap.
    """
    left = np.ones(count, dtype=np.bool_)
    heap = [(-len(row), index) for index, row in enumerate(covers) if len(row)]
    heapq.heapify(heap)
    chosen: list[int] = []
    while heap and left.any():
        _, index = heapq.heappop(heap)
        gain = int(left[covers[index]].sum())
        if gain and heap and gain < -heap[0][0]:
            heapq.heappush(heap, (-gain, index))
        elif gain:
            chosen.append(index)
            left[covers[index]] = False
    return chosen


def drop_needless(covers: list[Ints], chosen: list[int], count: int) -> list[int]:
    """Those that are chosen, without those whose patches the others cover; the first chosen go first."""
    times = np.bincount(np.concatenate([covers[index] for index in chosen]), minlength=count)
    kept = []
    for index in chosen:
        if (times[covers[index]] > 1).all():
            times[covers[index]] -= 1
        else:
            kept.append(index)
    return kept

"""Few candidates that cover all patches: chosen greedily, then fewer by exchanging neighbours."""

import heapq

import numpy as np

from ikde.kernels.arrays import Floats, Ints

ROUND = 200_000
"""What an exchange costs beside what it counts, in such counts."""
SHARE = 0.5
"""Rows that hold fewer patches than this share of what the chosen ones hold are not tried."""


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


def improve(covers: list[Ints], chosen: list[int], centres: Floats, work: int) -> list[int]:
    """A cover with as few rows or fewer: over and over some neighbours are taken out, and what is bare covered anew.

    The draws are the same every time, and it ends after `work` steps of counting, whatever the clock says.

    Args:
        covers: the patches that each row holds.
        chosen: rows that hold them all.
        centres: [M, 3] of the rows' spheres.
        work: numbers read, at most; 1e9 take 2 to 3 s.
    """
    state = _Exchange(covers, chosen, work)
    draw = np.random.Generator(np.random.PCG64(0))
    while state.work > 0 and len(state.chosen) > 1:
        around = centres[state.chosen[int(draw.integers(len(state.chosen)))]]
        away = ((centres[state.chosen] - around) ** 2).sum(axis=1)
        some = np.argsort(away, kind="stable")[: int(draw.integers(2, 6))]
        state.exchange([state.chosen[i] for i in some], draw)
    return state.chosen


class _Exchange:
    """A cover under change: which rows are in it, and how often each patch is covered."""

    def __init__(self, covers: list[Ints], chosen: list[int], work: int) -> None:
        self.covers, self.chosen, self.work = covers, list(chosen), work
        least = SHARE * np.median([len(covers[i]) for i in chosen])
        large = sorted({*(i for i, row in enumerate(covers) if len(row) >= least), *chosen})
        patches = np.concatenate([covers[i] for i in large])
        rows = np.repeat(large, [len(covers[i]) for i in large])
        ends = np.cumsum(np.bincount(patches))
        self.holders = np.split(rows[np.argsort(patches, kind="stable")], ends[:-1])
        self.is_held = np.zeros(len(ends), dtype=np.bool_)
        self.times = np.bincount(np.concatenate([covers[i] for i in chosen]), minlength=len(ends))

    def exchange(self, out: list[int], draw: np.random.Generator) -> None:
        """Take some rows out for no more others, if that leaves nothing bare."""
        self.work -= ROUND
        found = self._cover(self._bare_without(out), len(out), draw)
        if found is None:
            return
        for index in out:
            self.times[self.covers[index]] -= 1
            self.chosen.remove(index)
        for index in found:
            self.times[self.covers[index]] += 1
            self.chosen.append(index)

    def _bare_without(self, out: list[int]) -> Ints:
        patches, times = np.unique(np.concatenate([self.covers[i] for i in out]), return_counts=True)
        return patches[self.times[patches] == times]

    def _cover(self, bare: Ints, most: int, draw: np.random.Generator) -> list[int] | None:
        """At most so many rows that hold what is bare: greedily, with gains a little off; or None."""
        found: list[int] = []
        while len(bare):
            if len(found) == most:
                return None
            holders = np.concatenate([self.holders[patch] for patch in bare])
            self.work -= len(holders)
            gains = np.bincount(holders)
            best = int((gains * (1.0 + 0.1 * draw.random(len(gains)))).argmax())
            found.append(best)
            self.is_held[self.covers[best]] = True
            bare = bare[~self.is_held[bare]]
            self.is_held[self.covers[best]] = False
        return found

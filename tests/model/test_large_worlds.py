"""Caches are emptied before clouds fill the memory, and not for worlds of solids."""

from functools import lru_cache

from ikde.model import large_worlds as module
from ikde.model.large_worlds import Kept


def test_caches_are_emptied_when_too_many_points_were_packed(monkeypatch):
    monkeypatch.setattr(module, "MAX_POINTS", 100)
    kept, made = Kept(), []

    @kept.add
    @lru_cache
    def make(name):
        made.append(name)

    for points, again in ((60, ["a"]), (40, ["a"]), (0, ["a"]), (1, ["a", "a"]), (99, ["a", "a"]), (500, ["a"] * 3)):
        kept.note(points)
        make("a")
        assert made == again

"""What is made of each obstacle of a world, kept for the next world."""

from collections.abc import Callable
from typing import Generic, TypeVar

from ikde.model.world import Obstacle

FEW = 4  # obstacles that may have moved, before they are looked up: they may stand in another order
Found = TypeVar("Found")


class PerObstacle(Generic[Found]):
    """What is made of each obstacle of a world, kept for the next one: where one has moved, only that is made anew."""

    def __init__(self, make: Callable[[Obstacle], Found]) -> None:
        self._make = make
        self._last: tuple[tuple[Obstacle, ...], list[Found]] = ((), [])

    def list(self, obstacles: tuple[Obstacle, ...]) -> list[Found]:
        """Of each obstacle, in their order."""
        make, (before, found) = self._make, self._last
        changed = find_changed(before, obstacles)
        if changed is None or len(changed) > FEW:
            kept = {id(old): part for old, part in zip(before, found, strict=True)}
            made = [kept[id(obstacle)] if id(obstacle) in kept else make(obstacle) for obstacle in obstacles]
        else:
            made = found.copy()
            for place in changed:
                made[place] = make(obstacles[place])
        self._last = obstacles, made
        return made


def find_changed(before: tuple[Obstacle, ...], after: tuple[Obstacle, ...]) -> list[int] | None:
    """Places at which another object stands than before; None if there are fewer or more of them."""
    if len(before) != len(after):
        return None
    return [place for place, (old, new) in enumerate(zip(before, after, strict=True)) if old is not new]

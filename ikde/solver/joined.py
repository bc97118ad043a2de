"""A world behind what is laid out for a robot: a large one is not copied again for the next question in it.

Blocks (`kernels/flat_arguments.py`) end with the world. Of a cloud of a million points a copy takes 20 ms, most of it
to get the memory; what stands before it, a hundredth of that, changes from question to question.
"""

import weakref

import numpy as np

from ikde.kernels.arrays import CollisionArrays, Floats, Ints

LARGE = 100_000
"""Numbers of a world from which on its copies are used again."""
SIZE = 6  # where the size of the world stands among those of a model
EMPTY = np.empty(0)


class Joins:
    """Arrays that end with a world, and are taken again once nothing holds them."""

    def __init__(self) -> None:
        self._free: dict[int, tuple[weakref.ref[Floats], dict[int, list[Floats]]]] = {}

    def join(self, head: Floats, world: Floats) -> Floats:
        """A new array, or one that was given before and is held no more, with both, one after the other."""
        if len(world) < LARGE or world.flags.writeable:
            return np.concatenate([head, world])
        key, free = id(world), self._free
        known = free.get(key)
        if known is None or known[0]() is not world:
            known = free[key] = weakref.ref(world, lambda _: free.pop(key, None)), {}
        left = known[1].setdefault(len(head), [])
        try:
            whole = left.pop()
        except IndexError:
            whole = np.concatenate([head, world])
        whole[: len(head)] = head
        taken = whole[:]
        weakref.finalize(taken, left.append, whole).atexit = False
        return taken

    def __len__(self) -> int:
        return len(self._free)


JOINS = Joins()


def is_large(collision: CollisionArrays) -> bool:
    """Whether what ends with this world is better not kept: it is made in no time from what was held before."""
    return len(collision.world) >= LARGE


def without_world(collision: CollisionArrays) -> CollisionArrays:
    """The same tables with an empty world."""
    return collision._replace(world=EMPTY)


def append_world(numbers: Floats, whole: Ints, model: int, world: Floats) -> tuple[Floats, Ints]:
    """A block of a model `without_world`, whose whole numbers begin at `model`, with one."""
    if not len(world):
        return numbers, whole
    whole[model + SIZE] = len(world)
    return JOINS.join(numbers, world), whole


def cut_world(numbers: Floats, whole: Ints) -> tuple[Floats, Ints]:
    """The block of a grader (`flatten_grader`) without its world: a copy, as a view does not hold what was joined."""
    other = whole.copy()
    other[SIZE] = 0
    return numbers[: len(numbers) - int(whole[SIZE])].copy(), other


def join_answer(numbers: Floats, whole: Ints, world: Floats) -> tuple[Floats, Ints]:
    """The block of `flatten_answer` without a world, with one."""
    if not len(world):
        return numbers, whole
    whole[whole[3] + SIZE] = whole[whole[-1] + SIZE] = len(world)
    return JOINS.join(numbers, world), whole

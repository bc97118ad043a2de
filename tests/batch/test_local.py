"""Whole parts on a pool of threads: in order, the same bytes, few at a time, and stopped when nobody waits any more."""

import threading
import time
from concurrent.futures import ThreadPoolExecutor

import pytest

from ikde.batch import local as module
from ikde.batch.local import AHEAD, solve_parts
from ikde.batch.parts import list_parts
from ikde.batch.task import solve_task
from ikde.errors import InputError
from tests.batch.small import BLINK, make_arm, make_batch
from tests.substitutes import never

ENDLESS = {"restarts": 10**6, "generations": 20, "population": 20, "position_tolerance_m": 1e-12}
ARMS = (make_arm("free", detector="none", **BLINK), make_arm("careful", **BLINK))


@pytest.fixture(scope="module")
def batch():
    return make_batch(arms=ARMS)


def parts_of(batch):
    return list(list_parts([arm.name for arm in batch.arms], batch.solves, batch.chunk))


def solve(batch, parts, threads):
    return [(sealed.part, sealed.solutions.to_pybytes()) for sealed in solve_parts(batch, parts, threads)]


class Watch:
    """Stands in for `solve_task`: counts parts that are under way or waiting to be taken."""

    def __init__(self, substitute, delay=0.0, broken=()):
        self.honest, self.delay, self.broken = solve_task, delay, broken
        self.begun, self.inside, self.warmed, self.lock = [], {}, [], threading.Lock()
        self.is_warming, self.warm_up = False, module._warm_up
        substitute(solve_task, self)
        substitute(module._warm_up, self.watch_warm_up)

    def watch_warm_up(self, *arguments):
        self.is_warming = True
        self.warm_up(*arguments)
        self.is_warming = False

    def __call__(self, task, threads):
        part = task.part
        if self.is_warming:
            self.warmed.append((part.arm, part.first, task.explain))
            return self.honest(task, threads)
        with self.lock:
            self.begun.append(part)
            self.inside[part] = threads
        if part in self.broken:
            raise InputError(f"part {part.number} of {part.arm} is broken")
        time.sleep(self.delay * (part.number % 3))
        return self.honest(task, 1)


@pytest.mark.parametrize("threads", [2, 3, 16, None])
def test_threads_change_neither_bytes_nor_order(batch, threads):
    parts = parts_of(batch)
    expected = solve(batch, parts, 1)
    assert [part for part, _ in expected] == parts
    assert solve(batch, parts, threads) == expected


def test_parts_come_in_order_even_if_they_end_in_another(batch, substitute):
    Watch(substitute, delay=0.02)
    parts = parts_of(batch)
    assert [sealed.part for sealed in solve_parts(batch, parts, 3)] == parts


@pytest.mark.parametrize("threads", [2, 3])
def test_few_parts_are_under_way_at_a_time(batch, substitute, threads):
    watch, parts = Watch(substitute), parts_of(batch)
    for taken, _ in enumerate(solve_parts(batch, parts, threads), 1):
        time.sleep(0.02)  # a slow disk
        assert len(watch.begun) - taken <= threads + AHEAD


def test_the_last_few_parts_share_all_threads(batch, substitute):
    watch, parts = Watch(substitute), parts_of(batch)
    list(solve_parts(batch, parts, 4))
    assert [watch.inside[part] for part in parts] == [1, 1, 1, 1, 1, 1, 1, 1, 2, 4]


@pytest.mark.parametrize(("threads", "count"), [(1, 4), (2, 1), (2, 0)])
def test_one_thread_or_one_part_needs_no_pool(batch, substitute, threads, count):
    substitute(ThreadPoolExecutor, never)
    parts = parts_of(batch)[:count]
    assert [sealed.part for sealed in solve_parts(batch, parts, threads)] == parts


def test_what_goes_wrong_is_raised_where_its_part_would_come(batch, substitute):
    parts = parts_of(batch)
    Watch(substitute, broken=parts[4:])
    answers = solve_parts(batch, parts, 2)
    assert [next(answers).part for _ in range(4)] == parts[:4]
    with pytest.raises(InputError, match="part 4 of free is broken"):
        next(answers)


def test_when_nobody_takes_parts_any_more_searches_stop(monkeypatch, substitute):
    batch = make_batch(arms=(make_arm("endless", **ENDLESS),))
    watch, parts = Watch(substitute), parts_of(batch)
    substitute(module._warm_up, lambda *arguments: None)

    def interrupted(future):
        while len(watch.begun) < 2:
            time.sleep(0.01)
        raise KeyboardInterrupt

    monkeypatch.setattr(module.Future, "result", interrupted)
    with pytest.raises(KeyboardInterrupt):
        next(solve_parts(batch, parts, 2))  # comes back only when all threads have ended
    assert len(watch.begun) == 2


def test_each_arm_is_compiled_first(batch, substitute):
    watch, parts = Watch(substitute), parts_of(batch)
    list(solve_parts(batch, parts[3:], 2))
    assert sorted(watch.warmed) == [("careful", 0, False), ("free", 15, False)]

"""Whole parts on a pool of threads: in order, the same bytes, few at a time, and stopped when nobody waits any more."""

import threading
import time
from concurrent.futures import ThreadPoolExecutor

import pyarrow as pa
import pyarrow.parquet as pq
import pytest

import ikde
from ikde.batch import local as module
from ikde.batch.local import AHEAD, SPAN_PARTS, SPAN_SECONDS, SPAN_SOLVES, Spans, solve_parts
from ikde.batch.parts import list_parts
from ikde.batch.sources import ListSource
from ikde.batch.task import solve_task
from ikde.errors import InputError
from tests.batch.small import BLINK, FAR, ROBOT, make_arm, make_batch, make_targets
from tests.substitutes import never

ENDLESS = {"restarts": 10**6, "generations": 20, "population": 20, "position_tolerance_m": 1e-12}
ARMS = (make_arm("free", detector="none", **BLINK), make_arm("careful", **BLINK))


@pytest.fixture(scope="module")
def batch():
    return make_batch(arms=ARMS)


def parts_of(batch):
    return list(list_parts([arm.name for arm in batch.arms], batch.solves, batch.chunk))


def finish(batch, parts, threads):
    """One part after another."""
    for together in solve_parts(batch, parts, threads):
        yield from together


def solve(batch, parts, threads):
    return [(one.part, one.sealed.solutions.to_pybytes()) for one in finish(batch, parts, threads)]


class Watch:
    """Stands in for `solve_task`: counts parts that are under way or waiting to be taken."""

    def __init__(self, substitute, delay=0.0, broken=()):
        self.honest, self.delay, self.broken = solve_task, delay, broken
        self.begun, self.inside, self.warmed, self.lock = [], {}, [], threading.Lock()
        self.names = set()
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
            self.names.add(threading.current_thread().name)
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


@pytest.mark.parametrize("threads", [1, 3])
def test_what_is_solved_together_changes_no_byte(substitute, monkeypatch, threads):
    points = [*make_targets(5), ikde.Target(FAR), *make_targets(4), ikde.Target(FAR), ikde.Target((0.0, 0.0, 3.0))]
    source = ListSource(targets=points, names=tuple(f"t{k // 2}" for k in range(len(points))))
    arm, graders = make_arm("a", position_tolerance_m=0.05, restarts=2), (ROBOT.detectors["typical"],)
    batch = make_batch(arms=(arm,), source=source, repeats=3, chunk=2, graders=graders, explain=True)
    parts = parts_of(batch)
    alone = [one for part in parts for one in solve(batch, [part], 1)]
    monkeypatch.setattr(module, "SHARES", 0.25)
    watch = Watch(substitute)
    assert solve(batch, parts, threads) == alone
    assert max(part.rows for part in watch.begun) > 2
    words = [
        pq.read_table(pa.BufferReader(data))["reason"].combine_chunks().dictionary.to_pylist() for _, data in alone
    ]
    assert len(set(map(str, words))) > 2  # parts have words of their own


def test_parts_come_in_order_even_if_they_end_in_another(batch, substitute):
    Watch(substitute, delay=0.02)
    parts = parts_of(batch)
    assert [one.part for one in finish(batch, parts, 3)] == parts


@pytest.mark.parametrize("threads", [2, 3])
def test_few_parts_are_under_way_at_a_time(batch, substitute, threads):
    watch, parts = Watch(substitute), parts_of(batch)
    for taken, _ in enumerate(finish(batch, parts, threads), 1):
        time.sleep(0.02)  # a slow disk
        assert len(watch.begun) - taken <= threads + AHEAD


def test_the_last_few_parts_share_all_threads(batch, substitute):
    watch, parts = Watch(substitute), parts_of(batch)
    list(solve_parts(batch, parts, 4))
    assert [watch.inside[part] for part in parts] == [1, 1, 1, 1, 1, 1, 1, 1, 2, 4]


@pytest.mark.parametrize(("threads", "count"), [(1, 1), (2, 1), (2, 0)])
def test_one_part_needs_no_pool(batch, substitute, threads, count):
    substitute(ThreadPoolExecutor, never)
    parts = parts_of(batch)[:count]
    assert [one.part for one in finish(batch, parts, threads)] == parts


def test_one_thread_solves_while_what_it_has_solved_is_written(batch, substitute):
    watch, parts = Watch(substitute), parts_of(batch)
    answers = finish(batch, parts, 1)
    next(answers)
    while len(watch.begun) < 2:  # though nobody asks for it yet
        time.sleep(0.001)
    assert [one.part for one in answers] == parts[1:]
    assert watch.begun == parts
    assert len(watch.names - {threading.current_thread().name}) == 1


def test_what_goes_wrong_is_raised_where_its_part_would_come(batch, substitute):
    parts = parts_of(batch)
    Watch(substitute, broken=parts[4:])
    answers = finish(batch, parts, 2)
    assert [next(answers).part for _ in range(4)] == parts[:4]
    with pytest.raises(InputError, match="part 4 of free is broken"):
        next(answers)


def test_when_no_more_parts_are_taken_searches_stop(monkeypatch, substitute):
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


FIFTY = list(list_parts(["a", "b"], 500, 20))


@pytest.mark.parametrize(
    ("seconds", "threads", "sizes"),
    [
        (None, 1, [1, 1, 1]),  # nobody knows how long the first takes
        (10.0, 1, [1, 1, 1]),
        (0.5 * SPAN_SECONDS, 1, [2, 2, 2]),
        (0.25 * SPAN_SECONDS, 1, [4, 4, 4]),
        (1e-9, 1, [6, 5, 4]),  # 49 // 8 = 6, 43 // 8 = 5, ...
        (1e-9, 2, [3, 2, 2]),
        (1e-9, 7, [1, 1, 1]),
    ],
)
def test_as_many_parts_are_taken_as_are_soon_solved(seconds, threads, sizes):
    spans = Spans(FIFTY, threads)
    if seconds:
        spans.took(FIFTY[0], seconds)
    taken = [spans.take() for _ in sizes]
    assert [len(span) for span in taken] == sizes
    assert [part for span in taken for part in span] == FIFTY[: sum(sizes)]
    assert spans.left == 50 - sum(sizes)


def test_a_span_has_no_hole_and_one_arm():
    parts = [*FIFTY[:2], *FIFTY[3:5], *FIFTY[23:27]]
    spans = Spans(parts * 20, 1)
    for arm in "ab":
        spans.took(next(part for part in parts if part.arm == arm), 1e-9)
    assert [spans.take() for _ in range(4)] == [FIFTY[:2], FIFTY[3:5], FIFTY[23:25], FIFTY[25:27]]
    assert (FIFTY[0].last, FIFTY[26].first) == (20, 20)
    apart = Spans([FIFTY[0], FIFTY[26]] * 20, 1)
    apart.took(FIFTY[0], 1e-9)
    assert apart.take() == [FIFTY[0]]  # what goes on is another arm's


@pytest.mark.parametrize(("chunk", "most"), [(1, SPAN_PARTS), (SPAN_SOLVES // 3, 3), (SPAN_SOLVES + 1, 1)])
def test_a_span_is_limited_for_memory_and_open_files(chunk, most):
    parts = list(list_parts(["a"], 1000 * chunk, chunk))
    spans = Spans(parts, 1)
    spans.took(parts[0], 1e-9)
    assert len(spans.take()) == most


def test_how_long_an_arm_takes_is_asked_of_its_last_span():
    spans = Spans(FIFTY * 20, 1)
    for seconds in (1e-9, 1e9):
        spans.took(FIFTY[0], seconds)
    assert len(spans.take()) == 1


def test_each_arm_is_compiled_first(batch, substitute):
    watch, parts = Watch(substitute), parts_of(batch)
    list(solve_parts(batch, parts[3:], 2))
    assert sorted(watch.warmed) == [("careful", 0, False), ("free", 15, False)]

"""Searches on other threads end when they are told to, and nobody else's do."""

import threading
import time

import numpy as np
import pytest

import ikde
from ikde.solver.cancellation import get_cancel_check, stoppable
from ikde.solver.search import search
from tests.flat_settings import flat_settings
from tests.problems import problem_of

ENDLESS = flat_settings(restarts=10**6, generations=20, position_tolerance_m=1e-12)
TARGET = ikde.Target((0.8, 0.5, 1.0))


def test_a_brake_holds_where_it_was_taken_and_nowhere_else():
    stop = threading.Event()
    with stoppable(stop):
        inside = get_cancel_check()
        with stoppable(threading.Event()):
            other = get_cancel_check()
    outside = get_cancel_check()
    inside()
    stop.set()
    other()
    outside()
    with pytest.raises(KeyboardInterrupt):
        inside()


@pytest.mark.parametrize("threads", [1, 2])
def test_a_search_on_another_thread_stops(qiao, threads):
    problem, stop, ended = problem_of(qiao, ENDLESS), threading.Event(), []

    def run():
        with stoppable(stop):
            try:
                search(problem, [TARGET] * 3, seed=1, streams=range(3), threads=threads)
            except KeyboardInterrupt:
                ended.append(True)

    thread = threading.Thread(target=run)
    thread.start()
    time.sleep(0.3)
    stop.set()
    thread.join(timeout=60)
    assert ended == [True]


def test_a_search_that_is_not_told_to_stop_is_the_same(qiao):
    settings = flat_settings(population=8, generations=5, restarts=3)
    problem = problem_of(qiao, settings)
    plain = search(problem, [TARGET] * 3, seed=1, streams=range(3))
    with stoppable(threading.Event()):
        watched = search(problem, [TARGET] * 3, seed=1, streams=range(3))
    np.testing.assert_array_equal(plain.q, watched.q)

"""One peer in a process of its own, answering requests over a pipe.

A request is `("prepare", setup, p, R, seconds)`, `("solve", p, R, seconds, slice_s)` or
`("meet", solids, p, R, seconds, rounds)`; it ends when the runner does.
"""

import importlib
import os
import sys
import time
import traceback
from collections.abc import Sequence
from importlib.metadata import version
from multiprocessing.connection import Connection

import numpy as np
from protocol import Answer, Peer, Setup, Solid
from roster import EVERY, Entry

SLOW_S = 0.02
WARM_UP_S, WARM_UP_TIMES = 1.0, 64  # so many targets that what only many need is compiled as well


def main() -> None:
    """Serve the entry of the roster named by its place, over an inherited descriptor."""
    entry, pipe = EVERY[int(sys.argv[1])], Connection(int(sys.argv[2]))
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, sorted(os.sched_getaffinity(0))[-entry.cores :])
    started = time.perf_counter()
    try:
        peer = make_peer(entry)
        versions = {package: version(package) for package in entry.packages}
    except (ImportError, OSError, RuntimeError) as error:
        pipe.send({"missing": f"{type(error).__name__}: {error}"})
        return
    pipe.send({"import_s": time.perf_counter() - started, "versions": versions})
    while True:
        try:
            task, *request = pipe.recv()
        except EOFError:
            return
        if task == "prepare":
            pipe.send(prepare(peer, *request))
        else:
            pipe.send(meet(peer, *request) if task == "meet" else peer.answer(*request))


def make_peer(entry: Entry) -> Peer:
    """Import its adapter."""
    file, kind = entry.adapter.split(":")
    return getattr(importlib.import_module(f"adapters.{file}"), kind)(**entry.options)


def prepare(peer: Peer, setup: Setup, p: np.ndarray, R: np.ndarray, seconds: float) -> dict[str, float | str]:
    """Load the robot and solve what does not count: seconds of loading and of the first target."""
    started = time.perf_counter()
    try:
        peer.prepare(setup)
        prepared = time.perf_counter()
        peer.answer(p[:1], R[:1], seconds, WARM_UP_S)
        first = time.perf_counter()
        peer.answer(np.tile(p, (WARM_UP_TIMES, 1)), np.tile(R, (WARM_UP_TIMES, 1, 1)), seconds, WARM_UP_S)
    except Exception as error:
        traceback.print_exception(error)
        return {"lost": f"{type(error).__name__}: {' '.join(str(error).split())[:200]}"}
    return {"prepare_s": prepared - started, "first_s": first - prepared}


def meet(
    peer: Peer, solids: Sequence[Solid], p: np.ndarray, R: np.ndarray, seconds: float, rounds: int
) -> tuple[float, list[Answer]]:
    """Seconds of loading solids, and answers to a target among them, again and again; slow ones answer once."""
    clock = peer.setup.clock
    started = clock()
    peer.load(solids)
    load_s, answers = clock() - started, []
    for _ in range(rounds):
        answers += peer.answer(p[None], R[None], seconds, seconds)
        if answers[-1][0] > SLOW_S:
            break
    return load_s, answers


if __name__ == "__main__":
    main()

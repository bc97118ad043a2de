"""One peer in a process of its own, answering requests over a pipe; times are taken here, around `solve` alone.

A request is a pickled tuple: `("prepare", setup, p, R, seconds)`, `("solve", p, R, seconds, slice_s)` or `("end",)`.
What libraries print goes to stderr, so that the pipe carries answers only.
"""

import importlib
import os
import pickle
import sys
import time
import traceback
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

FOLDER = Path(__file__).parent
BATCH_WARM_UP = 64  # times the targets that do not count
ADAPTERS = sorted(path.stem for path in (FOLDER / "adapters").glob("*.py") if path.stem != "__init__")


def main() -> None:
    """Serve one peer, named by adapter and index."""
    adapter, index, cores = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, sorted(os.sched_getaffinity(0))[-cores:])
    started = time.perf_counter()
    try:
        module = importlib.import_module(f"adapters.{adapter}")
        peer = module.PEERS[index]()
        versions = peer.versions()
    except (ImportError, OSError, RuntimeError) as error:
        _answer(answers, {"missing": f"{type(error).__name__}: {error}"})
        return
    _answer(answers, {"import_s": time.perf_counter() - started, "versions": versions})
    while True:
        request = pickle.load(sys.stdin.buffer)
        if request[0] == "end":
            return
        _answer(answers, {"prepare": _prepare, "solve": _solve}[request[0]](peer, *request[1:]))


def _answer(pipe: BinaryIO, answer: Any) -> None:
    pickle.dump(answer, pipe)
    pipe.flush()


def _prepare(peer: Any, setup: Any, p: np.ndarray, R: np.ndarray, seconds: float) -> dict[str, float | str]:
    """Load the robot and solve a few targets that do not count: seconds of loading and of the first."""
    if peer.batch:  # as many as later, or what only many need would compile on the clock
        p, R = np.tile(p, (BATCH_WARM_UP, 1)), np.tile(R, (BATCH_WARM_UP, 1, 1))
    started = time.perf_counter()
    try:
        peer.prepare(setup)
        prepared = time.perf_counter()
        count = len(p) if peer.batch else 1
        _solve(peer, p[:count], R[:count], seconds, np.inf)
        first = time.perf_counter()
        _solve(peer, p[1:], R[1:], seconds, seconds)
    except Exception as error:
        traceback.print_exception(error)
        return {"lost": f"{type(error).__name__}: {' '.join(str(error).split())[:200]}"}
    return {"prepare_s": prepared - started, "first_s": first - prepared}


def _solve(
    peer: Any, p: np.ndarray, R: np.ndarray, seconds: float, slice_s: float
) -> list[tuple[float, np.ndarray | None]]:
    """Solve targets one after the other until `slice_s` have passed: seconds and joint values of each."""
    targets = peer.convert_batch(p, R)
    if peer.batch:
        started = time.perf_counter()
        found = peer.solve_batch(targets, started + seconds * len(p))
        share = (time.perf_counter() - started) / len(p)
        return [(share, q) for q in found]
    answers = []
    begun = time.perf_counter()
    for target in targets:
        started = time.perf_counter()
        q = peer.solve(target, started + seconds)
        ended = time.perf_counter()
        answers.append((ended - started, None if q is None else np.array(q, dtype=float)))
        if ended - begun > slice_s:
            break
    return answers


if __name__ == "__main__":
    main()

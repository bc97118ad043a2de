"""Mutated files of every kind through the readers that users call: an answer or one line, in bounded time and memory.

    python benchmarks/fuzz_files.py [count] [--seed 1]

Case k of a seed is the same bytes on every machine. Files are changed as bytes (flipped, cut, repeated, spliced) and as
what they mean: a value of a YAML or JSON file for another, a column of a table for one of another type, an array's
header inside a sound archive. Processes with a limit on their memory read them; one that does not answer in time is
ended and counted. Writes benchmarks/results/fuzz_files.json.
"""

import argparse
import json
import multiprocessing
import os
import resource
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

os.environ.setdefault("IKDE_KERNELS", "tables")

from fuzzer import KINDS, Fuzzer
from machine import describe

from ikde.errors import MAX_LENGTH, InputError

RESULTS = Path(__file__).parent / "results" / "fuzz_files.json"
SECONDS = 30.0  # a file, on a machine that does other things as well
ROOM_MB = 3000  # of address space beyond what a process has before its first file
PAGE_EVERY = 25  # run folders are drawn as a page this often: a page takes a second


def judge(read: Callable[[], None]) -> str:
    """What came of reading a file: an answer, one line, or the name of what escaped."""
    try:
        read()
    except InputError as error:
        text = str(error)
        return "one line" if text.isprintable() and len(text) <= MAX_LENGTH else f"not one line: {text!r:.200}"
    except BaseException as error:
        return f"{type(error).__name__}: {str(error)[:200]!r}"
    return "answer"


def work(pipe: Any, seed: int, folder: str) -> None:
    """Read the cases whose numbers come through the pipe; answer with outcome, seconds and MB at most so far."""
    sys.stdout = open(os.devnull, "w")  # noqa: SIM115, PTH123
    fuzzer = Fuzzer(Path(tempfile.mkdtemp(dir=folder)))
    fuzzer._read_run("manifest", fuzzer.kept[fuzzer.run / "manifest.json"], draw=True)  # all that is loaded late
    in_use = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (in_use + ROOM_MB * 10**6,) * 2)
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    base = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    pipe.send(None)
    while (number := pipe.recv()) is not None:
        kind, data = fuzzer.make(seed, number)
        started = time.perf_counter()
        outcome = judge(lambda: fuzzer.read(kind, data, draw=number // len(KINDS) % PAGE_EVERY == 0))  # noqa: B023
        seconds = time.perf_counter() - started
        pipe.send((kind, outcome, seconds, (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - base) / 1e3))


@contextmanager
def worker(seed: int, folder: str) -> Iterator[tuple[Any, Any]]:
    """A process that reads, and the pipe to it."""
    context = multiprocessing.get_context("spawn")
    ours, theirs = context.Pipe()
    process = context.Process(target=work, args=(theirs, seed, folder), daemon=True)
    process.start()
    theirs.close()
    try:
        ours.recv()
        yield process, ours
    finally:
        process.kill()
        process.join()


def fuzz(count: int, seed: int) -> dict[str, Any]:
    """Counts of outcomes by kind, the slowest file of each, and every case that is neither an answer nor one line."""
    counts: dict[str, Counter[str]] = {}
    slowest: dict[str, float] = {}
    largest_mb, wrong, number = 0.0, [], 0
    with tempfile.TemporaryDirectory() as folder:
        kinds = None
        while number < count:
            with worker(seed, folder) as (process, pipe):
                while number < count:
                    pipe.send(number)
                    kinds = kinds or list(KINDS)
                    kind, outcome, seconds, grown_mb = kinds[number % len(kinds)], "no answer in time", SECONDS, 0.0
                    try:
                        if pipe.poll(SECONDS):
                            kind, outcome, seconds, grown_mb = pipe.recv()
                    except EOFError:
                        process.join()
                        outcome = f"process ended with {process.exitcode}"
                    told = outcome if outcome in ("answer", "one line") else "escaped"
                    counts.setdefault(kind, Counter())[told] += 1
                    slowest[kind], largest_mb = max(seconds, slowest.get(kind, 0.0)), max(largest_mb, grown_mb)
                    number += 1
                    if told == "escaped":
                        wrong.append({"number": number - 1, "kind": kind, "outcome": outcome})
                    if told == "escaped" or seconds > 5.0:
                        print(number - 1, kind, outcome, f"{seconds:.1f} s", flush=True)
                    if outcome.startswith(("no answer", "process")):
                        break
                    if number % 1000 == 0:
                        print(f"{number:,} of {count:,}, {len(wrong)} escaped", flush=True)
    return {
        "files": count,
        "seed": seed,
        "outcomes": {kind: dict(found) for kind, found in counts.items()},
        "escaped": wrong,
        "slowest_s": {kind: round(seconds, 3) for kind, seconds in slowest.items()},
        "largest_growth_mb": round(largest_mb, 1),
        "limits": {"seconds": SECONDS, "room_mb": ROOM_MB},
    }


def main() -> None:
    """Read so many files and record what came of them."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("count", type=int, nargs="?", default=20_000)
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    results = fuzz(given.count, given.seed)
    RESULTS.write_text(json.dumps({"machine": describe(), **results}, indent=1) + "\n", encoding="utf-8")
    for kind, outcomes in results["outcomes"].items():
        print(f"{kind:26} {outcomes}, slowest {results['slowest_s'][kind]} s")


if __name__ == "__main__":
    main()

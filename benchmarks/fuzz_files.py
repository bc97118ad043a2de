"""Mutated files of every kind through the readers that users call: an answer or one line, in bounded time and memory.

    python benchmarks/fuzz_files.py [count] [--seed 1]

Case k of a seed is the same bytes on every machine. Files are changed as bytes (flipped, cut, repeated, spliced) and as
what they mean: a value of a YAML or JSON file for another, a column of a table for one of another type, an array's
header inside a sound archive. Processes with a limit on their memory read them; one that does not answer in time is
ended and counted. Writes benchmarks/results/fuzz_files.json.
"""

import argparse
import io
import json
import multiprocessing
import os
import resource
import shutil
import sys
import tempfile
import time
import zipfile
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from copy import deepcopy
from pathlib import Path
from typing import Any

os.environ.setdefault("IKDE_KERNELS", "tables")

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import yaml
from machine import describe

import ikde
from ikde.batch.parts import serialize
from ikde.batch.summary import summarise
from ikde.errors import LONGEST, InputError
from ikde.io.joint_text import parse_joints
from ikde.report.batch_page.answers import gather_answers
from ikde.report.batch_page.page import make_batch_page
from ikde.report.html import render_html
from ikde.report.markdown import render_markdown

ROOT = Path(__file__).parent.parent
RESULTS = Path(__file__).parent / "results" / "fuzz_files.json"
SECONDS = 30.0  # a file, on a machine that does other things as well
ROOM_MB = 3000  # of address space beyond what a process has before its first file
PAGE_EVERY = 25  # run folders are drawn as a page this often: a page takes a second

WORDS = (
    *(
        "",
        "null",
        "~",
        "true",
        ".nan",
        ".inf",
        "-.inf",
        "0",
        "-0.0",
        "-1",
        "1e308",
        "-1e308",
        "1e-308",
        "1e5",
        "9" * 400,
    ),
    *(
        "0x10",
        "1_000",
        "[]",
        "{}",
        "[[[[",
        "*a",
        "&a [*a]",
        "!!python/object/apply:os.system [x]",
        "!!int x",
        "? a",
        "- ",
        ": ",
    ),
    *(
        "../../../etc/passwd",
        "/dev/zero",
        "x" * 10_000,
        "\x1b[31m",
        "\u202e",
        "\x00",
        "[red]",
        "<script>",
        "$x$",
        "\\",
        "'",
        '"',
    ),
    *(
        "k**k**k",
        "9**9**9**9",
        "(" * 200,
        "sin(" * 200,
        "1/0",
        "k if k else k",
        "none",
        "tool",
        "world",
        "qiao2021",
        "mm",
        "deg",
    ),
)
VALUES = (
    *(None, True, False, 0, -1, 1, 2**63, 10**30, 1e-300, 1e300, 1e5, 1e9, -1e9, float("nan"), float("inf")),
    *("", "x", "x" * 2000, "\x1b[31m", "../../etc/passwd", "none", "world", "tool", "[red]", "9**9**9", "sin(k)"),
    *([], {}, [None], [0.0], [0.0, 0.0, 0.0], [1e9] * 3, [float("nan")] * 3, {"a": {"b": {}}}, [[]] * 50, ["a", "a"]),
)
HEADERS = (
    *(
        "{'descr': '<f8', 'fortran_order': False, 'shape': (10000000000, 3), }",
        "{'descr': '|O', 'shape': (2,)}",
        "{",
        "(" * 500,
    ),
    *(
        "{'descr': '<f8', 'fortran_order': True, 'shape': (3, 12), }",
        "{'descr': [('a', '<f8')], 'fortran_order': 0, 'shape': (1,)}",
    ),
    *(
        "{'descr': '<U1000', 'fortran_order': False, 'shape': (-1,), }",
        "-" * 5000 + "1",
        "{'descr': '<f8', 'shape': 3L}",
    ),
)

Rng = np.random.Generator
Cases = dict[str, Callable[[Rng], bytes]]


def pick(rng: Rng, choices: Any) -> Any:
    """One of them."""
    return choices[int(rng.integers(len(choices)))]


def few(rng: Rng) -> range:
    """So many changes: mostly one, so that what is wrong is deep inside."""
    return range(min(4, int(rng.geometric(0.6))))


def mutate_bytes(rng: Rng, data: bytes) -> bytes:
    """One to four changes to bytes, of which some are words that mean something."""
    for _ in few(rng):
        most = max(1, len(data) // 4) if rng.random() < 0.2 else 8
        at, length = int(rng.integers(len(data) + 1)), int(rng.integers(1, 1 + most))
        change = int(rng.integers(8))
        if change == 0 and at < len(data):
            data = data[:at] + bytes([data[at] ^ (1 << int(rng.integers(8)))]) + data[at + 1 :]
        elif change == 1:
            data = data[:at] + bytes([int(rng.integers(256))]) + data[at + 1 :]
        elif change == 2:
            data = data[:at] + data[at + length :]
        elif change == 3:
            data = data[: at + length] + data[at : at + length] * int(rng.integers(1, 4)) + data[at + length :]
        elif change == 4:
            data = data[:at] if rng.random() < 0.3 else data
        elif change == 5:
            other = int(rng.integers(len(data) + 1))
            data = data[:at] + data[other : other + length] + data[at + length :]
        elif change == 6:
            data = data[:at] + pick(rng, WORDS).encode("utf-8", "surrogatepass") + data[at:]
        else:
            data = data[:at] + bytes(rng.integers(256, size=int(rng.integers(1, 9)), dtype=np.uint8)) + data[at + 8 :]
    return data


def mutate_words(rng: Rng, text: str) -> bytes:
    """Words and lines of a text exchanged, repeated, left out."""
    lines = text.splitlines(keepends=True)
    for _ in few(rng):
        at = int(rng.integers(len(lines)))
        words = lines[at].split(" ")
        change = int(rng.integers(5))
        if change == 0:
            words[int(rng.integers(len(words)))] = pick(rng, WORDS)
            lines[at] = " ".join(words)
        elif change == 1:
            lines.insert(at, pick(rng, lines))
        elif change == 2 and len(lines) > 1:
            del lines[at]
        elif change == 3:
            lines[at] = pick(rng, ("  ", "", "- ", "\t", "&a ", "*a\n")) + lines[at]
        else:
            lines[at] = lines[at].replace(pick(rng, list(",:[]{}#-0123456789")), pick(rng, WORDS), 1)
    return "".join(lines).encode("utf-8", "surrogatepass")


def mutate_value(rng: Rng, data: Any) -> Any:
    """Plain data with one to three values, keys or entries exchanged."""
    data = json.loads(json.dumps(data))
    for _ in few(rng):
        place = data
        while isinstance(place, dict | list) and place:
            keys = list(place) if isinstance(place, dict) else range(len(place))
            key, change = pick(rng, keys), int(rng.integers(12))
            if isinstance(place[key], dict | list) and place[key] and change > 2:
                place = place[key]
                continue
            if change == 0:
                del place[key]
            elif change == 1 and isinstance(place, dict):
                place[pick(rng, ("x", "", "\x1b[31m", "tool", "x" * 500))] = place.pop(key)
            elif change == 2 and isinstance(place, list):
                place += [place[key]] * int(rng.integers(1, 20))
            else:
                place[key] = deepcopy(pick(rng, VALUES))
            break
    return data


def mutate_yaml(rng: Rng, text: str) -> bytes:
    """A YAML file changed as bytes, as words or as what it means."""
    change = rng.random()
    if change < 0.25:
        return mutate_bytes(rng, text.encode())
    if change < 0.5:
        return mutate_words(rng, text)
    return yaml.safe_dump(mutate_value(rng, yaml.safe_load(text)), sort_keys=False, allow_unicode=True).encode()


def mutate_json(rng: Rng, text: str) -> bytes:
    """The same of a JSON file."""
    if rng.random() < 0.4:
        return mutate_bytes(rng, text.encode())
    return json.dumps(mutate_value(rng, json.loads(text))).encode()


def odd_column(rng: Rng, rows: int) -> Any:
    """A column that nobody expects."""
    return pick(
        rng,
        (
            pa.nulls(rows),
            pa.nulls(rows, pa.float64()),
            [float("nan")] * rows,
            [1e300] * rows,
            [-1] * rows,
            [2**62] * rows,
            ["x"] * rows,
            ["1"] * rows,
            pa.array([None, *["\x1b[31m" * 500] * (rows - 1)], pa.string()).dictionary_encode(),
            [[1.0, 2.0]] * rows,
            [{"a": 1}] * rows,
            [b"\xff"] * rows,
            [True] * rows,
            pa.array(np.arange(rows), pa.timestamp("s")),
            pa.array(np.arange(rows, dtype=np.float16)),
            pa.array([1] * rows, pa.decimal128(10)),
        ),
    )


def mutate_parquet(rng: Rng, data: bytes, write: Callable[[pa.Table], bytes]) -> bytes:
    """A Parquet file changed as bytes or as a table: columns exchanged, left out, repeated; rows cut."""
    if rng.random() < 0.5:
        return mutate_bytes(rng, data)
    table = pq.read_table(pa.BufferReader(data))
    for _ in few(rng):
        at, change = int(rng.integers(table.num_columns)), int(rng.integers(5))
        if change == 0 and table.num_columns > 1:
            table = table.remove_column(at)
        elif change == 1:
            table = table.slice(int(rng.integers(len(table))))
        elif change == 2:
            table = table.append_column(table.column_names[at], table[at])
        elif len(table):
            table = table.set_column(
                at, table.column_names[at], pa.chunked_array([pa.array(odd_column(rng, len(table)))])
            )
    return write(table)


def write_parquet(table: pa.Table) -> bytes:
    """A table as the bytes of a file."""
    sink = io.BytesIO()
    pq.write_table(table, sink)
    return sink.getvalue()


def mutate_npz(rng: Rng, arrays: dict[str, bytes], packing: int) -> bytes:
    """An archive changed as bytes, or a sound one of arrays that are not."""
    members, inside = dict(arrays), rng.random() < 0.5
    if inside:
        name = pick(rng, list(members))
        if rng.random() < 0.4:
            header = pick(rng, HEADERS).encode()
            members[name] = b"\x93NUMPY\1\0" + len(header).to_bytes(2, "little") + header + bytes(288)
        else:
            members[name] = mutate_bytes(rng, members[name])
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", packing) as archive:
        for name, contents in members.items():
            archive.writestr(zipfile.ZipInfo(f"{name}.npy"), contents, packing)
    return buffer.getvalue() if inside else mutate_bytes(rng, buffer.getvalue())


class Fuzzer:
    """All kinds of files, what changes them and what reads them, in a folder of its own."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.run = folder / "run"
        self.robot = ikde.load_robot("qiao2021")
        rng = np.random.default_rng(1)
        p, quat = rng.uniform(-1.0, 1.0, (12, 3)), rng.normal(size=(12, 4))
        names = [f"n{k}" for k in range(12)]
        columns = dict(zip("xyz", p.T, strict=True)) | dict(zip(("qw", "qx", "qy", "qz"), quat.T, strict=True))
        self.csv = pa.table({"n": names, **columns}).to_pandas().to_csv(index=False)
        self.parquet = write_parquet(pa.table({"n": names, **columns}))
        self.arrays = {name: _npy(array) for name, array in {"n": np.array(names), "p": p, "quat": quat}.items()}
        self.robots = [path.read_text() for path in sorted((ROOT / "ikde" / "robots").glob("*.yaml"))]
        self.runs = [path.read_text() for path in sorted((ROOT / "configs" / "runs").glob("*.yaml"))]
        self.tracks = [path.read_text() for path in sorted((ROOT / "configs" / "tracks").glob("*.yaml"))]
        shutil.copy(ROOT / "configs" / "runs" / "from_csv.csv", folder)
        (folder / "points.csv").write_text(self.csv)
        ikde.run_batch(ikde.load_batch(_small_run(folder)), self.run, threads=1)
        self.kept = {path: path.read_bytes() for path in sorted(self.run.glob("**/*")) if path.is_file()}

    def kinds(self) -> Cases:
        """What makes a mutated file, by kind."""
        q, listed = "q1: 0.1\nq2: 0\nq3: -0.2\nd_x: 1e-3\nq_z: .5\n", json.dumps([0.1] * 9)
        return {
            "robot, YAML": lambda rng: mutate_yaml(rng, pick(rng, self.robots)),
            "run, YAML": lambda rng: mutate_yaml(rng, pick(rng, self.runs)),
            "track, YAML": lambda rng: mutate_yaml(rng, pick(rng, self.tracks)),
            "q, YAML": lambda rng: mutate_yaml(rng, q),
            "q, JSON": lambda rng: mutate_json(rng, listed),
            "targets, CSV": lambda rng: (mutate_words if rng.random() < 0.5 else _mutate_text)(rng, self.csv),
            "targets, Parquet": lambda rng: mutate_parquet(rng, self.parquet, write_parquet),
            "targets, NPZ stored": lambda rng: mutate_npz(rng, self.arrays, zipfile.ZIP_STORED),
            "targets, NPZ compressed": lambda rng: mutate_npz(rng, self.arrays, zipfile.ZIP_DEFLATED),
            "run folder, manifest": lambda rng: mutate_json(rng, (self.kept[self.run / "manifest.json"]).decode()),
            "run folder, solutions": lambda rng: self._mutate_part(rng, "solutions"),
            "run folder, timing": lambda rng: self._mutate_part(rng, "timing"),
        }

    def make(self, seed: int, number: int) -> tuple[str, bytes]:
        """Kind and bytes of a case."""
        kinds = self.kinds()
        kind = list(kinds)[number % len(kinds)]
        return kind, kinds[kind](np.random.default_rng((seed, number)))

    def read(self, kind: str, data: bytes, *, draw: bool = False) -> None:
        """Give a file to what users call for its kind."""
        what, _, form = kind.partition(", ")
        if what == "run folder":
            self._read_run(form, data, draw)
            return
        endings = {"YAML": "yaml", "JSON": "json", "CSV": "csv", "Parquet": "parquet"}
        path = self.folder / f"case.{endings.get(form, 'npz')}"
        path.write_bytes(data)
        readers: dict[str, Callable[[], Any]] = {
            "robot": lambda: ikde.load_robot(path),
            "run": lambda: ikde.load_batch(path),
            "track": lambda: ikde.load_track(path),
            "q": lambda: parse_joints(self.robot, str(path), "m", "rad"),
            "targets": lambda: ikde.load_batch(_table_run(path)),
        }
        readers[what]()

    def _read_run(self, form: str, data: bytes, draw: bool) -> None:
        path = self._file_of(form)
        path.write_bytes(data)
        try:
            for read in (ikde.read_batch, lambda run: ikde.read_batch(run, timing=True), summarise, gather_answers):
                answers = read(self.run)
            if draw:
                page = make_batch_page(answers)
                render_html(page).encode()
                render_markdown(page).encode()
        finally:
            path.write_bytes(self.kept[path])

    def _file_of(self, form: str) -> Path:
        return self.run / "manifest.json" if form == "manifest" else self.run / form / "a-00001.parquet"

    def _mutate_part(self, rng: Rng, form: str) -> bytes:
        write = lambda table: serialize(table).to_pybytes()  # noqa: E731 - with a part's own choices
        return mutate_parquet(rng, self.kept[self._file_of(form)], write)


def _mutate_text(rng: Rng, text: str) -> bytes:
    return mutate_bytes(rng, text.encode())


def _npy(array: np.ndarray) -> bytes:
    buffer = io.BytesIO()
    np.save(buffer, array)
    return buffer.getvalue()


def _table_run(path: Path) -> dict[str, Any]:
    """A run over a table: with quaternions, names and millimetres."""
    whole = path.suffix == ".npz"
    columns = {"position": "p" if whole else ["x", "y", "z"], "name": "n"}
    columns["quat_wxyz"] = "quat" if whole else ["qw", "qx", "qy", "qz"]
    return {
        "robot": "qiao2021",
        "targets": {"file": {"path": str(path), "columns": columns, "units": {"length": "mm"}}},
    }


def _small_run(folder: Path) -> dict[str, Any]:
    quick = {"settings": {"population": 6, "generations": 1, "restarts": 1}, "detector": "none"}
    run = _table_run(folder / "points.csv")
    return {**run, "arms": {"a": quick, "b": quick}, "grade": ["typical"], "repeats": 2, "chunk": 8, "explain": False}


def judge(read: Callable[[], None]) -> str:
    """What came of reading a file: an answer, one line, or the name of what escaped."""
    try:
        read()
    except InputError as error:
        text = str(error)
        return "one line" if text.isprintable() and len(text) <= LONGEST else f"not one line: {text!r:.200}"
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
        outcome = judge(lambda: fuzzer.read(kind, data, draw=number // 12 % PAGE_EVERY == 0))  # noqa: B023
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


KINDS = tuple(Fuzzer.kinds(Fuzzer.__new__(Fuzzer)))


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

"""The runner's end of the pipe: starts a worker, asks it, and stops it when it is gone or over its time.

`Connection` puts the length before each message: reading a pickle from a bare pipe fails once it is longer than 64 KB.
"""

import os
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from multiprocessing import Pipe
from pathlib import Path
from typing import Any

import numpy as np
from protocol import Answer, Setup, Solid
from roster import EVERY

WORKER = Path(__file__).parent / "worker.py"
THREADS = ("OMP", "OPENBLAS", "MKL", "NUMBA", "BLIS", "VECLIB_MAXIMUM")
START_S, PREPARE_S, GRACE_S = 120.0, 300.0, 5.0
BUSY = 20.0  # times as long on the wall as on a processor, where seconds are those of a processor


class Lost(Exception):  # noqa: N818 - read as `raise Lost`
    """A peer that cannot be used, with the reason in one line."""


class Client:
    """A running worker."""

    def __init__(self, index: int) -> None:
        self._index, self.entry = index, EVERY[index]
        self._setup: Setup | None = None
        self._start()

    def prepare(self, setup: Setup, p: np.ndarray, R: np.ndarray, seconds: float) -> dict[str, float]:
        """Load a robot unless it is the one at hand, in a new process if the last has gone; seconds that took."""
        if setup is not self._setup:
            self._setup, self._outcome = setup, {"lost": "not started"}
            if self._process.poll() is not None:
                self._start()
            self._outcome = self._ask(PREPARE_S, "prepare", setup, p, R, seconds)
        if "lost" in self._outcome:
            raise Lost(self._outcome["lost"])
        return self._outcome

    def solve(self, p: np.ndarray, R: np.ndarray, seconds: float, slice_s: float) -> list[Answer]:
        """Solve targets until the slice is over; a target may take its own time twice, then the worker is stopped."""
        try:
            return self._ask(slice_s + 2.0 * seconds + GRACE_S, "solve", p, R, seconds, slice_s)
        except Lost:
            self._setup = None
            raise

    def meet(
        self, solids: Sequence[Solid], target: tuple[np.ndarray, np.ndarray], seconds: float, rounds: int
    ) -> tuple[float, list[Answer]]:
        """Load solids and solve a target among them `rounds` times: seconds of loading, and the answers."""
        try:
            return self._ask(BUSY * rounds * seconds + GRACE_S, "meet", solids, *target, seconds, rounds)
        except Lost:
            self._setup = None
            raise

    def close(self) -> None:
        """End the worker."""
        self._process.kill()
        self._process.wait()
        self._pipe.close()

    def _start(self) -> None:
        one_thread = {f"{name}_NUM_THREADS": "1" for name in THREADS}
        flags = f"--xla_cpu_multi_thread_eigen=false intra_op_parallelism_threads=1 {os.environ.get('XLA_FLAGS', '')}"
        environment = {**os.environ, **one_thread, "XLA_FLAGS": flags.strip(), "JAX_PLATFORMS": "cpu"}
        self._pipe, theirs = Pipe()
        self._errors = tempfile.TemporaryFile()  # noqa: SIM115 - lives as long as the process
        self._process = subprocess.Popen(
            [sys.executable, str(WORKER), str(self._index), str(theirs.fileno())],
            env=environment,
            stdin=subprocess.DEVNULL,
            stdout=self._errors,
            stderr=self._errors,
            pass_fds=[theirs.fileno()],
        )
        theirs.close()
        answer = self._read(START_S)
        if "missing" in answer:
            self.close()
            raise Lost(answer["missing"])
        self.import_s, self.versions = round(answer["import_s"], 3), answer["versions"]

    def _ask(self, patience_s: float, *request: Any) -> Any:
        try:
            self._pipe.send(request)
        except OSError:
            raise self._explain() from None
        return self._read(patience_s)

    def _read(self, patience_s: float) -> Any:
        try:
            if self._pipe.poll(patience_s):
                return self._pipe.recv()
        except (EOFError, OSError):
            raise self._explain() from None
        self.close()
        raise Lost(f"stopped: no answer within {patience_s:.0f} s")

    def _explain(self) -> Lost:
        """Its last words; a worker whose pipe is shut gets a moment to end by itself."""
        try:
            self._process.wait(GRACE_S)
        except subprocess.TimeoutExpired:
            self.close()
        self._errors.seek(0)
        lines = self._errors.read().decode(errors="replace").strip().splitlines()
        return Lost(f"ended with {self._process.returncode}: {lines[-1][:200] if lines else 'no word'}")

"""The runner's end of the pipe: starts a worker, asks it, notices when it is gone or stuck."""

import ast
import os
import pickle
import select
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from typing import Any

import numpy as np
from protocol import Setup
from worker import ADAPTERS, FOLDER

THREADS = ("OMP", "OPENBLAS", "MKL", "NUMBA", "BLIS", "VECLIB_MAXIMUM")
START_S, PREPARE_S, GRACE_S = 180.0, 600.0, 60.0


class Lost(Exception):  # noqa: N818 - read as `raise Lost`
    """A peer that cannot be used, with the reason in one line."""


@dataclass(frozen=True)
class Description:
    """What an adapter's source says about one of its peers, read without importing what it needs."""

    adapter: str
    index: int
    name: str
    use: str
    cores: int
    batch: bool


def list_peers() -> list[Description]:
    """Every peer of every adapter."""
    return [peer for adapter in ADAPTERS for peer in _read_adapter(adapter)]


def _read_adapter(adapter: str) -> list[Description]:
    tree = ast.parse((FOLDER / "adapters" / f"{adapter}.py").read_text(encoding="utf-8"))
    classes = {node.name: node for node in tree.body if isinstance(node, ast.ClassDef)}
    peers = next(n.value for n in tree.body if isinstance(n, ast.Assign) and ast.unparse(n.targets[0]) == "PEERS")
    found = []
    for index, element in enumerate(peers.elts):  # type: ignore[attr-defined]
        facts = _read_class(classes, element.id)
        found.append(
            Description(adapter, index, facts["name"], facts["use"], facts.get("cores", 1), facts.get("batch", False))
        )
    return found


def _read_class(classes: dict[str, ast.ClassDef], name: str) -> dict[str, Any]:
    facts: dict[str, Any] = {}
    for base in classes[name].bases:
        if ast.unparse(base) in classes:
            facts |= _read_class(classes, ast.unparse(base))
    for node in classes[name].body:
        if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name):
            try:
                facts[node.targets[0].id] = ast.literal_eval(node.value)
            except ValueError:
                continue
    return facts


class Client:
    """A running worker."""

    def __init__(self, description: Description) -> None:
        self.name, self.use, self.batch = description.name, description.use, description.batch
        self._description = description
        self._start()

    def prepare(self, setup: Setup, p: np.ndarray, R: np.ndarray, seconds: float) -> dict[str, float]:
        """Load a case's robot, in a new process if the last one has gone; seconds that took."""
        if self._process.poll() is not None:
            self._start()
        answer = self._ask(PREPARE_S + seconds * len(p), "prepare", setup, p, R, seconds)
        if "lost" in answer:
            raise Lost(answer["lost"])
        return answer

    def solve(
        self, p: np.ndarray, R: np.ndarray, seconds: float, slice_s: float
    ) -> list[tuple[float, np.ndarray | None]]:
        """Solve targets until the slice is over: seconds and joint values of each."""
        at_once = len(p) if self.batch else 1
        return self._ask(GRACE_S + slice_s + 3.0 * seconds * at_once, "solve", p, R, seconds, slice_s)

    def _start(self) -> None:
        peer = self._description
        one_thread = {f"{name}_NUM_THREADS": "1" for name in THREADS}
        flags = f"--xla_cpu_multi_thread_eigen=false intra_op_parallelism_threads=1 {os.environ.get('XLA_FLAGS', '')}"
        environment = {**os.environ, **one_thread, "XLA_FLAGS": flags.strip(), "JAX_PLATFORMS": "cpu"}
        command = [sys.executable, str(FOLDER / "worker.py"), peer.adapter, str(peer.index), str(peer.cores)]
        self._errors = tempfile.TemporaryFile()  # noqa: SIM115 - lives as long as the process
        pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "stderr": self._errors, "bufsize": 0}
        self._process = subprocess.Popen(command, env=environment, **pipes)
        answer = self._read(START_S)
        if "missing" in answer:
            self.close()
            raise Lost(answer["missing"])
        self.import_s, self.versions = round(answer["import_s"], 3), answer["versions"]

    def close(self) -> None:
        """End the worker."""
        if self._process.poll() is None:
            self._process.kill()
        self._process.wait()

    def _ask(self, patience_s: float, *request: Any) -> Any:
        if self._process.poll() is not None:
            raise Lost("gone since an earlier case")
        try:
            self._process.stdin.write(pickle.dumps(request))  # type: ignore[union-attr]
        except OSError:
            raise self._explain() from None
        return self._read(patience_s)

    def _read(self, patience_s: float) -> Any:
        pipe = self._process.stdout
        ready, _, _ = select.select([pipe], [], [], patience_s)
        if not ready:
            self.close()
            raise Lost(f"no answer within {patience_s:.0f} s")
        try:
            return pickle.load(pipe)  # type: ignore[arg-type]
        except (EOFError, pickle.UnpicklingError):
            raise self._explain() from None

    def _explain(self) -> Lost:
        self._process.wait()
        self._errors.seek(0)
        lines = self._errors.read().decode(errors="replace").strip().splitlines()
        return Lost(f"ended with {self._process.returncode}: {lines[-1][:200] if lines else 'no word'}")

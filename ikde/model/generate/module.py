"""The module for a robot, detector and kind of target: found in the cache folder or written, imported by path."""

import hashlib
import importlib.util
import os
import re
import sys
import tempfile
from functools import lru_cache
from pathlib import Path
from types import ModuleType

import numpy as np

from ikde.kernels import jit
from ikde.model.generate.proofs import proof_margin
from ikde.model.pack import pack_detector, pack_robot
from ikde.model.robot import Detector, Robot


@lru_cache(maxsize=256)
def load_module(robot: Robot, detector: Detector | None, kind: str) -> ModuleType:
    """The module for targets of one kind (`position`, `axis`, `pose`); written first if the cache has none yet."""
    name = module_name(robot, detector, kind)
    if not jit.CACHE_IS_WRITABLE:  # by us, that is: nothing that lies there may be run
        return _execute(f"ikde_kernels_{name}", _format(robot, detector, kind))
    path = jit.CACHE_FOLDER / "robots" / f"{name}.py"
    if not path.exists():
        write_whole(path, _format(robot, detector, kind).encode())
    return _import(f"ikde_kernels_{name}", path)


def code_digest() -> str:
    """Of all code that answers hang on bit for bit: the kernels, and the generator that writes more of them."""
    return f"{jit.CACHE_FOLDER.name}-{_own_digest()[:12]}"


def _format(robot: Robot, detector: Detector | None, kind: str) -> str:
    """The text; the generator is imported only when it has something to write."""
    from ikde.model.generate.assemble import format_module

    return format_module(robot, detector, kind)


def module_name(robot: Robot, detector: Detector | None, kind: str) -> str:
    """Name of a module: readable, and unlike that of any module with other contents."""
    arrays, packed = pack_robot(robot), pack_detector(robot, detector)
    digest = hashlib.sha256(f"{kind} {proof_margin(robot, detector)} {jit.CACHE_FOLDER.name} {_own_digest()}".encode())
    for array in (*arrays, *packed[1:], robot.lower, robot.upper):
        digest.update(np.asarray(array).tobytes())
    words = (robot.name, detector.name if detector else "none", kind, digest.hexdigest()[:12])
    return "_".join(re.sub(r"\W+", "_", word) for word in words)


@lru_cache(maxsize=1)
def _own_digest() -> str:
    """Of the generator: another one writes other modules."""
    digest = hashlib.sha256()
    for source in sorted(Path(__file__).parent.glob("*.py")):
        digest.update(source.read_bytes())
    return digest.hexdigest()


def write_whole(path: Path, content: bytes) -> None:
    """Whole or not at all: another process may write the same at the same moment.

    Its time is always the same, as its contents are: numba takes machine code for outdated when the file is newer.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, temporary = tempfile.mkstemp(dir=path.parent, suffix=".tmp")
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(content)
        os.utime(temporary, (1.0, 1.0))
        Path(temporary).replace(path)
    finally:
        Path(temporary).unlink(missing_ok=True)


def _execute(name: str, content: str) -> ModuleType:
    """A module without a file."""
    module = sys.modules[name] = ModuleType(name)
    exec(compile(content, f"<{name}>", "exec"), module.__dict__)
    return module


def _import(name: str, path: Path) -> ModuleType:
    """Import a file; numba finds its machine code by the file's path."""
    spec = importlib.util.spec_from_file_location(name, path)
    if spec is None or spec.loader is None:
        raise ImportError(f"cannot import {path}")
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module  # machine code from the cache looks its module up by name
    spec.loader.exec_module(module)
    return module

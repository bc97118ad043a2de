"""The module for a collision model and kind of target: found in the cache folder or written, run from what was read.

A module's file is named by the SHA-256 of its text, and is run only if its bytes have that hash. An index, a file for
each digest of what a text depends on, names the text, so that nothing is written twice; no name of a robot, joint or
detector is part of either.
"""

import hashlib
import marshal
import os
import sys
from functools import lru_cache
from pathlib import Path
from types import CodeType, ModuleType
from typing import Literal

import numpy as np

from ikde.errors import InputError, quoted
from ikde.kernels import cache_folder
from ikde.kernels.cache_files import discard, read_file, read_sealed, write_file, write_sealed
from ikde.model.closed_form import find_ur_arm
from ikde.model.collision_model import CollisionModel
from ikde.model.generate.proofs import proof_margin
from ikde.model.pack import pack_robot

KERNELS = "IKDE_KERNELS"


@lru_cache(maxsize=256)
def load_module(collision: CollisionModel, kind: str) -> ModuleType:
    """The module for targets of one kind (`position`, `axis`, `pose`); written first if the cache has none yet.

    Without a cache it has no file, and every process compiles for itself.
    """
    if not cache_folder.CACHE_IS_WRITABLE:  # what lies there is not trusted
        return _run(_format(collision, kind), None)
    index = robots_folder() / f"{digest_inputs(collision, kind)}.index"
    return _run(*(_find(index) or _write(index, _format(collision, kind))))


def robots_folder() -> Path:
    """Where modules and pools of seeds are kept."""
    return cache_folder.CACHE_FOLDER / cache_folder.ROBOTS


def describe_kernels() -> dict[str, str]:
    """All that answers depend on bit for bit beside their recipe: the kernels and what writes them, and which run."""
    return {"code": f"{cache_folder.CACHE_FOLDER.name}-{_own_digest()[:12]}", "kind": kernel_kind()}


def kernel_kind() -> Literal["written", "tables"]:
    """`written` for a robot, or `tables` if `$IKDE_KERNELS` says so; they add up in another order, so bits differ.

    Raises:
        InputError: for another word there.
    """
    given = os.environ.get(KERNELS) or "written"
    if given not in ("written", "tables"):
        raise InputError(f"expected written or tables, got {quoted(given)}", (f"${KERNELS}",))
    return "tables" if given == "tables" else "written"


def digest_inputs(collision: CollisionModel, kind: str) -> str:
    """SHA-256, hex, of all that a text depends on; no name is."""
    robot = collision.robot
    closed = kind == "pose" and find_ur_arm(robot) is not None
    words = (kind, closed, proof_margin(collision), cache_folder.CACHE_FOLDER.name, _own_digest())
    digest = hashlib.sha256(repr(words).encode())
    for array in (*pack_robot(robot), *collision.arrays[1:-1], *robot.written_ranges):
        digest.update(repr(np.shape(array)).encode() + np.asarray(array).tobytes())
    return digest.hexdigest()


@lru_cache(maxsize=1)
def _own_digest() -> str:
    """Of the generator: another one writes other modules."""
    digest = hashlib.sha256()
    for source in sorted(Path(__file__).parent.glob("*.py")):
        digest.update(source.read_bytes())
    return digest.hexdigest()


def _format(collision: CollisionModel, kind: str) -> bytes:
    """The text; the generator is imported only when it has something to write."""
    from ikde.model.generate.assemble import format_module

    return format_module(collision, kind).encode()


def _find(index: Path) -> tuple[bytes, Path] | None:
    """The text that an index names and its file, or None; a text that is not what its name says is removed."""
    named = read_sealed(index)
    if named is None:
        return None
    path = index.with_name(f"{named.decode()}.py")
    text = read_file(path)
    if text is None:
        return None
    if hashlib.sha256(text).hexdigest() != path.stem:
        discard(path, "is damaged")
        return None
    return text, path


def _write(index: Path, text: bytes) -> tuple[bytes, Path | None]:
    """Put a text and its index into the cache; the text and its file, None where nothing can be written."""
    path = index.with_name(f"{hashlib.sha256(text).hexdigest()}.py")
    if not write_file(path, text):
        return text, None
    write_sealed(index, path.stem.encode())
    return text, path


@lru_cache(maxsize=256)
def _run(text: bytes, path: Path | None) -> ModuleType:
    """A module of this text: one for all robots that differ in names only."""
    name = f"ikde_kernels_{hashlib.sha256(text).hexdigest()}"
    module = sys.modules[name] = ModuleType(name)  # machine code from the cache looks its module up by name
    if path is None:
        code = compile(text, f"<{name}>", "exec")
    else:
        module.__file__, code = str(path), _compile(text, path)
    exec(code, module.__dict__)
    return module


def _compile(text: bytes, path: Path) -> CodeType:
    """The text as Python runs it; kept beside it, since compiling it takes 0.02 to 0.08 s of every start."""
    kept = path.with_suffix(f".{sys.implementation.cache_tag}.code")
    content = read_sealed(kept)
    if content is not None:
        try:
            code = marshal.loads(content)
        except (EOFError, ValueError, TypeError):  # another build of Python may write it otherwise
            code = None
        if code is not None and code.co_filename == str(path):
            return code
    code = compile(text, str(path), "exec")
    write_sealed(kept, marshal.dumps(code))
    return code

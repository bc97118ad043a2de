"""Files of the cache: whole or not there, this user's alone, and made again when they are damaged."""

import hashlib
import os
import shutil
import stat
import tempfile
import threading
import warnings
from pathlib import Path

from ikde.errors import CacheWarning
from ikde.kernels.cache_folder import find_fault

SEAL = hashlib.sha256().digest_size  # bytes
FLAGS = getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0)  # no links, and no waiting for a pipe
WARNED: set[str] = set()
WRITING = threading.Lock()
"""Held while a file is written: what ends this process meanwhile would leave half of it."""
if hasattr(os, "register_at_fork"):
    os.register_at_fork(before=WRITING.acquire, after_in_parent=WRITING.release, after_in_child=WRITING.release)


def read_file(path: Path) -> bytes | None:
    """All of a file, or None if it is not there; what is no file of this user's alone is removed."""
    try:
        with open(path, "rb", opener=lambda name, flags: os.open(name, flags | FLAGS)) as file:
            state = os.fstat(file.fileno())
            fault = find_fault(state) if stat.S_ISREG(state.st_mode) else "is no file"
            if fault is None:
                return file.read()
    except FileNotFoundError:
        return None
    except OSError as error:
        fault = f"cannot be read ({error.strerror})"
    discard(path, fault)
    return None


def write_file(path: Path, content: bytes) -> bool:
    """Write a file whole or not at all: another process may write the same at the same moment. True if it is there."""
    try:
        with WRITING:
            _write(path, content)
    except OSError as error:
        _tell_once("full", f"{path} cannot be written ({error.strerror}): the next process compiles again")
        return False
    return True


def _write(path: Path, content: bytes) -> None:
    path.parent.mkdir(stat.S_IRWXU, parents=True, exist_ok=True)
    handle, temporary = tempfile.mkstemp(dir=path.parent, suffix=".tmp")
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(content)
            file.flush()
            os.fsync(handle)
        if path.is_dir():
            discard(path, "is no file")
        Path(temporary).replace(path)
    finally:
        Path(temporary).unlink(missing_ok=True)


def read_sealed(path: Path) -> bytes | None:
    """What `write_sealed` wrote, or None; a file that has changed since is removed."""
    sealed = read_file(path)
    if sealed is None:
        return None
    content = unseal(path, sealed)
    if content is None:
        discard(path, "is damaged")
    return content


def seal(path: Path, content: bytes) -> bytes:
    """A file's content behind its checksum: of its name and content, so that no other file passes for it."""
    return hashlib.sha256(path.name.encode() + b"\0" + content).digest() + content


def unseal(path: Path, sealed: bytes) -> bytes | None:
    """The content of what `seal` made, or None if it has changed since."""
    content = sealed[SEAL:]
    return content if seal(path, content) == sealed else None


def write_sealed(path: Path, content: bytes) -> None:
    """Write a file with its checksum in front."""
    write_file(path, seal(path, content))


def discard(path: Path, fault: str) -> None:
    """Remove what cannot be used, file or folder, and say so once: it is made again."""
    try:
        if path.is_dir() and not path.is_symlink():
            shutil.rmtree(path)
        else:
            path.unlink(missing_ok=True)
    except OSError as error:
        fault = f"{fault} and cannot be removed ({error.strerror})"
    _tell_once("damaged", f"{path} {fault}: such files of the cache are removed and made again")


def _tell_once(what: str, message: str) -> None:
    if what not in WARNED:
        WARNED.add(what)
        warnings.warn(message, CacheWarning, stacklevel=3)

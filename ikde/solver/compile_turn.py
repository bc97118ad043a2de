"""One compiler at a time in a cache folder: a lock, and in its file what is compiled by the process that holds it."""

import hashlib
import json
import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

LOCK = "compiling.lock"
WORK = ("robot", "detector", "what")


def mark_work(question: dict[str, Any]) -> bytes:
    """What stands in the lock's file while this is compiled: a digest, since names are others' text."""
    return hashlib.sha256(json.dumps([question[name] for name in WORK]).encode()).hexdigest().encode()


@contextmanager
def take_turn(cache: Path, mark: bytes = b"") -> Iterator[None]:
    """Be the only one that compiles into a cache folder; where files cannot be locked there may be two, and no harm."""
    handle = os.open(cache / LOCK, os.O_RDWR | os.O_CREAT | getattr(os, "O_NOFOLLOW", 0), 0o600)
    try:
        with suppress(ImportError, OSError):
            import fcntl

            fcntl.flock(handle, fcntl.LOCK_EX)
        os.ftruncate(handle, 0)
        os.write(handle, mark)
        yield
    finally:
        os.close(handle)


def is_taken_for(cache: Path, mark: bytes) -> bool:
    """Whether a process has its turn with this work; False where that cannot be known."""
    try:
        handle = os.open(cache / LOCK, os.O_RDONLY | getattr(os, "O_NOFOLLOW", 0))
    except OSError:
        return False
    try:
        import fcntl

        fcntl.flock(handle, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except BlockingIOError:
        return os.read(handle, len(mark) + 1) == mark
    except (ImportError, OSError):
        return False
    finally:
        os.close(handle)
    return False

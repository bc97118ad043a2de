"""The folder of a run: which run, the one process that writes to it, and what is finished."""

import fcntl
import os
import re
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path

from ikde.batch.manifest import (
    MANIFEST,
    REPORT,
    REPORT_FILES,
    Manifest,
    describe_difference,
    make_manifest,
    read_manifest,
    refuse_links,
    write_manifest,
)
from ikde.batch.parts import GO_ON, SOLUTIONS, TIMING
from ikde.batch.plan import Batch
from ikde.errors import FileError
from ikde.formats.atomic import remove_temporaries, sync_folder, temporary_path

LOCK = ".lock"
SYNC_SECONDS = 1.0


@contextmanager
def claim_folder(folder: Path, batch: Batch, *, overwrite: bool) -> Iterator[None]:
    """Hold the folder of a run while the block runs: made, ours, of this recipe, and of no other process.

    Raises:
        FileError: for a folder that cannot be written, holds something else, holds a run of another recipe (unless
            `overwrite`), or is being written by another process.
    """
    with ExitStack() as held:
        with _errors_of(folder):
            folder.mkdir(parents=True, exist_ok=True)
            _check_ours(folder)
            held.enter_context(_lock(folder))
            _prepare(folder, batch, overwrite)
        yield


def check_folder(folder: Path, batch: Batch, *, overwrite: bool) -> None:
    """Raise `FileError` where `claim_folder` would, as far as looking tells: nothing is written."""
    with _errors_of(folder):
        if folder.exists():
            _check_ours(folder)
            _find_run(folder, batch, overwrite)
        elif any(parent.exists() and not parent.is_dir() for parent in folder.parents):
            raise NotADirectoryError


@contextmanager
def _errors_of(folder: Path) -> Iterator[None]:
    try:
        yield
    except (FileExistsError, NotADirectoryError):
        raise FileError(folder, "is a file or lies below one; expected a folder") from None
    except OSError as error:
        raise FileError(folder, f"cannot be used: {error.strerror or error}") from None


@contextmanager
def keep_names(folder: Path) -> Iterator[Callable[[], None]]:
    """What is called after every part: names get onto the disk once a second, and at the end, or raise `FileError`."""
    last = time.monotonic()

    def keep() -> None:
        nonlocal last
        if time.monotonic() - last >= SYNC_SECONDS:
            _sync_names(folder)
            last = time.monotonic()

    try:
        yield keep
    except BaseException:
        with suppress(FileError):
            _sync_names(folder)
        raise
    _sync_names(folder)


def _sync_names(folder: Path) -> None:
    for kind in (TIMING, SOLUTIONS):
        try:
            sync_folder(folder / kind)
        except OSError as error:
            raise FileError(folder / kind, f"cannot be written: {error.strerror}; {GO_ON}") from None


def _prepare(folder: Path, batch: Batch, overwrite: bool) -> None:
    """Leave the manifest of this batch and finished parts, nothing else of ours; it is ours at every moment."""
    there = _find_run(folder, batch, overwrite)
    if there is None:
        write_manifest(folder, make_manifest(batch))
    for kind in (SOLUTIONS, TIMING):
        (folder / kind).mkdir(exist_ok=True)
        remove_temporaries(folder / kind)
        if overwrite:
            for path in (folder / kind).glob("*.parquet"):
                path.unlink()
            sync_folder(folder / kind)
    if overwrite:
        _remove_report(folder / REPORT)
    if there and overwrite:
        write_manifest(folder, make_manifest(batch))
    sync_folder(folder)


def _find_run(folder: Path, batch: Batch, overwrite: bool) -> Manifest | None:
    """The run that is in a folder of ours; it must be of this batch, unless it is replaced."""
    refuse_links(folder, REPORT)
    there = read_manifest(folder) if (folder / MANIFEST).exists() else None
    if there and there.hash != batch.hash and not overwrite:
        difference = describe_difference(there.recipe, batch.recipe)
        raise FileError(folder, f"holds another run (--overwrite replaces it): {difference}")
    return there


def _check_ours(folder: Path) -> None:
    """Refuse a folder with anything in it but a run of ours, or what is left of one that was killed at birth."""
    leftovers = {LOCK, temporary_path(folder / MANIFEST).name}
    if (folder / MANIFEST).exists():
        read_manifest(folder)
    elif {path.name for path in folder.iterdir()} - leftovers:
        raise FileError(folder, "is not empty and holds no run of ikde; name another folder")


@contextmanager
def _lock(folder: Path) -> Iterator[None]:
    """A lock that the system lets go of when its holder ends, however it ends."""
    flags = os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC  # a link would lead elsewhere
    descriptor = os.open(folder / LOCK, flags, 0o666)
    with os.fdopen(descriptor, "r+", encoding="utf-8") as file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise FileError(folder, f"process {file.read(20) or 'another'} is writing this run") from None
        if not re.fullmatch(r"\d*", file.read(20)):
            raise FileError(folder / LOCK, "was not written by ikde; expected the number of a process")
        file.seek(0)
        file.truncate()
        file.write(str(os.getpid()))
        file.flush()
        yield


def _remove_report(folder: Path) -> None:
    """Delete the page of a run that is gone, and nothing else that lies there."""
    if folder.is_dir():
        for name in REPORT_FILES:
            (folder / name).unlink(missing_ok=True)
        if not any(folder.iterdir()):
            folder.rmdir()

"""Files that are either whole or not there: written under a hidden name, synced, renamed."""

import os
from collections.abc import Iterable, Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from ikde.errors import FileError


def write_together(files: Mapping[Path, Any]) -> None:
    """Write bytes (anything with a buffer) to files and give them their names in this order, when all are on the disk.

    A process that is killed in between leaves at most hidden files behind, which the next call writes over.

    Raises:
        OSError: with the path that it is about; then no name is new, or only those before it.
    """
    opened: dict[Path, int] = {}
    try:
        for path, data in files.items():
            with _blame(path):
                opened[path] = _open_new(temporary_path(path))
                _write(opened[path], data)
        _sync_together(opened)
        for path in files:
            with _blame(path):
                temporary_path(path).replace(path)
    except OSError:
        for path in files:
            with suppress(OSError):
                temporary_path(path).unlink()
        raise
    finally:
        for descriptor in opened.values():
            os.close(descriptor)


def replace_all(folder: Path, files: Mapping[str, Any], names: Iterable[str] = ()) -> tuple[Path, ...]:
    """Write bytes by name into a folder, and remove those of `names` that are not among them; returns the files.

    Raises:
        FileError: if they cannot be written; then none of them is new, or only those that were named before.
    """
    paths = {folder / name: data for name, data in files.items()}
    try:
        write_together(paths)
        for name in set(names) - set(files):
            (folder / name).unlink(missing_ok=True)
        sync_folder(folder)
    except OSError as error:
        raise FileError(error.filename or folder, f"cannot be written: {error.strerror or error}") from None
    return tuple(paths)


def temporary_path(path: Path) -> Path:
    """Where a file stands while it is being written: beside its place, since a rename does not cross disks."""
    return path.with_name(f".{path.name}.tmp")


def sync_folder(folder: Path) -> None:
    """Wait until the names in a folder are on the disk."""
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def remove_temporaries(folder: Path) -> None:
    """Delete what a killed process left half-written."""
    for leftover in folder.glob(".*.tmp"):
        leftover.unlink()


def _open_new(path: Path) -> int:
    """A file that was not there: what lies in its place, be it a link that leads elsewhere, goes."""
    path.unlink(missing_ok=True)
    return os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o666)


def _write(descriptor: int, data: Any) -> None:
    """All of it: one call may write less."""
    rest = memoryview(data)
    while rest:
        rest = rest[os.write(descriptor, rest) :]


def _sync_together(opened: Mapping[Path, int]) -> None:
    """Wait until the contents of files are on the disk: side by side, so that the disk is waited for once."""
    with ThreadPoolExecutor(len(opened)) as pool:
        waiting = {path: pool.submit(os.fsync, descriptor) for path, descriptor in opened.items()}
        for path, synced in waiting.items():
            with _blame(path):
                synced.result()


@contextmanager
def _blame(path: Path) -> Iterator[None]:
    """Name the file that an `OSError` is about."""
    try:
        yield
    except OSError as error:
        raise OSError(error.errno, error.strerror, str(path)) from None

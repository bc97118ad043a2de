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


def write_named(path: Path, data: Any, beside: Mapping[str, Any] | None = None) -> tuple[Path, ...]:
    """Write bytes to a file that a user named, and others by name beside it, whole or not at all; returns the files.

    Where the name is a symbolic link, the file that it leads to is written and the link stays, as most programs do.

    Raises:
        FileError: if it cannot be written, is no ordinary file (a device, a pipe, a folder), or has no folder.
    """
    if not path.name:
        raise FileError(path, "cannot be written: expected the name of a file")
    try:
        with suppress(FileNotFoundError, NotADirectoryError):
            path.lstat()  # unlike exists, it tells what can be no name of a file
        if path.exists() and not path.is_file():
            raise FileError(path, "cannot be written: this is no ordinary file; expected a file name")
        place = path.resolve() if path.is_symlink() else path
    except (OSError, RuntimeError, ValueError) as error:
        raise FileError(path, f"cannot be written: {getattr(error, 'strerror', None) or 'no path'}") from None
    if not place.parent.is_dir():
        raise FileError(path, "cannot be written: its folder does not exist")
    own = {path.parent / name: content for name, content in (beside or {}).items()}
    _write_all({**own, place: data}, path.parent)
    return (*own, path)


def replace_all(folder: Path, files: Mapping[str, Any], names: Iterable[str] = ()) -> tuple[Path, ...]:
    """Write bytes by name into a folder, and remove those of `names` that are not among them; returns the files.

    Raises:
        FileError: if they cannot be written; then none of them is new, or only those that were named before.
    """
    paths = {folder / name: data for name, data in files.items()}
    _write_all(paths, folder, set(names) - set(files))
    return tuple(paths)


def _write_all(files: Mapping[Path, Any], folder: Path, gone: Iterable[str] = ()) -> None:
    """Write them, remove those that are gone from the folder, and wait until the names are on the disk."""
    try:
        write_together(files)
        for name in gone:
            (folder / name).unlink(missing_ok=True)
        for parent in {folder, *(path.parent for path in files)}:
            sync_folder(parent)
    except OSError as error:
        raise FileError(error.filename or folder, f"cannot be written: {error.strerror or error}") from None


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

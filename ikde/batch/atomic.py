"""Files that are either whole or not there: written under a hidden name, synced, renamed."""

import os
from contextlib import suppress
from pathlib import Path
from typing import Any


def write_atomically(path: Path, data: Any) -> None:
    """Write bytes (anything with a buffer) to `path`, on the disk when this returns; raises `OSError`.

    Whoever is killed in between leaves at most a hidden file behind, which the next call writes over.
    """
    temporary = temporary_path(path)
    try:
        with temporary.open("wb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        temporary.replace(path)
        sync_folder(path.parent)
    except OSError:
        with suppress(OSError):
            temporary.unlink()
        raise


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

"""Where a report goes: a page as HTML and as Markdown, and the data that it shows; whole files or none."""

import json
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from tempfile import TemporaryFile
from typing import Any

from ikde.errors import FileError
from ikde.formats.atomic import replace_all

RESULTS = "results.json"


def prepare_folder(folder: Path) -> None:
    """Make the folder if need be; raises `FileError` now rather than after minutes of work."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        TemporaryFile(dir=folder).close()
    except FileExistsError:
        raise FileError(folder, "this is a file; expected a folder") from None
    except OSError as error:
        raise FileError(folder, f"cannot be written: {error.strerror or error}") from None


@contextmanager
def open_folder(folder: Path) -> Iterator[None]:
    """Make the folder, and take it away again if nothing comes of it; raises `FileError` if it cannot be written."""
    is_new = not folder.exists()
    prepare_folder(folder)
    try:
        yield
    except BaseException:
        if is_new:
            with suppress(OSError):
                folder.rmdir()
        raise


def write_report(folder: Path, files: Mapping[str, str]) -> tuple[Path, ...]:
    """Write files by name in place of an earlier report's, all or none; raises `FileError` as `replace_all`."""
    return replace_all(folder, {name: text.encode() for name, text in files.items()})


def format_results(results: Mapping[str, Any]) -> str:
    """`results.json`'s text."""
    return json.dumps(results, indent=1, allow_nan=False, ensure_ascii=False) + "\n"

"""Where a report goes: a page as HTML and as Markdown, and the data that it shows; whole files or none."""

import json
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import asdict
from pathlib import Path
from tempfile import TemporaryFile
from typing import Any

from ikde.bench.budget import Budget
from ikde.errors import FileError, quoted
from ikde.files.atomic import replace_all
from ikde.files.reading import read_json

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


def write_report(folder: Path, files: Mapping[str, str]) -> None:
    """Write files by name in place of an earlier report's, all or none; raises `FileError` as `replace_all`."""
    replace_all(folder, {name: text.encode() for name, text in files.items()})


def format_results(results: Mapping[str, Any]) -> str:
    """`results.json`'s text."""
    return json.dumps(results, indent=1, allow_nan=False, ensure_ascii=False) + "\n"


def read_results(folder: Path) -> dict[str, Any]:
    """What an earlier `ikde bench paper` recorded; raises `FileError` if the folder holds no such record."""
    path = folder / RESULTS
    results = read_json(path)
    try:
        made, sections = results["made"], results["sections"]
        budget, _ = asdict(Budget(**made["budget"])), set(made["only"])
    except (KeyError, TypeError):
        raise FileError(path, "not a record of this version's `ikde bench paper`") from None
    for name, size in budget.items():
        if type(size) is not int or size < 1:
            raise FileError(
                path, f"expected a whole number of at least 1, got {quoted(size)}", ("made", "budget", name)
            )
    for where, value in {("sections",): sections, **_list_sections(sections)}.items():
        if not isinstance(value, dict):
            raise FileError(path, f"expected a mapping, got {quoted(value)}", where)
    return results


def _list_sections(sections: Any) -> dict[tuple[str, ...], Any]:
    return {("sections", name): section for name, section in sections.items()} if isinstance(sections, dict) else {}

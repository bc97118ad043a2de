"""The run file: how it becomes a `Batch`."""

from collections.abc import Mapping
from os import PathLike
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from ikde.batch.plan import Batch
from ikde.batch.resolve import make_batch
from ikde.batch.spec import BatchSpec
from ikde.errors import FileError, InputError
from ikde.files.placed import placed
from ikde.io.robots import is_file_name, load_robot
from ikde.io.schema import Given, as_file_error
from ikde.io.yaml_file import Document, read_yaml
from ikde.model.robot import Robot


def load_batch(source: str | Path | Mapping[str, Any]) -> Batch:
    """Load a run and check all of it, before anything runs.

    Args:
        source: the path of a YAML file, or the same keys as a mapping; paths inside start at the file's folder, or
            at the current one.

    Raises:
        FileError: for a file that cannot be read or is wrong, with its line and key.
        InputError: for a mapping that is wrong, with its key, and for what is neither path nor mapping.
    """
    if isinstance(source, Mapping):
        return _resolve(Given(dict(source)), Path(), None)
    if not isinstance(source, str | PathLike):
        raise InputError(f"expected the path of a run file or a mapping, got {type(source).__name__}")
    path = Path(source)
    return _resolve(read_yaml(path), path.parent, str(path))


def _resolve(source: Document | Given, folder: Path, file: str | None) -> Batch:
    try:
        spec = BatchSpec.model_validate(source.data)
    except ValidationError as error:
        raise as_file_error(source, error, BatchSpec) from None
    try:
        with placed("robot"):
            robot = _load(spec.robot, folder)
        return make_batch(spec, robot, folder=folder, file=file)
    except FileError:
        raise
    except InputError as error:
        raise source.error(error.message, error.where) from None


def _load(name: str, folder: Path) -> Robot:
    """A robot by name, or from a file beside the run file."""
    if not is_file_name(name):
        return load_robot(name)
    path = folder / name
    if not path.exists():
        raise InputError(f"no such file: {path}")
    return load_robot(path)

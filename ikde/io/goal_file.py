"""Goal files to a `Target` or a `Region`."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from os import PathLike
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ValidationError

from ikde.errors import FileError, InputError, quoted
from ikde.formats.error_path import prefix_errors
from ikde.formats.goal_entries import BaseRegionFile, GoalFile
from ikde.formats.goals import TAKE, make_alternatives, make_base, make_goal, with_base
from ikde.io.schema import Given, as_file_error
from ikde.io.yaml_file import Document, read_yaml
from ikde.model.base_region import BaseRegion
from ikde.model.region import Region
from ikde.model.target import Target


def load_goal(source: str | PathLike[str] | Mapping[str, Any]) -> Target | Region:
    """Load a goal and check all of it: a `Region`, or a `Target` if it has no freedom.

    Args:
        source: the path of a YAML file, or its keys as a mapping.

    Raises:
        FileError: for a file that cannot be read or is wrong, with its line and key.
        InputError: for a mapping that is wrong, with its key.
    """
    if not isinstance(source, str | PathLike | Mapping):
        raise InputError(f"expected the path of a goal file or a mapping, got {quoted(source)}")
    document = Given(dict(source)) if isinstance(source, Mapping) else read_yaml(Path(source))
    with _placed(document, GoalFile):
        return _make_goal(GoalFile.model_validate(document.data))


def load_base_region(path: Path) -> BaseRegion:
    """Where a base may stand, from a file of its own; errors as `load_goal`."""
    document = read_yaml(path)
    with _placed(document, BaseRegionFile):
        entry = BaseRegionFile.model_validate(document.data)
        return make_base(entry, entry.units)


@contextmanager
def _placed(document: Document | Given, model: type[BaseModel]) -> Iterator[None]:
    """Errors of what is read, at their place in the file."""
    try:
        yield
    except ValidationError as error:
        raise as_file_error(document, error, model) from None
    except FileError:
        raise
    except InputError as error:
        raise document.error(error.message, error.where) from None


def _make_goal(file: GoalFile) -> Target | Region:
    if (file.goal is None) == (file.any_of is None):
        raise InputError("expected a `goal`, or several in `any_of`", ("goal",) if file.goal else ())
    if file.goal is None:
        goal = make_alternatives(file.any_of or (), file.take, file.units)
    else:
        if file.take != "first":
            raise InputError(TAKE, ("take",))
        with prefix_errors("goal"):
            goal = make_goal(file.goal, file.units)
    return with_base(goal, file.base, file.units)

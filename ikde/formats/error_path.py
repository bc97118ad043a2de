"""Where in the run file something is wrong: each level adds its own key to the path of an error."""

from collections.abc import Iterator
from contextlib import contextmanager

from ikde.errors import FileError, InputError


@contextmanager
def prefix_errors(*where: str | int) -> Iterator[None]:
    """Put `where` before the path of every `InputError` of the block; a `FileError` knows its own file."""
    try:
        yield
    except FileError:
        raise
    except InputError as error:
        raise InputError(error.message, (*where, *error.where)) from None

"""Files that name a robot and say what to do with it, run files and track files: how they become plans."""

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from functools import partial
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from pydantic import ValidationError

from ikde.batch.spec import BatchSpec
from ikde.errors import FileError, InputError
from ikde.formats.error_path import prefix_errors
from ikde.formats.reading import read_text
from ikde.io.robot_file import parse_robot
from ikde.io.robots import is_file_name, is_urdf, load_robot, parse_file
from ikde.io.schema import Given, as_file_error
from ikde.io.yaml_file import Document, read_yaml
from ikde.model.robot import Robot
from ikde.track.spec import TrackSpec

if TYPE_CHECKING:
    from ikde.batch.plan import Batch
    from ikde.batch.worlds import Errors
    from ikde.model.world import World
    from ikde.track.plan import TrackPlan

Spec = TypeVar("Spec", BatchSpec, TrackSpec)
Plan = TypeVar("Plan")


def load_batch(source: str | Path | Mapping[str, Any], attach: str | None = None) -> "Batch":
    """Load a run and check all of it, before anything runs.

    Args:
        source: the path of a YAML file, or the same keys as a mapping; paths inside start at the file's folder, or
            at the current one.
        attach: what the robot picks up in each world beside what the file says under `attached`, as `ikde batch
            --attach` takes it: `mug=tool:table`.

    Raises:
        FileError: for a file that cannot be read or is wrong, with its line and key.
        InputError: for a mapping that is wrong, with its key, and for what is neither path nor mapping.
    """
    from ikde.batch.resolve import make_batch  # here: what the other kind of file needs takes 0.06 s to import

    def make(spec: BatchSpec, robot: Robot, *, folder: Path, file: str | None) -> "Batch":
        read = partial(_read_world, folder)
        return make_batch(spec, robot, folder=folder, file=file, read_world=read, attach=attach)

    return _load_plan(source, "run", BatchSpec, make)


def _read_world(folder: Path, name: str) -> "tuple[World, Errors]":
    from ikde.io.world_file import read_world

    found = read_world(folder / name)
    return found.world, found.errors


def _read_track_world(folder: Path, name: str) -> "tuple[World, Errors]":
    """The same, with the key that names a file which is not there."""
    try:
        read_text(folder / name)
    except FileError as error:
        raise InputError(f"{error.message}: {folder / name}", ("world",)) from None
    return _read_world(folder, name)


def load_track(source: str | Path | Mapping[str, Any]) -> "TrackPlan":
    """Load a track and check all of it, before anything moves; `source` and errors as for `load_batch`."""
    from ikde.track.make_plan import make_plan

    def make(spec: TrackSpec, robot: Robot, *, folder: Path, file: str | None) -> "TrackPlan":
        return make_plan(spec, robot, folder=folder, file=file, read_world=partial(_read_track_world, folder))

    return _load_plan(source, "track", TrackSpec, make)


@contextmanager
def in_track_file(plan: "TrackPlan") -> Iterator[None]:
    """Errors about obstacles that move name the line and key of the track file that describes them."""
    try:
        yield
    except FileError:
        raise
    except InputError as error:
        if plan.file is None or error.where[:1] != ("moving",):
            raise
        raise read_yaml(Path(plan.file)).error(error.message, error.where) from None


def _load_plan(source: Any, kind: str, model: type[Spec], make: Callable[..., Plan]) -> Plan:
    """Load a file of a kind; `make` is called with the spec, the robot, and `folder` and `file` by name."""
    if isinstance(source, Mapping):
        return _resolve(Given(dict(source)), model, make, Path(), None)
    if not isinstance(source, str | PathLike):
        raise InputError(f"expected the path of a {kind} file or a mapping, got {type(source).__name__}")
    path = Path(source)
    return _resolve(read_yaml(path), model, make, path.parent, str(path))


def _resolve(
    source: Document | Given, model: type[Spec], make: Callable[..., Plan], folder: Path, file: str | None
) -> Plan:
    try:
        spec = model.model_validate(source.data)
    except ValidationError as error:
        raise as_file_error(source, error, model) from None
    try:
        with prefix_errors("robot"):
            robot = _load_robot(spec.robot, folder)
        if spec.tool is not None:
            robot = robot.with_tool(spec.tool)
        return make(spec, robot, folder=folder, file=file)
    except FileError:
        raise
    except InputError as error:
        if error.where[:1] == ("attach",):  # typed, and no key of the file
            raise
        raise source.error(error.message, error.where) from None


def _load_robot(name: str, folder: Path) -> Robot:
    """A robot by name, or from a file beside the file that names it."""
    if not is_file_name(name):
        return load_robot(name)
    path = folder / name
    try:
        text = read_text(path)
    except FileError as error:
        raise InputError(f"{error.message}: {path}") from None
    return parse_file(path) if is_urdf(path) else parse_robot(Document(path, text))

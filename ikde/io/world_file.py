"""World files: a document of ikde's own, a cuRobo scene or a MoveIt planning scene, to a checked `World`."""

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from os import PathLike
from pathlib import Path
from typing import Any, NamedTuple

from pydantic import ValidationError

from ikde.errors import FileError, InputError, quoted
from ikde.formats.world_entries import WorldFile
from ikde.io.curobo_scene import is_curobo_scene, read_curobo_scene
from ikde.io.moveit_scene import is_moveit_scene, read_moveit_scene
from ikde.io.scene_values import Reading
from ikde.io.schema import Given, as_file_error
from ikde.io.world_objects import make_file_world
from ikde.io.yaml_file import Document, Where, read_yaml
from ikde.model.world import World

OF_WORLD = ("obstacles", "world")  # where errors begin that a robot has with an obstacle


class ReadWorld(NamedTuple):
    """A world, and what was decided when it was read."""

    world: World
    format: str
    """Of the file: `ikde`, `cuRobo` or `MoveIt`."""
    notes: tuple[str, ...]
    """Meshes that became hulls, planes that became half-spaces, and the like; a line each."""
    document: Document | Given

    @contextmanager
    def errors(self) -> Iterator[None]:
        """What of the world does not fit a robot is said with the line of this file that it stands on."""
        try:
            yield
        except FileError:
            raise
        except InputError as error:
            if len(error.where) > 1 and error.where[0] == "attached" and error.where[1] in self._held:
                raise self.document.error(error.message, error.where) from None
            if len(error.where) < 2 or error.where[0] not in OF_WORLD or error.where[1] not in self.world.names:
                raise
            raise self.error(error.message, str(error.where[1]), *error.where[2:]) from None

    @property
    def _held(self) -> Mapping[str, Any]:
        """What the file itself says that the robot holds."""
        return self.document.data.get("attached") or {} if self.format == "ikde" else {}

    def error(self, message: str, name: str, *inside: str | int) -> InputError:
        """An error about an obstacle, at its place in the file."""
        return self.document.error(message, _locate(self.document.data, name, inside))


def load_world(source: str | PathLike[str] | Mapping[str, Any]) -> World:
    """Load a world and check all of it.

    Args:
        source: the path of a YAML file: ikde's own, a cuRobo scene or a MoveIt planning scene; or its keys as a
            mapping. Files that it names are read inside its folder, or, of a mapping, inside the current one.

    Raises:
        FileError: for a file that cannot be read or is wrong, with its line and key.
        InputError: for a mapping that is wrong, with its key.
    """
    return read_world(source).world


def read_world(source: str | PathLike[str] | Mapping[str, Any]) -> ReadWorld:
    """Load a world as `load_world` does, with what was decided; `source` and errors are the same."""
    if isinstance(source, Mapping):
        return _parse(Given(dict(source)), Path())
    if not isinstance(source, str | PathLike):
        raise InputError(f"expected the path of a world file or a mapping, got {quoted(source)}")
    return _parse(read_yaml(Path(source)), Path(source).parent)


def _parse(document: Document | Given, folder: Path) -> ReadWorld:
    name, read = _find_reader(document.data)
    reading = Reading(folder)
    try:
        world = read(document.data, reading)
    except ValidationError as error:
        raise as_file_error(document, error, WorldFile) from None
    except FileError:
        raise
    except InputError as error:
        raise document.error(error.message, error.where) from None
    return ReadWorld(world, name, tuple(reading.notes), document)


def _find_reader(data: Any) -> tuple[str, Callable[[Any, Reading], World]]:
    if isinstance(data, Mapping) and "obstacles" not in data:
        if is_moveit_scene(data):
            return "MoveIt", read_moveit_scene
        if is_curobo_scene(data):
            return "cuRobo", read_curobo_scene
    return "ikde", lambda given, reading: make_file_world(WorldFile.model_validate(given), reading)


def _locate(data: Any, name: str, inside: Where) -> Where:
    """The path of an obstacle, or of what is inside it; of scenes of others of the obstacle, and of its frame."""
    if "obstacles" in data:
        return ("obstacles", name, *inside)
    if not is_moveit_scene(data):
        return next(((kind, name) for kind, entries in data.items() if name in (entries or ())), ())
    objects, above = (data["world"], ("world",)) if "world" in data else (data, ())
    place = [str(entry["id"]) for entry in objects["collision_objects"]].index(name)
    frame = ("header", "frame_id") if inside[:1] == ("frame",) else ()
    return (*above, "collision_objects", place, *frame)

"""Robots by name (those that ship with ikde) or by file: a robot file, or a URDF."""

from functools import lru_cache
from pathlib import Path

from ikde.errors import InputError, nearest, quoted
from ikde.io.ready_robot import read_ready
from ikde.model.robot import Robot

OF_URDF = (".urdf", ".xacro")
FOLDER = Path(__file__).parent.parent / "robots"


def robot_names() -> tuple[str, ...]:
    """Names of the robots that ship with ikde."""
    return tuple(sorted(path.stem for path in FOLDER.glob("*.yaml")))


def is_file_name(text: str) -> bool:
    """True for what names a file rather than a robot that ships with ikde."""
    return "/" in text or "\\" in text or text.lower().endswith((".yaml", ".yml", *OF_URDF))


def is_there(path: str | Path) -> bool:
    """Whether there is such a file or folder; False, too, for what can be no name of one."""
    try:
        return Path(path).exists()
    except OSError:  # too long
        return False


def is_urdf(path: Path) -> bool:
    """True for the name of a URDF, or of what becomes one."""
    return path.suffix.lower() in OF_URDF


def find_urdf(file: str) -> tuple[Path, tuple[Path, ...]]:
    """A URDF by its path or, if there is no such file, by the name of an installed one; and folders of its meshes.

    Raises:
        InputError: for a name that no installed URDF has, with the nearest.
    """
    if is_file_name(file) or is_there(file):
        return Path(file), ()
    from ikde.io.urdf_import.installed import find_installed

    return find_installed(file)


def robot_path(name_or_path: str | Path) -> Path:
    """The file behind a name or a path; raises `InputError` for an unknown name."""
    text = str(name_or_path)
    is_file = is_there(text) and Path(text).is_file()
    if isinstance(name_or_path, Path) or is_file_name(text) or (text not in robot_names() and is_file):
        return Path(name_or_path)
    if text not in robot_names():
        known = ", ".join(robot_names())
        raise InputError(
            f"no robot is called {quoted(text)}{nearest(text, robot_names())}; ikde has {known}; or name a file"
        )
    return FOLDER / f"{text}.yaml"


def load_robot(name_or_path: str | Path) -> Robot:
    """Load a robot.

    Args:
        name_or_path: the name of a robot that ships with ikde (`robot_names()`), or the path of a YAML file, or of a
            URDF, which is read as by `ikde.import_urdf(path)`.

    Raises:
        InputError: for an unknown name.
        FileError: for a file that cannot be read or is wrong, with its line and key.
    """
    path = robot_path(name_or_path)
    return _load_shipped(path) if path.parent == FOLDER else parse_file(path)


@lru_cache
def _load_shipped(path: Path) -> Robot:
    return read_ready(path) or parse_file(path)


def parse_file(path: Path) -> Robot:
    """The robot that a file describes; pydantic is imported here, since it takes as long as a solve without it."""
    if is_urdf(path):
        from ikde.io.urdf_import.read_urdf import import_urdf

        return import_urdf(path)
    from ikde.io.robot_file import parse_robot
    from ikde.io.yaml_file import read_yaml

    return parse_robot(read_yaml(path))


def check_kept(out: Path | None, *read: Path | None) -> None:
    """Raise `InputError` if what is to be written is one of the files that are read."""
    for path in read:
        if out is not None and path is not None and is_there(out) and is_there(path) and out.samefile(path):
            raise InputError(f"{out} is what is read; expected another file to write", ("out",))


def load_part(path: Path) -> Robot:
    """A robot for `compose`, from a file: unlike others it may have no joints at all, as a rigid tool."""
    if is_urdf(path):
        return parse_file(path)
    from ikde.io.robot_file import parse_part
    from ikde.io.yaml_file import read_yaml

    return parse_part(read_yaml(path))

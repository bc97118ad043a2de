"""Robots by name (those that ship with ikde) or by file."""

from functools import lru_cache
from pathlib import Path

from ikde.errors import InputError, nearest
from ikde.io.ready_robot import read_ready
from ikde.model.robot import Robot

FOLDER = Path(__file__).parent.parent / "robots"


def robot_names() -> tuple[str, ...]:
    """Names of the robots that ship with ikde."""
    return tuple(sorted(path.stem for path in FOLDER.glob("*.yaml")))


def is_file_name(text: str) -> bool:
    """True for what names a file rather than a robot that ships with ikde."""
    return "/" in text or "\\" in text or text.endswith((".yaml", ".yml"))


def robot_path(name_or_path: str | Path) -> Path:
    """The file behind a name or a path; raises `InputError` for an unknown name."""
    text = str(name_or_path)
    if isinstance(name_or_path, Path) or is_file_name(text) or (text not in robot_names() and Path(text).is_file()):
        return Path(name_or_path)
    if text not in robot_names():
        known = ", ".join(robot_names())
        raise InputError(f"no robot is called {text!r}{nearest(text, robot_names())}; ikde has {known}; or name a file")
    return FOLDER / f"{text}.yaml"


def load_robot(name_or_path: str | Path) -> Robot:
    """Load a robot.

    Args:
        name_or_path: the name of a robot that ships with ikde (`robot_names()`), or the path of a YAML file.

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
    from ikde.io.robot_file import parse_robot
    from ikde.io.yaml_file import read_yaml

    return parse_robot(read_yaml(path))

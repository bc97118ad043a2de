"""Joint values as people type them: numbers in one string, `name=value` pairs, or a YAML/JSON file."""

import re
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ikde.errors import InputError, nearest, quoted
from ikde.formats.units import ANGLES_RAD, LENGTHS_M

if TYPE_CHECKING:
    from ikde.model.robot import Robot

MINUS_SIGNS = str.maketrans("−–—‐‑", "-----")  # a row pasted from a paper carries a typographer's minus
SEPARATORS = re.compile(r"[\s,;()\[\]]+")
FILE_ENDINGS = (".yaml", ".yml", ".json")
FORMS = "; give a number for each joint, joints by name as q1=0.5,q2=1, or a YAML or JSON file"


def split_values(text: str) -> list[str]:
    """The values in a text: between blanks, commas, semicolons and brackets."""
    return list(filter(None, SEPARATORS.split(text.translate(MINUS_SIGNS))))


def parse_joints(robot: "Robot", text: str, unit: str, angles: str, key: str = "q") -> list[float] | dict[str, float]:
    """Parse joint values into m and rad: a list in the robot's order, or a dict by joint name.

    `text` is `"0 0 0.1 ..."`, `"q1=0.5 q_z=0"`, or the path of a YAML or JSON file with a list or a mapping; prismatic
    joints are in `unit`, revolute ones in `angles`. An error calls the value `key`.

    Raises:
        InputError: for words that are no numbers, a wrong count, an unknown joint.
    """
    scale = {j.name: LENGTHS_M[unit] if j.kind == "prismatic" else ANGLES_RAD[angles] for j in robot.joints}
    values = _read(text, key)
    if isinstance(values, Mapping):
        return {name: value * scale[_known(name, scale, key)] for name, value in values.items()}
    if len(values) != len(scale):
        raise InputError(f"expected {len(scale)} joint values ({', '.join(scale)}), got {len(values)}", (key,))
    return [value * factor for value, factor in zip(values, scale.values(), strict=True)]


def parse_freeze(robot: "Robot", text: str, unit: str, angles: str) -> dict[str, float | None]:
    """Parse `d_x=0.2,q_z` into joints with their frozen value in m or rad, or None."""
    frozen: dict[str, float | None] = {}
    for word in split_values(text):
        name, equals, value = word.partition("=")
        if _known(name, robot.joint_names, "freeze") in frozen:
            raise InputError("this joint is given twice", ("freeze", name))
        frozen[name] = None
        if equals:
            parsed = parse_joints(robot, f"{name}={value}", unit, angles, "freeze")
            frozen[name] = parsed[name] if isinstance(parsed, dict) else None
    return frozen


def parse_weights(robot: "Robot", text: str) -> dict[str, float]:
    """Parse `q1=2,d_x=0.5`, or a file, into weights by joint name, per m or rad."""
    weights = _read(text, "weights")
    if not isinstance(weights, Mapping):
        raise InputError("expected name=value", ("weights",))
    return {_known(name, robot.joint_names, "weights"): value for name, value in weights.items()}


def _read(text: str, key: str) -> list[float] | dict[str, float]:
    if text.strip().lower().endswith(FILE_ENDINGS):
        return _read_file(Path(text.strip()))
    words = split_values(text)
    if not any("=" in word for word in words):
        return [_number(word, (key,), FORMS) for word in words]
    pairs = {}
    for word in words:
        name, equals, value = word.partition("=")
        if not equals:
            raise InputError(f"expected name=value, got {quoted(word)}", (key,))
        if name in pairs:
            raise InputError("this joint is given twice", (key, name))
        pairs[name] = _number(value, (key, name))
    return pairs


def _read_file(path: Path) -> list[float] | dict[str, float]:
    from ikde.io.yaml_file import read_yaml

    document = read_yaml(path)
    data: Any = document.data
    items = enumerate(data) if isinstance(data, list) else data.items() if isinstance(data, dict) else None
    if items is None:
        raise document.error("expected a list of joint values, or a mapping from joint names to values")
    for where, value in items:
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise document.error(f"expected a number, got {quoted(value)}", (where,))
    return data


def _number(word: str, where: tuple[Any, ...], forms: str = "") -> float:
    try:
        return float(word)
    except ValueError:
        raise InputError(f"expected a number, got {quoted(word)}{forms}", where) from None


def _known(name: str, names: Any, key: str) -> str:
    if name not in names:
        known = f"{nearest(name, names)}; joints are {', '.join(names)}"
        raise InputError(f"no joint is called {quoted(name)}{known}", (key,))
    return name

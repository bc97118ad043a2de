"""What a shell completes: robots, and what the chosen robot calls its joints, detectors, pair lists and conventions.

Robot files are read as YAML alone, without numpy: a key that is pressed waits for it. A name that holds more than
letters, digits and `_.+-` is not offered, since shells evaluate what they are given.
"""

import os
import re
from collections.abc import Callable, Iterable
from contextlib import suppress
from pathlib import Path
from typing import Any

import typer

ROBOTS = Path(__file__).parent.parent / "robots"
HARMLESS = re.compile(r"[\w.+-]+", re.ASCII)
DEFAULT_ROBOT = "qiao2021"
ROBOT = "IKDE_ROBOT"
"""Environment variable: the robot where none is named."""


def offer(*words: str) -> Callable[[str], list[str]]:
    """Completion of one of these words."""
    return lambda incomplete: _fitting(words, incomplete)


def offer_robots(incomplete: str) -> list[str]:
    """The robots that ship with ikde; where none fits, shells offer files."""
    return _fitting(sorted(path.stem for path in ROBOTS.glob("*.yaml")), incomplete)


def offer_section(section: str, *others: str) -> Callable[[typer.Context, str], list[str]]:
    """Completion of what a section of the chosen robot's file names, and of other words."""
    return lambda ctx, incomplete: _fitting([*_names(ctx, section), *others], incomplete)


def offer_joints(mark: str = "") -> Callable[[typer.Context, str], list[str]]:
    """Completion of joints in a list with commas, each once; `mark` follows each: `=` where a value has to."""

    def complete(ctx: typer.Context, incomplete: str) -> list[str]:
        before, comma, last = incomplete.rpartition(",")
        given = {word.partition("=")[0] for word in before.split(",")}
        left = [name for name in _names(ctx, "joints") if name not in given]
        return [f"{before}{comma}{name}{mark}" for name in _fitting(left, last)]

    return complete


def _fitting(words: Iterable[str], incomplete: str) -> list[str]:
    return [word for word in words if word.startswith(incomplete) and HARMLESS.fullmatch(word.replace("/", ""))]


def _names(ctx: typer.Context, section: str) -> list[str]:
    """Keys of a section of the robot's file; none if that cannot be read."""
    typed = ctx.args if "name" in ctx.params else []  # an option without its value keeps typer from reading arguments
    given = ctx.params.get("robot") or next(iter(typed), None) or ctx.params.get("name")
    name = str(given or os.environ.get(ROBOT) or DEFAULT_ROBOT)
    shipped = ROBOTS / f"{name}.yaml"
    data: Any = None
    with suppress(Exception):
        from ikde.io.yaml_file import read_yaml

        data = read_yaml(shipped if HARMLESS.fullmatch(name) and shipped.exists() else Path(name)).data
    names = data.get(section) if isinstance(data, dict) else None
    return [str(key) for key in names] if isinstance(names, dict) else []

"""A shipped robot as `parse_robot` made it, in JSON beside its file: read in 2 ms, where YAML and pydantic take 200.

What stands there names the SHA-256 of the robot file, and is passed over if that is another one. Numbers are written so
that they are read to the bit; they are also the same on every machine, as those that numpy's sine makes may not be.
"""

import hashlib
import json
from pathlib import Path

from ikde.model.plain_data import decode, encode
from ikde.model.robot import Robot

FOLDER = "ready"  # beside the robot files


def format_ready(robot: Robot, source: bytes) -> str:
    """The text for a robot that was made of these bytes."""
    return json.dumps({"source": _digest(source), "robot": encode(robot)}, ensure_ascii=False, indent=1) + "\n"


def read_ready(path: Path) -> Robot | None:
    """The robot of a shipped file, or None if nothing stands beside the file, or it was made of another one."""
    try:
        written = json.loads((path.parent / FOLDER / f"{path.stem}.json").read_bytes())
        return decode(Robot, written["robot"]) if written["source"] == _digest(path.read_bytes()) else None
    except FileNotFoundError:
        return None


def _digest(source: bytes) -> str:
    return hashlib.sha256(source).hexdigest()

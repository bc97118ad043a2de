"""The recipe of a run: plain data that holds all that the answers depend on, so that two runs can be compared."""

import hashlib
import json
import math
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from importlib import import_module
from typing import Any

import numpy as np

from ikde.model.robot import Robot

LEAVES_ANSWERS_ALONE = (  # all pairs are in `pair_lists`
    *(
        "title",
        "provenance",
        "wheels",
        "adjacent",
        "compared",
        "neighbours",
        "file_ranges",
        "drive",
        "inertias",
        "tools",
        "free_joints",
    ),
)
OF_TRACKS = ("max_speed", "max_acceleration", "max_effort")  # of joints: a batch solves for poses, not for motions


def as_plain(value: Any) -> Any:
    """Dataclasses, arrays, tuples and mappings as dicts, lists and scalars: what JSON can hold. Infinities are null."""
    if is_dataclass(value):
        return {field.name: as_plain(getattr(value, field.name)) for field in fields(value)}
    if isinstance(value, Mapping):
        return {str(key): as_plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [as_plain(item) for item in value]
    if isinstance(value, np.ndarray | np.generic):
        return as_plain(value.tolist())
    return None if isinstance(value, float) and math.isinf(value) else value


def digest(value: Any) -> str:
    """SHA-256 of plain data, hex; the order of keys does not matter, the last bit of a number does."""
    canonical = json.dumps(value, sort_keys=True, separators=(",", ":"), allow_nan=False)
    return hashlib.sha256(canonical.encode()).hexdigest()


def ikde_version() -> str:
    """Version of ikde; the package itself is above this floor, so it is asked for by name."""
    return import_module("ikde").__version__


def robot_digest(robot: Robot) -> str:
    """Digest of everything that an answer depends on: not title, wheels, speeds, masses, reasons nor sources."""
    changes = {field.name: as_plain(getattr(robot, field.name)) for field in fields(robot)}
    changes["joints"] = [{k: v for k, v in joint.items() if k not in OF_TRACKS} for joint in changes["joints"]]
    return digest({name: value for name, value in changes.items() if name not in LEAVES_ANSWERS_ALONE})


def array_digest(*arrays: np.ndarray) -> str:
    """Digest of arrays of numbers: their shapes and bits."""
    hasher = hashlib.sha256()
    for array in arrays:
        hasher.update(repr(array.shape).encode())
        hasher.update(np.ascontiguousarray(array).tobytes())
    return hasher.hexdigest()

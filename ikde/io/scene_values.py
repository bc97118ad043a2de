"""Values of scenes that other programs write: keys, lists, poses; and what a reader of files learns besides a world."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ikde.errors import InputError, nearest, quoted
from ikde.formats.error_path import prefix_errors
from ikde.kernels.arrays import Floats
from ikde.model.rotation import rotation_from_quat_wxyz
from ikde.model.solids import IDENTITY

UNIT_LENGTH = 1e-3
"""How far the length of a quaternion in a file may be from 1: files round their numbers."""
MAX_NOTES = 1000
MAX_NUMBER = 1e9  # as in all files


class Reading:
    """Where the files that a world names are, and what is said of what was read."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.notes: list[str] = []
        self.cloud_points = 0
        self.mesh_triangles = 0

    def note(self, text: str) -> None:
        """Say something, once."""
        if text not in self.notes and len(self.notes) < MAX_NOTES:
            self.notes.append(text)


def get(entry: Mapping[str, Any], key: str) -> Any:
    """The value of a key that must be there."""
    if entry.get(key) is None:
        raise InputError("this key is missing", (key,))
    return entry[key]


def as_mapping(value: Any) -> Mapping[str, Any]:
    """Keys with values; nothing at all is none."""
    if value is None:
        return {}
    if not isinstance(value, Mapping):
        raise InputError(f"expected keys with values, got {quoted(value)}")
    return value


def as_list(value: Any) -> list[Any]:
    """A list; nothing at all is empty."""
    if value is None:
        return []
    if not isinstance(value, list):
        raise InputError(f"expected a list, got {quoted(value)}")
    return value


def as_numbers(value: Any, names: Sequence[str]) -> Floats:
    """Numbers in a list, or under their names; those that are not named are refused, those that are missing, too."""
    if isinstance(value, Mapping):
        check_keys(value, names)
        value = [get(value, name) for name in names]
    if not isinstance(value, list) or len(value) != len(names):
        raise InputError(f"expected {len(names)} numbers ({', '.join(names)}), got {quoted(value)}")
    for place, number in enumerate(value):
        with prefix_errors(place):
            as_number(number)
    return np.array(value, dtype=float)


def as_number(value: Any) -> float:
    """A finite number."""
    if isinstance(value, bool) or not isinstance(value, int | float) or not abs(value) <= MAX_NUMBER:
        raise InputError(f"expected a finite number, got {quoted(value)}")
    return float(value)


def as_values(value: Any, key: str) -> Any:
    """What stands under the only key of a message, or the value itself."""
    return value.get(key) if isinstance(value, Mapping) else value


def as_name(value: Any) -> str:
    """A name; numbers are names, too, for YAML takes `007` for one."""
    if isinstance(value, bool) or not isinstance(value, str | int | float):
        raise InputError(f"expected a name, got {quoted(value)}")
    return str(value)


def check_keys(entry: Mapping[str, Any], known: Sequence[str]) -> None:
    """Refuse keys that are not known: what is read in part would be called free where it is not."""
    for key in entry:
        if key not in known:
            hint = nearest(key, known) or f"; expected one of {', '.join(known)}"
            raise InputError(f"unknown key{hint}", (key,))


def make_pose(p: Floats, quat_wxyz: Floats) -> Floats:
    """A pose [3, 4] from a place [3] in m and a unit quaternion [4], w first."""
    T = np.eye(4)[:3]
    T[:, :3], T[:, 3] = rotation_from_unit_quat(quat_wxyz), p
    return T


def rotation_from_unit_quat(quat_wxyz: Floats) -> Floats:
    """The rotation [3, 3] of a quaternion [4], w first, of length 1 within `UNIT_LENGTH`; others are refused."""
    size = float(np.linalg.norm(quat_wxyz))
    if not abs(size - 1.0) <= UNIT_LENGTH:
        raise InputError(f"expected a quaternion of length 1, got one of length {size:g}")
    return rotation_from_quat_wxyz(quat_wxyz)


def compose(T_a_b: Floats, T_b_c: Floats) -> Floats:
    """T_a_c [3, 4] from poses [3, 4]; the identity on either side keeps the bits of the other."""
    if T_b_c is IDENTITY or np.array_equal(T_b_c, IDENTITY):
        return T_a_b
    if T_a_b is IDENTITY or np.array_equal(T_a_b, IDENTITY):
        return T_b_c
    T = np.empty((3, 4))
    T[:, :3] = T_a_b[:, :3] @ T_b_c[:, :3]
    T[:, 3] = T_a_b[:, :3] @ T_b_c[:, 3] + T_a_b[:, 3]
    return T


class Frames:
    """Frames that a file places, by name: parent and pose in it."""

    def __init__(self) -> None:
        self._placed: dict[str, tuple[str, Floats]] = {}
        self._resolved: dict[str, tuple[str, Floats]] = {}

    def add(self, name: str, parent: str, T_parent_frame: Floats) -> None:
        """Place a frame in another."""
        if name in self._placed:
            raise InputError(f"two frames are called {quoted(name)}")
        self._placed[name] = parent, T_parent_frame

    def resolve(self, frame: str) -> tuple[str, Floats]:
        """The frame that no file places, a frame's last parent, and the pose [3, 4] in it; cycles are refused."""
        above = {frame: None}  # in order
        while frame not in self._resolved and frame in self._placed:
            frame = self._placed[frame][0]
            if frame in above:
                names = list(above)
                cycle = " -> ".join([*names[names.index(frame) :], frame])
                raise InputError(f"frames are placed in each other: {cycle}")
            above[frame] = None
        last, T = self._resolved.get(frame, (frame, IDENTITY))
        for name in [*above][-2::-1]:
            T = compose(T, self._placed[name][1])
            self._resolved[name] = last, T
        return last, T


def prefixed(where: tuple[str | int, ...], value: Any, names: Sequence[str]) -> Floats:
    """`as_numbers` of a value at a place."""
    with prefix_errors(*where):
        return as_numbers(value, names)

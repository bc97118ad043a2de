"""Equality by value for frozen dataclasses that hold arrays or mappings, which Python neither compares nor hashes."""

import json
from collections.abc import Callable, Mapping
from dataclasses import fields
from hashlib import sha256
from types import MappingProxyType
from typing import Any

import numpy as np

from ikde.kernels.arrays import read_only
from ikde.model.plain_data import encode

FEW = 64  # numbers of an array that a hash takes


class Value:
    """Equal are two of one class whose fields are equal to the bit (0.0 is not -0.0), also after pickling or copying.

    Fields are read once, when they are first compared or hashed: 1 ms for a robot, then 0.05 us a call.
    """

    __slots__ = ("_digest",)

    def __eq__(self, other: object) -> bool:
        if self is other:
            return True
        return _digest(self) == _digest(other) if type(other) is type(self) else NotImplemented

    def __hash__(self) -> int:
        try:
            return hash(self._digest)
        except AttributeError:
            return hash(_digest(self))


def _digest(value: Any) -> bytes:
    try:
        return value._digest
    except AttributeError:
        text = json.dumps(encode(value), default=lambda number: number.item())
        object.__setattr__(value, "_digest", sha256(text.encode()).digest())
        return value._digest


class MadeAnew:
    """A dataclass that pickling and copying make anew from its fields: arrays that travel would arrive writable."""

    __slots__ = ()

    def __reduce__(self) -> tuple[Any, ...]:
        known = {field.name: _pack(getattr(self, field.name)) for field in fields(self)}  # type: ignore[arg-type]
        return _make, (type(self), known)


class ReadOnlyValue(MadeAnew, Value):
    """A value whose arrays and mappings are read-only copies, also after pickling or copying: what is found is kept."""

    __slots__ = ()

    def __post_init__(self) -> None:
        for field in fields(self):  # type: ignore[arg-type]
            object.__setattr__(self, field.name, _keep(getattr(self, field.name)))


class ByFields(MadeAnew):
    """Equal are two of one class whose fields are, arrays to the bit; arrays are read-only, also after they travelled.

    Nothing is written down for it, since a cloud of points may be large: a hash takes of an array its shape, and a few
    of its numbers, so that two clouds are hardly ever compared number by number. Fields with
    `compare=False` do not count.
    """

    __slots__ = ("_hash",)

    def __post_init__(self) -> None:
        for field in fields(self):  # type: ignore[arg-type]
            value = getattr(self, field.name)
            if isinstance(value, np.ndarray):
                read_only(value)

    def __eq__(self, other: object) -> bool:
        if self is other:
            return True
        if type(other) is not type(self):
            return NotImplemented
        names = [field.name for field in fields(self) if field.compare]  # type: ignore[arg-type]
        return hash(self) == hash(other) and all(_is_same(getattr(self, name), getattr(other, name)) for name in names)

    def __hash__(self) -> int:
        try:
            return self._hash
        except AttributeError:
            compared = [field.name for field in fields(self) if field.compare]  # type: ignore[arg-type]
            object.__setattr__(self, "_hash", hash(tuple(_key(getattr(self, name)) for name in compared)))
            return self._hash


def _is_same(a: Any, b: Any) -> bool:
    if a is b:
        return True
    if isinstance(a, np.ndarray) and isinstance(b, np.ndarray):
        bits = f"u{a.dtype.itemsize}"
        return a.dtype == b.dtype and np.array_equal(a.view(bits), b.view(bits))
    return a == b


def _key(value: Any) -> Any:
    """What of a field a hash is of."""
    if not isinstance(value, np.ndarray):
        return value
    return value.tobytes() if value.size <= FEW else (value.shape, value.flat[:: value.size // FEW].tobytes())


def _keep(value: Any) -> Any:
    """A read-only copy of an array or a mapping; anything else is as it is."""
    if isinstance(value, np.ndarray):
        return read_only(value.copy())
    if isinstance(value, Mapping):
        return MappingProxyType({key: _keep(item) for key, item in value.items()})
    return value


def _pack(value: Any) -> Any:
    """What `_keep` has made, as pickle takes it."""
    return {key: _pack(item) for key, item in value.items()} if isinstance(value, MappingProxyType) else value


def _make(kind: Callable[..., Any], known: Mapping[str, Any]) -> Any:
    return kind(**known)

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

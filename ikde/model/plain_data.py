"""Robots and what they are made of as plain data, for JSON: every number is read to the bit."""

from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from typing import Any, get_args, get_origin

import numpy as np


def encode(value: Any) -> Any:
    """Dictionaries, lists, text, numbers and None."""
    if is_dataclass(value):
        return {field.name: encode(getattr(value, field.name)) for field in fields(value)}
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, Mapping):  # keys may be tuples
        return [[encode(key), encode(item)] for key, item in value.items()]
    return [encode(item) for item in value] if isinstance(value, tuple) else value


def decode(kind: Any, value: Any) -> Any:
    """The value of a field of this type, out of what `encode` made of it; raises what comes for anything else."""
    if is_dataclass(kind):
        return kind(**{field.name: decode(field.type, value[field.name]) for field in fields(kind)})  # type: ignore[operator]
    origin, inner = get_origin(kind), get_args(kind)
    if origin is np.ndarray:
        return np.array(value)
    if origin is tuple:
        return tuple(decode(inner[0], item) for item in value)
    if origin is Mapping or (isinstance(origin, type) and issubclass(origin, Mapping)):
        return {decode(inner[0], key): decode(inner[1], item) for key, item in value}
    known = [part for part in inner if part is not type(None)]
    for part in known if len(known) > 1 else ():  # dataclasses that their fields tell apart
        if is_dataclass(part) and {field.name for field in fields(part)} == set(value):
            return decode(part, value)
    return decode(known[0], value) if value is not None and type(None) in inner else value

"""Pydantic's complaints as ikde says them: a line each, with the file, the line, the key and what was expected."""

from collections.abc import Mapping, Sequence
from types import UnionType
from typing import Annotated, Any, NamedTuple, Union, get_args, get_origin

from pydantic import BaseModel, ValidationError

from ikde.errors import InputError, nearest, quoted
from ikde.io.yaml_file import Document, Where

EXPECTED = {
    "missing": "this key is missing",
    "float_type": "expected a number",
    "int_type": "expected a whole number",
    "bool_type": "expected true or false",
    "bool_parsing": "expected true or false",
    "int_parsing": "expected a whole number",
    "int_from_float": "expected a whole number",
    "string_type": "expected text",
    "dict_type": "expected keys with values",
    "list_type": "expected a list",
    "model_type": "expected keys with values",
    "model_attributes_type": "expected keys with values",
    "finite_number": "expected a finite number",
    "string_too_short": "expected text that is not empty",
}
UNKNOWN = "extra_forbidden"  # what pydantic calls a key that is none
MAX_LISTED = 10  # errors of a file that are listed
FEW = 4  # values: where there may not be more, there may not be fewer either
LIMITS = {
    "greater_than_equal": ("at least", "ge"),
    "greater_than": ("more than", "gt"),
    "less_than_equal": ("at most", "le"),
    "less_than": ("less than", "lt"),
}


class Given:
    """Data that came from no file: errors name the key alone."""

    def __init__(self, data: Any) -> None:
        self.data = data

    def line(self, where: Where) -> None:
        """Data that came from no file has no lines."""

    def error(self, message: str, where: Where = ()) -> InputError:
        """An error at a path of the data."""
        return InputError(message, where)


def as_file_error(document: Document | Given, error: ValidationError, model: type[BaseModel]) -> InputError:
    """Pydantic's complaints, placed in the file: the first one with the others as its notes, in order of lines.

    The first `MAX_LISTED` are listed, the others counted.
    """
    complaints = [_place(document.data, complaint) for complaint in error.errors()]
    listed = [complaint for complaint in complaints if not _is_misspelt(complaint, complaints, model)]
    listed.sort(key=lambda it: (document.line(it.where) or 0, it.kind != UNKNOWN))
    return _join([document.error(_describe(it, model), it.where) for it in listed[:MAX_LISTED]], len(listed))


def place_errors(document: Document | Given, error: InputError) -> InputError:
    """What is wrong with values, placed and listed likewise."""
    found = sorted((error, *error.others), key=lambda it: document.line(it.where) or 0)
    return _join([document.error(it.message, it.where) for it in found[:MAX_LISTED]], len(found))


def _join(listed: Sequence[InputError], count: int) -> InputError:
    """The first of `count`, with the others that are listed as its notes."""
    first, *others = listed
    for other in others:
        first.add_note(str(other))
    if count > MAX_LISTED:
        first.add_note(f"and {count - MAX_LISTED} more")
    return first


class _Complaint(NamedTuple):
    """What is wrong with one value."""

    kind: str
    where: Where
    key: str
    """The last step to it, also where the file has no such key."""
    details: Mapping[str, Any]
    """As pydantic gives them."""


def _place(data: Any, complaint: Mapping[str, Any]) -> _Complaint:
    steps = complaint["loc"]
    where = _real_path(data, steps, is_missing=complaint["type"] == "missing")
    return _Complaint(complaint["type"], where, str(steps[-1]) if steps else "", complaint)


def _is_misspelt(complaint: _Complaint, all_of_them: Sequence[_Complaint], model: type[BaseModel]) -> bool:
    """True for a key that is missing because it was misspelt: the unknown key beside it says so."""
    beside = [c for c in all_of_them if c.kind == UNKNOWN and c.where[:-1] == complaint.where[:-1]]
    hint = quoted(complaint.key)
    return complaint.kind == "missing" and any(hint in nearest(c.key, _keys_at(model, c.where[:-1])) for c in beside)


def _describe(complaint: _Complaint, model: type[BaseModel]) -> str:
    """What is said of a complaint."""
    kind, where, details = complaint.kind, complaint.where, complaint.details
    context = details.get("ctx", {})
    if kind == UNKNOWN:
        keys = _keys_at(model, where[:-1])
        return f"unknown key{nearest(complaint.key, keys) or '; expected one of ' + ', '.join(keys)}"
    if "actual_length" in context:
        return _describe_length(kind, context)
    if kind == "literal_error":
        return f"expected {context['expected']}, got {quoted(details['input'])}"
    if kind in LIMITS:
        words, key = LIMITS[kind]
        limit = context[key]
        return f"expected {words} {limit:{'g' if isinstance(limit, float) else ','}}, got {quoted(details['input'])}"
    if kind in EXPECTED:  # a whole file that is something else is not quoted
        got = "" if kind == "missing" or not where else f", got {quoted(details['input'])}"
        return f"{EXPECTED[kind]}{got}"
    return details["msg"][0].lower() + details["msg"][1:]


def _describe_length(kind: str, context: Mapping[str, Any]) -> str:
    length = context["actual_length"]
    if kind == "too_short":
        least = context["min_length"]
        return f"expected {'at least 1 value' if least == 1 else f'{least} values'}, got {length}"
    most, got = context["max_length"], "more" if length is None else f"{length:,}"  # pydantic stops counting keys
    return f"expected {most if most <= FEW else f'at most {most:,}'} values, got {got}"


def _real_path(data: Any, loc: tuple[Any, ...], *, is_missing: bool) -> Where:
    """Pydantic's location without the union branches it adds, which are no keys of the file; a missing key is one."""
    where: list[str | int] = []
    for position, key in enumerate(loc):
        if isinstance(data, dict) and (key in data or (is_missing and position == len(loc) - 1)):
            where.append(key)
            data = data.get(key)
        elif isinstance(data, list) and isinstance(key, int):
            where.append(key)
            data = data[key] if key < len(data) else None
    return tuple(where)


def _keys_at(model: type[BaseModel], where: Where) -> list[str]:
    """Valid keys of the entry at a path."""
    kind: Any = model
    for key in where:
        if isinstance(kind, type) and issubclass(kind, BaseModel):
            fields = {field.alias or name: field.annotation for name, field in kind.model_fields.items()}
            kind = _strip(fields.get(str(key)))
        else:
            kind = _strip(get_args(kind)[-1])
    if not (isinstance(kind, type) and issubclass(kind, BaseModel)):
        return []
    return [field.alias or name for name, field in kind.model_fields.items()]


def _strip(kind: Any) -> Any:
    """`X | None` as X, and of several kinds the one that has keys."""
    if get_origin(kind) is Annotated:
        return _strip(get_args(kind)[0])
    if get_origin(kind) in (Union, UnionType):
        kinds = [_strip(arg) for arg in get_args(kind) if arg is not type(None)]
        return next((k for k in kinds if isinstance(k, type) and issubclass(k, BaseModel)), kinds[0])
    return kind

"""Pydantic's complaints as ikde says them: one line, with the file, the line, the key and what was expected."""

from types import UnionType
from typing import Annotated, Any, Union, get_args, get_origin

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
FEW = 4  # values: where there may not be more, there may not be fewer either
LIMITS = {
    "greater_than_equal": ("at least", "ge"),
    "greater_than": ("more than", "gt"),
    "less_than_equal": ("at most", "le"),
    "less_than": ("less than", "lt"),
}

KEY_ITSELF = "[key]"  # pydantic's last step to a key that is wrong, where others lead to values


class Given:
    """Data that came from no file: errors name the key alone."""

    def __init__(self, data: Any) -> None:
        self.data = data

    def error(self, message: str, where: Where = ()) -> InputError:
        """An error at a path of the data."""
        return InputError(message, where)


def as_file_error(document: Document | Given, error: ValidationError, model: type[BaseModel]) -> InputError:
    """The first complaint of pydantic, placed in the file; a misspelt key before the key that it left missing."""
    first = min(error.errors(), key=lambda complaint: complaint["type"] != "extra_forbidden")
    where = _real_path(document.data, first["loc"])
    kind, context = first["type"], first.get("ctx", {})
    if kind == "extra_forbidden":
        key = str(first["loc"][-1])
        keys = _keys_at(model, where[:-1])
        return document.error(f"unknown key{nearest(key, keys) or '; expected one of ' + ', '.join(keys)}", where)
    if kind == "too_short" and "actual_length" in context:
        least = context["min_length"]
        message = f"expected {'at least 1 value' if least == 1 else f'{least} values'}, got {context['actual_length']}"
    elif kind == "too_long" and "actual_length" in context:
        most, length = context["max_length"], context["actual_length"]
        got = "more" if length is None else f"{length:,}"  # pydantic stops counting keys
        message = f"expected {most if most <= FEW else f'at most {most:,}'} values, got {got}"
    elif kind == "literal_error":
        message = f"expected {context['expected']}, got {quoted(first['input'])}"
    elif kind in LIMITS:
        words, key = LIMITS[kind]
        limit = context[key]
        message = f"expected {words} {limit:{'g' if isinstance(limit, float) else ','}}, got {quoted(first['input'])}"
    elif kind in EXPECTED:  # a whole file that is something else is not quoted
        got = "" if kind == "missing" or not where else f", got {quoted(first['input'])}"
        message = f"{EXPECTED[kind]}{got}"
    else:
        message = first["msg"][0].lower() + first["msg"][1:]
    return document.error(message, where)


def _real_path(data: Any, loc: tuple[Any, ...]) -> Where:
    """Pydantic's location without the union branches it adds, which are no keys of the file."""
    where: list[str | int] = []
    for position, key in enumerate(loc):
        if isinstance(data, dict) and (key in data or (position == len(loc) - 1 and key != KEY_ITSELF)):
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

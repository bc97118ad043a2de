"""Plain data as YAML that every reader of it takes for the same, on one line or on several."""

import json
import re
from collections.abc import Iterator, Mapping
from typing import Any

_WORD = re.compile(r"[A-Za-z_][A-Za-z0-9_./-]*")
_NO_WORDS = {"null", "true", "false", "yes", "no", "on", "off", "y", "n"}  # to some readers of YAML


def format_flow(value: Any) -> str:
    """Plain data in one line."""
    if isinstance(value, Mapping):
        return f"{{{', '.join(f'{format_flow(key)}: {format_flow(item)}' for key, item in value.items())}}}"
    if isinstance(value, list):
        return f"[{', '.join(map(format_flow, value))}]"
    if isinstance(value, float):
        text = repr(value + 0.0).removesuffix(".0")
        return text.replace("e", ".0e") if "e" in text and "." not in text else text  # 1e-5 is text to some readers
    if isinstance(value, str):
        is_word = _WORD.fullmatch(value) and value.lower() not in _NO_WORDS
        return value if is_word else json.dumps(value, ensure_ascii=not value.isprintable())  # YAML has no surrogates
    return str(value)


def format_block(data: Mapping[str, Any], indent: str = "") -> Iterator[str]:
    """Lines of a mapping: mappings in it and lists of mappings below their keys, all else behind them."""
    for key, value in data.items():
        if isinstance(value, Mapping) and value:
            yield f"{indent}{format_flow(key)}:"
            yield from format_block(value, f"{indent}  ")
        elif isinstance(value, list) and value and isinstance(value[0], Mapping):
            yield f"{indent}{format_flow(key)}:"
            yield from (f"{indent}  - {format_flow(item)}" for item in value)
        else:
            yield f"{indent}{format_flow(key)}: {format_flow(value)}"

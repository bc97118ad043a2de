"""YAML read safely, with the line of every value, so that an error can say where it is.

Numbers are read as people write them: `1e-6` and `1.5e8` are numbers here, and `on`, `no`, `y` are words (YAML 1.2's
core schema; PyYAML alone reads the first two as text and the last three as booleans). What a file may hold is limited,
and the limits hold before anything larger is built: values, aliases included, and levels.
"""

import re
from pathlib import Path
from typing import Any, NamedTuple

import yaml

from ikde.errors import FileError, quoted
from ikde.formats.reading import MAX_DEPTH, read_text

Where = tuple[str | int, ...]

MAX_VALUES = 10**6  # of a file, those that aliases repeat included
_NUMBER = re.compile(
    r"^[-+]?(\.[0-9]+|[0-9][0-9_]*(\.[0-9]*)?)([eE][-+]?[0-9]+)?$|^[-+]?\.(inf|Inf|INF)$|^\.(nan|NaN|NAN)$"
)
_WHOLE = re.compile(r"^[-+]?[0-9][0-9_]*$")
_BOOLEAN = re.compile(r"^(true|True|TRUE|false|False|FALSE)$")
_NULL = re.compile(r"^(~|null|Null|NULL|)$")

SRDF = "this is an SRDF; expected YAML (`ikde robots import FILE.urdf --srdf FILE.srdf` reads it beside its URDF)"
XML_KINDS = {
    "<mujoco": "this is MJCF; expected YAML (convert it to URDF, which `ikde robots import FILE.urdf` reads)",
    "xmlns:xacro": "this is xacro; expected YAML (`xacro FILE > robot.urdf`, then `ikde robots import robot.urdf`)",
    "<group_state": SRDF,
    "<disable_collisions": SRDF,
    "<robot": "this is a URDF; expected YAML (`ikde robots import FILE.urdf` makes a robot file of it)",
}

_Safe: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)  # libyaml's parser is seven times faster


class _Loader(_Safe):
    """The safe loader with YAML 1.2's words and numbers."""

    yaml_implicit_resolvers: dict[str, Any] = {}  # noqa: RUF012 - PyYAML's own name and shape


for _tag, _pattern in (("null", _NULL), ("bool", _BOOLEAN), ("int", _WHOLE), ("float", _NUMBER)):
    _Loader.add_implicit_resolver(f"tag:yaml.org,2002:{_tag}", _pattern, None)


class Document:
    """Plain data from a YAML file, and the line of each value by its path."""

    def __init__(self, path: Path, text: str) -> None:
        self.path = path
        self.lines: dict[Where, int] = {}
        self.aliases: dict[Where, Where] = {}
        """Path of an alias -> path of what it stands for."""
        self.data: Any = None
        _refuse_other_kinds(path, text)
        try:
            self.data = _Reader(self, text).read()
        except yaml.MarkedYAMLError as error:
            mark = error.problem_mark or error.context_mark
            problem = "a tab; YAML wants spaces" if mark and _is_tab(text, mark) else f"not YAML: {error.problem}"
            raise FileError(path, problem, line=mark.line + 1 if mark else None) from None
        except yaml.YAMLError as error:
            raise FileError(path, f"not YAML: {' '.join(str(error).split())}") from None
        except MemoryError:
            raise FileError(path, "cannot be read: not enough memory") from None

    def line(self, where: Where) -> int | None:
        """Line of the value at a path, or of the nearest value above it; behind an alias, where it was written."""
        for end in range(len(where), 0, -1):
            if where[:end] in self.aliases:
                return self.line(self.aliases[where[:end]] + where[end:]) if end < len(where) else self.lines[where]
            if where[:end] in self.lines:
                return self.lines[where[:end]]
        return self.lines.get(())

    def error(self, message: str, where: Where = ()) -> FileError:
        """An error at a path of this file."""
        return FileError(self.path, message, where, self.line(where))


def _refuse_other_kinds(path: Path, text: str) -> None:
    """Say of an empty file and of XML what they are."""
    start = text.lstrip("\ufeff \t\r\n")
    if not start:
        raise FileError(path, "the file is empty")
    if start.startswith("<"):
        kind = next((said for mark, said in XML_KINDS.items() if mark in start), "this is XML; expected YAML")
        raise FileError(path, kind)


def _is_tab(text: str, mark: Any) -> bool:
    """True if a tab stands where the parser gave up."""
    lines = text.splitlines()
    return mark.line < len(lines) and lines[mark.line][mark.column : mark.column + 1] == "\t"


class _Anchored(NamedTuple):
    """What an alias stands for."""

    data: Any
    where: Where
    values: int
    levels: int


class _Reader:
    """Builds a document from the parser's events, so that a file which is too much is left off in the middle."""

    def __init__(self, document: Document, text: str) -> None:
        self._document = document
        self._events = _Loader(text)
        self._anchored: dict[str, _Anchored] = {}
        self._values = 0
        self._deepest = 0

    def read(self) -> Any:
        """The only document of the file, or None."""
        self._next()  # the stream begins
        if isinstance(self._next(), yaml.StreamEndEvent):
            return None
        data = self._read(self._next(), ())
        self._next()  # the document ends
        after = self._next()
        if not isinstance(after, yaml.StreamEndEvent):
            raise FileError(self._document.path, "expected a single document", line=after.start_mark.line + 1)
        return data

    def _next(self) -> Any:
        return self._events.get_event()

    def _read(self, event: Any, where: Where) -> Any:
        self._document.lines[where] = event.start_mark.line + 1
        if isinstance(event, yaml.AliasEvent):
            return self._repeat(event, where)
        outer, before = self._deepest, self._values
        self._deepest = len(where)
        self._count(where, 1, 0)
        if isinstance(event, yaml.MappingStartEvent):
            data: Any = self._read_mapping(where)
        elif isinstance(event, yaml.SequenceStartEvent):
            data = self._read_list(where)
        else:
            data = self._read_scalar(event, where)
        if event.anchor:
            levels = self._deepest - len(where)
            self._anchored[event.anchor] = _Anchored(data, where, self._values - before, levels)
        self._deepest = max(self._deepest, outer)
        return data

    def _repeat(self, event: Any, where: Where) -> Any:
        known = self._anchored.get(event.anchor)
        if known is None:
            name = quoted(event.anchor)
            raise self._document.error(f"the alias {name} stands for nothing before it, or contains itself", where)
        self._count(where, known.values, known.levels)
        self._document.aliases[where] = known.where
        return known.data

    def _count(self, where: Where, values: int, levels: int) -> None:
        """Note so many values, so many levels deep."""
        self._values += values
        self._deepest = max(self._deepest, len(where) + levels)
        if self._values > MAX_VALUES:
            raise self._document.error(f"too many values, aliases counted; expected at most {MAX_VALUES:,}", where[:3])
        if len(where) + levels > MAX_DEPTH:
            raise self._document.error(f"nested too deeply; expected at most {MAX_DEPTH} levels", where[:3])

    def _read_list(self, where: Where) -> list[Any]:
        items: list[Any] = []
        while not isinstance(event := self._next(), yaml.SequenceEndEvent):
            items.append(self._read(event, (*where, len(items))))
        return items

    def _read_mapping(self, where: Where) -> dict[str, Any]:
        mapping: dict[str, Any] = {}
        while not isinstance(event := self._next(), yaml.MappingEndEvent):
            line = event.start_mark.line + 1
            if not isinstance(event, yaml.ScalarEvent):
                raise FileError(self._document.path, "a key must be a word", where, line)
            key = str(event.value)
            if key in mapping:
                raise FileError(self._document.path, "this key is given twice", (*where, key), line)
            mapping[key] = self._read(self._next(), (*where, key))
            self._document.lines[(*where, key)] = line
        return mapping

    def _read_scalar(self, event: Any, where: Where) -> Any:
        text = str(event.value)
        known = event.tag not in (None, "!")
        tag = event.tag if known else self._events.resolve(yaml.ScalarNode, text, event.implicit)
        try:
            match tag.rsplit(":", 1)[-1]:
                case "int":
                    return int(text)
                case "float":
                    return float(text.lower().replace("_", "").replace(".inf", "inf").replace(".nan", "nan"))
                case "bool":
                    return text.lower() == "true"
                case "null":
                    return None
                case "str":
                    return text
        except ValueError:
            raise self._document.error(f"{quoted(text)} does not fit its tag {quoted(tag)}", where) from None
        raise self._document.error(f"the tag {quoted(tag)} is not read here", where)


def read_yaml(path: Path) -> Document:
    """Read a YAML file; raises `FileError` if it is missing, no regular file, too large, not UTF-8 or not YAML."""
    return Document(path, read_text(path))

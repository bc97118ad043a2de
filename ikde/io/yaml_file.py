"""YAML read safely, with the line of every value, so that an error can say where it is.

Numbers are read as people write them: `1e-6` and `1.5e8` are numbers here, and `on`, `no`, `y` are words (YAML 1.2's
core schema; PyYAML alone reads the first two as text and the last three as booleans).
"""

import re
from pathlib import Path
from typing import Any

import yaml

from ikde.errors import FileError, InputError

Where = tuple[str | int, ...]

MAX_DEPTH = 40
MOST_REPEATED = 10**6  # values that aliases repeat
_NUMBER = re.compile(
    r"^[-+]?(\.[0-9]+|[0-9][0-9_]*(\.[0-9]*)?)([eE][-+]?[0-9]+)?$|^[-+]?\.(inf|Inf|INF)$|^\.(nan|NaN|NAN)$"
)
_WHOLE = re.compile(r"^[-+]?[0-9][0-9_]*$")
_BOOLEAN = re.compile(r"^(true|True|TRUE|false|False|FALSE)$")
_NULL = re.compile(r"^(~|null|Null|NULL|)$")


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
        try:
            root = yaml.compose(text, Loader=_Loader)
            repeated = 0 if root is None else _count_repeated(root)
        except yaml.MarkedYAMLError as error:
            mark = error.problem_mark or error.context_mark
            raise FileError(path, f"not YAML: {error.problem}", line=mark.line + 1 if mark else None) from None
        except yaml.YAMLError as error:
            raise FileError(path, f"not YAML: {' '.join(str(error).split())}") from None
        except RecursionError:
            raise FileError(path, "nested too deeply") from None
        if repeated > MOST_REPEATED:
            raise FileError(path, f"aliases repeat {repeated:,} values; expected at most {MOST_REPEATED:,}")
        self.data = None if root is None else self._read(root, ())

    def line(self, where: Where) -> int | None:
        """Line of the value at a path, or of the nearest value above it."""
        while where and where not in self.lines:
            where = where[:-1]
        return self.lines.get(where)

    def error(self, message: str, where: Where = ()) -> FileError:
        """An error at a path of this file."""
        return FileError(self.path, message, where, self.line(where))

    def at(self, error: InputError) -> FileError:
        """Another floor's error, placed in this file."""
        return self.error(error.message, error.where)

    def _read(self, node: yaml.Node, where: Where) -> Any:
        self.lines[where] = node.start_mark.line + 1
        if len(where) > MAX_DEPTH:
            raise self.error("nested too deeply, or an alias that contains itself", where[:3])
        if isinstance(node, yaml.MappingNode):
            return self._read_mapping(node, where)
        if isinstance(node, yaml.SequenceNode):
            return [self._read(child, (*where, index)) for index, child in enumerate(node.value)]
        return self._read_scalar(node, where)

    def _read_mapping(self, node: yaml.MappingNode, where: Where) -> dict[str, Any]:
        mapping: dict[str, Any] = {}
        for key_node, value_node in node.value:
            if not isinstance(key_node, yaml.ScalarNode):
                raise FileError(self.path, "a key must be a word", where, key_node.start_mark.line + 1)
            key = str(key_node.value)
            if key in mapping:
                raise FileError(self.path, "this key is given twice", (*where, key), key_node.start_mark.line + 1)
            mapping[key] = self._read(value_node, (*where, key))
            self.lines[(*where, key)] = key_node.start_mark.line + 1
        return mapping

    def _read_scalar(self, node: yaml.Node, where: Where) -> Any:
        text = str(node.value)
        try:
            match node.tag.rsplit(":", 1)[-1]:
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
            raise self.error(f"{text!r} does not fit its tag {node.tag}", where) from None
        raise self.error(f"the tag {node.tag} is not read here", where)


def _count_repeated(root: yaml.Node) -> int:
    """Values that are there once more, or more often, through aliases; what contains itself counts once."""
    sizes: dict[int, int] = {}

    def count(node: yaml.Node) -> int:
        if id(node) not in sizes:
            sizes[id(node)] = 0
            children = [value for _, value in node.value] if isinstance(node, yaml.MappingNode) else node.value
            is_leaf = isinstance(node, yaml.ScalarNode)
            sizes[id(node)] = 1 if is_leaf else 1 + sum([count(child) for child in children])
        return sizes[id(node)]

    return count(root) - len(sizes)


def read_yaml(path: Path) -> Document:
    """Read a YAML file; raises `FileError` if it is missing, a folder, unreadable, not UTF-8 or not YAML."""
    return Document(path, read_text(path))


def read_text(path: Path) -> str:
    """Text of a file; raises `FileError` in one line for everything that can go wrong with it."""
    try:
        return path.read_text(encoding="utf-8")
    except FileNotFoundError:
        raise FileError(path, "no such file") from None
    except IsADirectoryError:
        raise FileError(path, "this is a folder; expected a file") from None
    except UnicodeDecodeError:
        raise FileError(path, "not a UTF-8 text file") from None
    except (OSError, ValueError) as error:
        raise FileError(path, f"cannot be read: {getattr(error, 'strerror', None) or error}") from None

"""XML from strangers as plain elements that know their lines: within limits, no DOCTYPE and so no entities."""

from dataclasses import dataclass, field
from math import isfinite
from pathlib import Path
from xml.parsers import expat

from ikde.errors import FileError, quoted
from ikde.formats.reading import read_text

MAX_ELEMENTS, MAX_LEVELS = 200_000, 100
Where = tuple[str | int, ...]


@dataclass(slots=True)
class Element:
    """An element with its attributes and the line that it begins in; text between elements is not kept."""

    tag: str
    attributes: dict[str, str]
    line: int
    children: list["Element"] = field(default_factory=list)

    def find_all(self, tag: str) -> list["Element"]:
        """Its children of this name."""
        return [child for child in self.children if child.tag == tag]

    def find(self, tag: str) -> "Element | None":
        """Its first child of this name."""
        return next((child for child in self.children if child.tag == tag), None)


class XmlFile:
    """A file that has been read, and what is said of a place in it."""

    def __init__(self, path: Path) -> None:
        """Read a whole file; raises `FileError` in one line for all that is not plain XML within the limits."""
        self.path = path
        self.root = _Reader(path).read(read_text(path))

    def error(self, message: str, element: Element, *where: str | int) -> FileError:
        """An error about an element of this file."""
        return FileError(self.path, message, where, element.line)

    def read_name(self, element: Element, key: str, *where: str) -> str:
        """An attribute that must be there."""
        if not element.attributes.get(key):
            raise self.error(f"expected an attribute {key!r} of <{element.tag}>", element, *where)
        return element.attributes[key]

    def read_number(self, element: Element, key: str, default: float | None = None, *where: str) -> float:
        """An attribute as one number, which may be infinite; `default` None: it must be there."""
        text = element.attributes.get(key)
        if text is None and default is not None:
            return default
        numbers = _to_numbers(text or "")
        if numbers is None or len(numbers) != 1 or numbers[0] != numbers[0]:
            raise self.error(f"expected a number, got {quoted(text or '')}", element, *where, key)
        return numbers[0]

    def read_numbers(self, element: Element, key: str, default: tuple[float, ...], *where: str) -> tuple[float, ...]:
        """An attribute as finite numbers, as many as `default` has."""
        text = element.attributes.get(key)
        if text is None:
            return default
        numbers = _to_numbers(text)
        if numbers is None or len(numbers) != len(default) or not all(map(isfinite, numbers)):
            raise self.error(f"expected {len(default)} finite numbers, got {quoted(text)}", element, *where, key)
        return numbers


def _to_numbers(text: str) -> tuple[float, ...] | None:
    try:
        return None if "_" in text else tuple(map(float, text.split()))
    except ValueError:
        return None


class _Reader:
    def __init__(self, path: Path) -> None:
        self._path = path
        self._root: Element | None = None
        self._open: list[Element] = []
        self._count = 0
        self._parser = expat.ParserCreate("utf-8")
        self._parser.StartElementHandler = self._start
        self._parser.EndElementHandler = self._end
        self._parser.StartDoctypeDeclHandler = self._refuse_doctype

    def read(self, text: str) -> Element:
        try:
            self._parser.Parse(text.encode(), True)
        except expat.ExpatError as error:
            raise FileError(self._path, f"not XML: {expat.ErrorString(error.code)}", line=error.lineno) from None
        if self._root is None:
            raise FileError(self._path, "not XML: no element found")
        return self._root

    def _start(self, tag: str, attributes: dict[str, str]) -> None:
        element = Element(tag, attributes, self._parser.CurrentLineNumber)
        self._count += 1
        if self._count > MAX_ELEMENTS:
            raise self._error(f"too many elements; expected at most {MAX_ELEMENTS:,}")
        if len(self._open) >= MAX_LEVELS:
            raise self._error(f"nested too deeply; expected at most {MAX_LEVELS} levels")
        if self._open:
            self._open[-1].children.append(element)
        else:
            self._root = element
        self._open.append(element)

    def _end(self, _: str) -> None:
        self._open.pop()

    def _refuse_doctype(self, *_: object) -> None:
        raise self._error("a DOCTYPE is not read here: it can name other files and entities; take it out")

    def _error(self, message: str) -> FileError:
        return FileError(self._path, message, line=self._parser.CurrentLineNumber)

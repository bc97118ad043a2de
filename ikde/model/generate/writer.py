"""Straight-line code: named values, constants folded, nothing computed twice or without use."""

import re
from collections.abc import Iterable

Value = float | str
"""A number known now, or the name of one known when the code runs."""

NAME = re.compile(r"[A-Za-z_]\w*")


class Writer:
    """Collects statements `name = expression` in the order in which they are asked for."""

    def __init__(self) -> None:
        self._lines: list[tuple[str, str]] = []
        self._names: dict[str, str] = {}
        self._labels: dict[str, tuple[float, ...]] = {}

    def let(self, name: str, expression: str) -> str:
        """The name of an expression: an older one if the same has been written before."""
        if expression not in self._names:
            if name in self._names.values():
                raise ValueError(f"{name} is written twice, once as {expression}")
            self._names[expression] = name
            self._lines.append((name, expression))
        return self._names[expression]

    def sum(self, name: str, *products: tuple[Value, ...]) -> Value:
        """The sum of products, each a tuple of factors; numbers are multiplied and added now."""
        constant, terms = 0.0, []
        for factors in products:
            scale, names = 1.0, []
            for factor in factors:
                if isinstance(factor, str):
                    names.append(factor)
                else:
                    scale *= factor
            if not names:
                constant += scale
            elif scale != 0.0:
                terms.append((scale, names))
        if not terms:
            return constant
        if len(terms) == 1 and terms[0][0] == 1.0 and len(terms[0][1]) == 1 and constant == 0.0:
            return terms[0][1][0]
        return self.let(name, _format_sum(terms, constant))

    def label(self, stem: str, values: Iterable[float], unit: float) -> str:
        """A name for some numbers: the stem and their multiples of a unit; other numbers never get the same one."""
        numbers = tuple(float(value) + 0.0 for value in values)  # no -0.0
        short = "_".join([stem, *(f"{value / unit:.0f}".replace("-", "n") for value in numbers)])
        label, copies = short, 0
        while self._labels.setdefault(label, numbers) != numbers:
            copies += 1
            label = f"{short}_or{copies}"
        return label

    def lines(self, wanted: Iterable[Value], written: set[str]) -> list[str]:
        """The statements that the wanted values hang on, in order, but for those `written`, to which they are added."""
        needed = {value for value in wanted if isinstance(value, str)}
        for name, expression in reversed(self._lines):
            if name in needed:
                needed.update(NAME.findall(expression))
        new = [(name, expression) for name, expression in self._lines if name in needed and name not in written]
        written.update(name for name, _ in new)
        return [f"{name} = {expression}" for name, expression in new]


def text(value: Value) -> str:
    """A value as it stands in code: all digits of a number, so that nothing is lost."""
    return value if isinstance(value, str) else repr(value)


def _format_sum(terms: list[tuple[float, list[str]]], constant: float) -> str:
    first = sorted(terms, key=lambda term: term[0] < 0.0)  # a sum that begins with a minus costs one operation more
    written = ""
    for scale, names in first:
        size = abs(scale)
        product = " * ".join([*([repr(size)] if size != 1.0 else []), *names])
        sign = "-" if scale < 0.0 else "+"
        written += f" {sign} {product}" if written else ("-" if scale < 0.0 else "") + product
    if constant:
        written += f" {'-' if constant < 0.0 else '+'} {abs(constant)!r}"
    return written

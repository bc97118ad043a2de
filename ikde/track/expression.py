"""Formulas in files: arithmetic over k and N, read through a whitelist and evaluated on arrays. Nothing is executed.

What a formula may cost is limited before it is evaluated: all numbers are floats (a power of powers is infinite, not
long), and so many operations may be done at so many samples. Samples are taken in pieces, so that memory stays flat.
"""

import ast
import math
import re
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from functools import reduce
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ikde.errors import InputError, nearest, quoted
from ikde.formats.error_path import prefix_errors
from ikde.kernels.arrays import Floats

MAX_LENGTH = 1000  # characters of a formula
DEEPEST = 300  # operations inside each other
BUDGET = 2 * 10**8  # operations of one formula at all samples together: seconds
PIECE = 2**16  # samples at a time
OPERATORS = {
    ast.Add: np.add,
    ast.Sub: np.subtract,
    ast.Mult: np.multiply,
    ast.Div: np.divide,
    ast.Mod: np.mod,
    ast.Pow: np.power,
}
SIGNS = {ast.USub: np.negative, ast.UAdd: np.positive}
COMPARISONS = {
    ast.Lt: np.less,
    ast.LtE: np.less_equal,
    ast.Gt: np.greater,
    ast.GtE: np.greater_equal,
    ast.Eq: np.equal,
    ast.NotEq: np.not_equal,
}
FUNCTIONS = {"sin": np.sin, "cos": np.cos, "tan": np.tan, "sqrt": np.sqrt, "abs": np.abs}
FUNCTIONS_OF_MANY = {"min": np.minimum, "max": np.maximum}
NAMES = ("k", "N", "pi", *FUNCTIONS, *FUNCTIONS_OF_MANY)
UNLISTED = re.compile(r"#.*|[^\x00-\x7f]|\b0[xXoObB]\w*|\d+_\w*")  # Python knows comments, 0x10 and 1_0
ALLOWED = f"a formula has numbers, {', '.join(NAMES)}, + - * / % **, brackets, and `a if k <= b else c`"


class Sampling(NamedTuple):
    """What a formula depends on: the samples k, whole or not, and their count N."""

    k: Floats
    N: int


Number = Callable[[Sampling], Floats]
Condition = Callable[[Sampling], NDArray[np.bool_]]


@dataclass(frozen=True, slots=True)
class Expression:
    """A formula that has been read."""

    text: str
    operations: int
    """What there is to do at a sample."""
    _evaluate: Number

    def evaluate(self, k: Floats, N: int) -> Floats:
        """Values [S] at samples `k` [S] of `N`.

        Raises:
            InputError: with the first k where there is none, or if all of them would take too long.
        """
        if self.operations * len(k) > BUDGET:
            cost = f"{self.operations} operations at {len(k):,} places, samples and half-way between them"
            raise InputError(f"{_quote(self.text)} takes too long: {cost}; expected at most {BUDGET:,} in all")
        values = np.empty(len(k))
        with np.errstate(all="ignore"):
            for first in range(0, len(k), PIECE):
                piece = slice(first, first + PIECE)
                values[piece] = self._evaluate(Sampling(k[piece], N))
        for bad in np.flatnonzero(~np.isfinite(values))[:1]:
            raise InputError(f"{_quote(self.text)} is {values[bad]:g} at k = {k[bad]:g}; expected a finite number")
        return values


def parse_expression(text: str | float) -> Expression:
    """Read a formula, or a number that stands for itself; raises `InputError` that says what is not allowed."""
    text = str(text).strip()
    if len(text) > MAX_LENGTH:
        raise InputError(f"expected at most {MAX_LENGTH} characters, got {len(text)}")
    for unlisted in UNLISTED.findall(text)[:1]:
        raise InputError(f"{_quote(unlisted)} is not allowed here; {ALLOWED}")
    try:
        with warnings.catch_warnings(action="ignore"):  # of Python about Python
            body = ast.parse(text, mode="eval").body
        if _depth(body) > DEEPEST:
            raise InputError(f"nested too deeply; expected at most {DEEPEST} levels")
        return Expression(text, sum(isinstance(node, ast.expr) for node in ast.walk(body)), _number(body))
    except (SyntaxError, ValueError) as error:
        raise InputError(f"{_quote(text)} is no formula: {getattr(error, 'msg', error)}") from None
    except (RecursionError, MemoryError):
        raise InputError("nested too deeply") from None


def evaluate_formula(key: str | int, formula: float | str, k: Floats, samples: int) -> Floats:
    """Values [S] of the formula under `key` at samples `k` [S] of so many."""
    with prefix_errors(key):
        return parse_expression(formula).evaluate(k, samples)


def _depth(node: ast.AST) -> int:
    """Levels of operations inside each other."""
    depth, level = 0, [node]
    while level:
        depth, level = depth + 1, [child for above in level for child in ast.iter_child_nodes(above)]
    return depth


def _number(node: ast.expr) -> Number:
    """What computes the number that a node stands for."""
    match node:
        case ast.Constant(value=bool()):
            pass
        case ast.Constant(value=int() | float() as value):
            return _constant(value, node)
        case ast.Name(id=name):
            return _name(name)
        case ast.UnaryOp(op=op, operand=operand) if type(op) in SIGNS:
            sign, value = SIGNS[type(op)], _number(operand)
            return lambda at: sign(value(at))
        case ast.BinOp(left=left, op=op, right=right) if type(op) in OPERATORS:
            operator, a, b = OPERATORS[type(op)], _number(left), _number(right)
            return lambda at: operator(a(at), b(at))
        case ast.Call(func=ast.Name(id=name), args=arguments, keywords=[]):
            return _call(name, [_number(argument) for argument in arguments])
        case ast.IfExp(test=test, body=body, orelse=orelse):
            condition, then, otherwise = _condition(test), _number(body), _number(orelse)
            return lambda at: np.where(condition(at), then(at), otherwise(at))
    raise InputError(f"{_quote(ast.unparse(node))} is not allowed here; {ALLOWED}")


def _condition(node: ast.expr) -> Condition:
    """What decides a comparison; `a < b < c` asks for both."""
    match node:
        case ast.Compare(left=left, ops=ops, comparators=others) if {type(op) for op in ops} <= set(COMPARISONS):
            values = [_number(value) for value in (left, *others)]
            tests = [COMPARISONS[type(op)] for op in ops]
            pairs = list(zip(tests, values, values[1:], strict=False))
            return lambda at: reduce(np.logical_and, [test(a(at), b(at)) for test, a, b in pairs])
    raise InputError(f"{_quote(ast.unparse(node))} is no condition; expected a comparison, such as `k <= 250`")


def _constant(value: float, node: ast.expr) -> Number:
    try:
        number = np.array(value, dtype=float)
    except OverflowError:
        number = np.array(math.inf)
    if not np.isfinite(number):
        raise InputError(f"{_quote(ast.unparse(node))} is too large a number")
    return lambda at: number


def _name(name: str) -> Number:
    if name == "k":
        return lambda at: at.k
    if name == "N":
        return lambda at: np.array(float(at.N))
    if name == "pi":
        return lambda at: np.array(math.pi)
    if name in NAMES:
        raise InputError(f"{name} is a function; expected {name}(...)")
    raise InputError(f"{_quote(name)} is not known{nearest(name, NAMES)}; {ALLOWED}")


def _call(name: str, arguments: list[Number]) -> Number:
    if name in FUNCTIONS:
        if len(arguments) != 1:
            raise InputError(f"{name}(...) takes 1 value, got {len(arguments)}")
        function, value = FUNCTIONS[name], arguments[0]
        return lambda at: function(value(at))
    if name in FUNCTIONS_OF_MANY:
        if len(arguments) < 2:
            raise InputError(f"{name}(...) takes 2 values or more, got {len(arguments)}")
        choose = FUNCTIONS_OF_MANY[name]
        return lambda at: reduce(choose, (value(at) for value in arguments))
    known = (*FUNCTIONS, *FUNCTIONS_OF_MANY)
    raise InputError(f"no function is called {_quote(name)}{nearest(name, known)}; there are {', '.join(known)}")


def _quote(text: str) -> str:
    return quoted(" ".join(text.split()))

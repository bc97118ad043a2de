"""Kernels and generated text as plain Python: nothing is compiled, so that many robots cost little."""

import math
import re
from types import FunctionType, SimpleNamespace

import numpy as np

from ikde.kernels.tables import LANES
from ikde.kernels.trig import sin_cos

DECORATOR = re.compile(r"^@(?:inline_|leaf_)?kernel\n", flags=re.MULTILINE)


def plain(kernel):
    """A kernel without its compiler, and so are all that it calls; anything else as it is."""
    return getattr(kernel, "plain", kernel)


def plain_module(module):
    """All of a module's kernels without their compiler."""
    return SimpleNamespace(**{name: plain(value) for name, value in vars(module).items()})


def reachable(kernel, seen=None):
    """Names of all functions that run when a kernel is called, itself among them; a generated one has no module."""
    seen, function = set() if seen is None else seen, getattr(kernel, "py_func", kernel)
    name = f"{function.__module__}.{function.__name__}"
    if name not in seen:
        seen.add(name)
        for used in map(function.__globals__.get, function.__code__.co_names):
            if isinstance(getattr(used, "py_func", used), FunctionType):
                reachable(used, seen)
    return seen


def run_text(text):
    """The functions that a generated text defines, not compiled."""
    space = {"math": math, "np": np, "LANES": LANES, "sin_cos": plain(sin_cos)}
    exec(compile(DECORATOR.sub("", text), "<generated>", "exec"), space)
    for name, value in space.items():
        space[name] = plain(value)
    return SimpleNamespace(**space)


def quietly():
    """Random streams wrap around, and lanes without a target hold anything; numpy's scalars would complain."""
    return np.errstate(over="ignore", invalid="ignore", divide="ignore")


def evaluate(writer, wanted, **known):
    """Values of a writer's names by running its statements."""
    space = {"math": math, "np": np, **known}
    exec("\n".join(writer.lines(wanted, set())), space)
    return [space[value] if isinstance(value, str) else value for value in wanted]


def joint_names(q):
    """What generated kinematics takes: q0, s0, c0 and so on."""
    named = {}
    for k, value in enumerate(q):
        named |= {f"q{k}": float(value), f"s{k}": math.sin(value), f"c{k}": math.cos(value)}
    return named

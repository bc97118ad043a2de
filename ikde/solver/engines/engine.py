"""What an engine is, and the inputs that all of them share."""

import math
from collections.abc import Sequence
from typing import Any, Protocol

import numpy as np

from ikde.kernels.arrays import REACHED, DescentArrays, Floats, Ints, TargetArrays, read_only
from ikde.model.pack import pack_targets
from ikde.model.target import Targets
from ikde.solver.engines.pool import rotation_length_m
from ikde.solver.engines.search_state import SearchState
from ikde.solver.problem import Problem, shrink

Outputs = tuple[Any, ...]
"""What the kernels fill: q [N], score [2], counts [COUNTS] and how often each pair blocked [P], or rows of them."""


class Engine(Protocol):
    """Makes attempts on the rows of a `SearchState`: each row's answer depends on its stream and the attempts only."""

    name: str
    rows_per_call: int
    """Rows that share a call of the kernel."""
    attempts_per_call: int
    """Python hears Ctrl-C between calls."""
    is_ready: bool
    """Its kernels have run in this process: a call compiles and loads nothing."""

    def call(self, rows: range, first: int, last: Ints) -> None:
        """Make attempts first .. last[row] - 1, at most `attempts_per_call`, on every row that is open."""
        ...


class SearchInputs:
    """Problem, targets and streams as the kernels take them, and the rows to be filled."""

    def __init__(
        self, problem: Problem, targets: Targets, found: SearchState, *, seed: int, streams: Sequence[int]
    ) -> None:
        self.problem, self.found = problem, found
        self.targets: TargetArrays = pack_targets(targets)
        self.seed: np.uint64 = np.uint64(seed)
        self.streams: Ints = (
            streams.start + streams.step * np.arange(len(streams))  # its end may be 2^63, which is no int64
            if isinstance(streams, range)
            else np.array(streams, dtype=np.int64)  # 60 ns a number
        )

    def attempts(self, rows: range, first: int, last: Ints, kind: int | None = None) -> Ints:
        """Attempts [rows, 2] to make: first .. last - 1 where a row is open and its target of this kind, else none."""
        inside = slice(rows.start, rows.stop)
        wanted = (self.found.counts[inside, REACHED] == 0) & ~self.found.is_excluded(inside)
        if kind is not None:
            wanted &= self.targets.kind[inside] == kind
        attempts = np.empty((len(rows), 2), dtype=np.int64)
        attempts[:, 0], attempts[:, 1] = first, np.where(wanted, last[inside], first)
        return attempts

    @property
    def outputs(self) -> Outputs:
        """What the kernels fill."""
        return self.found.q, self.found.score, self.found.counts, self.found.pair_counts.filled


def make_ranges(problem: Problem) -> Floats:
    """Lower, upper, and the middle of boxes [3, N]."""
    near = 0.5 * (problem.lower + problem.upper) if problem.near is None else problem.near
    return read_only(np.array([problem.lower, problem.upper, near]))


def make_descent(problem: Problem, kind: str) -> DescentArrays:
    """Settings of damped least squares for one kind of target; a step stops where `verify` accepts, a hair inside."""
    settings = problem.settings
    return DescentArrays(
        rotation_length=rotation_length_m(problem.robot),
        position_tolerance=shrink(settings.position_tolerance_m),
        orientation_tolerance=shrink(measure_rotation(settings.orientation_tolerance_rad, kind)),
    )


def make_walk(problem: Problem, kind: str) -> Floats:
    """The same and the weights of the motion [9 + N], as `kernels/least_motion.py` takes them."""
    return np.array([*make_descent(problem, kind), *problem.weights])


def measure_rotation(angle_rad: float, kind: str) -> float:
    """How `damped.compute_rotation` measures an angle in [0, pi]: a number that grows with it, from 0 to 2.

    For a pose the chord 2 sin(angle / 2). For an axis the sine, unfolded beyond a quarter turn, where it is flat: there
    a step stops up to 1.5e-6 rad inside. (With the chord, 4 of 20,000 answers of qiao2021 would be others.)
    """
    if kind != "axis":
        return 2.0 * math.sin(0.5 * angle_rad)
    sine = math.sin(angle_rad)
    return sine if angle_rad <= 0.5 * math.pi else 2.0 - sine

"""What every peer is given and asked for: the same robot, limits, tolerances, targets and sphere checker.

An adapter is one file in `adapters/` with one or more subclasses of `Peer` in its `PEERS`. A worker (`worker.py`) makes
one, calls `prepare` once a case, `convert` for each target (not timed: a user has targets in the library's own type)
and `solve` (timed).
"""

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from importlib.metadata import version
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from checker import Checker, make_checker

import ikde

TOOL_WEIGHT_M = 0.1  # m/rad: what an orientation error counts beside a position error, where a peer adds the two


@dataclass(frozen=True, kw_only=True)
class Setup:
    """One case: a robot as object and as files, and what counts as reached."""

    robot: ikde.Robot
    urdf: Path
    mjcf: Path
    kind: str
    """`pose` or `position`."""
    position_tolerance_m: float
    orientation_tolerance_rad: float
    seed: int

    @property
    def is_pose(self) -> bool:
        """Whether the orientation is asked for."""
        return self.kind == "pose"

    @property
    def lower(self) -> np.ndarray:
        """[N] m or rad."""
        return self.robot.lower

    @property
    def upper(self) -> np.ndarray:
        """[N] m or rad."""
        return self.robot.upper

    @cached_property
    def checker(self) -> Checker:
        """The sphere checker that all collision-blind peers share: ikde's own kernels."""
        return make_checker(self.robot, self.seed)

    def inside(self, q: np.ndarray) -> bool:
        """Whether joint values [N] keep the limits."""
        return bool(np.all(q >= self.lower) and np.all(q <= self.upper))

    def reaches(self, T_world_tool: np.ndarray, p: np.ndarray, R: np.ndarray) -> bool:
        """Whether a tool pose [4, 4] is within the tolerances of a target."""
        error = T_world_tool[:3, 3] - p
        if math.sqrt(error @ error) > self.position_tolerance_m:
            return False
        return not self.is_pose or angle_between(T_world_tool[:3, :3], R) <= self.orientation_tolerance_rad


def angle_between(A: np.ndarray, B: np.ndarray) -> float:
    """Angle in rad between two rotations [3, 3], exact near 0."""
    C = A.T @ B
    x, y, z = C[2, 1] - C[1, 2], C[0, 2] - C[2, 0], C[1, 0] - C[0, 1]
    return math.atan2(math.sqrt(x * x + y * y + z * z), C[0, 0] + C[1, 1] + C[2, 2] - 1.0)


class Peer:
    """One way to solve; adapters say how."""

    name: ClassVar[str]
    packages: ClassVar[Sequence[str]] = ()
    """Distributions whose versions go on the record."""
    use: ClassVar[str]
    """One line: how it is used and what its documentation advises; the README lists it."""
    cores: ClassVar[int] = 1
    batch: ClassVar[bool] = False
    """True if `solve_batch` takes all targets at once; a target's time is then its share of the batch's."""

    setup: Setup

    def prepare(self, setup: Setup) -> None:
        """Load the robot; called once a case, its time is recorded apart."""
        self.setup = setup

    def convert(self, p: np.ndarray, R: np.ndarray) -> Any:
        """A target in the library's own type, from position [3] in m and orientation [3, 3]; not timed."""
        return p, R

    def solve(self, target: Any, deadline: float) -> np.ndarray | None:
        """Joint values [N] in the robot's order, free of self-collision, or None by `deadline` (`perf_counter`)."""
        raise NotImplementedError

    def convert_batch(self, p: np.ndarray, R: np.ndarray) -> Any:
        """Many targets in the library's own type, from positions [T, 3] and orientations [T, 3, 3]; not timed."""
        return [self.convert(a.copy(), b.copy()) for a, b in zip(p, R, strict=True)]

    def solve_batch(self, targets: Any, deadline: float) -> Sequence[np.ndarray | None]:
        """Many at once, for peers with `batch`."""
        raise NotImplementedError

    def restart(self, attempt: Callable[[], np.ndarray | None], deadline: float) -> np.ndarray | None:
        """Reject and restart, for what is blind to collisions: until an answer is inside the limits and free."""
        setup, checker = self.setup, self.setup.checker
        while True:
            q = attempt()
            if q is not None and setup.inside(q) and checker.is_free(q):
                return q
            if time.perf_counter() > deadline:
                return None

    @classmethod
    def versions(cls) -> dict[str, str]:
        """Version of each distribution."""
        return {package: version(package) for package in cls.packages}


def random_rotation(quat: np.ndarray) -> np.ndarray:
    """The rotation [3, 3] of a quaternion of any length; uniform if its four numbers are normal."""
    w, x, y, z = quat / np.sqrt(np.sum(quat * quat))
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )

"""What every peer is given and asked for: the same robot, limits, tolerances, targets and sphere checker.

An adapter is one file in `adapters/` with subclasses of `Peer`, entered in `roster.py`. A worker (`worker.py`) makes
one, calls `prepare` once a robot and kind of target, `convert` for each target (not timed: a user has targets in the
library's own type) and `solve` (timed).
"""

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from checker import Checker, make_checker

import ikde

Answer = tuple[float, np.ndarray | None]
"""Seconds, and joint values [N] if there are any."""

TOOL_WEIGHT_M = 0.1  # m/rad: what an orientation error counts beside a position error, where a peer adds the two


@dataclass(frozen=True, kw_only=True)
class Solid:
    """What stands around the robot: a box by its edges, or a cylinder by its radius and height along z, m."""

    kind: str
    size_m: tuple[float, ...]
    T_world_solid: np.ndarray
    """[4, 4]"""


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
    clock: Callable[[], float] = time.perf_counter
    """What time is measured by: seconds on the wall, or of the process on a processor (`time.process_time`)."""
    check: str = "kernels"
    """Who says that an answer of a blind one is free: `kernels`, of itself; in a world `coal` or `world kernels`."""

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
    def checker(self) -> "Checker | Any":
        """The sphere checker that all collision-blind peers share."""
        if self.check == "kernels":
            return make_checker(self.robot, self.seed)
        from world_checkers import CoalChecker, KernelChecker

        if self.check == "coal":
            return CoalChecker(self.robot, self.urdf, self.seed)
        return KernelChecker(self.robot, self.seed)

    def inside(self, q: np.ndarray) -> bool:
        """Whether joint values [N] keep the limits."""
        return bool(np.all(q >= self.lower) and np.all(q <= self.upper))

    def keeps(self, p_error: np.ndarray, R_error: np.ndarray) -> bool:
        """Whether an error in m and, for poses, one in rad are within the tolerances; vectors [3] or [1]."""
        if math.sqrt(p_error @ p_error) > self.position_tolerance_m:
            return False
        return not self.is_pose or math.sqrt(R_error @ R_error) <= self.orientation_tolerance_rad

    def reaches(self, T_world_tool: np.ndarray, p: np.ndarray, R: np.ndarray) -> bool:
        """Whether a tool pose [4, 4] is within the tolerances of a target."""
        return self.keeps(T_world_tool[:3, 3] - p, np.array([angle_between(T_world_tool[:3, :3], R)]))


def angle_between(A: np.ndarray, B: np.ndarray) -> float:
    """Angle in rad between two rotations [3, 3], exact near 0."""
    C = A.T @ B
    x, y, z = C[2, 1] - C[1, 2], C[0, 2] - C[2, 0], C[1, 0] - C[0, 1]
    return math.atan2(math.sqrt(x * x + y * y + z * z), C[0, 0] + C[1, 1] + C[2, 2] - 1.0)


class Peer:
    """One way to solve; adapters say how."""

    setup: Setup

    def prepare(self, setup: Setup) -> None:
        """Load the robot; its time is recorded apart."""
        self.setup = setup

    def load(self, solids: Sequence[Solid]) -> None:
        """Put solids around the robot, in place of those before; its time is recorded apart."""
        self.setup.checker.load(solids)

    def convert(self, p: np.ndarray, R: np.ndarray) -> Any:
        """A target in the library's own type, from position [3] in m and orientation [3, 3]; not timed."""
        return p, R

    def solve(self, target: Any, deadline: float) -> np.ndarray | None:
        """Joint values [N] in the robot's order, free of self-collision, or None by `deadline` (`setup.clock`)."""
        raise NotImplementedError

    def answer(self, p: np.ndarray, R: np.ndarray, seconds: float, slice_s: float) -> list[Answer]:
        """Solve targets, positions [T, 3] and orientations [T, 3, 3], until `slice_s` have passed."""
        targets = [self.convert(a.copy(), b.copy()) for a, b in zip(p, R, strict=True)]
        answers: list[Answer] = []
        clock = self.setup.clock
        begun = clock()
        for target in targets:
            started = clock()
            q = self.solve(target, started + seconds)
            ended = clock()
            answers.append((ended - started, None if q is None else np.array(q, dtype=float)))
            if ended - begun > slice_s:
                break
        return answers

    def restart(self, attempt: Callable[[], np.ndarray | None], deadline: float) -> np.ndarray | None:
        """Reject and restart, for what is blind to collisions: until an answer is inside the limits and free."""
        setup, checker = self.setup, self.setup.checker
        while True:
            q = attempt()
            if q is not None and setup.inside(q) and checker.is_free(q):
                return q
            if setup.clock() > deadline:
                return None


def to_matrix(p: np.ndarray, R: np.ndarray) -> np.ndarray:
    """A homogeneous matrix [4, 4]."""
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = R, p
    return T


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

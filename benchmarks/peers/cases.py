"""Targets: ordinary and hard ones, as poses and as positions, the paper's two, and poses of an arm on a fixed base.

Ordinary targets are tool poses of uniform, collision-free configurations. Hard ones are those of them with the tool
below 0.45 m of which nearly every answer collides: of `RESTARTS` plain descents from random configurations, at least
`HARD_SHARE` of the answers do. Every target has a collision-free answer by construction. Deterministic by seed.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numba
import numpy as np
from checker import Checker, make_checker

import ikde
from ikde.kernels.frames import compute_bodies, compute_jacobian, compute_tool
from ikde.model.pack import pack_robot
from ikde.paper.plain_search import limit_base

ROBOT, ARM = "qiao2021", "ur5"
SEED = 20260
LOW_M = 0.45
RESTARTS, HARD_SHARE = 12, 0.9
BLOCK = 1000
STEPS, DAMPING, REACHED_M, REACHED_RAD = 80, 1e-4, 1e-4, 1e-3
PAPER_TARGETS_M = {"task 1": (0.8, 0.5, 1.0), "task 2": (0.54, -0.131, 0.974)}
PAPER_BASE_M = 0.1
NAMES = ("pose", "hard pose", "position", "hard position", "paper task 1", "paper task 2", "ur5 pose", "ur5 hard pose")

Descend = Callable[[np.ndarray, np.ndarray], bool]
Poses = tuple[np.ndarray, np.ndarray]


@dataclass(frozen=True)
class Case:
    """T targets of one robot."""

    name: str
    kind: str
    robot: ikde.Robot
    p: np.ndarray
    """[T, 3] m"""
    R: np.ndarray
    """[T, 3, 3]; only for poses."""

    def targets(self) -> list[ikde.Target]:
        """As ikde's targets."""
        if self.kind == "position":
            return [ikde.Target(p) for p in self.p]
        return [ikde.Target(p, R_world_tool=R) for p, R in zip(self.p, self.R, strict=True)]


def make_case(name: str, count: int) -> Case:
    """`count` targets of one of `NAMES`; fewer are the first of more."""
    on_arm = name.startswith(f"{ARM} ")
    robot, kind = ikde.load_robot(ARM if on_arm else ROBOT), name.removeprefix(f"{ARM} ").removeprefix("hard ")
    if kind.startswith("paper "):
        p = np.tile(PAPER_TARGETS_M[kind.removeprefix("paper ")], (count, 1))
        return Case(name, "position", limit_base(robot, PAPER_BASE_M), p, np.tile(np.eye(3), (count, 1, 1)))
    seed = SEED + NAMES.index(name)
    hard = "hard " in name
    p, R = draw_hard(robot, kind, count, seed) if hard else draw_ordinary(robot, count, seed)
    return Case(name, kind, robot, p, R)


def draw_ordinary(robot: ikde.Robot, count: int, seed: int) -> Poses:
    """Tool poses of random collision-free configurations: positions [T, 3] in m, orientations [T, 3, 3]."""
    checker = make_checker(robot, seed)
    T = ikde.forward(robot, np.array([checker.draw_free() for _ in range(count)]))[robot.tool]
    return T[:, :3, 3].copy(), T[:, :3, :3].copy()


def draw_hard(robot: ikde.Robot, kind: str, count: int, seed: int) -> Poses:
    """The same, low ones of which most answers collide."""
    checker, descend = make_checker(robot, seed), make_descent(robot, kind == "pose")
    found_p: list[np.ndarray] = []
    found_R: list[np.ndarray] = []
    while len(found_p) < count:
        T_world_tool = ikde.forward(robot, np.array([checker.draw_free() for _ in range(BLOCK)]))[robot.tool]
        for T in T_world_tool[T_world_tool[:, 2, 3] < LOW_M]:
            if collision_share(checker, descend, T[:3]) >= HARD_SHARE:
                found_p.append(T[:3, 3].copy())
                found_R.append(T[:3, :3].copy())
    return np.array(found_p[:count]), np.array(found_R[:count])


def collision_share(checker: Checker, descend: Descend, T_world_tool: np.ndarray) -> float:
    """Share of colliding answers among those of `RESTARTS` plain descents; 0 if there are fewer than four."""
    answers = [q for q in (checker.draw() for _ in range(RESTARTS)) if descend(np.ascontiguousarray(T_world_tool), q)]
    return 1.0 - np.mean([checker.is_free(q) for q in answers]) if len(answers) >= 4 else 0.0


def make_descent(robot: ikde.Robot, is_pose: bool) -> Descend:
    """Damped least squares inside the limits, compiled: changes q in place, says whether it reached the target."""
    arrays, lower, upper = pack_robot(robot), robot.lower, robot.upper
    bodies, joints, rows = len(arrays.bodies), len(robot.joints), 6 if is_pose else 3

    @numba.njit
    def descend(T_target: np.ndarray, q: np.ndarray) -> bool:
        T_world_body, T = np.empty((bodies, 3, 4)), np.empty((3, 4))
        J, error = np.empty((6, joints)), np.empty(6)
        for _ in range(STEPS):
            compute_bodies(arrays, q, T_world_body)
            compute_tool(arrays, T_world_body, T)
            error[:3] = T_target[:, 3] - T[:, 3]
            error[3:] = 0.0
            for k in range(3):  # half the sum of the axes' cross products: sin(angle) times the axis
                a, b = T[:, k], T_target[:, k]
                error[3] += 0.5 * (a[1] * b[2] - a[2] * b[1])
                error[4] += 0.5 * (a[2] * b[0] - a[0] * b[2])
                error[5] += 0.5 * (a[0] * b[1] - a[1] * b[0])
            turned = rows == 3 or (np.linalg.norm(error[3:]) < REACHED_RAD and np.sum(T[:, :3] * T_target[:, :3]) > 0.0)
            if turned and np.linalg.norm(error[:3]) < REACHED_M:
                return True
            compute_jacobian(arrays, T_world_body, T, J)
            A = J[:rows] @ J[:rows].T
            damping = DAMPING + 0.1 * np.sum(error[:rows] ** 2)
            for k in range(rows):
                A[k, k] += damping
            q += J[:rows].T @ np.linalg.solve(A, error[:rows])
            for k in range(joints):
                q[k] = min(max(q[k], lower[k]), upper[k])
        return False

    return descend

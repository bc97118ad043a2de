"""EAIK: closed form for an arm on a fixed base, or on a mobile one that is sampled around the target."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numba
import numpy as np
from eaik.IK_HP import HPRobot
from protocol import Peer, Setup, random_rotation, to_matrix

import ikde

ARM_JOINTS, HELD, TURN = 6, 1000, 2.0 * np.pi


class Fixed(Peer):
    """All branches, the first that is inside and free."""

    def prepare(self, setup: Setup) -> None:
        """All joints are the arm's."""
        super().prepare(setup)
        if len(setup.robot.joints) != ARM_JOINTS or not setup.is_pose:
            raise ValueError("poses of six joints on a fixed base only")
        self.solver, _, self.R_tool_end = make_arm(setup.robot, np.eye(4))
        self.choose = make_choice(setup.lower, setup.upper, setup.checker.is_free)

    def convert(self, p: np.ndarray, R: np.ndarray) -> np.ndarray:
        """A homogeneous matrix of EAIK's end effector."""
        return to_matrix(p, R @ self.R_tool_end)

    def solve(self, target: Any, deadline: float) -> np.ndarray | None:
        """There is nothing random to try again."""
        answer, q = self.solver.IK(target), np.empty(ARM_JOINTS)
        return q if len(answer.Q) and self.choose(q, answer.Q, answer.is_LS) else None


class Sampled(Peer):
    """A random base from which the target is in reach, all branches, the first that is inside and free."""

    def prepare(self, setup: Setup) -> None:
        """The arm as seen from the frame that the base moves."""
        super().prepare(setup)
        moving = [frame.name for frame in setup.robot.frames if frame.joint]
        if len(moving) <= ARM_JOINTS:
            raise ValueError("no base to sample")
        T_world_base = ikde.forward(setup.robot, np.zeros(len(setup.robot.joints)))[moving[-ARM_JOINTS - 1]]
        self.solver, points, R_tool_end = make_arm(setup.robot, T_world_base)
        reach = np.linalg.norm(np.diff(points[2:], axis=0), axis=1).sum()
        self.propose = make_proposal(setup.lower, setup.upper, points[2], reach, T_world_base[2, 3], R_tool_end)
        self.choose = make_choice(setup.lower, setup.upper, setup.checker.is_free)

    def solve(self, target: Any, deadline: float) -> np.ndarray | None:
        """One base at a time."""
        p, R = target
        is_pose, propose, choose, solve = self.setup.is_pose, self.propose, self.choose, self.solver.IK
        while True:
            q, T = propose(p, R, is_pose)
            answer = solve(T)
            if choose(q, answer.Q, answer.is_LS):
                return q
            if self.setup.clock() > deadline:
                return None


class AmongSolids(Peer):
    """The branches one by one, checked from Python. Of a longer arm one joint, and what is before it, are drawn."""

    def __init__(self, check: str) -> None:
        self.check = check

    def prepare(self, setup: Setup) -> None:
        """Of seven joints the last that leaves a known decomposition is held, at one of many values."""
        super().prepare(replace(setup, check=self.check))
        robot, count = setup.robot, len(setup.robot.joints)
        if not setup.is_pose or any(joint.kind == "prismatic" for joint in robot.joints[-7:]):
            raise ValueError("poses of arms that turn only")
        self.first = max(count - 7, 0)
        self.random = np.random.default_rng(setup.seed)
        frames = ikde.forward(robot, np.zeros(count))
        moving = [frame for frame in robot.frames if frame.joint]
        self.lifts = [(k, frames[frame.name][:3, :3] @ frame.axis) for k, frame in enumerate(moving[: self.first])]
        if any(robot.joints[k].kind != "prismatic" for k, _ in self.lifts):
            raise ValueError("what is before the arm may only lift it")
        arm = moving[self.first :]
        H = np.array([frames[frame.name][:3, :3] @ frame.axis for frame in arm])
        points = [np.zeros(3), *(frames[frame.name][:3, 3] for frame in arm), frames[robot.tool][:3, 3]]
        P = np.diff(np.array(points), axis=0)
        self.solvers = [HPRobot(H, P)] if len(arm) == ARM_JOINTS else self.hold(H, P)
        self.R_tool_end = frames[robot.tool][:3, :3].T.copy()

    def hold(self, H: np.ndarray, P: np.ndarray) -> list[HPRobot]:
        """Solvers for as many values of one joint."""
        lower, upper = self.setup.lower[self.first :], self.setup.upper[self.first :]
        for k in reversed(range(len(H))):
            if HPRobot(H, P, fixed_axes=[(k, 0.3)]).hasKnownDecomposition():
                values = self.random.uniform(lower[k], upper[k], HELD)
                return [HPRobot(H, P, fixed_axes=[(k, value)]) for value in values]
        raise ValueError("no joint leaves a known decomposition")

    def convert(self, p: np.ndarray, R: np.ndarray) -> np.ndarray:
        """A homogeneous matrix of EAIK's end effector."""
        return to_matrix(p, R @ self.R_tool_end)

    def solve(self, target: Any, deadline: float) -> np.ndarray | None:
        """All branches; again with other values if any were drawn."""
        setup, is_free, solvers = self.setup, self.setup.checker.is_free, self.solvers
        lower, upper, random = setup.lower, setup.upper, self.random
        q = np.empty(len(lower))
        while True:
            T = target.copy()
            for k, axis in self.lifts:
                q[k] = random.uniform(lower[k], upper[k])
                T[:3, 3] -= q[k] * axis
            solver = solvers[random.integers(len(solvers))] if len(solvers) > 1 else solvers[0]
            answer = solver.IK(T)
            for branch, is_approximate in zip(answer.Q, answer.is_LS, strict=True):
                if is_approximate:
                    continue
                q[self.first :] = branch
                q[q < lower] += TURN
                q[q > upper] -= TURN
                if (q >= lower).all() and is_free(q):
                    return q
            if len(solvers) == 1 or self.setup.clock() > deadline:
                return None


def make_arm(robot: ikde.Robot, T_world_base: np.ndarray) -> tuple[HPRobot, np.ndarray, np.ndarray]:
    """The last six joints seen from a base [4, 4] at q = 0: the solver, its points [8, 3] in m, and R_tool_end."""
    frames = ikde.forward(robot, np.zeros(len(robot.joints)))
    arm = [frame for frame in robot.frames if frame.joint][-ARM_JOINTS:]
    T_base_world = np.linalg.inv(T_world_base)
    Ts = [T_base_world @ frames[frame.name] for frame in arm]
    H = np.array([T[:3, :3] @ frame.axis for T, frame in zip(Ts, arm, strict=True)])
    T_base_tool = T_base_world @ frames[robot.tool]
    points = np.array([np.zeros(3), *(T[:3, 3] for T in Ts), T_base_tool[:3, 3]])
    solver = HPRobot(H, np.diff(points, axis=0))
    assert solver.hasKnownDecomposition()
    # EAIK's end effector is turned like the base at q = 0.
    return solver, points, T_base_tool[:3, :3].T.copy()


def make_proposal(
    lower: np.ndarray, upper: np.ndarray, shoulder: np.ndarray, reach: float, height: float, R_tool_end: np.ndarray
) -> Callable[..., tuple[np.ndarray, np.ndarray]]:
    """Compiled: a random base from which the target is within the arm's reach, and the arm's own target [4, 4]."""
    turned = numba.njit(random_rotation)

    @numba.njit
    def propose(p, R, is_pose):
        q = np.empty(lower.size)
        yaw = np.random.uniform(lower[2], upper[2])
        c, s = np.cos(yaw), np.sin(yaw)
        dz = p[2] - height - shoulder[2]
        flat = np.sqrt(max(reach * reach - dz * dz, 0.0))
        x = p[0] - (c * shoulder[0] - s * shoulder[1]) + np.random.uniform(-flat, flat)
        y = p[1] - (s * shoulder[0] + c * shoulder[1]) + np.random.uniform(-flat, flat)
        x, y = min(max(x, lower[0]), upper[0]), min(max(y, lower[1]), upper[1])
        q[0], q[1], q[2] = x, y, yaw
        R_base_world = np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
        T = np.eye(4)
        T[:3, :3] = R_base_world @ (R if is_pose else turned(np.random.standard_normal(4))) @ R_tool_end
        T[:3, 3] = R_base_world @ (p - np.array([x, y, height]))
        return q, T

    return propose


def make_choice(lower: np.ndarray, upper: np.ndarray, is_free: Callable[..., bool]) -> Callable[..., bool]:
    """Compiled: completes q [N] with the first exact branch that keeps the limits and is free."""

    @numba.njit
    def choose(q, branches, approximate):
        for row in range(branches.shape[0]):
            if approximate[row]:
                continue
            q[-ARM_JOINTS:] = branches[row]
            if np.all(q >= lower) and np.all(q <= upper) and is_free(q):
                return True
        return False

    return choose

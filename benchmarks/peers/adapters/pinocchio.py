"""Pinocchio with a Levenberg-Marquardt loop: in Python, and the same loop in C++ over its headers.

Pinocchio has no solver of its own; its documentation shows a damped Gauss-Newton loop on `log6` ("Inverse kinematics
(CLIK)"). This is that loop with Levenberg-Marquardt damping, steps bounded, limits by clipping, collision-free seeds.
"""

import ctypes
import hashlib
import os
import subprocess
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
from protocol import Peer, Setup

from ikde.model.collision_model import CollisionModel

STEPS, MAX_STEP, MIN_DAMPING, DAMPING = 60, 0.8, 1e-6, 0.1
SOURCE = Path(__file__).parent / "pinocchio_lm.cpp"


class InPython(Peer):
    """The loop in Python."""

    def prepare(self, setup: Setup) -> None:
        """From URDF."""
        super().prepare(setup)
        self.model = pin.buildModelFromUrdf(str(setup.urdf))
        self.data = self.model.createData()
        self.tool = self.model.getFrameId(setup.robot.tool)
        names = [self.model.names[k] for k in range(1, self.model.njoints)]
        assert names == list(setup.robot.joint_names)  # its order is ours on a chain
        self.lower, self.upper = setup.lower, setup.upper

    def convert(self, p: np.ndarray, R: np.ndarray) -> Any:
        """SE3."""
        return pin.SE3(R, p)

    def solve(self, target: Any, deadline: float) -> np.ndarray | None:
        """Descents from collision-free seeds."""
        draw = self.setup.checker.draw_free
        return self.restart(lambda: self.descend(target, draw()), deadline)

    def descend(self, target: Any, q: np.ndarray) -> np.ndarray | None:
        """One descent."""
        model, data, tool, is_pose = self.model, self.data, self.tool, self.setup.is_pose
        rows = 6 if is_pose else 3
        identity = np.eye(rows)
        for _ in range(STEPS):
            pin.computeJointJacobians(model, data, q)
            T = pin.updateFramePlacement(model, data, tool)
            error = np.empty(rows)
            error[:3] = T.rotation.T @ (target.translation - T.translation)
            if is_pose:
                error[3:] = pin.log3(T.rotation.T @ target.rotation)
            if self.setup.keeps(error[:3], error[3:]):
                return q
            J = pin.getFrameJacobian(model, data, tool, pin.LOCAL)[:rows]
            damping = MIN_DAMPING + DAMPING * (error @ error)
            step = J.T @ np.linalg.solve(J @ J.T + damping * identity, error)
            longest = np.abs(step).max()
            if longest > MAX_STEP:
                step *= MAX_STEP / longest
            q = np.clip(q + step, self.lower, self.upper)
        return None


class InCpp(InPython):
    """The loop, the restarts and the sphere check in C++."""

    def prepare(self, setup: Setup) -> None:
        """Compile once a machine, a minute or two; hand over joints and spheres."""
        super().prepare(setup)
        library = ctypes.CDLL(str(compile_library()))
        library.make.restype = ctypes.c_void_p
        library.solve.restype = ctypes.c_int
        numbers, counts = pack(self.model, self.tool, setup)
        self.solver = library.make(_pointer(numbers), _pointer(counts), ctypes.c_ulonglong(setup.seed))
        self.call, self.q = library.solve, np.empty(len(setup.robot.joints))
        self.q_pointer = _pointer(self.q)
        self.solver_pointer = ctypes.c_void_p(self.solver)

    def convert(self, p: np.ndarray, R: np.ndarray) -> Any:
        """Position, then rotation row by row."""
        numbers = np.concatenate([p, np.ravel(R)])
        return numbers, _pointer(numbers)

    def solve(self, target: Any, deadline: float) -> np.ndarray | None:
        """One call."""
        seconds = ctypes.c_double(deadline - time.perf_counter())
        return self.q.copy() if self.call(self.solver_pointer, target[1], self.q_pointer, seconds) else None


def pack(model: Any, tool: int, setup: Setup) -> tuple[np.ndarray, np.ndarray]:
    """What the C++ solver is made of, as numbers and counts, in the order that it reads them."""
    from ikde.model.spheres import bounding_sphere, expand_rows
    from ikde.model.tree import build_tree

    robot = setup.robot
    detector = CollisionModel.of(robot).detector
    parts, counts = [], [model.njoints - 1, int(setup.is_pose)]
    axes = {frame.joint: frame.axis for frame in robot.frames if frame.joint}
    for k, joint in enumerate(robot.joints, start=1):
        counts += [model.parents[k], int(joint.kind == "prismatic")]
        M = model.jointPlacements[k]
        parts += [np.ravel(M.rotation), M.translation, axes[joint.name]]
    frame = model.frames[tool]
    counts += [frame.parentJoint]
    parts += [np.ravel(frame.placement.rotation), frame.placement.translation, setup.lower, setup.upper]
    parts += [[setup.position_tolerance_m, setup.orientation_tolerance_rad, detector.safe_distance_m]]
    parts += [[MIN_DAMPING, DAMPING, MAX_STEP]]
    counts += [STEPS]
    tree, groups = build_tree(robot), {}
    for sphere in expand_rows(robot, tree, detector.spheres):
        groups.setdefault(sphere.component, []).append(sphere)
    names = list(groups)
    counts += [len(names)]
    for spheres in groups.values():
        body_joint = tree.bodies[spheres[0].body].joint
        counts += [0 if body_joint is None else body_joint + 1, len(spheres)]
        centre, radius = bounding_sphere(spheres)
        parts += [centre, [radius], *([*s.p_body_sphere, s.radius_m] for s in spheres)]
    pairs = CollisionModel(robot=robot, detector=detector).pairs
    counts += [len(pairs), *(names.index(name) for pair in pairs for name in pair)]
    return np.concatenate([np.ravel(part) for part in parts]).astype(float), np.array(counts, dtype=np.int32)


def compile_library() -> Path:
    """The compiled solver, kept by the hash of its source."""
    prefix = Path(pin.__file__).parents[4]
    digest = hashlib.sha256(SOURCE.read_bytes()).hexdigest()[:12]
    path = Path(tempfile.gettempdir()) / f"ikde-peers-{os.getuid()}" / f"pinocchio_lm_{pin.__version__}_{digest}.so"
    if not path.exists():
        path.parent.mkdir(exist_ok=True)
        folders = [f"-I{prefix / 'include'}", f"-I{prefix / 'include' / 'eigen3'}"]
        options = ["-std=c++17", "-O3", "-march=native", "-DNDEBUG", "-shared", "-fPIC", "-w"]
        options += ["-DBOOST_MPL_LIMIT_LIST_SIZE=30", "-DBOOST_MPL_CFG_NO_PREPROCESSED_HEADERS"]  # as its CMake files
        partial = path.with_suffix(".partial")
        command = ["g++", *options, *folders, str(SOURCE), "-o", str(partial)]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode:
            raise RuntimeError(f"g++ failed: {done.stderr.strip().splitlines()[0]}")
        partial.replace(path)
    return path


def _pointer(array: np.ndarray) -> ctypes.c_void_p:
    return ctypes.c_void_p(array.ctypes.data)

"""Robots that end in a UR-type arm, some of them random and written so as to hide it, and the closed form as a call."""

import numba
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import ikde
from ikde.kernels.closed_form import ANGLES, BRANCHES, solve_ur_arm
from ikde.model.closed_form import find_ur_arm, pack_ur_arm
from ikde.model.robot import Frame
from tests.random_robots import make_robot
from tests.reference import make_transform
from tests.reference_ur_arm import denavit_hartenberg

TWISTS = (0.5 * np.pi, 0.0, 0.0, 0.5 * np.pi, -0.5 * np.pi, 0.0)


def random_ur_robot(seed, *, twists=TWISTS, gap=0.0, lower=-np.pi, upper=np.pi):
    """Up to three random joints and then a UR-type arm: random lengths, zeros, signs, mount, tool and joint order.

    `twists` [6] rad and `gap`, m, by which axis 6 misses axis 5, make it another arm.
    """
    rng = np.random.default_rng(seed)
    before = int(rng.integers(0, 4))
    a = [
        rng.choice([0.0, rng.uniform(-0.2, 0.2)]),
        *(rng.uniform(0.15, 0.6, 2) * rng.choice([-1.0, 1.0], 2)),
        rng.choice([0.0, rng.uniform(-0.1, 0.1)]),
        gap,
        0.0,
    ]
    d = rng.uniform(-0.15, 0.15, 6)
    frames, kinds, T_next, parent = [], {}, random_transform(rng), "world"
    for k in range(before + 6):
        kinds[f"j{k}"] = "revolute" if k >= before or rng.random() < 0.5 else "prismatic"
        # The frame stands anywhere on the axis and is turned anyhow; what follows undoes that.
        hide = denavit_hartenberg(rng.uniform(-np.pi, np.pi), rng.uniform(-0.3, 0.3), 0.0, 0.0)
        hide = hide @ make_transform(Rotation.random(rng=rng).as_matrix(), np.zeros(3))
        axis = hide[:3, :3].T @ [0.0, 0.0, rng.choice([-1.0, 1.0])]
        frames.append(make_any_frame(f"f{k}", parent, T_next @ hide, f"j{k}", axis / np.linalg.norm(axis)))
        link = k - before
        after = denavit_hartenberg(0.0, d[link], a[link], twists[link]) if link >= 0 else random_transform(rng)
        T_next, parent = np.linalg.inv(hide) @ after, f"f{k}"
    frames.append(make_any_frame("tool", parent, T_next @ random_transform(rng)))
    order = [f"j{k}" for k in rng.permutation(before + 6)]
    return make_robot({name: kinds[name] for name in order}, frames, lower=lower, upper=upper)


def random_transform(rng):
    """A random pose [4, 4] within half a metre."""
    return make_transform(Rotation.random(rng=rng).as_matrix(), rng.uniform(-0.5, 0.5, 3))


def make_any_frame(name, parent, T, joint=None, axis=None):
    """A frame from its transform [4, 4]."""
    return Frame(name=name, parent=parent, p_parent_frame=T[:3, 3], R_parent_frame=T[:3, :3], joint=joint, axis=axis)


SHIPPED = [ikde.load_robot(name) for name in ("qiao2021", "qiao2021_dh", "ur5")]
UR_ROBOTS = [*SHIPPED, *(random_ur_robot(seed) for seed in range(12))]
every_ur_robot = pytest.mark.parametrize("robot", UR_ROBOTS, ids=lambda robot: robot.name)


@numba.njit
def solve_all(arm, ranges, poses, out_q, out_branch, out_count):
    work = np.full((2, ANGLES), np.nan)
    for k in range(len(poses)):
        out_count[k] = solve_ur_arm(arm, ranges, poses[k], work, out_q[k], out_branch[k])


def solve(robot, poses, limits=None, near=None):
    """Lists of solutions [n, 6] and codes [n] for tool poses [T, 4, 4] in the carrier, in the turns nearest `near`."""
    poses = np.ascontiguousarray(poses[:, :3])
    out_q, out_branch = np.full((len(poses), BRANCHES, 6), np.nan), np.full((len(poses), BRANCHES), -1)
    count = np.zeros(len(poses), dtype=int)
    lower, upper = (robot.lower, robot.upper) if limits is None else limits
    ranges = np.array([lower, upper, 0.5 * (lower + upper) if near is None else near])
    solve_all(pack_ur_arm(find_ur_arm(robot)), ranges, poses, out_q, out_branch, count)
    return [q[:n] for q, n in zip(out_q, count, strict=True)], [b[:n] for b, n in zip(out_branch, count, strict=True)]


def any_turn(robot):
    """Limits that leave every joint a whole turn."""
    return np.array([np.full(len(robot.joints), -np.pi), np.full(len(robot.joints), np.pi)])


def pose(arm, q):
    """T_carrier_tool [..., 4, 4] for the arm's six joints [..., 6]."""
    return arm.tool_pose(arm.signs * q + arm.offsets)


def random_arm_q(robot, rng, count):
    """Values [count, 6] of the arm's joints inside their limits, and the poses [count, 4, 4]."""
    arm = find_ur_arm(robot)
    q = rng.uniform(robot.lower, robot.upper, (count, len(robot.joints)))[:, list(arm.coordinates)]
    return q, pose(arm, q)

"""Room for the numbers of `kernels/least_motion.py`, in few tables: each array more that is handed on is compiled more.

Vectors have an entry a joint: those of `q` in the order of the robot, all others in that of the joints that move.
"""

from typing import NamedTuple

import numpy as np

from ikde.kernels.arrays import Floats, Ints
from ikde.kernels.contacts import Contacts, make_contacts
from ikde.kernels.dual_active_set import HalfSpaces, make_half_spaces
from ikde.kernels.jit import kernel

TASK_ROWS = 6
MAX_CONTACTS = 12

# Rows of `vectors`: q where the descent stands, at the end of a step, and the best
HERE, TRIAL, BEST = range(3)
# the weighed motion so far; Q^T of it; the step; what takes the tool's error away, here and behind the step
Y, SPLIT, STEP, ALONG, BEHIND = range(3, 8)
# minima without and with constraints, in coordinates in which the Hessian is 1; a product; a row
FREE_POINT, POINT, PRODUCT, ROW = range(8, 12)
# the Jacobian [6], m/rad or 1 and rad/rad or 0; weighed, then L and the reflections [6]; of the bend [3]; of gaps
JACOBIAN, ROWS, ROTATED, SLOPE = 12, 18, 24, 27

NULL, BEND, HESSIAN = range(3)  # of `matrices`: motions that leave the tool, a row each; reduced, then its factor
# rows of `numbers`: of the target's rows, of L, of gaps in m, the tool's error where the step begins
ERROR, MULTIPLIER, DIAGONAL, SCALE, SLACK, ERROR_HERE = range(6)
MOVING, ORDER, PAIR = range(3)  # rows of `whole`: joints, parents first; the target's row of each row; pairs of gaps


class MotionTables(NamedTuple):
    """What most kernels need of it, for N joints."""

    vectors: Floats  # [SLOPE + MAX_CONTACTS, N]
    matrices: Floats  # [3, N, N]
    numbers: Floats  # [6, MAX_CONTACTS]
    whole: Ints  # [3, N or MAX_CONTACTS]
    T_world_body: Floats  # [B, 3, 4]
    T_world_tool: Floats  # [3, 4]
    length: Floats  # [2 N + MAX_CONTACTS] of the normals of the half spaces
    owner: Ints  # [2 N + MAX_CONTACTS] 2 k and 2 k + 1: lower and upper end of joint k; beyond: gaps


class MotionWork(NamedTuple):
    """All of it."""

    tables: MotionTables
    contacts: Contacts
    spaces: HalfSpaces


@kernel
def make_motion_work(robot, collision, joints):
    """Room for a robot and a collision model."""
    tables = MotionTables(
        np.empty((SLOPE + MAX_CONTACTS, joints)),
        np.empty((3, joints, joints)),
        np.empty((6, MAX_CONTACTS)),
        np.empty((3, max(joints, MAX_CONTACTS)), dtype=np.int64),
        np.empty((robot.bodies.shape[0], 3, 4)),
        np.empty((3, 4)),
        np.empty(2 * joints + MAX_CONTACTS),
        np.empty(2 * joints + MAX_CONTACTS, dtype=np.int64),
    )
    return MotionWork(
        tables,
        make_contacts(np.empty((collision.components.shape[0], 3)), np.empty((3, collision.radius.size)), MAX_CONTACTS),
        make_half_spaces(2 * joints + MAX_CONTACTS, joints),
    )

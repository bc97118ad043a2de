"""Rows of a step, uncompiled."""

import numpy as np

from ikde.kernels import step_constraints as kernels
from ikde.kernels.drive import take_drive_step
from ikde.kernels.step_constraints import make_step_constraints
from ikde.kernels.tracking import compute_poses
from tests.uncompiled import plain

constrain_step = plain(kernels.constrain_step)
DIFFERENCE = 1e-6


def end_of(stand, step):
    out = np.empty_like(stand.q)
    plain(take_drive_step)(stand.drive, stand.q, step, out)
    return out


def rows_at(stand, step):
    """All rows at a step: slack, slope and pair, and where it ends."""
    q_end = end_of(stand, step)
    found = make_step_constraints(stand.spheres, len(q_end), stand.size)
    T_body, T_tool = stand.work.T_world_body, stand.work.T_world_tool
    plain(compute_poses)(stand.arrays, q_end, T_body, T_tool)
    packed = (stand.arrays, stand.spheres, stand.drive, stand.track)
    count = constrain_step(*packed, T_body, T_tool, stand.q, q_end, step, found)
    return found.slack[:count].copy(), found.slope[:count].copy(), found.pair[:count].copy()

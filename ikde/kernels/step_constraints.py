"""Linearised inequality constraints on a step along a path: slack + slope . change of the step >= 0.

Pairs of components keep their distance, and all of them what is asked for from a world; a base its place, wheels their
speed, the tool its distance from the platform.
"""

import math
from typing import NamedTuple

import numpy as np

from ikde.kernels.arrays import Floats, Ints
from ikde.kernels.contacts import Contacts, add_chain, fill_gradient, find_contacts, make_contacts
from ikde.kernels.drive import fold_row
from ikde.kernels.jit import inline_kernel, kernel, leaf_kernel
from ikde.kernels.spheres import compute_bounds, compute_centres
from ikde.kernels.trig import sin_cos
from ikde.kernels.world_contacts import (
    PLACE,
    WorldContacts,
    fill_world_gradient,
    find_world_contacts,
    make_world_contacts,
)

MAX_PAIRS = 8  # the nearest
MAX_SOLIDS = 8  # likewise, of a world
MAX_CONSTRAINTS = MAX_PAIRS + MAX_SOLIDS + 13  # and eight of a base's place, four of its wheels, one of the distance
INSIDE = 2e-9  # m: where a curved constraint is set, so that meeting it to 1e-9 is meeting it


class StepConstraints(NamedTuple):
    """The constraints of a step, a row each, and what finding them needs."""

    slack: Floats  # [MAX_CONSTRAINTS] m
    slope: Floats  # [MAX_CONSTRAINTS, D] m for the whole of the largest step
    pair: Ints  # [MAX_CONSTRAINTS] the place of a row in the table of clearances; -1: none
    row: Floats  # [N]
    contacts: Contacts
    world: WorldContacts


@kernel
def make_step_constraints(collision, joints, size):
    """Room for the rows of a step [size] of so many joints."""
    return StepConstraints(
        np.empty(MAX_CONSTRAINTS),
        np.empty((MAX_CONSTRAINTS, size)),
        np.empty(MAX_CONSTRAINTS, dtype=np.int64),
        np.empty(joints),
        make_contacts(np.empty((collision.components.shape[0], 3)), np.empty((3, collision.radius.size)), MAX_PAIRS),
        make_world_contacts(MAX_SOLIDS),
    )


@leaf_kernel
def constrain_world(robot, collision, drive, track, T_world_body, q, step, count, constraints):
    """Rows of what is near of the world, where the spheres are placed; returns how many rows there are then.

    What is asked for there takes the place of the safe distance, which the margin and the reach are above.
    """
    near, contacts, safe = constraints.world, constraints.contacts, collision.safe_distance
    reach = track.reach - safe
    found = find_world_contacts(collision, contacts.bounds, contacts.centres, reach, near.gap, near.found, near.normal)
    for k in range(found):
        fill_world_gradient(robot, collision, T_world_body, contacts.centres, near, k, constraints.row)
        fold_row(drive, q, step, constraints.row, constraints.slope[count])
        constraints.slack[count], constraints.pair[count] = near.gap[k] + safe - track.margin, near.found[k, PLACE]
        count += 1
    return count


@leaf_kernel
def constrain_pairs(robot, collision, drive, track, T_world_body, q, step, constraints):
    """Rows of the pairs, and of what of a world is, nearer than the reach at the poses of the step's end; how many."""
    if track.reach == -math.inf:
        return 0
    contacts = constraints.contacts
    compute_bounds(collision, T_world_body, contacts.bounds)
    compute_centres(collision, T_world_body, contacts.centres)
    count = find_contacts(collision, track.reach, MAX_PAIRS, contacts)
    for k in range(count):
        fill_gradient(robot, collision, T_world_body, contacts, k, constraints.row)
        fold_row(drive, q, step, constraints.row, constraints.slope[k])
        constraints.slack[k], constraints.pair[k] = contacts.gap[k] - track.margin, contacts.spheres[k, 0]
    if collision.world.size > 0:
        return constrain_world(robot, collision, drive, track, T_world_body, q, step, count, constraints)
    return count


@inline_kernel
def constrain_base(drive, track, q, q_end, step, count, constraints):
    """Rows that keep a base with wheels inside the ranges of x and y on its whole arc; returns how many there are then.

    Where an arc goes out of a range and comes back it stays on this side of the point where the tangents of both ends
    meet, which is half of the distance ahead of its start, and a little more.
    """
    s, c = sin_cos(0.5 * drive.largest[1])
    ahead = 0.5 * drive.largest[0] * (s / (0.5 * drive.largest[1] * c) if drive.largest[1] > 0.0 else 1.0)
    s, c = sin_cos(q[drive.base[2]])
    for k in range(2):
        coordinate, along = drive.base[k], ahead * (c if k == 0 else s)
        for side in range(2):
            sign = 1.0 if side == 0 else -1.0
            room = sign * (q_end[coordinate] - track.ranges[side, coordinate])
            if room <= 4.0 * drive.largest[0]:
                for i in range(q.size):
                    constraints.row[i] = 0.0
                constraints.row[coordinate] = sign
                fold_row(drive, q, step, constraints.row, constraints.slope[count])
                constraints.slack[count], constraints.pair[count] = room - INSIDE, -1
                count += 1
            room = sign * (q[coordinate] - track.ranges[side, coordinate])
            if room <= ahead:
                for i in range(step.size):
                    constraints.slope[count, i] = 0.0
                constraints.slope[count, 0] = sign * along
                constraints.slack[count], constraints.pair[count] = room + sign * along * step[0], -1
                count += 1
    return count


@inline_kernel
def constrain_wheels(drive, step, count, constraints):
    """Rows that keep both wheels, rolling d -+ (half track) a, within their travel; returns how many rows then."""
    distance, rotation = drive.largest[0], drive.half_track * drive.largest[1]
    if distance + rotation <= drive.wheel_travel * (1.0 + 1e-12):
        return count
    for wheel in range(2):
        rolled = distance * step[0] + (rotation if wheel == 1 else -rotation) * step[1]
        for side in range(2):
            sign = 1.0 if side == 0 else -1.0
            for k in range(step.size):
                constraints.slope[count, k] = 0.0
            constraints.slope[count, 0] = -sign * distance
            constraints.slope[count, 1] = -sign * (rotation if wheel == 1 else -rotation)
            constraints.slack[count], constraints.pair[count] = drive.wheel_travel - sign * rolled, -1
            count += 1
    return count


@inline_kernel
def constrain_distance(robot, drive, T_world_body, T_world_tool, q, step, count, constraints):
    """Row that keeps the tool near the platform's centre [Qiao2022, eq. 18]; returns how many rows there are then."""
    if drive.max_distance == math.inf:
        return count
    T, p = T_world_body[drive.centre_body], drive.p_body_centre
    x = T[0, 0] * p[0] + T[0, 1] * p[1] + T[0, 2] * p[2] + T[0, 3]
    y = T[1, 0] * p[0] + T[1, 1] * p[1] + T[1, 2] * p[2] + T[1, 3]
    z = T[2, 0] * p[0] + T[2, 1] * p[1] + T[2, 2] * p[2] + T[2, 3]
    tx, ty, tz = T_world_tool[0, 3], T_world_tool[1, 3], T_world_tool[2, 3]
    dx, dy, dz = tx - x, ty - y, tz - z
    distance = max(math.sqrt(dx * dx + dy * dy + dz * dz), 1e-12)
    nx, ny, nz = dx / distance, dy / distance, dz / distance
    for i in range(q.size):
        constraints.row[i] = 0.0
    add_chain(
        robot, T_world_body, robot.frame_body[robot.frame_body.size - 1], tx, ty, tz, -nx, -ny, -nz, constraints.row
    )
    add_chain(robot, T_world_body, drive.centre_body, x, y, z, nx, ny, nz, constraints.row)
    fold_row(drive, q, step, constraints.row, constraints.slope[count])
    constraints.slack[count], constraints.pair[count] = drive.max_distance - distance - INSIDE, -1
    return count + 1


@inline_kernel
def constrain_step(robot, collision, drive, track, T_world_body, T_world_tool, q, q_end, step, constraints):
    """All constraints of a step from `q` [N] to `q_end` [N]; returns how many."""
    count = constrain_pairs(robot, collision, drive, track, T_world_body, q, step, constraints)
    if drive.base[0] >= 0:
        count = constrain_base(drive, track, q, q_end, step, count, constraints)
        count = constrain_wheels(drive, step, count, constraints)
    return constrain_distance(robot, drive, T_world_body, T_world_tool, q, step, count, constraints)

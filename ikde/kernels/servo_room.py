"""Room for a step towards a target, and the numbers that say how it ends."""

from typing import NamedTuple

import numpy as np

from ikde.kernels.arrays import Floats, Ints
from ikde.kernels.constrained_step import System
from ikde.kernels.contacts import make_contacts
from ikde.kernels.dual_active_set import make_half_spaces
from ikde.kernels.jit import kernel
from ikde.kernels.step_constraints import MAX_CONSTRAINTS, MAX_PAIRS, MAX_SOLIDS, StepConstraints
from ikde.kernels.tracking import Sample
from ikde.kernels.world_contacts import make_world_contacts

MAX_KEPT = 32  # in contact
CUTS = 24  # rows of earlier rounds that are held on to
ROWS = MAX_CONSTRAINTS + CUTS
MEMORY, IS_FREE = 20, 19  # of a target: its kind, its pose [3, 4], its speed [6]; and if the stop is proved free

# Why a bound of the box is where it is.
SPEED, ACCELERATION, RANGE, APPROACH = range(4)
# What holds a step.
NOTHING, BOX, ROW, PLACE, REACH = range(5)
# Rows that are no place of the table of clearances.
BASE_ROW, WHEEL_ROW, DISTANCE_ROW = -2, -3, -4
# Entries of what a step gives, numbers and whole numbers.
POSITION_ERROR, ORIENTATION_ERROR, ERROR, ERROR_BEFORE, CLEARANCE, HELD_VALUE, NUMBERS = range(7)
NEAREST, HELD, HELD_BY, HELD_SIDE, HELD_WHY, IS_PROVED, IS_BRAKING, DOUBT, CODES = range(9)


class Servo(NamedTuple):
    """Room for one step beside that of `make_sample`."""

    last: Floats  # [D] the step before, in shares of the largest
    brake: Floats  # [D] the step that brakes
    step: Floats  # [D]
    tried: Floats  # [D]
    goal: Floats  # [D] what would bring the tool to its target without limits of speed
    around: Floats  # [D] the same around what is near
    lead: Floats  # [D] what the target moves on by in a step
    moved: Floats  # [6] how far that is, m, and rad times the rotation length
    why: Ints  # [2, D]
    row: Ints  # [ROWS] place in the table of clearances, or which other row
    near: Ints  # [MAX_KEPT] places that are nearer than they may be
    slack: Floats  # [MAX_KEPT] by how much, m
    q_end: Floats  # [N]
    largest: Floats  # [D] m or rad, of steps as long as the way to the stop
    cut_slope: Floats  # [CUTS, D] rows of earlier rounds: another sphere of a component may have been the nearest
    cut_slack: Floats  # [CUTS] m, at a step of 0
    cut_row: Ints  # [CUTS]


@kernel
def make_servo(joints, size):
    """Allocate it."""
    return Servo(
        np.zeros(size),
        np.zeros(size),
        np.zeros(size),
        np.zeros(size),
        np.zeros(size),
        np.zeros(size),
        np.zeros(size),
        np.zeros(6),
        np.zeros((2, size), dtype=np.int64),
        np.zeros(ROWS, dtype=np.int64),
        np.zeros(MAX_KEPT, dtype=np.int64),
        np.zeros(MAX_KEPT),
        np.zeros(joints),
        np.zeros(size),
        np.zeros((CUTS, size)),
        np.zeros(CUTS),
        np.zeros(CUTS, dtype=np.int64),
    )


@kernel
def make_room(robot, collision, joints, size):
    """Room for a step, as `make_sample`, with rows of earlier rounds."""
    components, spheres = collision.components.shape[0], collision.radius.size
    system = System(
        np.empty(size),
        np.empty(size),
        np.empty((size, size)),
        np.empty((size, size)),
        np.empty(size),
        np.empty(6),
        np.empty(size),
        make_half_spaces(2 * size + ROWS, size),
    )
    constraints = StepConstraints(
        np.empty(ROWS),
        np.empty((ROWS, size)),
        np.empty(ROWS, dtype=np.int64),
        np.empty(joints),
        make_contacts(np.empty((components, 3)), np.empty((3, spheres)), MAX_PAIRS),
        make_world_contacts(MAX_SOLIDS),
    )
    return Sample(
        np.empty((robot.bodies.shape[0], 3, 4)),
        np.empty((3, 4)),
        np.empty((6, joints)),
        np.empty((6, size)),
        np.empty((6, size)),
        np.empty((6, size)),
        np.empty(6),
        np.empty(size),
        system,
        constraints,
    )

"""Answers of arms with joints to spare that touch something: pulled clear, while the tool stays where it is.

Only what meets its target is repaired: rows that lead out of obstacles from the first step on keep an arm from it.
"""

import math

import numpy as np

from ikde.kernels.arrays import BODY, FIRST, LAST, POSITION
from ikde.kernels.clearance import find_own_pair
from ikde.kernels.contacts import MAX_CONTACTS, add_chain, add_contacts, make_contacts
from ikde.kernels.damped import compute_error, descend, fill_jacobian, make_descent_workspace
from ikde.kernels.flat_arguments import unpack_models, unpack_world
from ikde.kernels.frames import compute_bodies, compute_tool
from ikde.kernels.jit import counting_kernel, inline_kernel
from ikde.kernels.obstacles import OWNER, is_apart, solid_gap
from ikde.kernels.tables import place_spheres
from ikde.kernels.world_grid import find_hit

CLEAR = 3e-3  # m: how far beyond what is asked for that is led which is nearer
STEPS = 25  # deep inside a thick board the nearest face is often the wrong one: to start again is cheaper then
SPARE = 2
STEP = 1e-6  # m: of the differences that tell where a distance grows


@inline_kernel
def find_deepest(world, collision, bounds, centres, component, near):
    """Smallest gap of a component beyond what is asked for, m, with sphere and solid; `near` and -1 if none is less."""
    best, sphere, solid = near, -1, -1
    for s in range(world.solids.shape[0]):
        asked = world.asked[component, int(world.solids[s, OWNER])]
        if asked == -math.inf:
            continue
        x, y, z = bounds[component, 0], bounds[component, 1], bounds[component, 2]
        if is_apart(world, s, x, y, z, collision.bounds[component, 3] + asked + best):
            continue
        for i in range(collision.components[component, FIRST], collision.components[component, LAST]):
            less = collision.radius[i] + asked
            gap = solid_gap(world, s, centres[0, i], centres[1, i], centres[2, i], best + less, -math.inf) - less
            if gap < best:
                best, sphere, solid = gap, np.int64(i), s
    return best, sphere, solid


@inline_kernel
def grow(world, s, x, y, z, reach, dx, dy, dz):
    """How the distance of a point from solid `s` grows along a step."""
    ahead = solid_gap(world, s, x + dx, y + dy, z + dz, reach, -math.inf)
    return ahead - solid_gap(world, s, x - dx, y - dy, z - dz, reach, -math.inf)


@inline_kernel
def add_obstacles(robot, collision, world, rows, contacts, work):
    """Append a row for each component nearer than `CLEAR` to an obstacle: of its deepest sphere. Returns the rows."""
    centres = contacts.centres
    for component in range(collision.components.shape[0]):
        if rows >= work.error.size:
            break
        gap, i, s = find_deepest(world, collision, contacts.bounds, centres, component, CLEAR)
        if i < 0:
            continue
        x, y, z = centres[0, i], centres[1, i], centres[2, i]
        reach = collision.radius[i] + world.asked[component, int(world.solids[s, OWNER])] + CLEAR + 2.0 * STEP
        nx = grow(world, s, x, y, z, reach, STEP, 0.0, 0.0)
        ny = grow(world, s, x, y, z, reach, 0.0, STEP, 0.0)
        nz = grow(world, s, x, y, z, reach, 0.0, 0.0, STEP)
        size = math.sqrt(nx * nx + ny * ny + nz * nz)
        if size == 0.0:
            continue
        row = work.jacobian[rows]
        for column in range(row.size):
            row[column] = 0.0
        body = collision.components[component, BODY]
        add_chain(robot, work.T_world_body, body, x, y, z, nx / size, ny / size, nz / size, row)
        work.error[rows] = CLEAR - gap
        rows += 1
    return rows


@counting_kernel
def repair_at(numbers, whole, target, index, ranges, descent, q):
    """Pull `q` [N], which meets its target, clear of the world and of itself. Returns the steps, below 0 if in vain.

    `q` stays as it is then. An arm with fewer than two joints to spare stays as it is: one rarely leads out, and the
    Panda's slowest answers took twice as long.
    """
    if q.size - SPARE < (3 if target.kind[index] == POSITION else 6):
        return 0
    robot, collision = unpack_models(numbers[whole[2] :], whole[whole[3] :])
    world, work = unpack_world(collision.world), make_descent_workspace(robot, q.size, 6 + MAX_CONTACTS)
    bounds, centres = np.empty((collision.components.shape[0], 3)), np.empty((3, collision.radius.size))
    contacts, trial = make_contacts(bounds, centres, MAX_CONTACTS), q.copy()
    for step in range(STEPS + 1):
        compute_bodies(robot, trial, work.T_world_body)
        compute_tool(robot, work.T_world_body, work.T_world_tool)
        position, angle = compute_error(target, index, descent.rotation_length, work.T_world_tool, work.error)
        place_spheres(collision, work.T_world_body, bounds, centres)
        met = position <= descent.position_tolerance and angle <= descent.orientation_tolerance
        met = met and step > 0 and find_own_pair(collision, bounds, centres) < 0
        if met and find_hit(world, collision, bounds, centres) < 0:
            q[:] = trial
            return step
        if step == STEPS:
            break
        rows = fill_jacobian(robot, target, index, descent, work)
        rows = add_obstacles(robot, collision, world, rows, contacts, work)
        rows = add_contacts(robot, collision, collision.safe_distance + CLEAR, rows, contacts, work)
        descend(ranges, descent, rows, trial, work)
    return -STEPS

"""From where a robot stands to where it would stop: whether everything keeps its distance all the way.

All speeds shrink together, so joints run on a straight line, and a base with wheels on an arc. Between two
configurations a point leaves the chord of its path by at most an eighth of rotation times travel: its second derivative
along the way is no more than the sum of all rotations times the sum of what each joint moves it. Along a chord the
distance from a convex solid is convex, and that of two spheres is the distance from a segment. What is too weak is
halved. Of a cloud, which is not convex, half of the travel counts.
"""

import math
from typing import NamedTuple

import numpy as np

from ikde.kernels.arrays import COORDINATE, FIRST, LAST, PRISMATIC, Floats, Ints
from ikde.kernels.clearance import find_closest_spheres
from ikde.kernels.drive import arc_is_inside, take_drive_step
from ikde.kernels.frames import compute_bodies
from ikde.kernels.jit import counting_kernel, inline_kernel, kernel
from ikde.kernels.obstacles import CLOUD, KIND, OWNER, is_apart, solid_gap
from ikde.kernels.spheres import compute_bounds, compute_centres

LEVELS = 6  # ends of pieces that are held at once: a way is halved four times at most
SMALLEST = 1.0 / 16.0  # of a way: pieces are not halved below it
SAMPLES = 8  # of a way, at which what is in contact is measured
ROUNDING = 5e-13  # m, rad: ranges are twice as far from their ends
SAME_M = 1e-9  # m: depths that differ by less are the same
PROVED = -1


class Way(NamedTuple):
    """Room for a way."""

    q: Floats  # [N]
    T_world_body: Floats  # [B, 3, 4]
    bounds: Floats  # [LEVELS, C, 3] m
    centres: Floats  # [LEVELS, 3, S] m
    ends: Floats  # [LEVELS] shares of the way
    travel: Floats  # [N] m or rad: by how much each joint moves on all of it; of a base on arcs x stands for its length
    moved: Floats  # [P + C] m: by how much it changes the gap of each pair, moves each component
    step: Floats  # [D]
    kept: Ints  # [K] what is in contact from the start: a pair, or P + component * solids + solid
    depth: Floats  # [K] its gap at the start, m


@kernel
def make_way(robot, collision, joints, size, room):
    """Allocate the room for a robot and steps [size]; `room`: how much may be in contact."""
    components, spheres = collision.components.shape[0], collision.radius.size
    return Way(
        np.empty(joints),
        np.empty((robot.bodies.shape[0], 3, 4)),
        np.empty((LEVELS, components, 3)),
        np.empty((LEVELS, 3, spheres)),
        np.empty(LEVELS),
        np.empty(joints),
        np.empty(collision.pairs.shape[0] + components),
        np.empty(size),
        np.empty(room, dtype=np.int64),
        np.empty(room),
    )


@inline_kernel
def stop_factor(drive, step):
    """How many times as long as a step [D] the way to its stop is, and the entry that brakes longest, or -1.

    The speeds shrink from the step's to 0 in the time that this entry needs at its largest change.
    """
    longest, entry = 0.0, -1
    for k in range(step.size):
        if drive.largest[k] > 0.0 and abs(step[k]) / drive.change[k] > longest:
            longest, entry = abs(step[k]) / drive.change[k], k
    return 1.0 + 0.5 * longest, entry


@inline_kernel
def brake_step(drive, last, out_step):
    """The step [D] after `last` [D] with which all speeds shrink as fast as they may together."""
    share = 0.0
    for k in range(last.size):
        if drive.largest[k] > 0.0 and abs(last[k]) > 0.0:
            share = max(share, 1.0 - drive.change[k] / abs(last[k]))
    for k in range(last.size):
        out_step[k] = share * last[k] if drive.largest[k] > 0.0 else 0.0


@inline_kernel
def measure_way(robot, drive, radii, step, factor, way):
    """Travel of joints, pairs and components on a way of `factor` steps [D]; returns the sum of all rotations, rad."""
    first, rotation = step.size - drive.others.size, 0.0
    for k in range(way.travel.size):
        way.travel[k] = 0.0
    for k in range(drive.others.size):
        way.travel[drive.others[k]] = factor * drive.largest[first + k] * abs(step[first + k])
    if first == 2:
        way.travel[drive.base[0]] = factor * drive.largest[0] * abs(step[0])
        way.travel[drive.base[2]] = factor * drive.largest[1] * abs(step[1])
    for body in range(1, robot.bodies.shape[0]):
        if robot.bodies[body, PRISMATIC] == 0:
            rotation += way.travel[robot.bodies[body, COORDINATE]]
    for row in range(way.moved.size):
        way.moved[row] = 0.0
        for k in range(way.travel.size):
            way.moved[row] += radii[row, k] * way.travel[k]
    return rotation


@inline_kernel
def place_way(robot, collision, drive, q, step, share, slot, way):
    """Spheres at a share of the way that begins at `q` [N], into a slot; `step` [D] is the whole of it."""
    for k in range(step.size):
        way.step[k] = share * step[k]
    take_drive_step(drive, q, way.step, way.q)
    compute_bodies(robot, way.q, way.T_world_body)
    compute_bounds(collision, way.T_world_body, way.bounds[slot])
    compute_centres(collision, way.T_world_body, way.centres[slot])
    way.ends[slot] = share


@inline_kernel
def chord_distance(ax, ay, az, bx, by, bz):
    """Distance of the origin from the segment between two points."""
    dx, dy, dz = bx - ax, by - ay, bz - az
    square = dx * dx + dy * dy + dz * dz
    share = min(max(-(ax * dx + ay * dy + az * dz) / square, 0.0), 1.0) if square > 0.0 else 0.0
    x, y, z = ax + share * dx, ay + share * dy, az + share * dz
    return math.sqrt(x * x + y * y + z * z)


@inline_kernel
def is_kept_out(way, kept, key):
    """Whether something is in contact from the start: the proof leaves it out."""
    found = False
    for i in range(kept):
        found |= way.kept[i] == key
    return found


@inline_kernel
def pair_is_apart(collision, way, slot, pair, travel, rotation):
    """Whether two components are proved to stay farther apart than the safe distance between slot 0 and `slot`.

    Also whether they are too near at its end. `travel` m, `rotation` rad: of this piece.
    """
    a, b = collision.pairs[pair, 0], collision.pairs[pair, 1]
    safe, A, B = collision.safe_distance, way.bounds[0], way.bounds[slot]
    x = 0.5 * (A[a, 0] + B[a, 0] - A[b, 0] - B[b, 0])
    y = 0.5 * (A[a, 1] + B[a, 1] - A[b, 1] - B[b, 1])
    z = 0.5 * (A[a, 2] + B[a, 2] - A[b, 2] - B[b, 2])
    limit = collision.bounds[a, 3] + collision.bounds[b, 3] + safe + 0.5 * travel
    if x * x + y * y + z * z > limit * limit:
        return True, False
    P, Q = way.centres[0], way.centres[slot]
    for i in range(collision.components[a, FIRST], collision.components[a, LAST]):
        for j in range(collision.components[b, FIRST], collision.components[b, LAST]):
            ax, ay, az = P[0, i] - P[0, j], P[1, i] - P[1, j], P[2, i] - P[2, j]
            bx, by, bz = Q[0, i] - Q[0, j], Q[1, i] - Q[1, j], Q[2, i] - Q[2, j]
            x, y, z = 0.5 * (ax + bx), 0.5 * (ay + by), 0.5 * (az + bz)
            least = collision.radius[i] + collision.radius[j] + safe
            square, limit = x * x + y * y + z * z, least + 0.5 * travel
            if square > limit * limit:
                continue
            bend = 0.125 * rotation * (2.0 * travel + rotation * (math.sqrt(square) + travel))
            if chord_distance(ax, ay, az, bx, by, bz) - bend <= least:
                return False, bx * bx + by * by + bz * bz <= least * least
    return True, False


@counting_kernel
def solid_is_apart(world, collision, way, slot, component, s, travel, rotation):
    """The same of a component and a solid, and the distance that is asked for."""
    asked = world.asked[component, int(world.solids[s, OWNER])]
    if asked == -math.inf:
        return True, False
    A, B, half = way.bounds[0], way.bounds[slot], 0.5 * travel
    x, y = 0.5 * (A[component, 0] + B[component, 0]), 0.5 * (A[component, 1] + B[component, 1])
    z = 0.5 * (A[component, 2] + B[component, 2])
    if is_apart(world, s, x, y, z, collision.bounds[component, 3] + asked + half):
        return True, False
    P, Q, is_cloud = way.centres[0], way.centres[slot], int(world.solids[s, KIND]) == CLOUD
    for i in range(collision.components[component, FIRST], collision.components[component, LAST]):
        least = collision.radius[i] + asked
        x, y, z = 0.5 * (P[0, i] + Q[0, i]), 0.5 * (P[1, i] + Q[1, i]), 0.5 * (P[2, i] + Q[2, i])
        middle = solid_gap(world, s, x, y, z, least + half, -math.inf)
        if middle > least + half:
            continue
        if is_cloud:
            return False, middle <= least
        begin = solid_gap(world, s, P[0, i], P[1, i], P[2, i], math.inf, -math.inf)
        end = solid_gap(world, s, Q[0, i], Q[1, i], Q[2, i], math.inf, -math.inf)
        bound = min(middle, 2.0 * middle - max(begin, end))
        if bound - 0.125 * rotation * travel <= least:
            return False, end <= least
    return True, False


@inline_kernel
def find_doubt(world, has_world, collision, way, slot, kept, rotation):
    """What of the piece between slot 0 and `slot` is not proved: its place in the table of clearances, or `PROVED`.

    Also whether it is too near at the end of the piece.
    """
    share, pairs = way.ends[slot] - way.ends[0], collision.pairs.shape[0]
    for pair in range(pairs):
        is_free, is_hit = pair_is_apart(collision, way, slot, pair, share * way.moved[pair], share * rotation)
        if not is_free and not is_kept_out(way, kept, pair):
            return np.int64(pair), is_hit
    if not has_world:
        return np.int64(PROVED), False
    solids = world.solids.shape[0]
    for component in range(collision.components.shape[0]):
        travel = share * way.moved[pairs + component]
        for s in range(solids):
            is_free, is_hit = solid_is_apart(world, collision, way, slot, component, s, travel, share * rotation)
            if not is_free and not is_kept_out(way, kept, pairs + component * solids + s):
                return np.int64(pairs + component * world.asked.shape[1] + int(world.solids[s, OWNER])), is_hit
    return np.int64(PROVED), False


@counting_kernel
def prove_way(robot, collision, world, has_world, drive, q, step, rotation, kept, way):
    """What is not proved to keep its distance on the way [D] from `q` [N]: its place, or `PROVED`.

    `rotation`, and travels in `way`, as `measure_way` finds them; the first `kept` of what is in contact is left out.
    """
    place_way(robot, collision, drive, q, step, 0.0, 0, way)
    place_way(robot, collision, drive, q, step, 1.0, 1, way)
    top = 1
    while top > 0:
        doubt, is_hit = find_doubt(world, has_world, collision, way, top, kept, rotation)
        if doubt == PROVED:
            way.bounds[0, :, :], way.centres[0, :, :], way.ends[0] = way.bounds[top], way.centres[top], way.ends[top]
            top -= 1
        elif is_hit or top + 1 == LEVELS or way.ends[top] - way.ends[0] <= SMALLEST:
            return doubt
        else:
            middle = 0.5 * (way.ends[0] + way.ends[top])
            top += 1
            place_way(robot, collision, drive, q, step, middle, top, way)
    return np.int64(PROVED)


@counting_kernel
def measure_kept(world, collision, centres, key):
    """Gap of what is in contact, m: of a pair its own, of a component and a solid less what is asked for."""
    pairs = collision.pairs.shape[0]
    if key < pairs:
        gap, _, _ = find_closest_spheres(collision, centres, collision.pairs[key, 0], collision.pairs[key, 1])
        return gap
    component, s = (key - pairs) // world.solids.shape[0], (key - pairs) % world.solids.shape[0]
    asked = world.asked[component, int(world.solids[s, OWNER])]
    least = math.inf
    for i in range(collision.components[component, FIRST], collision.components[component, LAST]):
        gap = solid_gap(world, s, centres[0, i], centres[1, i], centres[2, i], math.inf, -math.inf)
        least = min(least, gap - collision.radius[i])
    return least - asked if asked > -math.inf else math.inf


@counting_kernel
def gets_no_deeper(robot, collision, world, drive, q, step, kept, way):
    """Whether what is in contact at `q` [N] is nowhere deeper on the way [D], at samples of it."""
    for sample in range(SAMPLES + 1):
        place_way(robot, collision, drive, q, step, sample / SAMPLES, 0, way)
        for i in range(kept):
            gap = measure_kept(world, collision, way.centres[0], way.kept[i])
            if sample == 0:
                way.depth[i] = gap
            elif gap < way.depth[i] - SAME_M:
                return False
    return True


@inline_kernel
def stays_in_ranges(drive, ranges, q, q_stop, step):
    """Whether a way [D] from `q` [N] to `q_stop` [N] stays in the ranges; what is outside one may come nearer to it."""
    for k in range(q.size):
        if q_stop[k] < min(ranges[0, k], q[k]) - ROUNDING or q_stop[k] > max(ranges[1, k], q[k]) + ROUNDING:
            return False
    return drive.base[0] < 0 or arc_is_inside(drive, ranges, q, step)

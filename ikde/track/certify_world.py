"""Between samples, in a world: a lower bound on what the whole motion keeps beyond what is asked for.

A distance to anything that stands still changes by no more than the point moves. A revolute joint that moves by |dq_j|
moves no point farther than |dq_j| times its largest distance from the axis, a prismatic one no farther than |dq_j|, and
a base with wheels none farther than its arc is long, and its rotation times that distance. So the gap of a component
and an obstacle is nowhere in a segment below (gap(0) + gap(1) - travel) / 2. Where that is too weak they are halved.
"""

from collections.abc import Mapping

import numpy as np

from ikde.kernels.arrays import Floats
from ikde.model.base_motion import base_twist, find_wheels, step_base
from ikde.model.collision_model import CollisionModel
from ikde.model.tree import build_tree
from ikde.solver.plain import compute_world_gaps
from ikde.track.moving import Around
from ikde.track.travel import chain_of, list_centres, max_radius

SHARP_M, SHARP = 1e-4, 0.02  # how near the bound shall come to the true one: m, and as a share of it
MAX_HALVINGS = 14
AT_ONCE = 256  # configurations: more do not fit into the cache


def compute_room(collision: CollisionModel, q: Floats, around: Around | None = None) -> Floats:
    """What each component keeps of each obstacle beyond what is asked for [K, C, O], m; inf where not compared.

    `around`: what moves, and when `q` [K, N] is.
    """
    shape = len(collision.components), len(collision.obstacles)
    parts = []
    for some in (slice(k, k + AT_ONCE) for k in range(0, len(q), AT_ONCE)):
        still = around is None
        parts.append(
            compute_world_gaps(collision, q[some])
            if still
            else around.world.compute_gaps(q[some], around.times_s[some])
        )
    gaps = np.concatenate(parts) if parts else np.empty((0, shape[0] * shape[1]))
    return gaps.reshape(-1, *shape) - collision.limit_m


def bound_world(collision: CollisionModel, q: Floats, drive: str, around: Around | None = None) -> Floats:
    """Lower bound [M, C, O] of the room in each segment between rows of `q` [M + 1, N], m.

    An obstacle that moves adds the way of its points, at most: its own, and what it turns times its radius.
    """
    lower = np.full((max(len(q) - 1, 0), len(collision.components), len(collision.obstacles)), np.inf)
    if not lower.size:
        return lower
    base = find_wheels(collision.robot, drive)
    radii = reach_radii(collision, np.abs(q).max(axis=0))
    room = compute_room(collision, q, around)
    times = np.zeros(len(q)) if around is None else around.times_s
    least = room.min()
    if least == np.inf:  # nothing is compared
        return lower
    goal = max(least - max(SHARP_M, SHARP * abs(least)), 0.5 * least if least > 0.0 else -np.inf)
    which, start, end = np.arange(len(lower)), q[:-1], q[1:]
    before, after, begin, finish = room[:-1], room[1:], times[:-1], times[1:]
    for halving in range(MAX_HALVINGS + 1):
        travel = measure_steps(start, end, base) @ radii.T
        ways = travel[:, :, None]
        if around is not None:
            ways = ways + around.world.measure_travel(begin, finish)[:, None]
        bound = 0.5 * (before + after - ways)
        weak = (bound.min(axis=(1, 2)) < goal) & (halving < MAX_HALVINGS)
        np.minimum.at(lower, which[~weak], bound[~weak])
        if not weak.any():
            break
        which, start, end, before, after = which[weak], start[weak], end[weak], before[weak], after[weak]
        begin, finish = begin[weak], finish[weak]
        middle, noon = find_middle(start, end, base), 0.5 * (begin + finish)
        between = compute_room(collision, middle, None if around is None else Around(around.world, noon))
        which = np.concatenate([which, which])
        start, end = np.concatenate([start, middle]), np.concatenate([middle, end])
        before, after = np.concatenate([before, between]), np.concatenate([between, after])
        begin, finish = np.concatenate([begin, noon]), np.concatenate([noon, finish])
    return lower


def measure_steps(start: Floats, end: Floats, base: np.ndarray) -> Floats:
    """By how much each joint moves in each segment [M, N], m and rad; of a base on arcs x stands for its length."""
    steps = np.abs(end - start)
    if base[0] >= 0:
        along, _, across = base_twist(start[:, base], end[:, base], 1.0)
        steps[:, base[0]], steps[:, base[1]] = np.abs(along), np.abs(across)
    return steps


def find_middle(start: Floats, end: Floats, base: np.ndarray) -> Floats:
    """Configurations [M, N] half-way; a base with wheels is on its arc."""
    middle = 0.5 * (start + end)
    if base[0] >= 0:
        along, rotation, _ = base_twist(start[:, base], end[:, base], 1.0)
        middle[:, base] = step_base(start[:, base], along, rotation, 0.5)
    return middle


def reach_radii(collision: CollisionModel, max_abs_q: Floats) -> Floats:
    """How far a joint moves any sphere's centre of a component [C, N], at most: m a rad if revolute, 1 if prismatic.

    `max_abs_q` [N], m and rad, as for `certify.travel_radii`.
    """
    robot, tree = collision.robot, build_tree(collision.robot)
    centres: Mapping[str, list[tuple[int, Floats]]] = list_centres(collision)
    radii = np.zeros((len(collision.components), len(robot.joints)))
    for row, name in zip(radii, collision.components, strict=True):
        chain = chain_of(tree, centres[name][0][0])
        for body in chain:
            joint = tree.bodies[body].joint
            row[joint] = max(max_radius(robot, tree, max_abs_q, chain, body, p) for _, p in centres[name])
    return radii

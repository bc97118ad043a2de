"""Between samples: a lower bound on the clearance of the whole motion, and how far the tool leaves the path.

Joints run linearly. Seen from a body that carries two components, only the joints between them move them, so the place
of a base does not enter. If joint j rotates by |dq_j|, no point of what it carries moves farther than |dq_j| times its
largest distance from the axis; so the gap of two spheres is nowhere in a segment below (gap(0) + gap(1) - travel) / 2,
where travel is the sum over those joints. Segments whose bound is too weak are halved.
"""

from dataclasses import dataclass

import numpy as np

from ikde.kernels.arrays import Floats, Ints
from ikde.model.base_motion import base_twist, find_wheels, step_base
from ikde.model.collision_model import CollisionModel
from ikde.model.robot import Robot
from ikde.model.tree import build_tree
from ikde.solver.plain import compute_frames, compute_gaps
from ikde.solver.verify import compute_orientation_errors
from ikde.track.certify_world import bound_world
from ikde.track.moving import Around
from ikde.track.path import ToolPath
from ikde.track.travel import chain_of, list_centres, max_radius

SHARP_M, SHARP = 1e-4, 0.02  # how near the bound shall come to the true clearance: m, and as a share of it
MAX_HALVINGS = 14


@dataclass(frozen=True, kw_only=True, eq=False)
class Certificate:
    """What is certain about the motion between its samples."""

    clearance_m: float
    """No gap of the motion is smaller, at any moment; in a world neither of components nor to obstacles."""
    segment_m: Floats
    """[M] the same, of each segment."""
    room_m: Floats
    """[M] by how much more than what is asked for everything keeps: of components, that nothing touches; of obstacles,
    their margins."""
    own_m: Floats | None = None
    """[M] in a world, the clearance of components from one another alone."""
    world_m: Floats | None = None
    """[M] likewise that to obstacles; inf where nothing is compared with them."""

    def __repr__(self) -> str:
        return f"<Certificate: at least {1e3 * self.clearance_m:.6g} mm in {len(self.segment_m)} segments>"

    @property
    def is_free(self) -> bool:
        """True if nothing can touch between samples, and every margin to an obstacle is kept."""
        return bool(self.room_m.min() > 0.0)


def certify(
    collision: CollisionModel, q: Floats, drive: str = "omnidirectional", around: Around | None = None
) -> Certificate | None:
    """Bound the clearance of the motion through `q` [M + 1, N]; None without a pair or a segment: not checked.

    `drive`: of a base, which moves on arcs if it is `differential`; it matters in a world alone. `around`: what of the
    world moves.
    """
    if len(q) < 2 or not collision.pairs:
        return None
    room = bound_all(collision, q, drive, around)
    clearances, own = room + list_kept_m(collision), len(collision.pairs)
    segments, parts = clearances.min(axis=1), {}
    if collision.obstacles:
        parts = {"own_m": clearances[:, :own].min(axis=1), "world_m": clearances[:, own:].min(axis=1)}
    return Certificate(clearance_m=float(segments.min()), segment_m=segments, room_m=room.min(axis=1), **parts)


def list_kept_m(collision: CollisionModel) -> Floats:
    """What is asked for between samples of each of `all_pairs`, m: that components do not touch, and margins."""
    kept = collision.extras_m + collision.limit_m
    kept[: len(collision.pairs)] = 0.0
    return kept


def bound_all(collision: CollisionModel, q: Floats, drive: str, around: Around | None = None) -> Floats:
    """Lower bound of what each of `all_pairs` keeps beyond what is asked for [M, P + C O], m."""
    own = bound_pairs(collision, q)
    if not collision.obstacles:
        return own
    world = bound_world(collision, q, drive, around)
    return np.concatenate([own, world.reshape(len(own), int(np.prod(world.shape[1:])))], axis=1)


def bound_segments(collision: CollisionModel, q: Floats) -> Floats:
    """Lower bound [M] of the clearance in each segment between rows of `q` [M + 1, N]; inf without a pair."""
    return bound_pairs(collision, q).min(axis=1, initial=np.inf)


def bound_pairs(collision: CollisionModel, q: Floats) -> Floats:
    """The same of each pair [M, P]."""
    lower = np.full((max(len(q) - 1, 0), len(collision.pairs)), np.inf)
    if not lower.size:
        return lower
    radii = travel_radii(collision, np.abs(q).max(axis=0))
    gaps = compute_gaps(collision, q, collision.pairs)
    least = gaps.min()
    goal = max(least - max(SHARP_M, SHARP * abs(least)), 0.5 * least if least > 0.0 else -np.inf)
    which, start, end = np.arange(len(lower)), q[:-1], q[1:]
    before, after = gaps[:-1], gaps[1:]
    for halving in range(MAX_HALVINGS + 1):
        travel = np.abs(end - start) @ radii.T
        bound = 0.5 * (before + after - travel)
        weak = (bound.min(axis=1) < goal) & (halving < MAX_HALVINGS)
        np.minimum.at(lower, which[~weak], bound[~weak])
        if not weak.any():
            break
        which, start, end, before, after = which[weak], start[weak], end[weak], before[weak], after[weak]
        middle = 0.5 * (start + end)
        between = compute_gaps(collision, middle, collision.pairs)
        which = np.concatenate([which, which])
        start, end = np.concatenate([start, middle]), np.concatenate([middle, end])
        before, after = np.concatenate([before, between]), np.concatenate([between, after])
    return lower


def travel_radii(collision: CollisionModel, max_abs_q: Floats) -> Floats:
    """By how much a joint can change each pair's gap [P, N]: m a rad if revolute, 1 if prismatic, 0 elsewhere.

    `max_abs_q` [N], m and rad: what a prismatic joint has carried outwards, a revolute one moves more.
    """
    robot, tree = collision.robot, build_tree(collision.robot)
    centres = list_centres(collision)
    radii = np.zeros((len(collision.pairs), len(robot.joints)))
    for row, names in zip(radii, collision.pairs, strict=True):
        chains = [chain_of(tree, centres[name][0][0]) for name in names]
        for name, chain, other in zip(names, chains, chains[::-1], strict=True):
            for body in chain:
                if body not in other:
                    joint = tree.bodies[body].joint
                    row[joint] = max(max_radius(robot, tree, max_abs_q, chain, body, p) for _, p in centres[name])
    return radii


def halfway(robot: Robot, q: Floats, drive: str, dt_s: float) -> Floats:
    """Configurations [M, N] half-way between the rows of `q` [M + 1, N]; a base with wheels is on its arc."""
    middle = 0.5 * (q[:-1] + q[1:])
    base: Ints = find_wheels(robot, drive)
    if base[0] >= 0:
        v, omega, _ = base_twist(q[:-1, base], q[1:, base], dt_s)
        middle[:, base] = step_base(q[:-1, base], v, omega, 0.5 * dt_s)
    return middle


def measure_deviation(robot: Robot, path: ToolPath, q: Floats, drive: str) -> tuple[Floats, Floats]:
    """Distance [M] in m and angle [M] in rad of the tool from the path half-way between samples."""
    middle = halfway(robot, q, drive, path.dt_s)
    tool, targets = compute_frames(robot, middle)[robot.tool], path.half_targets()[: len(middle)]
    position = np.linalg.norm(tool[:, :3, 3] - targets.p_world_tool, axis=1)
    return position, compute_orientation_errors(targets, tool[:, :3, :3])

"""What the closed form proves of an arm that alone may move: why a pose has no solution.

Every pose within the tolerances has the branches of `model/branches.py`, each within its slack. A pose is *ruled out*
when each branch does not exist, is outside the limits in every turn, or collides, with all of its slack. Plain numpy
throughout, and no kernel: what a search has missed is not counted on.
"""

from collections import Counter
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from ikde.kernels.arrays import Floats, Ints
from ikde.model.branches import find_branches
from ikde.model.closed_form import find_still_arm, find_ur_arm
from ikde.model.collision_model import CollisionModel
from ikde.model.large_worlds import KEPT
from ikde.model.target import KINDS, Target, Targets
from ikde.solver.arm_motions import find_motions
from ikde.solver.plain import compute_frames, compute_gaps
from ikde.solver.problem import Problem
from ikde.solver.result import NO_SOLUTION, STOP_REASONS, StopReason, count_blocking_pairs
from ikde.solver.verify import Bools

ROUNDING = 1e-8  # m and rad: what the arm's own model may be off by, and what sums lose
TURN = 2.0 * np.pi
CHUNK = 1024  # poses that are judged at once

_OUT_OF_REACH, _COLLISION, _LIMITS, _WORLD = map(
    STOP_REASONS.index, (StopReason.OUT_OF_REACH, StopReason.COLLISION, StopReason.LIMITS, StopReason.WORLD)
)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Asked:
    """T poses of an arm, as what carries it sees them."""

    q: Floats
    """[T, N] of the joints that are not the arm's."""
    T_carrier_tool: Floats
    """[T, 4, 4] m"""
    carrier: int | None = None
    """A joint that carries the arm and is not known exactly."""
    carrier_slack: float = 0.0
    """By how much, m or rad."""
    moves_m: float = 0.0
    """How far the pose may be from what the carrier sees, beside the tolerances: for the joint that is not known."""
    rotates_rad: float = 0.0


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Judged:
    """The eight branches of T poses."""

    q: Floats
    """[T, 8, N] in the turn nearest to the ranges; NaN where no pose within the tolerances has the branch."""
    is_own: Bools
    """[T, 8] the pose itself has it."""
    missing: Bools
    """[T, 8] does not exist, for sure."""
    outside: Bools
    """[T, 8] outside the ranges, for sure."""
    colliding: Bools
    """[T, 8, P + C O] pairs that collide there for sure, then components and obstacles; only of what is not outside."""
    own: int
    """P, pairs of components."""

    @property
    def ruled_out(self) -> Ints:
        """[T] why no configuration meets the pose within the tolerances: index into `STOP_REASONS`; -1: one may."""
        collides = self.colliding.any(axis=-1)
        why = np.where(self.outside.any(axis=-1), _LIMITS, _OUT_OF_REACH)
        why = np.where(collides.any(axis=-1), _COLLISION, why)
        why = np.where(self.colliding[..., self.own :].any(axis=(-2, -1)), _WORLD, why)
        return np.where((self.missing | self.outside | collides).all(axis=-1), why, -1)


def rule_out_by_branches(problem: Problem, targets: Targets) -> Ints:
    """Why poses are ruled out [T], as `Judged.ruled_out`; -1 for what is no pose, or no arm that alone may move."""
    ruled_out = np.full(len(targets), -1)
    if find_still_arm(problem.robot, problem.lower, problem.upper) is not None:
        poses = np.flatnonzero(targets.kind == KINDS.index("pose"))
        for rows in np.array_split(poses, len(poses) // CHUNK + 1):
            ruled_out[rows] = judge_branches(problem, targets.take(rows)).ruled_out
    return ruled_out


def judge_branches(problem: Problem, targets: Targets) -> Judged:
    """All branches of poses, by an arm that alone may move."""
    q = np.broadcast_to(problem.lower, (len(targets), len(problem.lower)))
    T_world_tool = np.broadcast_to(np.eye(4), (len(targets), 4, 4)).copy()
    T_world_tool[:, :3] = targets.T_world_tool
    return judge(problem, Asked(q=q, T_carrier_tool=_place_carrier(problem) @ T_world_tool))


def judge(problem: Problem, asked: Asked) -> Judged:
    """All branches of poses, where every joint but the arm's is known, or nearly so."""
    settings, arm = problem.settings, find_ur_arm(problem.robot)
    assert arm is not None
    tolerances = settings.position_tolerance_m + ROUNDING, settings.orientation_tolerance_rad + ROUNDING
    found = find_branches(arm, asked.T_carrier_tool, tolerances[0] + asked.moves_m, tolerances[1] + asked.rotates_rad)
    q = np.repeat(asked.q[:, None], found.missing.shape[1], axis=1)
    slack = np.zeros(q.shape)
    joints, middle = list(arm.coordinates), 0.5 * (problem.lower + problem.upper)[list(arm.coordinates)]
    angles = arm.signs * (found.angles - arm.offsets)
    q[..., joints] = angles - TURN * np.rint((angles - middle) / TURN)
    slack[..., joints] = found.slack
    outside = (_measure_excess(problem, q) > slack).any(axis=-1) & ~found.missing
    if asked.carrier is not None:
        joints.append(asked.carrier)
        slack[..., asked.carrier] = asked.carrier_slack
    pairs, every = len(problem.collision.pairs), len(problem.collision.all_pairs)
    colliding = np.zeros((*outside.shape, every), dtype=bool)
    tested = np.isfinite(slack).all(axis=-1) & ~outside & ~found.missing
    if not problem.collision.pairs:
        return Judged(q=q, is_own=found.is_own, missing=found.missing, outside=outside, colliding=colliding, own=pairs)
    motions, moved = (
        find_motions(problem.collision.laden, tuple(joints)),
        (slack[tested][:, joints], _seen_by_tool(found.is_own[tested], tolerances[0]), tolerances[1]),
    )
    room = motions.bound_m(*moved)
    if problem.collision.obstacles:
        room = np.concatenate([room, motions.bound_in_world_m(*moved, problem.collision)], axis=-1)
    colliding[tested] = compute_gaps(problem.collision, q[tested]) + room <= problem.collision.limit_m
    return Judged(q=q, is_own=found.is_own, missing=found.missing, outside=outside, colliding=colliding, own=pairs)


def _seen_by_tool(is_own: Bools, position_m: float) -> Floats:
    """How far the tool may be from where it is in a branch [K, 1], m: of a branch that the pose has not, anywhere."""
    return np.where(is_own, position_m, np.inf)[:, None]


def _measure_excess(problem: Problem, q: Floats) -> Floats:
    """How far each joint is outside its range in the nearest turn [..., N]; q is in the turn nearest to the middle."""
    return np.maximum(np.maximum(problem.lower - q, q - problem.upper), 0.0)


@KEPT.add
@lru_cache(maxsize=64)
def _place_carrier(problem: Problem) -> Floats:
    """T_carrier_world [4, 4]."""
    arm = find_still_arm(problem.robot, problem.lower, problem.upper)
    assert arm is not None
    T_world_carrier = compute_frames(problem.robot, problem.lower)[problem.robot.tool]
    T_world_carrier = T_world_carrier @ np.linalg.inv(arm.tool_pose(arm.angles(problem.lower)))
    return np.asarray(np.linalg.inv(T_world_carrier), dtype=float)


def tell_branches(problem: Problem, target: Target) -> tuple[str, dict[tuple[str, str], int]]:
    """One line why a pose that is ruled out has no solution; and in how many branches each pair collides."""
    judged, collision = judge_branches(problem, Targets.of([target])), problem.collision
    outside, hits = judged.outside[0], judged.colliding[0][~judged.outside[0]]
    blocking = count_blocking_pairs(collision.counted, collision.fold(hits).sum(axis=0))
    colliding, count = int(hits.any(axis=-1).sum()), int((~judged.missing[0]).sum())
    words = []
    if outside.any():
        beyond = _measure_excess(problem, judged.q[0][outside]) > 0.0
        names = [problem.robot.joint_names[k] for k in np.flatnonzero(beyond.any(axis=0)).tolist()]
        words.append(f"{outside.sum()} outside the limits of {', '.join(names)}")
    if colliding and collision.obstacles:
        words.append(f"{colliding} in collision: {'; '.join(_name_blockers(collision, judged))}")
    elif colliding:
        worst = ", ".join(f"{a}-{b} in {n}" for (a, b), n in list(blocking.items())[:3])
        words.append(f"{colliding} in collision ({worst})")
    if not count:
        return f"{NO_SOLUTION}: no configuration of the arm, whatever its limits, has this pose", {}
    return f"{NO_SOLUTION}: of {count} configurations with this pose {' and '.join(words)}", blocking


def _name_blockers(collision: CollisionModel, judged: Judged) -> list[str]:
    """The pair that is deepest in each branch that collides, and by how much it is too near, in mm; alike ones once."""
    rows = np.flatnonzero(judged.colliding[0].any(axis=-1))
    gaps_m = np.where(judged.colliding[0][rows], compute_gaps(collision, judged.q[0][rows]), np.inf)
    found = Counter[str]()
    for gaps in gaps_m:
        worst = int(gaps.argmin())
        a, b = collision.name_pair(worst)
        found[f"{a} - {b} {1e3 * (gaps[worst] + collision.extra_m(worst)):.1f} mm"] += 1
    return [f"{words} ({count} of them)" if count > 1 else words for words, count in found.items()]


def find_beyond(problem: Problem, target: Target) -> Floats | None:
    """The configuration [N] that meets a pose and is least outside the limits, if one is free of collision."""
    judged = judge_branches(problem, Targets.of([target]))
    q = judged.q[0][judged.is_own[0]]
    free = q[(compute_gaps(problem.collision, q) > problem.collision.limit_m).all(axis=-1)]
    if not len(free):
        return None
    return free[_measure_excess(problem, free).sum(axis=-1).argmin()]

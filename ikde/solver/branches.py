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
from ikde.model.closed_form import URArm, find_still_arm, find_ur_arm
from ikde.model.collision_model import CollisionModel
from ikde.model.robot import WORLD, FreeSpheres, Robot, Spheres
from ikde.model.target import KINDS, Target, Targets
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
class Judged:
    """The eight branches of T poses."""

    q: Floats
    """[T, 8, N] in the turn nearest to the ranges; NaN where there is no branch."""
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
    robot, settings = problem.robot, problem.settings
    arm = find_still_arm(robot, problem.lower, problem.upper)
    assert arm is not None
    tolerances = settings.position_tolerance_m + ROUNDING, settings.orientation_tolerance_rad + ROUNDING
    found = find_branches(arm, _find_carried(problem, targets), *tolerances)
    q = np.broadcast_to(problem.lower, (*found.missing.shape, len(robot.joints))).copy()
    slack = np.zeros(q.shape)
    joints, middle = list(arm.coordinates), 0.5 * (problem.lower + problem.upper)[list(arm.coordinates)]
    angles = arm.signs * (found.angles - arm.offsets)
    q[..., joints] = angles - TURN * np.rint((angles - middle) / TURN)
    slack[..., joints] = found.slack
    outside = (_measure_excess(problem, q) > slack).any(axis=-1) & ~found.missing
    pairs, every = len(problem.collision.pairs), len(problem.collision.all_pairs)
    colliding = np.zeros((*outside.shape, every), dtype=bool)
    tested = np.isfinite(slack).all(axis=-1) & ~outside & ~found.missing
    if not problem.collision.pairs:
        return Judged(q=q, missing=found.missing, outside=outside, colliding=colliding, own=pairs)
    motions, moved = find_motions(problem.collision.own), (slack[tested][:, joints], *tolerances)
    room = motions.bound_m(*moved)
    if problem.collision.obstacles:
        room = np.concatenate([room, motions.bound_in_world_m(*moved, problem.collision)], axis=-1)
    colliding[tested] = compute_gaps(problem.collision, q[tested]) + room <= problem.collision.limit_m
    return Judged(q=q, missing=found.missing, outside=outside, colliding=colliding, own=pairs)


def _measure_excess(problem: Problem, q: Floats) -> Floats:
    """How far each joint is outside its range in the nearest turn [..., N]; q is in the turn nearest to the middle."""
    return np.maximum(np.maximum(problem.lower - q, q - problem.upper), 0.0)


def _find_carried(problem: Problem, targets: Targets) -> Floats:
    """T_carrier_tool [T, 4, 4] of targets, the carrier being where the frozen joints put it."""
    T_world_tool = np.broadcast_to(np.eye(4), (len(targets), 4, 4)).copy()
    T_world_tool[:, :3] = targets.T_world_tool
    return _place_carrier(problem) @ T_world_tool


@lru_cache(maxsize=64)
def _place_carrier(problem: Problem) -> Floats:
    """T_carrier_world [4, 4]."""
    arm = find_still_arm(problem.robot, problem.lower, problem.upper)
    assert arm is not None
    T_world_carrier = compute_frames(problem.robot, problem.lower)[problem.robot.tool]
    T_world_carrier = T_world_carrier @ np.linalg.inv(arm.tool_pose(arm.angles(problem.lower)))
    return np.asarray(np.linalg.inv(T_world_carrier), dtype=float)


class Motions:
    """How far two components can move against each other while the arm's joints move within their slack."""

    def __init__(self, collision: CollisionModel, arm: URArm) -> None:
        robot, pairs = collision.robot, collision.pairs
        names = [robot.joint_names[k] for k in arm.coordinates]
        axes = [next(frame.name for frame in robot.frames if frame.joint == name) for name in names]
        ways = {name: _list_ways_up(robot, name) for name in (WORLD, *(frame.name for frame in robot.frames))}
        parts = {name: ([False] * 6, np.zeros(6), 0.0) for pair in pairs for name in pair}
        for row in collision.rows:
            beyond = _reach_beyond(row)
            for point in (row.start, row.end):
                levers = np.array([_join(ways[axis], ways[point]) for axis in axes])
                _, old, old_tool = parts.get(row.component, (None, 0.0, 0.0))
                tool = max(old_tool, _join(ways[robot.tool], ways[point]) + beyond)
                moved = [axis in ways[point] for axis in axes]
                parts[row.component] = moved, np.maximum(old, levers + beyond), tool
        self._parts = parts
        self._moved, self._levers, self._tool = (
            [np.array([parts[pair[side]][k] for pair in pairs]) for side in (0, 1)] for k in range(3)
        )

    def bound_in_world_m(
        self, slack: Floats, position_m: float, orientation_rad: float, collision: CollisionModel
    ) -> Floats:
        """By how much each component can move in the world, at most, [K, C O] in m for slacks [K, 6]."""
        parts = [self._parts.get(name, ([False] * 6, np.zeros(6), np.inf)) for name in collision.components]
        moved, levers, tool = (np.array(column) for column in zip(*parts, strict=True))
        by_tool = slack @ (~moved * levers).T + position_m + orientation_rad * tool
        return np.repeat(np.minimum(slack @ (moved * levers).T, by_tool), len(collision.obstacles), axis=-1)

    def bound_m(self, slack: Floats, position_m: float, orientation_rad: float) -> Floats:
        """By how much, at most, [K, P] in m for slacks [K, 6]: seen from either component, and from base and tool."""
        apart = (self._moved[0] != self._moved[1]) * np.maximum(*self._levers)  # what moves both moves neither
        own = [
            np.minimum(slack @ (moved * levers).T, slack @ (~moved * levers).T + position_m + orientation_rad * tool)
            for moved, levers, tool in zip(self._moved, self._levers, self._tool, strict=True)
        ]
        return np.minimum(slack @ apart.T, own[0] + own[1])


@lru_cache(maxsize=64)
def find_motions(collision: CollisionModel) -> Motions:
    """Those of a robot's UR-type arm."""
    arm = find_ur_arm(collision.robot)
    assert arm is not None
    return Motions(collision, arm)


def _list_ways_up(robot: Robot, frame: str) -> dict[str, float]:
    """Frames from one up to the world, and how far their origins can be from its own, m."""
    frames, length, ways = {frame.name: frame for frame in robot.frames}, 0.0, {}
    while frame in frames:
        ways[frame] = length
        length += float(np.linalg.norm(frames[frame].p_parent_frame))
        joint = frames[frame].joint
        index = None if joint is None else robot.joint_names.index(joint)
        if index is not None and robot.is_prismatic[index]:
            length += max(abs(robot.lower[index]), abs(robot.upper[index]))
        frame = frames[frame].parent
    return {**ways, frame: length}


def _join(one: dict[str, float], other: dict[str, float]) -> float:
    """How far two frames can be apart, m: along the tree, over the first one that is above both."""
    return min((one[name] + other[name] for name in one if name in other), default=0.0)


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
    q = judge_branches(problem, Targets.of([target])).q[0]
    q = q[np.isfinite(q).all(axis=-1)]
    free = q[(compute_gaps(problem.collision, q) > problem.collision.limit_m).all(axis=-1)]
    if not len(free):
        return None
    return free[_measure_excess(problem, free).sum(axis=-1).argmin()]


def _reach_beyond(row: Spheres) -> float:
    """How far a row's centres may be beyond its key points, m."""
    if isinstance(row, FreeSpheres):
        return float(np.linalg.norm(np.array(row.spheres)[:, :3], axis=1).max())
    return 2.0 * row.radius_m * row.count if row.spacing == "touching" else 0.0

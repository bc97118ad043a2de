"""A no that is proved for a UR-type arm on one further joint: a rail, a lift, a base that turns.

The range of that joint is cut into pieces. In the middle of a piece the arm has its eight branches. Elsewhere in it
they are those of a pose that has moved the other way, so that their slack bounds them (`model/branches.py`). A piece in
which no branch is left is ruled out, any other is halved: until none is left, which proves the no, a free branch turns
up, or there are too many pieces. Plain numpy throughout, and no kernel.
"""

from collections import Counter
from typing import NamedTuple

import numpy as np

from ikde.kernels.arrays import Floats
from ikde.model.chain import path_to_tool
from ikde.model.closed_form import find_ur_arm
from ikde.model.robot import Robot
from ikde.model.target import Target
from ikde.solver.branches import ROUNDING, Asked, Judged, judge
from ikde.solver.plain import compute_frames, compute_gaps
from ikde.solver.problem import Problem
from ikde.solver.result import NO_SOLUTION, STOP_REASONS, StopReason, count_blocking_pairs
from ikde.solver.verify import Bools

FIRST_PIECES = 32
MAX_PIECES = 1500  # judged in all
TURN = 2.0 * np.pi
NAMED = 3  # in a message about many

_WORST_FIRST = [STOP_REASONS.index(stop) for stop in (StopReason.WORLD, StopReason.COLLISION, StopReason.LIMITS)]


class Swept(NamedTuple):
    """A range of the joint that carries the arm, no place of which lets the arm reach the pose."""

    joint: int
    lower: float
    upper: float
    stop_reason: StopReason
    blocking: dict[tuple[str, str], int]
    """In how many pieces of the range each pair, or the robot and each obstacle, rules a configuration out."""
    pieces: int


class Carrier(NamedTuple):
    """The joint that carries the arm, and where it is."""

    joint: int
    lower: float
    upper: float
    lever_m: float
    """How far the target moves by a radian of it, as it sees it; 1 of a prismatic joint."""
    turns: float
    """1, or 0 of a prismatic joint."""


def rule_out_by_sweep(problem: Problem, target: Target) -> Swept | None:
    """The proof that a pose has no solution, wherever the one joint that carries a UR-type arm is; None without one."""
    carrier = find_carrier(problem, target)
    if carrier is None:
        return None
    half = 0.5 * (carrier.upper - carrier.lower) / FIRST_PIECES
    middles = np.asarray(carrier.lower + half * (2.0 * np.arange(FIRST_PIECES) + 1.0), dtype=float)
    why, blocking, pieces = Counter[int](), Counter[int](), 0
    while len(middles):
        pieces += len(middles)
        if pieces > MAX_PIECES:
            return None
        judged = judge(problem, ask_pieces(problem, target, carrier, middles, half))
        is_open = judged.ruled_out < 0
        if _has_free(problem, judged, is_open):
            return None
        why.update(judged.ruled_out[~is_open].tolist())
        blocking.update(_list_blockers(problem, judged)[~is_open].nonzero()[1].tolist())
        half *= 0.5
        middles = np.concatenate([middles[is_open] - half, middles[is_open] + half])
    stop = next((code for code in _WORST_FIRST if why[code]), next(iter(why)))
    counts = np.array([blocking[place] for place in range(len(problem.collision.counted))])
    named = count_blocking_pairs(problem.collision.counted, counts)
    return Swept(carrier.joint, carrier.lower, carrier.upper, STOP_REASONS[stop], named, pieces)


def tell_sweep(robot: Robot, swept: Swept) -> str:
    """One line for the proof."""
    joint = robot.joints[swept.joint]
    unit = "m" if joint.kind == "prismatic" else "rad"
    where = f"wherever {joint.name} is"
    where += "" if joint.kind == "continuous" else f" from {swept.lower:.6g} to {swept.upper:.6g} {unit}"
    names = [b if a == robot.name else f"{a}-{b}" for a, b in swept.blocking]
    more = f" and {len(names) - NAMED} more" if len(names) > NAMED else ""
    touching = f" without touching: {', '.join(names[:NAMED])}{more}" if names else ""
    return f"{NO_SOLUTION}: {where}, the arm does not reach this pose inside its limits{touching}"


def find_carrier(problem: Problem, target: Target) -> Carrier | None:
    """The one joint that may move beside those of the arm, if it carries it."""
    robot, arm = problem.robot, find_ur_arm(problem.robot)
    if arm is None or target.kind != "pose":
        return None
    free = [k for k in np.flatnonzero(problem.lower < problem.upper).tolist() if k not in arm.coordinates]
    on_the_way = [body.joint for body in path_to_tool(robot)[0]]  # the arm's are the last six
    if len(free) != 1 or free[0] not in on_the_way:
        return None
    (joint,) = free
    lower, upper = float(problem.lower[joint]), float(problem.upper[joint])
    if robot.is_prismatic[joint]:
        return Carrier(joint, lower, upper, 1.0, 0.0)
    frame = next(frame for frame in robot.frames if frame.joint == robot.joint_names[joint])
    assert frame.axis is not None
    T_world_frame = compute_frames(robot, problem.lower)[frame.name]
    axis, away = T_world_frame[:3, :3] @ frame.axis, target.p_world_tool - T_world_frame[:3, 3]
    lever = float(np.linalg.norm(np.cross(axis, away))) + problem.settings.position_tolerance_m + ROUNDING
    return Carrier(joint, lower, min(upper, lower + TURN), lever, 1.0)


def ask_pieces(problem: Problem, target: Target, carrier: Carrier, middles: Floats, half: float) -> Asked:
    """The pose as what carries the arm sees it in the middle of each piece, and by how much it differs elsewhere."""
    robot, arm = problem.robot, find_ur_arm(problem.robot)
    assert arm is not None
    q = np.repeat(problem.lower[None], len(middles), axis=0)
    q[:, carrier.joint] = middles
    T_world_carrier = compute_frames(robot, q)[robot.tool] @ np.linalg.inv(arm.tool_pose(arm.angles(q)))
    T_world_tool = np.vstack([target.T_world_tool, [0.0, 0.0, 0.0, 1.0]])
    return Asked(
        q=q,
        T_carrier_tool=np.asarray(np.linalg.inv(T_world_carrier) @ T_world_tool, dtype=float),
        carrier=carrier.joint,
        carrier_slack=half,
        moves_m=half * carrier.lever_m,
        rotates_rad=half * carrier.turns,
    )


def _has_free(problem: Problem, judged: Judged, is_open: Bools) -> bool:
    """Whether a piece that is left has a solution in its middle: then there is nothing to prove."""
    own = judged.is_own & is_open[:, None] & ~judged.outside & ~judged.colliding.any(axis=-1)
    q = judged.q[own]
    inside = ((q >= problem.lower) & (q <= problem.upper)).all(axis=-1)
    return bool((compute_gaps(problem.collision, q[inside]) > problem.collision.limit_m).all(axis=-1).any())


def _list_blockers(problem: Problem, judged: Judged) -> Bools:
    """Which of all that may be to blame collides in some branch [K, P + O]."""
    return np.asarray(problem.collision.fold(judged.colliding & ~judged.outside[..., None]).any(axis=1))

"""Where a motion may start: configurations that meet the first pose, free of collision and inside all limits."""

from collections.abc import Mapping

import numpy as np

from ikde.errors import InputError
from ikde.kernels.arrays import Floats
from ikde.model.robot import Robot
from ikde.solver.joints import JointValues, joints_outside, read_configuration
from ikde.solver.plain import compute_frames
from ikde.solver.result import SolveResult
from ikde.solver.settings import SolveSettings
from ikde.solver.solve import solve, solve_many
from ikde.solver.verify import Bools, verify
from ikde.track.follower import Follower

EXACT = SolveSettings(position_tolerance_m=1e-9, orientation_tolerance_rad=1e-9)
DRAWS, MORE_DRAWS = 16, 64  # starts that the solver finds by itself, and as many near random configurations
NEAR_RESTARTS = 8
ROUNDING = 1e-12  # m or rad
LARGEST_SHIFT = 0.05  # m or rad: how far a given start may stand from what meets the first pose

Frozen = Mapping[str, float]


def draw_starts(follower: Follower, frozen: Frozen, seed: int, draws: int = DRAWS) -> tuple[Floats, SolveResult]:
    """Starts [S, N], all different and within (18), and what the solver says about the first pose."""
    robot, target = follower.robot, follower.path.targets()[0]
    told = {"collision": follower.collision, "freeze": frozen}
    first = solve(robot, target, EXACT, seed=seed, **told)
    if not first.reached:
        return np.empty((0, len(robot.joints))), first
    told |= {"threads": 1, "explain_failures": False}
    rows = solve_many(robot, [target] * draws, EXACT, seed=seed, **told)
    found = [rows.q[rows.reached]]
    rng = np.random.default_rng(seed)
    quick = EXACT.with_changes(restarts=NEAR_RESTARTS, method="lm")
    for stream in range(draws):
        near = np.where(robot.slides, robot.home, rng.uniform(robot.lower, robot.upper))
        row = solve_many(robot, [target], quick, seed=stream, near=near, **told)
        found.append(row.q[row.reached])
    q = np.concatenate(found)
    _, unlike = np.unique(q.round(3), axis=0, return_index=True)
    q = q[np.sort(unlike)]
    return q[keeps_distance(follower, q)], first


def keeps_distance(follower: Follower, q: Floats) -> Bools:
    """Whether the tool is near enough to the platform's centre (18) in each of `q` [S, N]."""
    limits = follower.limits
    if limits.farthest_m is None or limits.center is None:
        return np.ones(len(q), dtype=bool)
    frames = compute_frames(follower.robot, q)
    apart = frames[follower.robot.tool][:, :3, 3] - frames[limits.center][:, :3, 3]
    return np.linalg.norm(apart, axis=1) <= limits.farthest_m


def read_start(robot: Robot, start: JointValues) -> Floats:
    """A given start as an array [N]; raises `InputError` at `start` for what is none."""
    try:
        return read_configuration(robot, start)
    except InputError as error:
        raise InputError(error.message, ("start", *error.where[1:])) from None


def settle_start(follower: Follower, q: Floats, frozen: Frozen) -> Floats:
    """A given start [N], moved onto the first pose if it is near it.

    Raises `InputError` if it is not, or is outside its limits, or collides.
    """
    robot, limits, target = follower.robot, follower.limits, follower.path.targets()[0]
    outside = joints_outside(robot, q)
    if limits.ranges and outside:
        raise InputError(f"{', '.join(outside)} outside the limits", ("start",))
    moved = [name for name, value in frozen.items() if abs(q[robot.joint_names.index(name)] - value) > ROUNDING]
    if moved:
        raise InputError(f"{', '.join(moved)} is not where it is frozen", ("start",))
    collision = follower.collision
    grade = verify(robot, target, q, settings=limits.tolerances, collision=collision)
    if grade.self_collision:
        a, b = grade.colliding_pairs[0]
        raise InputError(f"{a} and {b} collide", ("start",))
    if not keeps_distance(follower, q[None])[0]:
        raise InputError(f"the tool is farther than {limits.farthest_m:g} m from {limits.center}", ("start",))
    if grade.within_tolerance:
        return q
    settled = solve(robot, target, EXACT, method="lm", near=q, collision=collision, freeze=frozen)
    if not settled.reached or np.abs(settled.q - q).max() > LARGEST_SHIFT:
        far = f"{1e3 * grade.position_error_m:.3g} mm and {grade.orientation_error_rad:.3g} rad"
        raise InputError(f"expected a configuration at the path's first pose, got one {far} away", ("start",))
    return settled.q

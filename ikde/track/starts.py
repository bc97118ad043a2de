"""Where a motion may start: configurations that meet the first pose, free of collision and inside all limits."""

from dataclasses import replace

import numpy as np

from ikde.errors import InputError
from ikde.kernels.arrays import Floats
from ikde.solver.joints import joints_outside
from ikde.solver.plain import compute_frames
from ikde.solver.problem import make_problem
from ikde.solver.result import SolveResult, StopReason
from ikde.solver.results import solve_rows
from ikde.solver.settings import BulkOptions, SolveSettings
from ikde.solver.solve import solve, solve_many
from ikde.solver.verify import Bools, verify
from ikde.track.plan import TrackPlan

EXACT = SolveSettings(position_tolerance_m=1e-9, orientation_tolerance_rad=1e-9)
DRAWS, MORE_DRAWS = 16, 64  # starts that the solver finds by itself, and as many near random configurations
NEAR_RESTARTS = 8
TRIED = (StopReason.BUDGET, StopReason.COLLISION, StopReason.WORLD)  # what further attempts may refute
ROUNDING = 1e-12  # m or rad
MAX_SHIFT = 0.05  # m or rad: how far a given start may stand from what meets the first pose


def draw_starts(plan: TrackPlan, draws: int = DRAWS) -> tuple[Floats, SolveResult]:
    """Starts [S, N], all different and within (18), and what the solver says about the first pose."""
    robot, target, seed = plan.robot, plan.path.targets()[0], plan.seed
    question = {"collision": plan.collision, "freeze": plan.frozen}
    first, nothing = solve(robot, target, EXACT, seed=seed, **question), np.empty((0, len(robot.joints)))
    if not first.reached and first.stop_reason not in TRIED:
        return nothing, first
    bulk = BulkOptions(threads=1, explain=False)
    rows = solve_many(robot, [target] * draws, EXACT, seed=seed, bulk=bulk, **question)
    if not (first.reached or rows.reached.any()):  # other random numbers may find what the first did not
        return nothing, first
    found = [rows.q[rows.reached]]
    rng = np.random.default_rng(seed)
    quick = EXACT.with_changes(restarts=NEAR_RESTARTS, method="lm")
    for stream in range(draws):
        near = np.where(robot.is_prismatic, robot.home, rng.uniform(*robot.drawn))
        # Not moved to the least motion: that may end at a limit or a contact, where no motion should start.
        problem = replace(make_problem(robot, quick, near=near, **question), descends=False)
        row = solve_rows(problem, [target], bulk, seed=stream)
        found.append(row.q[row.reached])
    q = np.concatenate(found)
    _, unlike = np.unique(q.round(3), axis=0, return_index=True)
    q = q[np.sort(unlike)]
    return q[keeps_distance(plan, q)], first


def keeps_distance(plan: TrackPlan, q: Floats) -> Bools:
    """Whether the tool is near enough to the platform's centre (18) in each of `q` [S, N]."""
    robot, limits = plan.robot, plan.limits
    if limits.max_distance_m is None or limits.center is None:
        return np.ones(len(q), dtype=bool)
    frames = compute_frames(robot, q)
    apart = frames[robot.tool][:, :3, 3] - frames[limits.center][:, :3, 3]
    return np.linalg.norm(apart, axis=1) <= limits.max_distance_m


def settle_start(plan: TrackPlan, q: Floats) -> Floats:
    """A given start [N], moved onto the first pose if it is near it.

    Raises `InputError` if it is not, or is outside its limits, or collides.
    """
    robot, limits, target = plan.robot, plan.limits, plan.path.targets()[0]
    outside = joints_outside(robot, q)
    if limits.ranges and outside:
        raise InputError(f"{', '.join(outside)} outside the limits", ("start",))
    moved = [name for name, value in plan.frozen.items() if abs(q[robot.joint_names.index(name)] - value) > ROUNDING]
    if moved:
        raise InputError(f"{', '.join(moved)} is not where it is frozen", ("start",))
    grade = verify(robot, target, q, settings=limits.tolerances, collision=plan.collision)
    if grade.collision:
        a, b = grade.colliding_pairs[0]
        raise InputError(f"{a} and {b} collide", ("start",))
    if not keeps_distance(plan, q[None])[0]:
        raise InputError(f"the tool is farther than {limits.max_distance_m:g} m from {limits.center}", ("start",))
    if grade.within_tolerance:
        return q
    settled = solve(robot, target, EXACT, method="lm", near=q, collision=plan.collision, freeze=plan.frozen)
    if not settled.reached or np.abs(settled.q - q).max() > MAX_SHIFT:
        far = f"{1e3 * grade.position_error_m:.3g} mm and {grade.orientation_error_rad:.3g} rad"
        raise InputError(f"expected a configuration at the path's first pose, got one {far} away", ("start",))
    return settled.q

"""An independent search for a step that a servo might take: a quadratic program by scipy, in numbers of plain numpy."""

import numpy as np
from scipy.optimize import minimize

import ikde
from ikde.solver.plain import compute_gaps
from tests.track.servo_walks import tool_error

H = 1e-6  # of differences
MARGIN_M = 2e-4  # above what is asked for: an allowed step keeps more than the servo must
NEAR_M = 0.3  # what is farther away can't be met within a step and its stop
PARTS = 8


def find_better_step(servo, target, dt_s, length_m):
    """By how much an allowed step lowers the tool's error, m; 0 if none was found. Not for a base on arcs."""
    robot, limits, model = servo.robot, servo.limits, servo.collision
    q, speeds = servo.q, np.array(servo.state["speeds"])
    low, high = -limits.speed * dt_s, limits.speed * dt_s
    if limits.acceleration is not None:
        low = np.maximum(low, (speeds - limits.acceleration * dt_s) * dt_s)
        high = np.minimum(high, (speeds + limits.acceleration * dt_s) * dt_s)
    here, error = tool_error(robot, q, target, length_m), _error(robot, q, target, length_m)
    J = np.column_stack([(error - _error(robot, q + H * row, target, length_m)) / H for row in np.eye(len(q))])
    gaps = compute_gaps(model, q) - model.limit_m - MARGIN_M
    near = np.flatnonzero(gaps < NEAR_M)
    slopes = [
        (compute_gaps(model, q + H * row)[near] - model.limit_m - MARGIN_M - gaps[near]) / H for row in np.eye(len(q))
    ]
    A, far = np.array(slopes).T, _far(limits, np.maximum(np.abs(low), np.abs(high)), dt_s)
    done = minimize(
        lambda u: 0.5 * np.sum((error - J @ u) ** 2) + 1e-9 * u @ u,
        np.clip(np.zeros(len(q)), low, high),
        jac=lambda u: -J.T @ (error - J @ u) + 2e-9 * u,
        bounds=list(zip(low, high, strict=True)),
        constraints={"type": "ineq", "fun": lambda u: gaps[near] + far * A @ u, "jac": lambda _: far * A},
        method="SLSQP",
    )
    for share in (1.0, 0.5, 0.25):
        step = np.clip(share * done.x, low, high)
        if _is_allowed(servo, q, step, dt_s):
            better = here - tool_error(robot, q + step, target, length_m)
            if better > 0.0:
                return better
    return 0.0


def _far(limits, step, dt_s):
    """How many times as long as a step the way to its stop is."""
    if limits.acceleration is None:
        return 1.0
    return 1.0 + 0.5 * float((np.abs(step) / (limits.acceleration * dt_s**2)).max())


def _is_allowed(servo, q, step, dt_s):
    """Whether it stops inside the ranges, and nothing is too near at some places on the way."""
    way = _far(servo.limits, step, dt_s) * step
    end, model = q + way, servo.collision
    if (end < servo.robot.lower).any() or (end > servo.robot.upper).any():
        return False
    rows = q + np.linspace(0.0, 1.0, PARTS + 1)[1:, None] * way
    return bool((compute_gaps(model, rows) - model.limit_m > MARGIN_M).all())


def _error(robot, q, target, length_m):
    """From tool to target [6], m: the rotation as a vector times a length."""
    T = ikde.forward(robot, q)[robot.tool]
    R, turn = T[:3, :3], np.zeros(3)
    if target.kind == "axis":
        turn = np.cross(R[:, 2], target.axis_world_tool)
    elif target.kind == "pose":
        W = target.R_world_tool @ R.T
        axis = 0.5 * np.array([W[2, 1] - W[1, 2], W[0, 2] - W[2, 0], W[1, 0] - W[0, 1]])
        size = np.linalg.norm(axis)
        turn = axis * (np.arctan2(size, 0.5 * (np.trace(W) - 1.0)) / size if size > 1e-12 else 1.0)
    return np.concatenate([target.p_world_tool - T[:3, 3], length_m * turn])

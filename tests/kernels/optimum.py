"""A local minimum of motion, asked of scipy, and how far a configuration is from the conditions of one."""

import numpy as np
from scipy.optimize import minimize, nnls

from ikde.model.collision_model import CollisionModel
from ikde.solver.plain import compute_gaps
from tests import reference

STEP = 1e-6  # m or rad, of differences
TOUCHING = 2e-6  # m or rad: constraints this near are active


def miss(robot, target, q):
    """What the tool misses of a target, in m and about rad: 3, 5 or 6 numbers, smooth where they are 0."""
    T, G = reference.compute_frames(robot, q)[robot.tool], target.T_world_tool
    missed, R, S = T[:3, 3] - G[:3, 3], G[:3, :3], T[:3, :3]
    if target.kind == "position":
        return missed
    if target.kind == "axis":
        return np.concatenate([missed, (R.T @ S[:, 2])[:2]])
    D = S @ R.T
    return np.concatenate([missed, 0.5 * np.array([D[2, 1] - D[1, 2], D[0, 2] - D[2, 0], D[1, 0] - D[0, 1]])])


def room(collision, q):
    """How far every pair is from colliding, m."""
    return compute_gaps(collision, q[None])[0] - collision.limit_m


def slope(function, q):
    """Derivative [K, N] of a function of joint values, by central differences."""
    rows = [(function(q + STEP * e) - function(q - STEP * e)) / (2.0 * STEP) for e in np.eye(len(q))]
    return np.array(rows).T


def motion(weights, near, q):
    """sqrt(sum (w_j dq_j)^2)."""
    return np.sqrt(np.sum((weights * (q - near)) ** 2))


def find_optimum(problem, target, q):
    """The motion of a local minimum near `q` that meets the target exactly, by SLSQP without collisions; or inf."""
    w, near = problem.weights, problem.near
    answer = minimize(
        lambda x: 0.5 * np.sum((w * (x - near)) ** 2),
        q,
        jac=lambda x: w * w * (x - near),
        bounds=list(zip(problem.lower, problem.upper, strict=True)),
        constraints=[{"type": "eq", "fun": lambda x: miss(problem.robot, target, x)}],
        method="SLSQP",
        options={"ftol": 1e-13, "maxiter": 200},
    )
    met = answer.success and np.abs(miss(problem.robot, target, answer.x)).max() < 1e-7
    return np.sqrt(2.0 * answer.fun) if met else np.inf


def residual(problem, target, q, collision=None):
    """What no multipliers explain of the gradient of half the motion's square, as a share of it: 0 at a minimum."""
    w = problem.weights
    y = w * (q - problem.near)
    rows = slope(lambda x: miss(problem.robot, target, x), q) / w
    normals = [*rows, *-rows]
    normals += [e for e, at, end in zip(np.eye(len(q)), q, problem.lower, strict=True) if at < end + TOUCHING]
    normals += [-e for e, at, end in zip(np.eye(len(q)), q, problem.upper, strict=True) if at > end - TOUCHING]
    if isinstance(collision, CollisionModel):
        active = room(collision, q) < TOUCHING
        normals += [*(slope(lambda x: room(collision, x)[active], q) / w)]
    return nnls(np.array(normals).T, y)[1] / np.linalg.norm(y)

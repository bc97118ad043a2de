"""Bodies, and the components and spheres that they carry: each placed when it is asked for, none twice.

What is asked for is placed by the same sums whoever asks, so that a verdict does not hang on what was asked before.
"""

import numpy as np

from ikde.kernels.arrays import BODY, COORDINATE, FIRST, LAST, PARENT, PRISMATIC
from ikde.kernels.jit import inline_kernel
from ikde.kernels.trig import sin_cos

PLACED = 3  # column of the bounds [C, 4]: 1 once the spheres of a component are placed


@inline_kernel
def place_bodies(robot, q, out_T):
    """Pose of every body in the world: T_world_parent @ T_parent_body @ (Rz(q) or Tz(q)). `out_T` [B, 3, 4]."""
    for i in range(3):
        for j in range(4):
            out_T[0, i, j] = 1.0 if i == j else 0.0
    for body in range(1, robot.bodies.shape[0]):
        T, parent = robot.T_parent_body[body], out_T[np.uint64(robot.bodies[body, PARENT])]
        value = q[robot.bodies[body, COORDINATE]]
        s, c = sin_cos(value)
        along = 0.0
        if robot.bodies[body, PRISMATIC] == 1:
            s, c, along = 0.0, 1.0, value
        for i in range(3):
            x, y = turn(parent, i, T[0, 0], T[1, 0], T[2, 0]), turn(parent, i, T[0, 1], T[1, 1], T[2, 1])
            z, p = turn(parent, i, T[0, 2], T[1, 2], T[2, 2]), turn(parent, i, T[0, 3], T[1, 3], T[2, 3])
            out_T[body, i, 0], out_T[body, i, 1] = x * c + y * s, y * c - x * s
            out_T[body, i, 2], out_T[body, i, 3] = z, parent[i, 3] + p + z * along


@inline_kernel
def turn(T, i, x, y, z):
    """Entry `i` of the rotation of `T` [3, 4] times (x, y, z)."""
    return T[i, 0] * x + T[i, 1] * y + T[i, 2] * z


@inline_kernel
def apply(T, i, x, y, z):
    """Entry `i` of a pose [3, 4] applied to the point (x, y, z)."""
    return T[i, 0] * x + T[i, 1] * y + T[i, 2] * z + T[i, 3]


@inline_kernel
def place_bounds(collision, T_world_body, out_bounds):
    """Middles of all components into the first columns of [C, 4], m; their spheres are still to be placed."""
    for component in range(collision.components.shape[0]):
        T = T_world_body[collision.components[component, BODY]]
        x, y, z = collision.bounds[component, 0], collision.bounds[component, 1], collision.bounds[component, 2]
        u, v, w = apply(T, 0, x, y, z), apply(T, 1, x, y, z), apply(T, 2, x, y, z)
        out_bounds[component, 0], out_bounds[component, 1], out_bounds[component, 2] = u, v, w
        out_bounds[component, PLACED] = 0.0


@inline_kernel
def place_component(collision, T_world_body, component, bounds, out_centres):
    """The spheres of a component into [3, S], m, unless they are there already."""
    if bounds[component, PLACED] == 1.0:
        return
    bounds[component, PLACED] = 1.0
    T, p = T_world_body[collision.components[component, BODY]], collision.p_body_sphere
    a, b, c, d = T[0, 0], T[0, 1], T[0, 2], T[0, 3]
    e, f, g, h = T[1, 0], T[1, 1], T[1, 2], T[1, 3]
    i, j, k, m = T[2, 0], T[2, 1], T[2, 2], T[2, 3]
    for sphere in range(collision.components[component, FIRST], collision.components[component, LAST]):
        x, y, z = p[0, sphere], p[1, sphere], p[2, sphere]
        out_centres[0, sphere] = a * x + b * y + c * z + d
        out_centres[1, sphere] = e * x + f * y + g * z + h
        out_centres[2, sphere] = i * x + j * y + k * z + m

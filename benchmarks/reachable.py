"""Targets that can be reached: where the tool is at free configurations drawn within the joint limits."""

import numpy as np

import ikde


def draw_configurations(robot: ikde.Robot, count: int, seed: int = 5) -> list[np.ndarray]:
    """Configurations [N] that are free of collision."""
    rng, drawn = np.random.default_rng(seed), []
    while len(drawn) < count:
        q = rng.uniform(robot.lower, robot.upper)
        if not ikde.check(robot, q).collision:
            drawn.append(q)
    return drawn


def make_target(robot: ikde.Robot, q: np.ndarray, kind: str) -> ikde.Target:
    """What the tool does at `q` [N], as a target: `position`, `axis` or `pose`."""
    T = ikde.forward(robot, q)["tool"]
    if kind == "position":
        return ikde.Target(T[:3, 3])
    return ikde.Target(T[:3, 3], axis_world_tool=T[:3, 2]) if kind == "axis" else ikde.Target(T[:3, 3], T[:3, :3])

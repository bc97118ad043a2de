"""Clearances of many configurations at once, from the robot's own rows and frames."""

import numpy as np

from ikde.kernels.arrays import Floats
from ikde.model.robot import Pairs, Robot, SphereRow
from ikde.solver.plain import compute_frames

Balls = tuple[Floats, Floats]
"""Centres [K, n, 3] in the world and radii [n], m."""


def compute_centres(row: SphereRow, start: Floats, end: Floats) -> Floats:
    """Centres [K, count, 3] of a row between key points [K, 3] [Qiao2021, eq. 12, 13, 16]."""
    middle, line = 0.5 * (start + end), end - start
    if row.count == 1:
        return middle[:, None]
    steps = np.arange(row.count)[:, None] - 0.5 * (row.count - 1)
    if row.spacing == "even":
        return middle[:, None] + steps * line[:, None] / (row.count - 1)
    diameter = 2.0 * row.radius_m * line / np.linalg.norm(line, axis=1, keepdims=True)
    return middle[:, None] + steps * diameter[:, None]


def compute_balls(robot: Robot, approximation: str, Q: Floats) -> dict[str, Balls]:
    """Every component's spheres, for `Q` [K, N] in the robot's own convention."""
    Ts_world = compute_frames(robot, Q)
    found: dict[str, list[Balls]] = {}
    for row in robot.approximations[approximation]:
        centres = compute_centres(row, Ts_world[row.start][:, :3, 3], Ts_world[row.end][:, :3, 3])
        found.setdefault(row.component, []).append((centres, np.full(row.count, row.radius_m)))
    return {
        name: (np.concatenate([c for c, _ in parts], axis=1), np.concatenate([r for _, r in parts]))
        for name, parts in found.items()
    }


def compute_gaps(robot: Robot, approximation: str, pairs: Pairs, Q: Floats) -> Floats:
    """Smallest distance - R_i - R_j [K, P] in m of every pair of components, for `Q` [K, N]."""
    balls = compute_balls(robot, approximation, Q)
    gaps = np.empty((len(Q), len(pairs)))
    for column, (a, b) in enumerate(pairs):
        (p, r), (s, t) = balls[a], balls[b]
        reach = np.linalg.norm(p[:, :, None] - s[:, None], axis=3) - r[:, None] - t
        gaps[:, column] = reach.min(axis=(1, 2))
    return gaps

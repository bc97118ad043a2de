"""Self-collision judged by surface points, as the paper did it before it compared centres: slow, for comparison.

The paper prints the ranges of the grid's angles, m in [0, 2 pi] and n in [0, pi], but no steps. Ours are calibrated:
36 x 18, ten degrees each way, with which one verdict costs tenths of a second, the order of the paper's Tables 3 and 4.
"""

from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from ikde.errors import InputError
from ikde.kernels.arrays import Floats
from ikde.kernels.frames import compute_bodies
from ikde.kernels.paper import compute_surface_from_centres, compute_surface_gap, judge_surfaces
from ikde.kernels.spheres import compute_centres
from ikde.model.arguments import RobotLike, read_robot
from ikde.model.collision_model import CollisionChoice, CollisionModel
from ikde.model.pack import pack_robot
from ikde.model.robot import Robot
from ikde.solver.joints import JointValues, read_configuration

Rule = Literal["eq. 18", "eq. 20"]
Grid = tuple[int, int]
GRID: Grid = (36, 18)
M_STEPS, N_STEPS = GRID


def surface_directions(m_steps: int = M_STEPS, n_steps: int = N_STEPS) -> Floats:
    """Unit vectors (cos m, sin m cos n, sin m sin n) of the grid [m_steps * n_steps, 3], each end once.

    [Qiao2021, eq. 11, 14, 17]
    """
    m = np.repeat(np.arange(m_steps) * 2.0 * np.pi / m_steps, n_steps)
    n = np.tile(np.arange(n_steps) * np.pi / n_steps, m_steps)
    return np.column_stack([np.cos(m), np.sin(m) * np.cos(n), np.sin(m) * np.sin(n)])


def covering_angle_rad(m_steps: int = M_STEPS, n_steps: int = N_STEPS) -> float:
    """No point of a sphere is farther than R times this from a grid point: half the diagonal of a grid cell.

    It is d_i / R_i of eq. 20. A cell is at most as wide as its angles, so two spheres whose surfaces share a point
    have grid points within d_i + d_j of each other: no contact of surfaces is missed.
    """
    return float(np.hypot(np.pi / m_steps, 0.5 * np.pi / n_steps))


@dataclass(frozen=True, slots=True, kw_only=True)
class SurfaceCheck:
    """A verdict by surface points."""

    collision: bool
    gap_m: float  # smallest distance between surface points of a pair, less d_i + d_j under eq. 20
    pair: tuple[str, str]


def check_surface(
    robot: RobotLike,
    q: JointValues,
    collision: CollisionChoice = None,
    *,
    rule: Rule = "eq. 20",
    m_steps: int = M_STEPS,
    n_steps: int = N_STEPS,
) -> SurfaceCheck:
    """Judge one configuration by the points on its spheres [Qiao2021, eq. 18, 20].

    `eq. 18` calls it a collision if two points coincide, so it misses contacts; `eq. 20` if two points are within
    d_i + d_j + safe distance, with d_i computed from the grid. A sphere deep inside another touches no surface and is
    seen by neither: centres ([Qiao2021, eq. 21], `check`) do not have that flaw.

    Args:
        robot: the robot, its name or the path of its file.
        q: joint values [N] or a mapping by joint name; m and rad.
        collision: a detector's name, a `Detector`, a `CollisionModel`, or None for the robot's default.
        rule: `"eq. 18"` or `"eq. 20"`.
        m_steps: steps of the angle m over the full circle.
        n_steps: steps of the angle n over the half circle.

    Raises:
        InputError: without a detector, and as `check` does.
    """
    robot = read_robot(robot)
    model, directions, covering_angle, limit = _read_judgement(robot, collision, rule, m_steps, n_steps)
    arrays, packed = pack_robot(robot), model.arrays
    T_world_body = np.empty((arrays.bodies.shape[0], 3, 4))
    centres = np.empty((3, packed.radius.size))
    points = np.empty((packed.radius.size, len(directions), 3))
    compute_bodies(arrays, read_configuration(robot, q), T_world_body)
    compute_centres(packed, T_world_body, centres)
    compute_surface_from_centres(packed, centres, directions, points)
    gap, pair = compute_surface_gap(packed, points, covering_angle)
    return SurfaceCheck(collision=gap <= limit, gap_m=gap, pair=model.pairs[pair])


def check_surface_many(
    robot: Robot, Q: Floats, collision: CollisionChoice = None, *, rule: Rule = "eq. 20", grid: Grid = GRID
) -> NDArray[np.bool_]:
    """Whether each row of `Q` [K, N] collides, in the robot's own convention: `check_surface`'s verdicts [K], fast.

    Most points of the `grid`, steps of m and n, are passed over: they are farther from the other sphere's surface than
    a collision allows.
    """
    model, directions, covering_angle, limit = _read_judgement(robot, collision, rule, *grid)
    Q, collides = np.ascontiguousarray(Q, dtype=float), np.empty(len(Q), dtype=bool)
    judge_surfaces(pack_robot(robot), model.arrays, directions, covering_angle, limit, Q, collides)
    return collides


def _read_judgement(
    robot: Robot, choice: CollisionChoice, rule: Rule, m_steps: int, n_steps: int
) -> tuple[CollisionModel, Floats, float, float]:
    """What is compared, the directions to surface points [K, 3], their covering angle in rad, and the limit in m."""
    if rule not in get_args(Rule):
        raise InputError(f"expected one of {', '.join(get_args(Rule))}, got {rule!r}", ("rule",))
    if m_steps < 3 or n_steps < 2:
        raise InputError(f"expected at least 3 x 2 steps, got {m_steps} x {n_steps}", ("m_steps",))
    chosen = CollisionModel.of(robot, choice)
    if not chosen.pairs:
        raise InputError("expected a detector, got none", ("detector",))
    if chosen.obstacles:
        raise InputError("surface points are not compared with a world: leave it out", ("collision",))
    directions = surface_directions(m_steps, n_steps)
    if rule == "eq. 18":
        return chosen, directions, 0.0, 0.0
    return chosen, directions, covering_angle_rad(m_steps, n_steps), chosen.limit_m

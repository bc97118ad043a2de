"""Self-collision judged by surface points, as the paper did it before it compared centres: slow, for comparison."""

from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from ikde.errors import InputError
from ikde.kernels.arrays import Floats
from ikde.kernels.frames import compute_bodies
from ikde.kernels.spheres import compute_centres
from ikde.kernels.surface import compute_surface_from_centres, compute_surface_gap, judge_surfaces
from ikde.model.collision_model import CollisionChoice, CollisionModel
from ikde.model.pack import pack_robot
from ikde.model.robot import Robot
from ikde.model.surface import M_STEPS, N_STEPS, covering_angle_rad, surface_directions
from ikde.solver.joints import JointValues, read_configuration

Rule = Literal["eq. 18", "eq. 20"]


@dataclass(frozen=True, slots=True, kw_only=True)
class SurfaceCheck:
    """A verdict by surface points."""

    collision: bool
    gap_m: float
    """Smallest distance between surface points of a pair, less d_i + d_j under eq. 20."""
    pair: tuple[str, str]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Question:
    """What is asked of a configuration: the detector, the points, and how near is a collision."""

    collision: CollisionModel
    directions: Floats  # [K, 3]
    covering_angle: float  # rad
    limit: float  # m


def check_surface(
    robot: Robot,
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
        robot: the robot.
        q: joint values [N] or a mapping by joint name; m and rad.
        collision: a detector's name, a `Detector`, a `CollisionModel`, or None for the robot's default.
        rule: `"eq. 18"` or `"eq. 20"`.
        m_steps: steps of the angle m over the full circle.
        n_steps: steps of the angle n over the half circle.

    Raises:
        InputError: without a detector, and as `check` does.
    """
    asked = _read_question(robot, collision, rule, m_steps, n_steps)
    arrays, packed = pack_robot(robot), asked.collision.arrays
    T_world_body = np.empty((arrays.bodies.shape[0], 3, 4))
    centres = np.empty((3, packed.radius.size))
    points = np.empty((packed.radius.size, len(asked.directions), 3))
    compute_bodies(arrays, read_configuration(robot, q), T_world_body)
    compute_centres(packed, T_world_body, centres)
    compute_surface_from_centres(packed, centres, asked.directions, points)
    gap, pair = compute_surface_gap(packed, points, asked.covering_angle)
    return SurfaceCheck(collision=gap <= asked.limit, gap_m=gap, pair=asked.collision.pairs[pair])


def check_surface_many(
    robot: Robot,
    Q: Floats,
    collision: CollisionChoice = None,
    *,
    rule: Rule = "eq. 20",
    m_steps: int = M_STEPS,
    n_steps: int = N_STEPS,
) -> NDArray[np.bool_]:
    """Whether each row of `Q` [K, N] collides, in the robot's own convention: `check_surface`'s verdicts [K], fast.

    Most points are passed over: they are farther from the other sphere's surface than a collision allows.
    """
    asked = _read_question(robot, collision, rule, m_steps, n_steps)
    collides = np.empty(len(Q), dtype=bool)
    arrays, packed = pack_robot(robot), asked.collision.arrays
    Q = np.ascontiguousarray(Q, dtype=float)
    judge_surfaces(arrays, packed, asked.directions, asked.covering_angle, asked.limit, Q, collides)
    return collides


def _read_question(robot: Robot, choice: CollisionChoice, rule: Rule, m_steps: int, n_steps: int) -> _Question:
    if rule not in get_args(Rule):
        raise InputError(f"expected one of {', '.join(get_args(Rule))}, got {rule!r}", ("rule",))
    if m_steps < 3 or n_steps < 2:
        raise InputError(f"expected at least 3 x 2 steps, got {m_steps} x {n_steps}", ("m_steps",))
    chosen = CollisionModel.of(robot, choice)
    if not chosen.pairs:
        raise InputError("expected a detector, got none", ("detector",))
    covers = rule == "eq. 20"
    return _Question(
        collision=chosen,
        directions=surface_directions(m_steps, n_steps),
        covering_angle=covering_angle_rad(m_steps, n_steps) if covers else 0.0,
        limit=chosen.limit_m if covers else 0.0,
    )

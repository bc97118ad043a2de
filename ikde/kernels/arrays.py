"""The table of every packed array: what `model.pack` gives and every kernel takes.

All arrays are C-ordered, read-only, float64 or int64; metres and radians. A *body* is what one joint moves; body 0 is
the world, body b > 0 is moved by the coordinate `q[body_coordinate[b]]` about or along the z axis of its own frame
(`pack` turns every joint axis to z, so that one formula serves all). Bodies stand in the tree's order: parents first.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


class RobotArrays(NamedTuple):
    """The kinematic tree: B bodies with the world, N joints, F named frames with the world first."""

    body_parent: Ints  # [B]
    body_coordinate: Ints  # [B] index into q; -1 for the world
    body_slides: Ints  # [B] 1 if prismatic, 0 if revolute
    body_moves_tool: Ints  # [B] 1 if the tool hangs on this body
    R_parent_body: Floats  # [B, 3, 3] at q = 0
    p_parent_body: Floats  # [B, 3] m
    frame_body: Ints  # [F] the body a frame is fixed to
    R_body_frame: Floats  # [F, 3, 3]
    p_body_frame: Floats  # [F, 3] m
    tool_frame: Ints  # [1] index of the tool among the frames
    lower: Floats  # [N] m or rad
    upper: Floats  # [N] m or rad


class DetectorArrays(NamedTuple):
    """One detector: S spheres sorted by component, C components, P component pairs, W rows of spheres."""

    safe_distance: Floats  # [1] m
    sphere_body: Ints  # [S]
    p_body_sphere: Floats  # [S, 3] m
    sphere_radius: Floats  # [S] m
    component_start: Ints  # [C + 1] spheres of component c: component_start[c] : component_start[c + 1]
    component_body: Ints  # [C]
    p_body_bound: Floats  # [C, 3] m, centre of a sphere around the whole component
    bound_radius: Floats  # [C] m
    pair_a: Ints  # [P] component
    pair_b: Ints  # [P] component
    row_start: Ints  # [W + 1] spheres of row w: row_start[w] : row_start[w + 1]
    row_from: Ints  # [W] frame of the first key point
    row_to: Ints  # [W] frame of the second key point
    sphere_offset: Floats  # [S] m along the row's line, from its middle


class TargetArrays(NamedTuple):
    """T targets in the world frame."""

    kind: Ints  # [T] 0 position, 1 position and tool axis, 2 pose
    p_world_tool: Floats  # [T, 3] m
    R_world_tool: Floats  # [T, 3, 3]; for kind 1 only its last column, the tool's z axis, is asked for


class SearchArrays(NamedTuple):
    """What a search is told: numbers from `SolveSettings`, ranges from the robot, `freeze` and `near`."""

    lower: Floats  # [N] m or rad
    upper: Floats  # [N] m or rad
    near: Floats  # [N] centre of the growing boxes
    first_box: Floats  # [1] share of each range searched by the first attempt; 1: the whole range at once
    tolerance: Floats  # [2] m, rad
    population: Ints  # [1]
    generations: Ints  # [1]
    strategy: Ints  # [1] index into `mutation.STRATEGIES`
    weight: Floats  # [1] F, the differential weight
    crossover: Floats  # [1] CR
    repair: Ints  # [1] index into `mutation.REPAIRS`
    in_place: Ints  # [1] 1: a better trial replaces its parent at once; 0: at the end of the generation
    collision_rule: Ints  # [1] 0 none, 1 reject, 2 feasibility

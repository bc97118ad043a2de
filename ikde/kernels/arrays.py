"""The table of every packed array: what `model.pack` gives and every kernel takes.

All arrays are C-ordered and read-only; metres and radians. Numbers are float64 or int64; what is only ever an index
into another array is uint64, since numba tests a signed index for being negative (0.06 us a collision check). A
transform is its upper three rows, [3, 4]: rotation and translation. Points stand as [3, S], coordinate by coordinate,
so that the compiler can vectorise.

A *body* is what one joint moves. Body 0 is the world; body b > 0 is moved by one coordinate of q about or along the z
axis of its own frame (`pack` turns every joint axis to z, so that one formula serves all). Parents come first.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Indices = NDArray[np.uint64]


class RobotArrays(NamedTuple):
    """The kinematic tree: B bodies with the world, F named frames with the world first and the tool last."""

    bodies: Ints  # [B, 4] parent body, coordinate of q, 1 if it slides, 1 if the tool hangs on it
    T_parent_body: Floats  # [B, 3, 4] at q = 0
    frame_body: Indices  # [F] the body a frame is fixed to
    T_body_frame: Floats  # [F, 3, 4]


PARENT, COORDINATE, SLIDES, MOVES_TOOL = range(4)  # columns of `RobotArrays.bodies`


class DetectorArrays(NamedTuple):
    """One detector: S spheres, those of one of the C components together, P component pairs, W rows of spheres."""

    safe_distance: float  # m
    p_body_sphere: Floats  # [3, S] m
    radius: Floats  # [S] m
    components: Indices  # [C, 3] body, first sphere, sphere after the last
    bounds: Floats  # [C, 4] centre in its body and radius of a sphere around the whole component, m
    pairs: Indices  # [P, 2] two components, the one with more spheres first
    rows: Indices  # [W, 4] frame of the first key point, of the second, first sphere, sphere after the last
    offset: Floats  # [S] m along the row's line, from its middle


BODY, FIRST, LAST = range(3)  # columns of `DetectorArrays.components`


class TargetArrays(NamedTuple):
    """T targets in the world frame."""

    kind: Ints  # [T] 0 position, 1 position and tool axis, 2 pose
    T_world_tool: Floats  # [T, 3, 4]; for kind 1 only the z axis and the position are asked for, for 0 the position


class SearchArrays(NamedTuple):
    """What a search is told: numbers from `SolveSettings`, ranges from the robot, `freeze` and `near`."""

    ranges: Floats  # [3, N] lower, upper, and the centre of the growing boxes; m or rad
    first_box: float  # half-width of the first attempt's box as a share of each range; 1: the whole range at once
    start_share: float  # share of each range, about its middle, that the first population is drawn from
    position_tolerance: float  # m
    orientation_tolerance: float  # rad
    population: int
    generations: int
    strategy: int  # index into `mutation.STRATEGIES`
    weight: float  # F, the differential weight
    crossover: float  # CR
    repair: int  # index into `mutation.REPAIRS`
    in_place: bool  # a better trial replaces its parent at once, not at the end of the generation
    collision_rule: int  # one of `evolution.IGNORE`, `REJECT`, `FEASIBILITY`

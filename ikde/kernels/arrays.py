"""The table of every packed array: what `model.pack` gives and every kernel takes.

All arrays are C-ordered and read-only; metres and radians. Numbers are float64 or int64; what is only ever an index
into another array is uint64, since numba tests a signed index for being negative (0.06 us a collision check). A
transform is its upper three rows, [3, 4]: rotation and translation. Points stand as [3, S], coordinate by coordinate,
so that the compiler can vectorise.

A *body* is what one joint moves. Body 0 is the world; body b > 0 is moved by one coordinate of q about or along the z
axis of its own frame (`pack` aligns every joint axis with z, so that one formula serves all). Parents come first.
"""

from typing import Any, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Indices = NDArray[np.uint64]
Array = TypeVar("Array", bound=np.ndarray[Any, Any])


def read_only(array: Array) -> Array:
    """The same array, which nothing writes to by mistake from now on."""
    array.setflags(write=False)
    return array


class RobotArrays(NamedTuple):
    """The kinematic tree: B bodies with the world, F named frames with the world first and the tool last."""

    bodies: Ints  # [B, 4] parent body, coordinate of q, 1 if prismatic, 1 if it carries the tool
    T_parent_body: Floats  # [B, 3, 4] at q = 0
    frame_body: Indices  # [F] the body a frame is fixed to
    T_body_frame: Floats  # [F, 3, 4]


PARENT, COORDINATE, PRISMATIC, MOVES_TOOL = range(4)  # columns of `RobotArrays.bodies`


class SafeDistance(NamedTuple):
    """What is left of `CollisionArrays` where the rest is written into the code."""

    safe_distance: float  # m


class CollisionArrays(NamedTuple):
    """What is compared on a robot: S spheres of C components, one after the other, P pairs of components, W rows."""

    safe_distance: float  # m
    p_body_sphere: Floats  # [3, S] m
    radius: Floats  # [S] m
    components: Indices  # [C, 3] body, first sphere, sphere after the last
    bounds: Floats  # [C, 4] centre in its body and radius of a sphere around the whole component, m
    pairs: Indices  # [P, 2] two components, the one with more spheres first
    rows: Indices  # [W, 4] frame of the first key point, of the second, first sphere, sphere after the last
    offset: Floats  # [S] m along the row's line, from its middle
    world: Floats  # what stands around, as `kernels/world_grid.py` cuts it; empty: nothing does


BODY, FIRST, LAST = range(3)  # columns of `CollisionArrays.components`


class WorldArrays(NamedTuple):
    """S solids of O obstacles beside a robot of C components; all in the world frame, m; whole numbers are floats, too.

    They lie one after the other in one array: `kernels/world_grid.py` cuts it, `model/pack_world.py` makes it.
    """

    solids: Floats  # [S, SOLID_COLUMNS] as `kernels/obstacles.py` names them
    spheres: (
        Floats  # [4, S] middle and radius, with what is asked for, of a sphere that holds the solid; -inf: half-spaces
    )
    asked: Floats  # [C, O] distance that a component keeps from an obstacle; -inf: they are not compared
    faces: Floats  # [F, 12] of hulls: three corners and the outward normal, in the solid's frame
    points: Floats  # [3, K] of clouds, in the solid's frame, sorted by cell
    clouds: Floats  # [clouds, GRID_COLUMNS] the cells of each
    cloud_starts: Floats  # [cells + 1 a cloud] first point of each cell
    cloud_far: Floats  # [cells + 1 a cloud] how far the nearest occupied cell is, box to box
    grid: Floats  # [GRID_COLUMNS] the cells over all solids but half-spaces; no cells: every solid is asked
    grid_starts: Floats  # [cells + 1] first entry of each cell in `grid_solids`
    grid_solids: Floats  # [E] solids by cell
    grid_near: Floats  # [cells] distance of the middle of the cell from the nearest solid, less what it asks for
    unbounded: Floats  # [H] solids that no cell holds


class TargetArrays(NamedTuple):
    """T targets in the world frame."""

    kind: Ints  # [T] POSITION, AXIS (position and tool axis) or POSE
    T_world_tool: Floats  # [T, 3, 4]; for kind 1 only the z axis and the position are asked for, for 0 the position


POSITION, AXIS, POSE = range(3)  # kinds of target


class SearchArrays(NamedTuple):
    """Settings of a search: numbers from `SolveSettings`, ranges from the robot, `freeze` and `near`."""

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
    collision_rule: int  # IGNORE, REJECT or FEASIBILITY


IGNORE, REJECT, FEASIBILITY = range(3)  # what a search makes of collisions


class DescentArrays(NamedTuple):
    """Settings of the damped least-squares steps of `kernels/damped.py`."""

    damping: float = 0.1  # lambda = damping * |error|^2 + least_damping
    least_damping: float = 1e-6  # m^2
    rotation_length: float = 0.5  # m/rad: what a radian counts beside a metre
    largest_step: float = 0.8  # m or rad, of any joint
    position_tolerance: float = 0.0  # m: no step is taken within both
    orientation_tolerance: float = 0.0  # rad
    most_steps: int = 12  # of one attempt of the engine `lm`
    patience: int = 5  # steps after which an attempt must be on its way
    hopeless: float = 0.3  # m: an error this large says that it is not


class SeedArrays(NamedTuple):
    """Where the engine `lm` starts: K configurations that are free of collision, and where the tool is in each."""

    q: Floats  # [K, N] m or rad; none: starts are drawn uniformly
    T_world_tool: (
        Floats  # [K, 3, 6 or 12 columns] what its kind of target asks of the tool, side by side (`kernels/seeds.py`)
    )
    base: Ints  # [3] coordinates of a planar base (x, y, yaw), at zero in the pool; -1: there is none
    grid: Ints  # [G, 2] a grid over tool poses: which entry of the transform each direction divides, into how many bins
    grid_scale: Floats  # [G, 2] lowest value, bins per unit
    cell_start: Ints  # [cells + 1] the first configuration of each cell: the pool is sorted by cell
    rotation_length: float  # m/rad: what a radian counts beside a metre
    first_box: float  # as in `SearchArrays`: below 1 the starts are drawn about ranges[2]


class ClosedFormArrays(NamedTuple):
    """A UR-type arm for `kernels/closed_form.py`: angles theta = sign * q + offset; `model.closed_form` finds it."""

    coordinates: Indices  # [6] coordinate of q of each joint
    transforms: Floats  # [2, 3, 4] T_base_carrier and T_tool_wrist, m
    lengths: Floats  # [8] a1, a2, a3, a4, d4, d5 in m, a2^2 + a3^2 in m^2, 1 / (2 a2 a3) in 1/m^2
    angles: Floats  # [3, 6] sign, offset in rad, and how much a radian of it counts as motion


class MemeticArrays(NamedTuple):
    """Settings of `kernels/memetic.py` beyond the ranges, tolerances, repair and collision rule of `SearchArrays`."""

    evaluations: int = 10_000  # budget of one attempt; a damped step counts N + 1
    first_population: int = 60  # at least 4
    last_population: int = 8  # at least 4
    memory: int = 5  # H, places in the memory of F and CR
    first_weight: float = 0.5  # F remembered at the start
    first_crossover: float = 0.8  # CR remembered at the start
    first_share: float = 0.25  # p: a trial is pulled to one of the best p of the population, at the start
    last_share: float = 0.125  # p at the end
    archive_share: float = 1.0  # members of the archive for each of the population
    is_weighted: bool = True  # jSO's rules for F and CR
    polish_share: float = 0.8  # of the evaluations that damped steps may take; 0: none
    polish_steps: int = 30  # at most, of one member
    patience: int = 2  # steps in a row without progress before a member is given up
    margin: float = 1e-5  # m: pairs nearer than the safe distance and this are moved apart


class DriveArrays(NamedTuple):
    """How a robot moves from sample to sample: a step [D], each entry a share of the largest, -1 to 1.

    A base with wheels takes the first two entries, along its heading and its yaw; the rest move one coordinate each.
    """

    base: Ints  # [3] coordinates of x, y and heading of a base with wheels; -1: every coordinate moves by itself
    others: Ints  # [D] or [D - 2] coordinates that move by themselves, parents first
    largest: Floats  # [D] largest step, m or rad per sample; 0: frozen
    change: Floats  # [D] largest change of the share from sample to sample; inf: any
    half_track: float  # m
    wheel_travel: float  # m per sample, the most that a wheel rolls; inf: any
    centre_body: int  # the body that carries the platform's centre
    p_body_centre: Floats  # [3] m
    max_distance: float  # m, of the tool from the platform's centre; inf: any


class TrackArrays(NamedTuple):
    """Settings of a step along a path."""

    ranges: Floats  # [2, N] lower, upper; m or rad
    reach: float  # m: pairs nearer than this are constrained; -inf: none
    margin: float  # m: what every pair keeps
    rotation_length: float  # m/rad: what a radian counts beside a metre
    position_goal: float  # m: refined until both are met
    orientation_goal: float  # rad
    position_tolerance: float  # m: accepted if it comes no nearer
    orientation_tolerance: float  # rad
    max_rounds: int  # of one step


class StepSearchArrays(NamedTuple):
    """Settings of the paper's search for one step along a path (`kernels/step_evolution.py`)."""

    population: int  # NP
    generations: int  # G, of one population
    attempts: int  # populations of one sample, at most
    weight: float  # F
    crossover: float  # CR
    odd: int  # index into `mutation.STRATEGIES`, of generations 1, 3, ..
    even: int  # of generations 2, 4, ..
    motion: Floats  # [N] W1, W2: of the square of a coordinate's change, per m^2 or rad^2
    position_weight: float  # W3: of the sum of the errors along the axes, per m
    orientation_weight: float  # per rad; the print has none
    position_tolerance: float  # m, along each axis
    orientation_tolerance: float  # rad


CLEARANCE, LIMITS, MANIPULABILITY, DRIFT = range(4)  # columns of what the null space is used for; DRIFT: the first of D


# Columns of what every search counts, `out_counts` [COUNTS]: 1 if reached; populations or starts; poses evaluated;
# attempts that met the target but collided, or left the ranges.
REACHED, ATTEMPTS, EVALUATIONS, COLLIDING, OUTSIDE = range(5)
COUNTS = 5

UNKNOWN_DEPTH = 1.0  # m, in a score: a collision whose depth is not measured; every measured one is better

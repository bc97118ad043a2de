"""Whether a configuration is free of itself and of a world, and by how much, pair by pair."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, overload

import numpy as np
from numpy.typing import ArrayLike

from ikde.errors import InputError
from ikde.kernels.arrays import Floats, Ints, read_only
from ikde.model.arguments import RobotLike, read_robot
from ikde.model.collision_model import CollisionChoice, CollisionModel
from ikde.model.robot import Pairs, Robot
from ikde.model.value import MadeAnew
from ikde.solver.joints import JointValues, joints_outside, read_joints
from ikde.solver.obstacle_clearance import ObstacleClearance, list_obstacles
from ikde.solver.plain import compute_gaps
from ikde.solver.standing import find_model
from ikde.solver.verify import Bools, MaskedBools

AT_ONCE = 256  # configurations: more do not fit into the cache


@dataclass(frozen=True, slots=True, kw_only=True)
class PairClearance:
    """Clearance between two components: min over their spheres of distance - R_i - R_j; negative is penetration."""

    a: str
    b: str
    clearance_m: float
    collides: bool


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class CheckResult(MadeAnew):
    """What a detector sees. Without a detector there are no pairs; collision and clearance are None."""

    q: Floats
    """[N] in the robot's own convention, m and rad."""
    collision: bool | None
    """None: not checked, no pair was compared."""
    clearance_m: float | None
    pairs: tuple[PairClearance, ...]
    """Every pair of the detector, worst first."""
    obstacles: tuple[ObstacleClearance, ...]
    """Of every obstacle the component that has the least room, worst first; nothing without a world."""
    closest_pair: tuple[str, str] | None
    """What the clearance lies between: of all pairs, and components and obstacles, those that have the least room."""
    detector: str
    safe_distance_m: float
    outside_limits: tuple[str, ...]
    """Joints of `q` outside their limits."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "q", read_only(self.q.copy()))

    def __repr__(self) -> str:
        if self.clearance_m is None or self.closest_pair is None:
            return "<CheckResult: self-collision not checked>"
        free = "free of self-collision and of the world" if self.obstacles else "free of self-collision"
        verdict, (a, b) = "in collision" if self.collision else free, self.closest_pair
        return f"<CheckResult: {verdict}, {a} - {b} {1e3 * self.clearance_m:.6g} mm>"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class CheckResults(MadeAnew):
    """What a detector sees of K configurations, as columns."""

    q: Floats
    """[K, N] in the robot's own convention, m and rad."""
    collision: MaskedBools
    """[K]; masked where no pair was compared: not checked."""
    clearance_m: Floats
    """[K]; inf where no pair was compared."""
    closest_pair: Ints
    """[K] index into `pairs`; -1 where no pair was compared."""
    pairs: Pairs
    """P pairs of components, in the detector's order; in a world each component and obstacle follow."""
    gaps_m: Floats
    """[K, P] clearance of every pair; inf where a component is not compared with an obstacle."""
    inside_limits: Bools
    """[K] whether every joint is inside its limits."""

    def __post_init__(self) -> None:
        """What was checked stays what it is: no column can be written to by mistake."""
        for name in ("q", "clearance_m", "closest_pair", "gaps_m", "inside_limits"):
            read_only(getattr(self, name))
        read_only(self.collision.data)
        self.collision.setflags(write=False)

    def __len__(self) -> int:
        return len(self.q)

    def __repr__(self) -> str:
        return f"<CheckResults: {len(self)} configurations, {int(self.collision.sum() or 0)} in collision>"


One = Mapping[str, float] | Sequence[float] | np.ndarray[tuple[int], np.dtype[Any]]
Many = Sequence[Sequence[float]] | Sequence[Floats] | np.ndarray[tuple[int, int], np.dtype[Any]]


@overload
def check(
    robot: RobotLike, q: One, collision: CollisionChoice = None, convention: str | None = None
) -> CheckResult: ...


@overload
def check(
    robot: RobotLike, q: Many, collision: CollisionChoice = None, convention: str | None = None
) -> CheckResults: ...


@overload
def check(
    robot: RobotLike, q: JointValues, collision: CollisionChoice = None, convention: str | None = None
) -> CheckResult | CheckResults: ...


def check(
    robot: RobotLike, q: JointValues, collision: CollisionChoice = None, convention: str | None = None
) -> CheckResult | CheckResults:
    """Clearance of every pair of components; collision means clearance <= safe distance [Qiao2021, eq. 21].

    In a world also that of every obstacle; collision then means as well that a margin is not kept.

    Args:
        robot: the robot, its name or the path of its file.
        q: joint values [N] or a mapping by joint name; m and rad. Values outside the limits are accepted and named.
            Of many, [K, N], the answer is that of `check_many`: `CheckResults`.
        collision: a detector's name, a `Detector`, a `World`, a `CollisionModel`, `"none"`, or None for the robot's
            default.
        convention: how `q` is counted; None for the robot's own.

    Raises:
        InputError: for a wrong count, an unknown joint, detector or convention, NaN or infinity.
    """
    robot = read_robot(robot)
    values = read_joints(robot, q, convention)
    if values.ndim == 2:
        return _check_rows(robot, values, collision)
    if values.ndim != 1:
        count = len(robot.joints)
        raise InputError(f"expected a configuration [{count}] or many [K, {count}], got shape {values.shape}", ("q",))
    model = find_model(robot, collision)
    gaps_m = compute_gaps(model, values)
    closest = int(gaps_m.argmin()) if model.pairs else None
    return CheckResult(
        q=values,
        collision=None if closest is None else bool(gaps_m[closest] <= model.limit_m),
        clearance_m=None if closest is None else float(gaps_m[closest]) + model.extra_m(closest),
        pairs=_list_pairs(model, gaps_m),
        obstacles=list_obstacles(model, gaps_m),
        closest_pair=None if closest is None else model.name_pair(closest),
        detector=model.name,
        safe_distance_m=model.limit_m,
        outside_limits=joints_outside(robot, values),
    )


def check_many(
    robot: RobotLike, q: ArrayLike, collision: CollisionChoice = None, convention: str | None = None
) -> CheckResults:
    """`check` of many configurations at once, as columns.

    Args:
        robot: the robot, its name or the path of its file.
        q: joint values [K, N]; m and rad.
        collision: as for `check`.
        convention: as for `check`.

    Raises:
        InputError: for a wrong shape or count, an unknown detector or convention, NaN or infinity.
    """
    robot = read_robot(robot)
    values = read_joints(robot, q, convention)
    if values.ndim != 2:
        raise InputError(f"expected configurations [K, {len(robot.joints)}], got shape {values.shape}", ("q",))
    return _check_rows(robot, values, collision)


def _check_rows(robot: Robot, values: Floats, collision: CollisionChoice) -> CheckResults:
    """Of `values` [K, N] in the robot's own convention."""
    model = find_model(robot, collision)
    gaps_m = np.concatenate([compute_gaps(model, values[k : k + AT_ONCE]) for k in range(0, len(values) or 1, AT_ONCE)])
    least = gaps_m.min(axis=1, initial=np.inf)
    unchecked = np.full(len(values), not model.pairs)
    closest = gaps_m.argmin(axis=1) if model.pairs else np.full(len(values), -1)
    if model.obstacles:
        gaps_m = gaps_m + model.extras_m
    return CheckResults(
        q=values,
        collision=np.ma.masked_array(least <= model.limit_m, mask=unchecked),
        clearance_m=model.clearances_m(least, closest),
        closest_pair=closest,
        pairs=model.all_pairs,
        gaps_m=gaps_m,
        inside_limits=np.all((robot.lower <= values) & (values <= robot.upper), axis=1),
    )


def compute_pairs(collision: CollisionModel, q: Floats) -> tuple[PairClearance, ...]:
    """Every pair of components that is compared, for one `q` [N], worst first, by plain numpy."""
    return _list_pairs(collision, compute_gaps(collision, q, collision.pairs))


def _list_pairs(collision: CollisionModel, gaps_m: Floats) -> tuple[PairClearance, ...]:
    """Every pair of components, worst first."""
    found = [
        PairClearance(a=a, b=b, clearance_m=gap, collides=gap <= collision.limit_m)
        for (a, b), gap in zip(collision.pairs, gaps_m.tolist(), strict=False)
    ]
    return tuple(sorted(found, key=lambda pair: pair.clearance_m))

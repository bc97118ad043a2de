"""Whether a configuration is free of self-collision, and by how much, pair by pair."""

from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ikde.errors import InputError
from ikde.kernels.arrays import Floats, Ints, read_only
from ikde.model.arguments import RobotLike, read_robot
from ikde.model.collision_model import CollisionChoice, CollisionModel
from ikde.model.robot import Pairs
from ikde.model.value import make_anew
from ikde.solver.joints import JointValues, joints_outside, read_configuration, read_joints
from ikde.solver.plain import compute_gaps
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
class CheckResult:
    """What a detector sees. Without a detector there are no pairs; collision and clearance are None."""

    q: Floats
    """[N] in the robot's own convention, m and rad."""
    collision: bool | None
    """None: not checked, no pair was compared."""
    clearance_m: float | None
    pairs: tuple[PairClearance, ...]
    """Every pair of the detector, worst first."""
    detector: str
    safe_distance_m: float
    outside_limits: tuple[str, ...]
    """Joints of `q` outside their limits."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "q", read_only(self.q.copy()))

    def __reduce__(self) -> tuple[Any, ...]:
        return make_anew, (CheckResult, {field.name: getattr(self, field.name) for field in fields(self)})

    def __repr__(self) -> str:
        if not self.pairs:
            return "<CheckResult: self-collision not checked>"
        verdict, closest = "in collision" if self.collision else "free of self-collision", self.pairs[0]
        return f"<CheckResult: {verdict}, {closest.a} - {closest.b} {1e3 * closest.clearance_m:.6g} mm>"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class CheckResults:
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
    """P pairs of components, in the detector's order."""
    gaps_m: Floats
    """[K, P] clearance of every pair."""
    inside_limits: Bools
    """[K] whether every joint is inside its limits."""

    def __post_init__(self) -> None:
        """What was checked stays what it is: no column can be written to by mistake."""
        for name in ("q", "clearance_m", "closest_pair", "gaps_m", "inside_limits"):
            read_only(getattr(self, name))
        read_only(self.collision.data)
        self.collision.setflags(write=False)

    def __reduce__(self) -> tuple[Any, ...]:
        return make_anew, (CheckResults, {field.name: getattr(self, field.name) for field in fields(self)})

    def __len__(self) -> int:
        return len(self.q)

    def __repr__(self) -> str:
        return f"<CheckResults: {len(self)} configurations, {int(self.collision.sum() or 0)} in collision>"


def check(
    robot: RobotLike, q: JointValues, collision: CollisionChoice = None, convention: str | None = None
) -> CheckResult:
    """Clearance of every pair of components; collision means clearance <= safe distance [Qiao2021, eq. 21].

    Args:
        robot: the robot, its name or the path of its file.
        q: joint values [N] or a mapping by joint name; m and rad. Values outside the limits are accepted and named.
        collision: a detector's name, a `Detector`, a `CollisionModel`, `"none"`, or None for the robot's default.
        convention: how `q` is counted; None for the robot's own.

    Raises:
        InputError: for a wrong count, an unknown joint, detector or convention, NaN or infinity.
    """
    robot = read_robot(robot)
    values = read_configuration(robot, q, convention)
    model = CollisionModel.of(robot, collision)
    pairs = compute_pairs(model, values)
    return CheckResult(
        q=values,
        collision=any(pair.collides for pair in pairs) if pairs else None,
        clearance_m=pairs[0].clearance_m if pairs else None,
        pairs=pairs,
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
    model = CollisionModel.of(robot, collision)
    gaps_m = np.concatenate([compute_gaps(model, values[k : k + AT_ONCE]) for k in range(0, len(values) or 1, AT_ONCE)])
    clearance_m = gaps_m.min(axis=1, initial=np.inf)
    unchecked = np.full(len(values), not model.pairs)
    return CheckResults(
        q=values,
        collision=np.ma.masked_array(clearance_m <= model.limit_m, mask=unchecked),
        clearance_m=clearance_m,
        closest_pair=gaps_m.argmin(axis=1) if model.pairs else np.full(len(values), -1),
        pairs=model.pairs,
        gaps_m=gaps_m,
        inside_limits=np.all((robot.lower <= values) & (values <= robot.upper), axis=1),
    )


def compute_pairs(collision: CollisionModel, q: Floats) -> tuple[PairClearance, ...]:
    """Every pair that is compared, for one `q` [N], worst first, by plain numpy."""
    gaps = compute_gaps(collision, q).tolist()
    found = [
        PairClearance(a=a, b=b, clearance_m=gap, collides=gap <= collision.limit_m)
        for (a, b), gap in zip(collision.pairs, gaps, strict=True)
    ]
    return tuple(sorted(found, key=lambda pair: pair.clearance_m))

"""Whether a configuration is free of self-collision, and by how much, pair by pair."""

from dataclasses import dataclass

from ikde.kernels.arrays import Floats
from ikde.model.arguments import RobotLike, read_robot
from ikde.model.collision_model import CollisionChoice, CollisionModel
from ikde.solver.joints import JointValues, joints_outside, read_configuration
from ikde.solver.plain import compute_gaps


@dataclass(frozen=True, slots=True, kw_only=True)
class PairClearance:
    """Clearance between two components: min over their spheres of distance - R_i - R_j; negative is penetration."""

    a: str
    b: str
    clearance_m: float
    collides: bool


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
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


def compute_pairs(collision: CollisionModel, q: Floats) -> tuple[PairClearance, ...]:
    """Every pair that is compared, for one `q` [N], worst first, by plain numpy."""
    gaps = compute_gaps(collision, q).tolist()
    found = [
        PairClearance(a=a, b=b, clearance_m=gap, collides=gap <= collision.limit_m)
        for (a, b), gap in zip(collision.pairs, gaps, strict=True)
    ]
    return tuple(sorted(found, key=lambda pair: pair.clearance_m))

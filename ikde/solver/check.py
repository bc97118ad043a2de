"""Whether a configuration is free of self-collision, and by how much, pair by pair."""

from dataclasses import dataclass

from ikde.kernels.arrays import Floats
from ikde.model.robot import Detector, Robot
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
    robot: Robot, q: JointValues, detector: str | Detector | None = None, convention: str | None = None
) -> CheckResult:
    """Clearance of every pair of components; collision means clearance <= safe distance [Qiao2021, eq. 21].

    Args:
        robot: the robot.
        q: joint values [N] or a mapping by joint name; m and rad. Values outside the limits are accepted and named.
        detector: a name, a `Detector`, `"none"`, or None for the robot's default.
        convention: how `q` is counted; None for the robot's own.

    Raises:
        InputError: for a wrong count, an unknown joint, detector or convention, NaN or infinity.
    """
    values = read_configuration(robot, q, convention)
    chosen = robot.detector(detector)
    pairs = compute_pairs(robot, chosen, values) if chosen else ()
    return CheckResult(
        q=values,
        collision=any(pair.collides for pair in pairs) if pairs else None,
        clearance_m=pairs[0].clearance_m if pairs else None,
        pairs=pairs,
        detector=chosen.name if chosen else "none",
        safe_distance_m=chosen.safe_distance_m if chosen else 0.0,
        outside_limits=joints_outside(robot, values),
    )


def compute_pairs(robot: Robot, detector: Detector, q: Floats) -> tuple[PairClearance, ...]:
    """Every pair of a detector for one `q` [N], worst first, by plain numpy."""
    pairs = robot.pairs(detector)
    gaps = compute_gaps(robot, detector.spheres, pairs, q).tolist()
    found = [
        PairClearance(a=a, b=b, clearance_m=gap, collides=gap <= detector.safe_distance_m)
        for (a, b), gap in zip(pairs, gaps, strict=True)
    ]
    return tuple(sorted(found, key=lambda pair: pair.clearance_m))

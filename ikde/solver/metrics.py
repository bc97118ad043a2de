"""The kernels' metrics of many configurations, confirmed by plain numpy.

The kernels' bits are the same on every machine, which numpy's are not: so these are the metrics that records hold.
"""

from collections.abc import Sequence
from dataclasses import dataclass, fields
from functools import lru_cache

import numpy as np

from ikde.errors import VerificationError
from ikde.kernels import grade_many as kernels
from ikde.kernels.arrays import Floats, Ints, read_only
from ikde.kernels.flat_arguments import Terms, flatten_grader
from ikde.model.collision_model import CollisionModel
from ikde.model.large_worlds import KEPT
from ikde.model.pack import pack_robot, pack_targets
from ikde.model.robot import FreeSpheres, Robot
from ikde.model.target import Target, Targets
from ikde.solver.joined import append_world, without_world
from ikde.solver.plain import compute_gaps
from ikde.solver.settings import SolveSettings
from ikde.solver.verify import Bools, Grades, MaskedBools

Limits = tuple[tuple[float, ...], tuple[float, ...]]
"""Lower and upper, m or rad."""

AGREEMENT = 1e-11  # m, rad: kernels and plain numpy must agree to this, times `measure_scale`
LARGE = 0.01  # of the lengths that a pose is made of: beyond 100 m of them rounding grows with them


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Metrics:
    """What the kernels see of T configurations."""

    position_error_m: Floats  # [T]
    orientation_error_rad: Floats  # [T]
    clearance_m: Floats  # [T]; inf without pairs
    closest_pair: Ints  # [T] index into the detector's pairs; -1 without
    accepted: Bools  # [T] within both tolerances, inside all limits, and above the safe distance

    def take(self, rows: Ints) -> "Metrics":
        """The metrics of these rows."""
        return Metrics(**{name: getattr(self, name)[rows] for name in COLUMNS})

    def piece(self, rows: slice) -> "Metrics":
        """The metrics of some rows side by side, as views."""
        return Metrics(**{name: getattr(self, name)[rows] for name in COLUMNS})

    def put(self, rows: Ints | slice, metrics: "Metrics") -> None:
        """Replace the metrics of these rows."""
        for name in COLUMNS:
            getattr(self, name)[rows] = getattr(metrics, name)


COLUMNS = tuple(field.name for field in fields(Metrics))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Clearances:
    """What a collision model sees of K configurations."""

    clearance_m: Floats  # [K]
    closest_pair: Ints  # [K] index into the detector's pairs
    collides: MaskedBools  # [K]; masked without pairs


def compute_metrics(
    collision: CollisionModel,
    targets: Targets | Sequence[Target],
    Q: Floats,
    settings: SolveSettings | None = None,
    limits: Limits | None = None,
) -> Metrics:
    """Metrics of configurations `Q` [T, N] in the robot's own convention, a target each.

    Without `settings` there are no tolerances; `limits` in place of the robot's own.
    """
    metrics, pairs, accepted = np.empty((len(Q), 3)), np.empty(len(Q), dtype=np.int64), np.empty(len(Q), dtype=np.bool_)
    (numbers, whole), asked = pack_grader(collision, settings, limits), pack_targets(targets)
    out = (np.ascontiguousarray(Q), metrics, pairs, accepted)
    kernels.grade_many(numbers, whole, asked.kind, asked.T_world_tool, *out)
    return Metrics(
        position_error_m=metrics[:, kernels.POSITION_ERROR],
        orientation_error_rad=metrics[:, kernels.ORIENTATION_ERROR],
        clearance_m=metrics[:, kernels.CLEARANCE],
        closest_pair=pairs,
        accepted=accepted,
    )


def make_metrics(count: int) -> Metrics:
    """Metrics of so many rows, none of which has been graded."""
    return Metrics(
        position_error_m=np.full(count, np.nan),
        orientation_error_rad=np.full(count, np.nan),
        clearance_m=np.full(count, np.nan),
        closest_pair=np.full(count, -1),
        accepted=np.zeros(count, dtype=np.bool_),
    )


@KEPT.add
@lru_cache(maxsize=64)
def pack_grader(
    collision: CollisionModel, settings: SolveSettings | None, limits: Limits | None = None
) -> tuple[Floats, Ints]:
    """What the grader takes beside targets and configurations; without settings there are no tolerances."""
    terms = Terms(
        limits=np.array(limits or (collision.robot.lower, collision.robot.upper)),
        position_tolerance=float(settings.position_tolerance_m) if settings else np.inf,
        orientation_tolerance=float(settings.orientation_tolerance_rad) if settings else np.inf,
    )
    arrays = collision.arrays
    return append_world(*flatten_grader(pack_robot(collision.robot), without_world(arrays), terms), 0, arrays.world)


def compute_clearances(collision: CollisionModel, Q: Floats) -> Clearances:
    """Clearances of configurations `Q` [K, N] in the robot's own convention: the kernels' metrics, confirmed.

    Raises:
        VerificationError: if kernels and plain numpy disagree by more than 1e-11 m: a bug.
    """
    metrics = compute_metrics(collision, Targets(np.zeros((len(Q), 3))), Q)
    plain = compute_gaps(collision, Q).min(axis=1, initial=np.inf)
    gaps = _difference(metrics.clearance_m, plain)
    gap = float((gaps / measure_scale(collision.robot, np.zeros((len(Q), 3)), Q)).max(initial=0.0))
    if not gap <= AGREEMENT:
        raise VerificationError(f"kernels and plain numpy disagree by {gap:.3g} m on a clearance")
    return Clearances(
        clearance_m=metrics.clearance_m,
        closest_pair=metrics.closest_pair,
        collides=judge_clearances(metrics, collision),
    )


def judge_clearances(metrics: Metrics, collision: CollisionModel) -> MaskedBools:
    """Whether configurations collide [T], by their clearance; masked where no pair was compared: not checked."""
    collides = read_only(~(metrics.clearance_m > collision.limit_m))
    return np.ma.masked_array(collides, mask=read_only(metrics.closest_pair < 0))


def compute_disagreement(targets: Targets | Sequence[Target], metrics: Metrics, verdicts: Grades) -> Floats:
    """Largest gap [T] between the kernels' metrics and plain numpy's, m or rad, relative to `measure_scale`."""
    gaps = [
        _difference(metrics.position_error_m, verdicts.position_error_m),
        _difference(metrics.orientation_error_rad, verdicts.orientation_error_rad),
        _difference(metrics.clearance_m, verdicts.clearance_m),
    ]
    return np.max(gaps, axis=0) / measure_scale(verdicts.collision.robot, Targets.of(targets).p_world_tool, verdicts.Q)


def measure_scale(robot: Robot, p_world_tool: Floats, Q: Floats) -> Floats:
    """By how much more than 1e-11 two graders may differ [T], through rounding alone: at least 1.

    As the target `p_world_tool` [T, 3] is beyond 1 m, or a hundredth of the robot's lengths at `Q` [T, N] is.
    """
    lengths = _sum_lengths(robot) + np.abs(Q) @ robot.is_prismatic
    return np.maximum(np.maximum(1.0, np.abs(p_world_tool).max(axis=1)), LARGE * lengths)


@lru_cache(maxsize=64)
def _sum_lengths(robot: Robot) -> float:
    """All that can add up in a coordinate at q = 0, m: the frames' places and the largest sphere."""
    rows = [row for rows in robot.approximations.values() for row in rows]
    sizes = [np.abs(row.spheres).sum(axis=1).max() if isinstance(row, FreeSpheres) else row.radius_m for row in rows]
    return float(sum(np.abs(frame.p_parent_frame).max() for frame in robot.frames)) + float(max(sizes, default=0.0))


def _difference(kernel: Floats, plain: Floats) -> Floats:
    """|kernel - plain|, 0 where both are infinite, and NaN where one of them is NaN."""
    with np.errstate(invalid="ignore"):
        return np.where(kernel == plain, 0.0, np.abs(kernel - plain))

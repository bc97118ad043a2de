"""Why a rollout ends before its path does.

Every limit is relaxed, one after the other. The one without which a step is found is what stands in the way, and that
step shows by how much. Only what is out of reach is proved; all else is what trying found, and is said as such.
"""

import numpy as np

from ikde.kernels.arrays import Floats
from ikde.kernels.tracking import REACHED, track_sample
from ikde.model.bounds import find_bounds
from ikde.model.pack import pack_robot
from ikde.model.robot import MAX_MAGNITUDE
from ikde.model.wheels import wheel_speeds
from ikde.solver.digits import at_least
from ikde.solver.result import SolveResult, StopReason
from ikde.track.drive import max_steps
from ikde.track.follower import Follower, Rollout
from ikde.track.starts import keeps_distance
from ikde.track.trajectory import TrackStop, TrackStopReason

FACTORS = (1.02, 1.05, 1.1, 1.2, 1.35, 1.5, 2.0, 3.0, 5.0, 10.0, 20.0, 50.0)
OF_SOLVER = {
    StopReason.OUT_OF_REACH: TrackStopReason.OUT_OF_REACH,
    StopReason.COLLISION: TrackStopReason.COLLISION,
    StopReason.WORLD: TrackStopReason.COLLISION,
    StopReason.LIMITS: TrackStopReason.JOINT_LIMIT,
}

IN_STEP = "in the step that was found"

Finding = tuple[Floats, Floats]
"""The end [N] and the step [D] that is possible without a limit."""


def first_out_of_reach(follower: Follower, lower: Floats, upper: Floats) -> tuple[int, float] | None:
    """The first sample that is proved to be out of reach of the ranges [N], and by how many m; None if none is."""
    excess = find_bounds(follower.robot, lower, upper).reach.excess_of_many_m(follower.path.p_world_tool)
    beyond = np.flatnonzero(excess > np.sqrt(3.0) * follower.plan.limits.position_error_m)  # which is allowed per axis
    return (int(beyond[0]), float(excess[beyond[0]])) if len(beyond) else None


def tell_out_of_reach(follower: Follower, sample: int, excess_m: float) -> TrackStop:
    """A stop at what is proved to be out of reach."""
    text = f"{tell_when(follower, sample)}: at least {at_least(1e3 * excess_m)} mm out of reach, whatever the joints do"
    return TrackStop(sample=sample, reason=TrackStopReason.OUT_OF_REACH, text=text)


def tell_static(follower: Follower, sample: int, result: SolveResult) -> TrackStop:
    """A stop at a pose that the solver did not meet, in its words."""
    pair = next(iter(result.blocking_pairs), None)
    reason, text = OF_SOLVER.get(result.stop_reason), result.reason
    if reason is None:
        reason = TrackStopReason.BUDGET
        off = f"the best is off by {1e3 * result.position_error_m:.3g} mm and {result.orientation_error_rad:.3g} rad"
        if result.collision and result.closest_pair is not None and _meets(follower, result):
            pair = result.closest_pair
            off = f"in the best of them {pair[0]} and {pair[1]} collide"
        text = f"no configuration was found in {result.attempts} attempts; {off}"
    hint = result.hint if result.stop_reason == StopReason.WORLD else None
    return TrackStop(sample=sample, reason=reason, text=f"{tell_when(follower, sample)}: {text}", pair=pair, hint=hint)


def _meets(follower: Follower, result: SolveResult) -> bool:
    """Whether an answer is within the tolerances of the path."""
    limits = follower.plan.limits
    near = result.position_error_m <= limits.position_error_m
    return near and result.orientation_error_rad <= limits.orientation_error_rad


def tell_too_far(follower: Follower, sample: int = 0, where: str = "every start") -> TrackStop:
    """A stop at a pose that was met only with the platform's centre too far away."""
    far = f"the tool is farther than {follower.plan.limits.max_distance_m:.4g} m from {follower.plan.limits.center}"
    return TrackStop(
        sample=sample,
        reason=TrackStopReason.DISTANCE_LIMIT,
        text=f"{tell_when(follower, sample)}: in {where} that was found {far}",
        limit=follower.plan.limits.center,
    )


def explain_stop(rollout: Rollout, static: SolveResult | None) -> TrackStop:
    """Why the sample after the rollout's last is not reached; `static` is what the solver says about it alone."""
    for check in CHECKS:
        stop = check(rollout)
        if stop is not None:
            return stop
    follower, sample = rollout.follower, rollout.last + 1
    if static is not None and not static.reached:
        return tell_static(follower, sample, static)
    stop = _without_speed(rollout)
    if stop is not None:
        return stop
    text = f"{tell_when(follower, sample)}: no step within the limits was found"
    return TrackStop(sample=sample, reason=TrackStopReason.BUDGET, text=text)


def tell_uncertified(follower: Follower, sample: int, place: int) -> TrackStop:
    """A stop before a segment in which a pair, by its place in the table of clearances, may touch on its way."""
    collision, pair = follower.collision, follower.collision.name_pair(place)
    kept_m = collision.extra_m(place) + collision.limit_m
    is_world = place >= len(collision.pairs)
    what = f"that {pair[0]} keeps {1e3 * kept_m:.4g} mm from {pair[1]}" if is_world and kept_m > 0.0 else ""
    text = f"contact of {pair[0]} and {pair[1]} on the way there can't be excluded"
    text = f"it can't be certified {what} on the way there" if what else text
    text = f"{tell_when(follower, sample)}: {text}"
    return TrackStop(sample=sample, reason=TrackStopReason.COLLISION, text=text, pair=pair)


def _try(follower: Follower, rollout: Rollout, scale: Floats | float = 1.0) -> Finding | None:
    """The step from a rollout's end, if there is one; `scale` makes shares of its largest step this follower's."""
    sample = rollout.last + 1
    q, step = np.zeros_like(rollout.rows[0]), np.zeros(follower.size)
    status, _, _ = track_sample(
        pack_robot(follower.robot),
        follower.arrays_at(sample),
        follower.drive,
        follower.track,
        follower.target,
        sample,
        rollout.weights[sample],
        rollout.rows[rollout.last],
        rollout.steps[rollout.last] * scale,
        sample == 1,
        follower.room,
        q,
        step,
    )
    return (q, step) if status == REACHED else None


def _without_collision(rollout: Rollout) -> TrackStop | None:
    follower, sample = rollout.follower, rollout.last + 1
    pairs = follower.collision.pairs
    found = _try(follower.with_track(reach=-np.inf), rollout) if pairs else None
    if found is None:
        return None
    gaps = follower.compute_gaps(found[0], sample)
    worst = int(np.argmin(gaps))
    if gaps[worst] > follower.track.margin:
        return None
    pair, extra_m = follower.collision.name_pair(worst), follower.collision.extra_m(worst)
    gap, least = 1e3 * (float(gaps[worst]) + extra_m), 1e3 * (follower.track.margin + extra_m)
    how = f"are {gap:.3g} mm apart, not {least:.3g} mm," if gap > 0.0 else f"overlap by {-gap:.3g} mm"
    text = f"{tell_when(follower, sample)}: {pair[0]} and {pair[1]} {how} {IN_STEP}"
    return TrackStop(sample=sample, reason=TrackStopReason.COLLISION, text=text, pair=pair)


def _without_ranges(rollout: Rollout) -> TrackStop | None:
    follower, sample = rollout.follower, rollout.last + 1
    ranges = follower.track.ranges
    found = _try(follower.with_track(ranges=np.sign(ranges - ranges.mean(axis=0)) * MAX_MAGNITUDE), rollout)
    if found is None:
        return None
    beyond = np.maximum(ranges[0] - found[0], found[0] - ranges[1])
    joint = int(np.argmax(beyond))
    if beyond[joint] <= 0.0:
        return None
    name = follower.robot.joint_names[joint]
    limits = f"[{ranges[0, joint]:.4g}, {ranges[1, joint]:.4g}]"
    unit = "m" if follower.robot.joints[joint].kind == "prismatic" else "rad"
    text = f"{tell_when(follower, sample)}: {name} is {beyond[joint]:.3g} {unit} outside its range {limits} {IN_STEP}"
    return TrackStop(sample=sample, reason=TrackStopReason.JOINT_LIMIT, text=text, limit=name)


def _without_acceleration(rollout: Rollout) -> TrackStop | None:
    follower, sample = rollout.follower, rollout.last + 1
    drive = follower.drive
    found = _try(follower.with_drive(change=np.full(follower.size, np.inf)), rollout)
    if found is None or not np.isfinite(drive.change).any():
        return None
    change = np.abs(found[1] - rollout.steps[rollout.last])
    worst = int(np.argmax(change / drive.change))
    name, when = entry_name(follower, worst), tell_when(follower, sample)
    if change[worst] <= drive.change[worst] or sample == 1:
        brakes = "with them every joint must be able to brake before its range ends"
        text = f"{when}: a step was found only without acceleration limits; {brakes}"
        return TrackStop(sample=sample, reason=TrackStopReason.ACCELERATION_LIMIT, text=text)
    per_second, unit = drive.largest[worst] / follower.path.dt_s**2, f"{_unit(follower, worst)}/s\u00b2"
    needed, limit = (f"{value[worst] * per_second:.4g} {unit}" for value in (change, drive.change))
    text = f"{when}: {name} needs an acceleration of {needed} {IN_STEP}, its limit is {limit}"
    return TrackStop(sample=sample, reason=TrackStopReason.ACCELERATION_LIMIT, text=text, limit=name)


def _without_wheels(rollout: Rollout) -> TrackStop | None:
    follower, sample = rollout.follower, rollout.last + 1
    wheels = follower.robot.wheels
    if wheels is None or np.isinf(follower.drive.wheel_travel) or follower.drive.base[0] < 0:
        return None
    found = _try(follower.with_drive(wheel_travel=np.inf), rollout)
    if found is None:
        return None
    v, omega = found[1][:2] * follower.drive.largest[:2] / follower.path.dt_s
    needed = float(np.abs(wheel_speeds(wheels, v, omega)).max())
    limit = follower.plan.limits.wheel_speed_rad_s
    if limit is None or needed <= limit:
        return None
    text = f"{tell_when(follower, sample)}: a wheel rotates at {needed:.4g} rad/s {IN_STEP}, its limit is {limit:.4g}"
    return TrackStop(sample=sample, reason=TrackStopReason.WHEEL_LIMIT, text=text, limit="wheels")


def _without_distance(rollout: Rollout) -> TrackStop | None:
    follower, sample = rollout.follower, rollout.last + 1
    found = None if np.isinf(follower.drive.max_distance) else _try(follower.with_drive(max_distance=np.inf), rollout)
    if found is None or keeps_distance(follower.plan, found[0][None])[0]:
        return None
    return tell_too_far(follower, sample, "the step")


def _without_speed(rollout: Rollout) -> TrackStop | None:
    """The least of some factors by which all speed limits would have to grow, and the joint that would use it up."""
    follower, sample = rollout.follower, rollout.last + 1
    usual = follower.drive.largest
    for factor in FACTORS:
        faster = follower.with_drive(largest=factor * usual, change=np.full(follower.size, np.inf))
        found = _try(faster, rollout, 1.0 / factor)
        if found is None:
            continue
        worst = int(np.argmax(np.abs(found[1])))
        if factor * abs(found[1][worst]) > 1.0:
            name, needed = entry_name(follower, worst), factor * abs(found[1][worst]) * usual[worst]
            text = f"{tell_when(follower, sample)}: {name} moves {_tell_speed(follower, worst, needed)}"
            return TrackStop(sample=sample, reason=TrackStopReason.SPEED_LIMIT, text=text, limit=name)
    return None


def _tell_speed(follower: Follower, entry: int, needed: float) -> str:
    """How fast a step of `needed` m or rad would be, and what it may be; or that it is too far for one step."""
    most, unit = follower.drive.largest[entry], _unit(follower, entry)
    if most < max_steps(follower.robot)[_entry_joint(follower, entry)]:
        dt_s = follower.path.dt_s
        limit = f"its limit is {most / dt_s:.4g} {unit}/s"
        return f"at {needed / dt_s:.4g} {unit}/s in the slowest step that was found, {limit}"
    return f"by {needed:.4g} {unit} in the shortest step that was found, at most {most:.4g} {unit} a sample are tried"


def _without_frozen(rollout: Rollout) -> TrackStop | None:
    """A step is possible if a frozen joint moves."""
    follower, sample = rollout.follower, rollout.last + 1
    usual = follower.drive.largest
    entries = range(follower.size)
    frozen = usual <= 0.0
    freed = [max_steps(follower.robot)[_entry_joint(follower, entry)] for entry in entries]
    found = _try(follower.with_drive(largest=np.where(frozen, freed, usual)), rollout) if frozen.any() else None
    moved = np.zeros(follower.size) if found is None else np.abs(found[1]) * frozen
    if not moved.any():
        return None
    name = entry_name(follower, int(np.argmax(moved)))
    text = f"{tell_when(follower, sample)}: {name} is frozen but moves {IN_STEP}"
    return TrackStop(sample=sample, reason=TrackStopReason.SPEED_LIMIT, text=text, limit=name)


CHECKS = (
    _without_wheels,
    _without_distance,
    _without_acceleration,
    _without_collision,
    _without_ranges,
    _without_frozen,
)
"""What is taken away, one after the other."""


def _entry_joint(follower: Follower, entry: int) -> int:
    """Index into q of an entry of a step; of a base's drive along its heading, that of x."""
    drive = follower.drive
    wheels = follower.size - len(drive.others)
    return int(drive.others[entry - wheels] if entry >= wheels else drive.base[0 if entry == 0 else 2])


def entry_name(follower: Follower, entry: int) -> str:
    """What an entry of a step moves."""
    is_driven = follower.drive.base[0] >= 0 and entry == 0
    return "the base" if is_driven else follower.robot.joint_names[_entry_joint(follower, entry)]


def _unit(follower: Follower, entry: int) -> str:
    return "m" if follower.robot.joints[_entry_joint(follower, entry)].kind == "prismatic" else "rad"


def tell_when(follower: Follower, sample: int) -> str:
    """`sample 40 (0.8 s)`."""
    return f"sample {sample} ({sample * follower.path.dt_s:.4g} s)"

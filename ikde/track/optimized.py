"""`optimized`, the paper's own: a differential evolution per sample inside the speed limits [Qiao2022, section 3.2].

It meets the limits at samples; between them nothing is checked. Where the print is unclear or wrong, and for what it
leaves out, see docs/track.md.
"""

import time
from typing import Any

import numpy as np

from ikde.kernels.arrays import Floats, StepSearchArrays
from ikde.kernels.mutation import STRATEGIES
from ikde.kernels.step_evolution import COLLIDES, LIMITED, NO_BOX, SOLVED, evolve_sample, make_step_workspace
from ikde.model.base_motion import find_planar_base
from ikde.model.pack import pack_robot
from ikde.solver.plain import compute_frames
from ikde.solver.verify import compute_orientation_errors
from ikde.track.continuation import Evolved, follow_from_start
from ikde.track.diagnosis import entry_name, first_out_of_reach, tell_out_of_reach, tell_when
from ikde.track.follower import Follower
from ikde.track.settings import OptimizedSettings
from ikde.track.starts import keeps_distance
from ikde.track.trajectory import Followed, TrackStop, TrackStopReason

WITHIN = 1.0 - 1e-6  # of the tolerances: what rounding can't undo
AT_LIMIT = 0.99  # of the largest step, from which on a limit is what stands in the way


def follow_optimized(follower: Follower) -> Followed:
    """Sample after sample, up to the first that no population solves."""
    return follow_from_start(follower, _evolve_samples)


def _evolve_samples(follower: Follower, start: Floats) -> Evolved:
    """The samples from `start` [N] at the path's first pose."""
    settings, seed = follower.plan.settings_of(OptimizedSettings), np.uint64(follower.plan.seed)
    robot, collision, samples = pack_robot(follower.robot), follower.collision.arrays, follower.path.samples
    search = pack_step_search(follower, settings)
    work = make_step_workspace(robot, collision, len(start), follower.size, settings.population)
    q, steps = np.zeros((samples + 1, len(start))), np.zeros((samples + 1, follower.size))
    seconds = np.zeros(samples)
    packed = (robot, collision, follower.drive, follower.track, follower.target)

    def evolve(k: int, search: StepSearchArrays) -> Any:
        return evolve_sample(*packed, k, search, seed, q[k - 1], steps[k - 1], k == 1, work, q[k], steps[k])

    q[0] = start
    evolve(1, search._replace(attempts=0))  # compiled before the clock runs
    for k in range(1, samples + 1):
        started = time.perf_counter()
        verdict, pair, *_ = evolve(k, search)
        seconds[k - 1] = time.perf_counter() - started
        if verdict != SOLVED:
            return q[:k], seconds[: k - 1], tell_unsolved(follower, k, verdict, pair, q[k], steps[k - 1 : k + 1])
    return q, seconds, None


def pack_step_search(follower: Follower, settings: OptimizedSettings) -> StepSearchArrays:
    """The settings for the kernel."""
    robot, limits = follower.robot, follower.plan.limits
    is_base = np.isin(np.arange(len(robot.joints)), find_planar_base(robot))
    odd, even = (STRATEGIES.index(name) for name in settings.strategies)
    return StepSearchArrays(
        population=settings.population,
        generations=settings.generations,
        attempts=1 + settings.max_redraws,
        weight=settings.weight,
        crossover=settings.crossover,
        odd=odd,
        even=even,
        motion=np.where(is_base, settings.base_weight, settings.arm_weight),
        position_weight=settings.position_weight,
        orientation_weight=settings.orientation_weight,
        position_tolerance=WITHIN * limits.position_error_m,
        orientation_tolerance=WITHIN * limits.orientation_error_rad,
    )


def tell_unsolved(follower: Follower, sample: int, verdict: int, pair: int, q: Floats, steps: Floats) -> TrackStop:
    """Why no population was solved: `q` [N] is the best of all, `steps` [2, D] the one before and that to `q`."""
    when = tell_when(follower, sample)
    best = f"the best of {1 + follower.plan.settings_of(OptimizedSettings).max_redraws} populations"
    if verdict == NO_BOX:
        text = f"{when}: no step within the accelerations stays inside the joint ranges and can brake before they end"
        return TrackStop(sample=sample, reason=TrackStopReason.ACCELERATION_LIMIT, text=text)
    if verdict == COLLIDES:
        names = follower.collision.counted[pair]
        text = f"{when}: {names[0]} and {names[1]} collide in {best}"
        return TrackStop(sample=sample, reason=TrackStopReason.COLLISION, text=text, pair=names)
    if verdict == LIMITED:
        reason, what, limit = find_broken(follower, q, steps[1])
        return TrackStop(sample=sample, reason=reason, text=f"{when}: {best} breaks {what}", limit=limit)
    beyond = first_out_of_reach(follower, *follower.track.ranges)
    if beyond is not None and beyond[0] == sample:
        return tell_out_of_reach(follower, *beyond)
    far = f"{best} is {_measure_miss(follower, sample, q)} away"
    fast, hard = np.abs(steps[1]) * (follower.drive.largest > 0.0), np.abs(steps[1] - steps[0]) / follower.drive.change
    shares = [(fast, TrackStopReason.SPEED_LIMIT, "speed")]
    if sample > 1:  # the first segment may have any speed
        shares.append((hard, TrackStopReason.ACCELERATION_LIMIT, "acceleration"))
    for share, reason, what in shares:
        if share.max() >= AT_LIMIT:
            name = entry_name(follower, int(np.argmax(share)))
            return TrackStop(
                sample=sample, reason=reason, text=f"{when}: {far}, with {name} at its {what} limit", limit=name
            )
    return TrackStop(sample=sample, reason=TrackStopReason.BUDGET, text=f"{when}: {far}")


def find_broken(follower: Follower, q: Floats, step: Floats) -> tuple[TrackStopReason, str, str | None]:
    """Which limit a free step [D] to `q` [N] at its target breaks, in words, and its name."""
    drive = follower.drive
    if drive.base[0] >= 0:
        v, omega = step[:2] * drive.largest[:2]
        if abs(v) + drive.half_track * abs(omega) > drive.wheel_travel:
            return TrackStopReason.WHEEL_LIMIT, "the wheels' limit", "wheels"
    if not keeps_distance(follower.plan, q[None])[0]:
        return TrackStopReason.DISTANCE_LIMIT, "the largest distance", follower.plan.limits.center
    return TrackStopReason.JOINT_LIMIT, "the base's range", None


def _measure_miss(follower: Follower, sample: int, q: Floats) -> str:
    """How far the tool is from its target, in words."""
    target = follower.path.targets()[sample : sample + 1]
    tool = compute_frames(follower.robot, q[None])[follower.robot.tool]
    far = float(np.linalg.norm(tool[0, :3, 3] - target.p_world_tool[0]))
    angle = float(compute_orientation_errors(target, tool[:, :3, :3])[0])
    return f"{1e3 * far:.3g} mm" + (f" and {angle:.3g} rad" if angle > 0.0 else "")

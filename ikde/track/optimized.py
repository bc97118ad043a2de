"""`optimized`, the paper's own: a differential evolution per sample inside the speed limits [Qiao2022, section 3.2].

It meets the limits at samples; between them nothing is looked at. Where the print is unclear or wrong, and for what it
leaves out, see docs/track.md.
"""

import time
from dataclasses import dataclass
from typing import Any

import numpy as np

from ikde.kernels.arrays import Floats, StepSearchArrays
from ikde.kernels.mutation import STRATEGIES
from ikde.kernels.step_evolution import (
    COLLIDES,
    LIMITED,
    NO_BOX,
    SOLVED,
    evolve_sample,
    make_step_workspace,
)
from ikde.model.pack import pack_robot
from ikde.model.planar_base import find_planar_base
from ikde.solver.plain import compute_frames
from ikde.solver.settings import require
from ikde.solver.verify import compute_orientation_errors
from ikde.track.check_settings import LEAST_POPULATION, check_counts, check_numbers
from ikde.track.follower import Follower
from ikde.track.refusal import entry_name, first_out_of_reach, tell_out_of_reach, tell_when
from ikde.track.starts import keeps_distance
from ikde.track.trajectory import TrackStop, TrackStopReason

WITHIN = 1.0 - 1e-6  # of the tolerances: what rounding can't undo
AT_LIMIT = 0.99  # of the largest step, from which on a limit is what stands in the way


@dataclass(frozen=True, slots=True, kw_only=True)
class OptimizedSettings:
    """Numbers of the paper, and those that it does not print."""

    population: int = 50
    """NP"""
    generations: int = 1000
    """G, of one population."""
    weight: float = 0.5
    """F"""
    crossover: float = 0.9
    """CR"""
    strategies: tuple[str, str] = ("best/1", "rand/1")
    """Of odd and of even generations (31): the text's order, and best/1 as named, from the best member."""
    returns: int = 20
    """How often a sample's population is drawn again at most; the paper has no end."""
    base_weight: float = 0.1
    """W1 of (34), of the square of the base's change, x, y and heading, as in (19). Calibrated, like all weights: with
    1 for W1 and W2 one seed in ten ends in a corner of task 1, with 0.1 none of 30 in any task."""
    arm_weight: float = 0.1
    """W2, of the square of each joint's, as in (17)."""
    position_weight: float = 10.0
    """W3, per m of error: large enough that no motion saved is worth an error."""
    orientation_weight: float = 3.0
    """Per rad of error, which the print forgets: 0.3 m of W3 a radian, as far as the tool is from the wrist."""

    def __post_init__(self) -> None:
        check_counts(self, {"population": LEAST_POPULATION, "generations": 1, "returns": 0})
        weights = ("base_weight", "arm_weight", "position_weight", "orientation_weight")
        check_numbers(self, {"weight": (0.0, 2.0), "crossover": (0.0, 1.0), **dict.fromkeys(weights, (0.0, 1e6))})
        is_pair = len(self.strategies) == 2 and all(name in STRATEGIES for name in self.strategies)
        require(is_pair, "strategies", f"two of {', '.join(STRATEGIES)}", self.strategies)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Evolved:
    """A motion as far as it goes, what each sample took, and why it ends before its path does."""

    q: Floats
    """[M + 1, N]"""
    seconds: Floats
    """[M]"""
    stop: TrackStop | None


def follow_optimized(
    follower: Follower, start: Floats, seed: int, settings: OptimizedSettings | None = None
) -> Evolved:
    """Sample after sample from `start` [N] at the path's first pose, up to the first that no population solves."""
    settings = settings or OptimizedSettings()
    robot, samples = follower.robot, follower.path.samples
    packed, detector = pack_robot(robot), follower.collision.arrays
    search = pack_step_search(follower, settings)
    work = make_step_workspace(packed, detector, len(start), follower.size, settings.population)
    q, steps = np.zeros((samples + 1, len(start))), np.zeros((samples + 1, follower.size))
    seconds = np.zeros(samples)
    told = (packed, detector, follower.drive, follower.track, follower.target)

    def evolve(k: int, search: StepSearchArrays) -> Any:
        row = (np.uint64(seed), q[k - 1], steps[k - 1], k == 1, work, q[k], steps[k])
        return evolve_sample(*told, k, search, *row)

    q[0] = start
    evolve(1, search._replace(attempts=0))  # compiled before the clock runs
    for k in range(1, samples + 1):
        started = time.perf_counter()
        verdict, pair, *_ = evolve(k, search)
        seconds[k - 1] = time.perf_counter() - started
        if verdict != SOLVED:
            stop = tell_unsolved(follower, settings, k, verdict, pair, q[k], steps[k - 1 : k + 1])
            return Evolved(q=q[:k], seconds=seconds[: k - 1], stop=stop)
    return Evolved(q=q, seconds=seconds, stop=None)


def pack_step_search(follower: Follower, settings: OptimizedSettings) -> StepSearchArrays:
    """The settings for the kernel."""
    robot, limits = follower.robot, follower.limits
    is_base = np.isin(np.arange(len(robot.joints)), find_planar_base(robot))
    odd, even = (STRATEGIES.index(name) for name in settings.strategies)
    return StepSearchArrays(
        population=settings.population,
        generations=settings.generations,
        attempts=1 + settings.returns,
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


def tell_unsolved(
    follower: Follower, settings: OptimizedSettings, sample: int, verdict: int, pair: int, q: Floats, steps: Floats
) -> TrackStop:
    """Why no population was solved: `q` [N] is the best of all, `steps` [2, D] the one before and that to `q`."""
    when = tell_when(follower, sample)
    told = f"the best of {1 + settings.returns} populations"
    if verdict == NO_BOX:
        text = f"{when}: no step within the accelerations stays inside the joint ranges and can brake before they end"
        return TrackStop(sample=sample, reason=TrackStopReason.ACCELERATION_LIMIT, text=text)
    if verdict == COLLIDES:
        names = follower.collision.pairs[pair]
        text = f"{when}: {names[0]} and {names[1]} collide in {told}"
        return TrackStop(sample=sample, reason=TrackStopReason.SELF_COLLISION, text=text, pair=names)
    if verdict == LIMITED:
        reason, what, limit = find_broken(follower, q, steps[1])
        return TrackStop(sample=sample, reason=reason, text=f"{when}: {told} breaks {what}", limit=limit)
    beyond = first_out_of_reach(follower, *follower.track.ranges)
    if beyond is not None and beyond[0] == sample:
        return tell_out_of_reach(follower, *beyond)
    far = f"{told} is {_measure_miss(follower, sample, q)} away"
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
    if not keeps_distance(follower, q[None])[0]:
        return TrackStopReason.DISTANCE_LIMIT, "the largest distance", follower.limits.center
    return TrackStopReason.JOINT_LIMIT, "the base's range", None


def _measure_miss(follower: Follower, sample: int, q: Floats) -> str:
    """How far the tool is from its target, in words."""
    target = follower.path.targets()[sample : sample + 1]
    tool = compute_frames(follower.robot, q[None])[follower.robot.tool]
    far = float(np.linalg.norm(tool[0, :3, 3] - target.p_world_tool[0]))
    turn = float(compute_orientation_errors(target, tool[:, :3, :3])[0])
    return f"{1e3 * far:.3g} mm" + (f" and {turn:.3g} rad" if turn > 0.0 else "")

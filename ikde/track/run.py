"""A plan of a track file, followed."""

from collections.abc import Callable, Mapping

import numpy as np

from ikde.kernels.arrays import Floats
from ikde.model.robot import Robot
from ikde.track.limits import MotionLimits
from ikde.track.plan import AskedLimits, TrackPlan
from ikde.track.track import track
from ikde.track.trajectory import Trajectory


def run_plan(plan: TrackPlan, *, announce_compile: Callable[[], None] | None = None) -> Trajectory:
    """Follow the plan's path as it says."""
    return track(
        plan.robot,
        plan.path,
        drive=plan.drive,
        method=plan.method,
        limits=make_limits(plan.robot, plan.limits),
        start=plan.start,
        seed=plan.seed,
        detector=plan.detector or "none",
        announce_compile=announce_compile,
    )


def make_limits(robot: Robot, asked: AskedLimits) -> MotionLimits:
    """Those that a track file asks for, and for what it leaves out those of the paper."""
    given = {"position_error_m": asked.position_error_m, "orientation_error_rad": asked.orientation_error_rad}
    usual = MotionLimits.of(robot).speed
    assert usual is not None
    return MotionLimits(
        ranges=asked.ranges,
        speed=_by_joint(robot, asked.speed, usual),
        acceleration=_by_joint(robot, asked.acceleration, np.full(len(usual), np.inf)) if asked.acceleration else None,
        wheel_speed_rad_s=asked.wheel_speed_rad_s,
        farthest_m=asked.farthest_m,
        center=asked.center,
        **{name: value for name, value in given.items() if value is not None},
    )


def _by_joint(robot: Robot, asked: Mapping[str, float], usual: Floats) -> Floats:
    """Values [N] by joint."""
    return np.array([asked.get(name, value) for name, value in zip(robot.joint_names, usual, strict=True)])

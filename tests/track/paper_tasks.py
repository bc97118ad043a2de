"""The paper's tasks, short: the first samples, from a start at the first pose."""

from functools import cache
from pathlib import Path

import ikde
from ikde.io.plan_file import load_track
from ikde.solver.settings import SolveSettings
from ikde.track.follower import make_follower
from ikde.track.limits import MotionLimits
from ikde.track.path import ToolPath
from ikde.track.plan import TrackPlan

TRACKS = Path(__file__).parents[2] / "configs" / "tracks"
EXACT = SolveSettings(position_tolerance_m=1e-9, orientation_tolerance_rad=1e-9)


@cache
def short_task(number, samples=10):
    """The first samples of a task."""
    path = load_track(TRACKS / f"qiao2022_task{number}.yaml").path
    return ToolPath(
        dt_s=path.dt_s,
        p_world_tool=path.p_world_tool[: samples + 1],
        orientation=path.orientation,
        R_world_tool=path.R_world_tool[: samples + 1],
    )


@cache
def start_of(robot_name, number):
    """A free configuration at the first pose."""
    return ikde.solve(ikde.load_robot(robot_name), short_task(number).targets()[0], EXACT, method="lm").q


def plan_of(robot, path, *, drive="differential", collision=None, **changes):
    """A path and what is asked of its motion: changes of the plan, else of the limits that are the paper's."""
    own = {key: changes.pop(key) for key in ("method", "start", "seed", "freeze", "settings") if key in changes}
    limits = MotionLimits.of(robot, **changes)
    return TrackPlan.of(robot, path, drive=drive, limits=limits, collision=collision, **own)


def follower_of(robot, path, **changes):
    """The same, packed for the kernels."""
    return make_follower(plan_of(robot, path, **changes))

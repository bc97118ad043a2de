"""The paper's tasks, short: the first samples, from a start at the first pose."""

from functools import cache
from pathlib import Path

import ikde
from ikde.io.track_file import load_track
from ikde.model.collision_model import CollisionModel
from ikde.solver.settings import SolveSettings
from ikde.track.follower import make_follower
from ikde.track.limits import MotionLimits
from ikde.track.path import ToolPath

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


def follower_of(robot, path, *, drive="differential", detector=True, frozen=(), **limits):
    """A path made ready, with the paper's limits but for changes."""
    return make_follower(
        CollisionModel(robot=robot, detector=CollisionModel.of(robot).detector if detector else None),
        path,
        drive=drive,
        limits=MotionLimits.of(robot, **limits),
        frozen=frozen,
    )

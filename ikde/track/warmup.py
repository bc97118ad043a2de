"""Compile ahead what follows a path: a robot that stands still at home, by each method."""

from functools import partial

import numpy as np

from ikde.model.collision_model import CollisionChoice
from ikde.model.robot import Robot
from ikde.solver.plain import compute_frames
from ikde.solver.warmup import Stage
from ikde.track.follow_path import follow_path
from ikde.track.path import ToolPath
from ikde.track.spec import TRACK_METHODS

SAMPLES = 2
DT_S = 0.02


def list_track_stages(robot: Robot, collision: CollisionChoice = None) -> list[Stage]:
    """A stage a method; kernels are the same for either drive and every kind of path."""
    tool = compute_frames(robot, robot.home)[robot.tool]
    path = ToolPath.through(np.tile(tool[:3, 3], (SAMPLES + 1, 1)), dt_s=DT_S)
    follow = partial(follow_path, robot, path, drive="omnidirectional", collision=collision)
    return [Stage(name=f"track, {method}", run=partial(follow, method=method)) for method in TRACK_METHODS]

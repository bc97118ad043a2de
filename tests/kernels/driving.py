"""Drives for the kernel tests: the 9-DoF robot, its base with wheels or without."""

import numpy as np

from ikde.kernels.arrays import DRIFT, TrackArrays
from ikde.kernels.tracking import make_sample
from ikde.model.collision_model import CollisionModel
from ikde.model.pack import pack_robot, pack_targets
from ikde.model.target import Targets
from ikde.solver.forward import forward
from ikde.track.drive import pack_drive
from ikde.track.limits import MotionLimits

DT_S = 0.02


def make_drive(robot, name="differential", **limits):
    """The packed drive of a robot at 20 ms a sample."""
    return pack_drive(robot, name, MotionLimits.of(robot, **limits), DT_S)


def make_track(robot, **changes):
    """Settings of the kernels, with the robot's ranges."""
    track = TrackArrays(
        ranges=np.array([robot.lower, robot.upper]),
        reach=0.1,
        margin=1e-4,
        rotation_length=0.3,
        position_goal=1e-9,
        orientation_goal=1e-8,
        position_tolerance=5e-7,
        orientation_tolerance=5e-5,
        max_rounds=30,
    )
    return track._replace(**changes)


class Stand:
    """A robot that stands at `q`, ready for a step."""

    def __init__(self, robot, q, name="differential", **limits):
        self.robot, self.q = robot, np.array(q, dtype=float)
        self.arrays, self.spheres = pack_robot(robot), CollisionModel.of(robot).arrays
        self.drive, self.track = make_drive(robot, name, **limits), make_track(robot)
        self.size = len(self.drive.largest)
        self.work = make_sample(self.arrays, self.spheres, len(self.q), self.size)
        self.weights = np.zeros(DRIFT + self.size)

    def target(self, kind="position", shift=(0.0, 0.0, 0.0)):
        """The tool's pose here, moved by `shift` m, as a target."""
        T = forward(self.robot, self.q)[self.robot.tool]
        p = T[:3, 3] + np.array(shift)
        if kind == "position":
            return pack_targets(Targets([p]))
        if kind == "axis":
            return pack_targets(Targets([p], axis_world_tool=[T[:3, 2]]))
        return pack_targets(Targets([p], R_world_tool=[T[:3, :3]]))

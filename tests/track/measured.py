"""A motion of the 9-DoF robot, made up and measured: the base drives on arcs while the arm waves, without a search."""

from dataclasses import replace

import numpy as np

from ikde.model.base_motion import step_base
from ikde.model.collision_model import CollisionModel
from ikde.solver.plain import compute_frames
from ikde.track.follow_path import grade_motion
from ikde.track.limits import MotionLimits
from ikde.track.path import ToolPath
from ikde.track.plan import TrackPlan
from ikde.track.summary import summarise_track
from ikde.track.trajectory import Followed

DT_S = 0.02


def make_measured(robot, *, steps=20, amplitude=0.05, stop=None, orientation="axis", drive="differential", **changes):
    """A motion through `steps` samples that meets its own path; `changes` are of the path's length and of limits.

    `q` [steps + 1, N] among them is another motion, of any robot.
    """
    q = changes.pop("q", None)
    q = wave(robot, steps, amplitude) if q is None else np.array(q)
    steps = len(q) - 1
    tool = compute_frames(robot, q)[robot.tool]
    further = changes.pop("further", 0)
    rows = np.minimum(np.arange(steps + 1 + further), steps)
    path = ToolPath(
        name="wave",
        dt_s=DT_S,
        p_world_tool=tool[rows, :3, 3],
        orientation=orientation,
        R_world_tool=None if orientation == "free" else tool[rows, :3, :3],
    )
    collision = CollisionModel.of(robot, changes.pop("detector", None))
    moving = changes.pop("moving", {})
    limits = MotionLimits.of(robot, **changes)
    plan = TrackPlan.of(robot, path, drive=drive, limits=limits, collision=collision)
    plan = replace(plan, moving=moving)
    followed = Followed(q=q, stop=stop, seconds=np.full(steps, 2e-5), search_seconds=0.25)
    return summarise_track(plan.collision, grade_motion(plan, followed))


def make_still(robot, **changes):
    """A motion of a robot that stands still: all joints move by 0.2 from home."""
    q = robot.home + np.linspace(0.0, 0.2, 21)[:, None]
    return make_measured(robot, q=q, drive="omnidirectional", **changes)


def wave(robot, steps, amplitude):
    """Joint values [steps + 1, 9]: v = 0.2 m/s, omega = 0.3 rad/s, joints around home."""
    q = np.tile(robot.home, (steps + 1, 1))
    for k in range(steps):
        q[k + 1, :3] = step_base(q[k, :3], np.array(0.2), np.array(0.3), DT_S)
    phase = np.linspace(0.0, np.pi, steps + 1)
    q[:, 3:] += amplitude * np.sin(phase)[:, None] * np.array([0.5, 0.8, -1.0, 0.3, 0.6, 0.2])
    return q

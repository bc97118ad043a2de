"""Where every frame is."""

from __future__ import annotations

from ikde.kernels.arrays import Floats
from ikde.model.arguments import RobotLike, read_robot
from ikde.model.robot import TOOL, WORLD
from ikde.solver.joints import JointValues, read_joints
from ikde.solver.plain import compute_frames


class FramePoses(dict[str, Floats]):
    """Frame name -> T_world_frame [..., 4, 4], m; a dictionary that a notebook shows in a line."""

    def __repr__(self) -> str:
        return f"<FramePoses of {len(self)} names, the tool's among them>"


def forward(robot: RobotLike, q: JointValues, convention: str | None = None) -> FramePoses:
    """Pose of every frame in the world [Qiao2021, eq. 3, 5-9].

    Args:
        robot: the robot, its name or the path of its file.
        q: joint values [N] or [..., N] in the robot's order, or a mapping by joint name; m and rad. Values outside
            the limits are accepted.
        convention: how `q` is counted; None for the robot's own.

    Returns:
        Frame name -> T_world_frame [..., 4, 4], m; the tool's frame also as `tool`, whatever the robot calls it.

    Raises:
        InputError: for a wrong count, an unknown joint or convention, NaN or infinity.
    """
    robot = read_robot(robot)
    Ts_world = compute_frames(robot, read_joints(robot, q, convention))
    return FramePoses({name: T for name, T in Ts_world.items() if name != WORLD} | {TOOL: Ts_world[robot.tool]})

"""The robot that options name, with the tool that is asked for; joints that do not move it are held."""

import os
from typing import TYPE_CHECKING, Annotated

from ikde.cli.candidates import ROBOT, offer_section
from ikde.cli.options import of_robot
from ikde.cli.output import print_note

if TYPE_CHECKING:
    from ikde.kernels.arrays import Floats
    from ikde.model.robot import Robot

ToolOption = Annotated[
    str | None,
    of_robot(
        metavar="NAME",
        autocompletion=offer_section("tools"),
        help="Which of its tools, or a frame; joints that do not move it are held (default: as its file says).",
    ),
]


def read_robot(name: str, tool: str | None = None) -> "Robot":
    """The robot that an option names, with the tool that is asked for; what is held is said on stderr.

    An error about a robot that the environment names says so.
    """
    robot = _load_named(name)
    robot = robot if tool is None else robot.with_tool(tool)
    if robot.free_joints:
        from ikde.model.tools import list_held, name_tool

        print_note(f"ikde: tool {name_tool(robot)}; held, as they do not move it: {', '.join(list_held(robot))}")
    return robot


def read_whole(name: str, tool: str | None = None) -> "Robot":
    """The same with all joints free, where a configuration is given and not searched."""
    robot = _load_named(name)
    return (robot if tool is None else robot.with_tool(tool)).whole


def hold_at(robot: "Robot", q: "Floats | None") -> "Robot":
    """The robot with joints that are held at `q` [N] and not at home, if any are."""
    if q is None or not robot.free_joints:
        return robot
    from ikde.model.tools import list_held

    values = dict(zip(robot.joint_names, q.tolist(), strict=True))
    return robot.with_tool(held_at={name: values[name] for name in list_held(robot)})


def _load_named(name: str) -> "Robot":
    from ikde.errors import FileError, InputError
    from ikde.io.robots import load_robot

    try:
        return load_robot(name)
    except FileError:
        raise
    except InputError as error:
        if name != os.environ.get(ROBOT):
            raise
        raise InputError(error.message, (f"${ROBOT}",)) from None

"""Several tools of one robot: one is asked, and joints that do not move it are held; what they carry still collides."""

from collections.abc import Mapping
from dataclasses import replace

from ikde.errors import InputError, nearest, quoted
from ikde.model.numbers import is_number
from ikde.model.robot import MAX_MAGNITUDE, TOOL, WORLD, Joint, Robot


def with_tool(robot: Robot, name: str | None = None, held_at: Mapping[str, float] | None = None) -> Robot:
    """The robot with this tool; see `Robot.with_tool`."""
    whole = robot.whole
    frame = robot.tool if name is None else find_tool(whole, name)
    values = _read_values(whole, held_at or {})
    chain = list_chain(whole, frame)
    if not chain:
        raise InputError(f"no joint moves {quoted(frame)}; expected another tool", ("tool",))
    taken = {other.name for other in whole.joints if other.name in chain and other.name in values}
    if taken:
        message = f"{', '.join(sorted(taken))}: this joint moves the tool and is not held; freeze it in a search"
        raise InputError(message, ("held_at",))
    joints = tuple(own if own.name in chain else _hold(own, values.get(own.name, own.home)) for own in whole.joints)
    if frame != robot.tool and any(own.name == TOOL for own in whole.frames):
        message = (
            f"the frame {TOOL!r} stands for the tool, which is {robot.tool!r}; name it otherwise to choose another"
        )
        raise InputError(message, ("tool",))
    if joints == whole.joints:
        return robot if frame == robot.tool and not robot.free_joints else replace(whole, tool=frame)
    ranges = whole.file_ranges or tuple(zip(*(ends.tolist() for ends in whole.drawn), strict=True))
    return replace(whole, tool=frame, joints=joints, free_joints=whole.joints, file_ranges=ranges)


def find_tool(robot: Robot, name: str) -> str:
    """The frame of a tool that the robot's file names, or a frame that is called so; raises `InputError` for others."""
    frames = [frame.name for frame in robot.frames]
    if name in robot.tools:
        return robot.tools[name]
    if name in frames:
        return name
    if name == TOOL:
        return robot.tool
    listed = f"; its tools are {', '.join(robot.tools)}" if robot.tools else ""
    known = nearest(str(name), [*robot.tools, *frames]) or listed
    raise InputError(f"no tool and no frame of {robot.name} is called {quoted(name)}{known}", ("tool",))


def list_chain(robot: Robot, frame: str) -> tuple[str, ...]:
    """Joints that move a frame, from the root on."""
    frames, chain = {own.name: own for own in robot.frames}, []
    while frame != WORLD:
        own = frames[frame]
        chain += [own.joint] if own.joint is not None else []
        frame = own.parent
    return tuple(chain[::-1])


def name_tool(robot: Robot) -> str:
    """What the file calls the tool that is asked: its name in `tools`, else its frame."""
    return next((name for name, frame in robot.tools.items() if frame == robot.tool), robot.tool)


def list_held(robot: Robot) -> tuple[str, ...]:
    """Joints that the choice of a tool holds."""
    return tuple(
        own.name for own, free in zip(robot.joints, robot.free_joints, strict=bool(robot.free_joints)) if own != free
    )


def _read_values(robot: Robot, held_at: Mapping[str, float]) -> dict[str, float]:
    joints = {joint.name: joint for joint in robot.joints}
    for name, value in held_at.items():
        if name not in joints:
            raise InputError(f"no joint is called {quoted(name)}{nearest(name, joints)}", ("held_at", name))
        joint = joints[name]
        if not (is_number(value) and abs(value) <= MAX_MAGNITUDE and joint.lower <= value <= joint.upper):
            limits = f"from {joint.lower:g} to {joint.upper:g}"
            raise InputError(f"expected a number {limits}, got {quoted(value)}", ("held_at", name))
    return {name: float(value) for name, value in held_at.items()}


def _hold(joint: Joint, value: float) -> Joint:
    """A joint that cannot leave a value."""
    kind = "prismatic" if joint.kind == "prismatic" else "revolute"
    return replace(joint, kind=kind, lower=value, upper=value, home=value)

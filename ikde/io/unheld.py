"""What other programs' formats cannot hold of a robot: listed on export."""

from collections.abc import Iterable, Iterator
from typing import Literal

from ikde.model.base_motion import base_joints
from ikde.model.collision_model import CollisionModel

Format = Literal["URDF", "SRDF", "MJCF", "cuRobo", "XRDF"]
BESIDE = ("cuRobo", "XRDF")
"""Those that stand beside a URDF."""


def list_unheld(collision: CollisionModel, kind: Format) -> tuple[str, ...]:
    """What a file of this kind does not hold of a robot, where it has any; first what its companion holds."""
    return (*_list_elsewhere(collision, kind), *_list_lost(collision, kind))


def _list_elsewhere(collision: CollisionModel, kind: Format) -> Iterator[str]:
    """What is in a file that goes with it."""
    if kind == "URDF":
        yield "home, and which pairs are compared: they are in the SRDF"
    if kind == "SRDF":
        yield "joints, frames and the tool: they are in the URDF"
        if collision.limit_m:
            yield "the safe distance: it is in the URDF"
    if kind in BESIDE:
        yield "joint limits, speeds, masses and frames: they are in the URDF"


def _list_lost(collision: CollisionModel, kind: Format) -> Iterator[str]:
    """What is not in any file of that kind."""
    robot = collision.robot
    accelerations = [joint.max_acceleration for joint in robot.joints]
    if kind in BESIDE:
        yield "limits of jerk, which ikde does not know"
    if kind in BESIDE and None in accelerations and any(accelerations):
        yield "accelerations, as not all joints have one"
    if kind == "MJCF" and any(accelerations):
        yield "accelerations"
    if kind == "MJCF" and any(joint.max_speed is not None for joint in robot.joints):
        yield "speeds"
    if kind == "MJCF" and any(joint.max_effort is not None for joint in robot.joints):
        yield "efforts"
    if kind == "MJCF" and robot.inertias:
        yield "masses: placeholders are written"
    if kind == "MJCF" and collision.limit_m:
        yield "the safe distance"
    if kind not in ("URDF", "SRDF") and collision.left_out_pairs:
        yield "reasons of pairs that are left out"
    yield from _list_own(collision)


def _list_own(collision: CollisionModel) -> Iterator[str]:
    """What is in no other format at all."""
    robot, detector = collision.robot, collision.detector
    others = [name for name in robot.detectors if detector is None or name != detector.name]
    if others:
        yield f"the other detectors: {', '.join(others)}"
    if robot.tools:
        yield f"tools by name: {', '.join(robot.tools)}"
    if robot.conventions:
        yield f"conventions: {', '.join(robot.conventions)}"
    if robot.drive is not None or robot.wheels is not None or base_joints(robot):
        yield "the drive and the wheels of the base, whose x, y and yaw are three joints"
    if robot.provenance:
        yield "where numbers come from"


def describe_unheld(unheld: Iterable[str]) -> tuple[str, ...]:
    """Lines for the top of a file."""
    lines = tuple(f"* {what}" for what in unheld)
    return ("Not held:", *lines) if lines else ()

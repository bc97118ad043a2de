"""What files say about a robot's joints and detectors, in m and rad."""

from collections.abc import Mapping
from dataclasses import replace

from ikde.errors import InputError, nearest
from ikde.formats.entries import DetectorEntry, DetectorPartsEntry, UnitsEntry
from ikde.model.collision_model import CollisionModel
from ikde.model.detectors import check_detector
from ikde.model.robot import MAX_MAGNITUDE, Detector, Joint, Robot


def read_collision(robot: Robot, choice: str | DetectorEntry | None, units: UnitsEntry) -> CollisionModel:
    """What is compared: by a detector's name, one of the user's own, or the robot's; nothing for `none`."""
    if not isinstance(choice, DetectorEntry):
        return CollisionModel.of(robot, choice)
    own = make_detector(choice.name, choice, units)
    check_detector(robot, own, ())
    return CollisionModel(robot=robot, detector=own)


def make_detector(name: str, entry: DetectorPartsEntry, units: UnitsEntry) -> Detector:
    """A detector as it is written, not yet checked."""
    safe_distance_m = entry.safe_distance * units.length_m
    return Detector(name=name, spheres=entry.spheres, pairs=entry.pairs, safe_distance_m=safe_distance_m)


def with_ranges(robot: Robot, ranges: Mapping[str, list[float]], units: UnitsEntry) -> Robot:
    """The robot with other joint limits: narrower or wider, or some where a continuous joint has none."""
    lower = to_si(robot, "ranges", {name: interval[0] for name, interval in ranges.items()}, units)
    upper = to_si(robot, "ranges", {name: interval[1] for name, interval in ranges.items()}, units)
    for name in ranges:
        if not lower[name] <= upper[name]:
            raise InputError("the upper end of this range is below the lower one", ("ranges", name))
    if not ranges:
        return robot

    def narrow(joint: Joint) -> Joint:
        if joint.name not in ranges:
            return joint
        kind = "revolute" if joint.kind == "continuous" else joint.kind
        return replace(joint, kind=kind, lower=lower[joint.name], upper=upper[joint.name])

    before = robot.file_ranges or tuple(zip(*(bound.tolist() for bound in robot.drawn), strict=True))
    return replace(robot, joints=tuple(map(narrow, robot.joints)), file_ranges=before)


def to_si(robot: Robot, key: str, values: Mapping[str, float | None], units: UnitsEntry) -> dict[str, float]:
    """Joint values in m and rad; None stays None."""
    scale = {j.name: units.length_m if j.kind == "prismatic" else units.angle_rad for j in robot.joints}
    converted = {}
    for name, value in values.items():
        if name not in scale:
            known = nearest(name, scale) or f"; it has {', '.join(scale)}"
            raise InputError(f"{robot.name} has no joint {name!r}{known}", (key, name))
        converted[name] = None if value is None else value * scale[name]
        if value is not None and abs(converted[name]) > MAX_MAGNITUDE:
            raise InputError(f"expected at most {MAX_MAGNITUDE:g} m or rad, got {converted[name]:g}", (key, name))
    return converted

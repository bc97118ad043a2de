"""XML that other programs read robots from: names, numbers and the file itself; shared by URDF and MJCF."""

import re
import xml.etree.ElementTree as ET
from collections.abc import Iterable, Mapping
from pathlib import Path

from ikde.errors import InputError
from ikde.formats.atomic import write_named
from ikde.model.collision_model import CollisionModel
from ikde.model.names import find_free_name
from ikde.model.robot import WORLD, Robot
from ikde.model.spheres import Sphere
from ikde.model.tree import build_tree

_NO_XML = re.compile(r"[\x00-\x08\x0b\x0c\x0e-\x1f\ud800-\udfff\ufffe\uffff]")

# Placeholders of what a robot file does not hold: neither forward kinematics nor spheres depend on them.
MASS_KG, INERTIA_KG_M2 = 1.0, 0.01
EFFORT, VELOCITY = 100.0, 1.0
PLACEHOLDERS = (
    f"Masses ({MASS_KG:g} kg) and inertias ({INERTIA_KG_M2:g} kg m2) are placeholders: a robot of ikde is geometry. "
    "Put in your own before simulating."
)


def format_numbers(values: Iterable[float]) -> str:
    """Numbers as `0.5 -1.0 0.1`: each reads back as the same bits (a negative zero as zero)."""
    return " ".join(repr(float(value) + 0.0) for value in values)


def format_document(root: ET.Element, notes: Iterable[str]) -> str:
    """The document's text, indented, with `notes` as a comment on top."""
    ET.indent(root)
    text = ET.tostring(root, encoding="unicode")
    comment = "\n".join(f"  {re.sub('-(?=-|$)', '- ', note)}" for note in notes)  # XML forbids -- in comments
    bad = _NO_XML.search(text + comment)
    if bad:
        raise InputError(f"a name holds the character {bad[0]!r}, which XML cannot")
    return f'<?xml version="1.0"?>\n<!--\n{comment}\n-->\n{text}\n'


def reserve_name(wanted: str, taken: set[str]) -> str:
    """`wanted`, cut to the length of a name, with underscores at its end until nothing else is called so.

    Adds it to `taken`.
    """
    name = find_free_name(wanted, taken)
    taken.add(name)
    return name


def list_components(collision: CollisionModel) -> dict[str, list[Sphere]]:
    """Spheres of each component of a detector's approximation, in the frame of the joint that moves them."""
    components: dict[str, list[Sphere]] = {}
    for sphere in collision.spheres:
        components.setdefault(sphere.component, []).append(sphere)
    return components


def name_components(collision: CollisionModel) -> dict[str, str]:
    """Name of the link, or body, of each component: `component_<name>`, or another one if a frame is called so."""
    taken = {WORLD, *(frame.name for frame in collision.robot.frames)}
    return {component: reserve_name(f"component_{component}", taken) for component in list_components(collision)}


def list_carriers(robot: Robot) -> list[str]:
    """Name of the frame that stands where each of the tree's bodies does: that of its joint, or the world."""
    by_joint = {frame.joint: frame.name for frame in robot.frames}
    bodies = build_tree(robot).bodies
    return [WORLD if body.joint is None else by_joint[robot.joint_names[body.joint]] for body in bodies]


def describe_collision(collision: CollisionModel) -> str:
    """One line about where the collision shapes come from."""
    detector = collision.detector
    if detector is None:
        return "No collision shapes."
    return (
        f"Collision shapes: the spheres {detector.spheres!r} of the detector {detector.name!r}, a link a component; it "
        f"compares {len(collision.pairs)} pairs of components, safe distance {detector.safe_distance_m!r} m."
    )


def write_xml(path: Path, text: str, beside: Mapping[str, str] | None = None) -> None:
    """Write a whole file, and others in its folder by name, or none; raises `FileError` in one line."""
    write_named(path, text.encode(), {name: own.encode() for name, own in (beside or {}).items()})

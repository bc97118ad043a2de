"""Joints and frames of a robot from the tree of a URDF, with the base that it stands on."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from math import pi

import numpy as np

from ikde.io.urdf_import.chain import LinkTree
from ikde.io.urdf_import.description import Description, UrdfJoint
from ikde.io.urdf_import.held import HeldJoint
from ikde.io.urdf_import.options import ImportOptions
from ikde.io.xml_file import reserve_name
from ikde.kernels.arrays import Floats
from ikde.model.robot import MAX_MAGNITUDE, TOOL, WORLD, Frame, Joint
from ikde.model.rotation import rotation_about, rotation_with_z

FAR_M = 100.0
"""Limits of a sliding joint without any, either way."""


@dataclass(slots=True, kw_only=True)
class Skeleton:
    """Joints and frames as they are collected; `frame_of` is the frame of each link, or that which it is part of."""

    joints: list[Joint] = field(default_factory=list)
    frames: list[Frame] = field(default_factory=list)
    frame_of: dict[str, str] = field(default_factory=dict)
    parts: dict[str, tuple[str, Floats, Floats]] = field(default_factory=dict)
    """Link that is no frame -> the component that it is, and its place [3] and rotation [3, 3] in that frame."""
    notes: dict[str, str] = field(default_factory=dict)
    """Joint -> what is worth knowing about it."""
    warnings: list[str] = field(default_factory=list)
    joint_names: set[str] = field(default_factory=set)
    """Taken."""
    frame_names: set[str] = field(default_factory=set)

    @property
    def component_of(self) -> dict[str, str]:
        """The component that each link's spheres make: that of its name, unless the file says another one."""
        return self.frame_of | {link: component for link, (component, *_) in self.parts.items()}

    def add(self, name: str, parent: str, p: Floats, R: Floats, moved: tuple[Joint, Floats] | None = None) -> None:
        """A frame, and the joint that moves it about or along an axis."""
        joint, axis = moved or (None, None)
        if joint:
            self.joints.append(joint)
        self.frames.append(
            Frame(
                name=name,
                parent=parent,
                p_parent_frame=p,
                R_parent_frame=R,
                joint=joint.name if joint else None,
                axis=axis,
            )
        )


def build_skeleton(
    description: Description, tree: LinkTree, tool: str, options: ImportOptions, held: Mapping[str, HeldJoint]
) -> Skeleton:
    """Every link as a frame of its name; joints of the chain move, all others are part of what they connect."""
    skeleton = Skeleton(joint_names=set(description.joints), frame_names=set(description.links))
    _add_root(skeleton, tree.root, tool, options)
    for link in tree.order[1:]:
        joint = tree.joint_of[link]
        parent = skeleton.frame_of[joint.parent]
        if link in description.marks.components:
            skeleton.frame_of[link] = parent
            skeleton.parts[link] = description.marks.components[link], joint.p_parent_child, joint.R_parent_child
            continue
        name = _name_frame(skeleton, link, tool)
        p, R = joint.p_parent_child, joint.R_parent_child
        if joint.name in held:
            value = held[joint.name].value
            shift = value * joint.axis if joint.kind == "prismatic" else np.zeros(3)
            rotation = rotation_about(joint.axis, value) if joint.kind in ("revolute", "continuous") else np.eye(3)
            skeleton.add(name, parent, p + R @ shift, R @ rotation)
        elif joint.kind == "planar":
            _add_planar(skeleton, name, parent, joint, options)
        elif joint.kind == "fixed":
            skeleton.add(name, parent, p, R)
        else:
            skeleton.add(name, parent, p, R, (_to_joint(skeleton, joint), joint.axis))
    _follow_marks(skeleton, description.marks.joints)
    return skeleton


def _follow_marks(skeleton: Skeleton, marked: Mapping[str, float | None]) -> None:
    """Joints in the order of q in which they were written, with their accelerations; others stand before them."""
    order = {name: place for place, name in enumerate(marked)}
    skeleton.joints.sort(key=lambda joint: order.get(joint.name, -1))
    skeleton.joints = [replace(joint, max_acceleration=marked.get(joint.name)) for joint in skeleton.joints]


def _name_frame(skeleton: Skeleton, link: str, tool: str) -> str:
    """A link's own name, unless ikde calls something else so."""
    name = link
    if link == WORLD or (link == TOOL and tool != link):
        name = reserve_name(f"{link}_link", skeleton.frame_names)
        skeleton.warnings.append(f"the link {link!r} is called {name!r} here: {link!r} has a meaning of its own")
    skeleton.frame_of[link] = name
    return name


def _add_root(skeleton: Skeleton, root: str, tool: str, options: ImportOptions) -> None:
    """The root link: in the world, or on a base."""
    if not options.drives:
        if root == WORLD:
            skeleton.frame_of[root] = WORLD
        else:
            skeleton.add(_name_frame(skeleton, root, tool), WORLD, np.zeros(3), np.eye(3))
        return
    name, reach_m = _name_frame(skeleton, root, tool), options.base_reach_m
    x, y, yaw = (reserve_name(f"base_{key}", skeleton.joint_names) for key in ("x", "y", "yaw"))
    _add_plane(skeleton, (x, y, yaw), name, (WORLD, np.zeros(3), np.eye(3)), (np.eye(3), (-reach_m, reach_m)))


def _add_planar(skeleton: Skeleton, name: str, parent: str, joint: UrdfJoint, options: ImportOptions) -> None:
    """A planar joint: two prismatic joints in the plane, and a revolute one about its normal."""
    x, y, yaw = (reserve_name(f"{joint.name}_{key}", skeleton.joint_names) for key in ("x", "y", "yaw"))
    place = (parent, joint.p_parent_child, joint.R_parent_child)
    reach_m = options.base_reach_m
    is_given = joint.lower < joint.upper
    limits = _close_range(joint.lower, joint.upper, reach_m, about_zero=True) if is_given else (-reach_m, reach_m)
    _add_plane(skeleton, (x, y, yaw), name, place, (rotation_with_z(joint.axis), limits))
    for part in (x, y, yaw):
        skeleton.notes[part] = f"of the planar joint {joint.name}"


def _add_plane(
    skeleton: Skeleton,
    names: tuple[str, str, str],
    frame: str,
    place: tuple[str, Floats, Floats],
    plane: tuple[Floats, tuple[float, float]],
) -> None:
    """Joints `names` that move `frame` in a plane: x, y [m] and the rotation about its normal, columns of a matrix."""
    (x, y, yaw), (parent, p, R), (axes, (lower, upper)) = names, place, plane
    first, second = (reserve_name(name, skeleton.frame_names) for name in (x, y))
    home = _choose_home(lower, upper)
    prismatic = [Joint(name=name, kind="prismatic", lower=lower, upper=upper, home=home) for name in (x, y)]
    skeleton.add(first, parent, p, R, (prismatic[0], axes[:, 0]))
    skeleton.add(second, first, np.zeros(3), np.eye(3), (prismatic[1], axes[:, 1]))
    revolute = Joint(name=yaw, kind="continuous", home=0.0)
    skeleton.add(frame, second, np.zeros(3), np.eye(3), (revolute, axes[:, 2]))


def _to_joint(skeleton: Skeleton, joint: UrdfJoint) -> Joint:
    """A joint of the chain, its home at 0 or in mid-range."""
    given = {"name": joint.name, "max_speed": joint.max_speed, "max_effort": joint.max_effort}
    is_endless = joint.lower < -MAX_MAGNITUDE and joint.upper > MAX_MAGNITUDE
    if joint.kind == "continuous" or (joint.kind == "revolute" and is_endless):
        if joint.kind == "revolute":
            skeleton.notes[joint.name] = "no limits in the file: continuous"
        return Joint(**given, kind="continuous", home=0.0)
    is_prismatic = joint.kind == "prismatic"
    lower, upper = _close_range(joint.lower, joint.upper, FAR_M if is_prismatic else 2.0 * pi, is_prismatic)
    if (lower, upper) != (joint.lower, joint.upper):
        unit = "m" if is_prismatic else "rad"
        which = "no limits" if is_endless else "no lower limit" if lower != joint.lower else "no upper limit"
        skeleton.notes[joint.name] = f"{which} in the file: {lower:g} to {upper:g} {unit}"
    if lower == upper:
        skeleton.notes[joint.name] = f"cannot move: both limits are {lower:g}"
    kind = "prismatic" if is_prismatic else "revolute"
    return Joint(**given, kind=kind, lower=lower, upper=upper, home=_choose_home(lower, upper))


def _close_range(lower: float, upper: float, far: float, about_zero: bool) -> tuple[float, float]:
    """Limits with an end where there is none: `far` from 0 if the other end lies within, else from that end."""
    open_below, open_above = lower < -MAX_MAGNITUDE, upper > MAX_MAGNITUDE
    if open_below and open_above:
        return -far, far
    if open_below:
        return (-far if about_zero and upper > -far else upper - far), upper
    if open_above:
        return lower, (far if about_zero and lower < far else lower + far)
    return lower, upper


def _choose_home(lower: float, upper: float) -> float:
    """0, or the middle of a range without it."""
    return 0.0 if lower <= 0.0 <= upper else 0.5 * (lower + upper)

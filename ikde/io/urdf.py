"""A robot as URDF, for programs that read that: the same frames, joints, limits and spheres."""

import xml.etree.ElementTree as ET
from collections.abc import Iterator, Mapping

import numpy as np

from ikde.io.unheld import describe_unheld, list_unheld
from ikde.io.xml_file import (
    EFFORT,
    INERTIA_KG_M2,
    MASS_KG,
    VELOCITY,
    describe_collision,
    format_document,
    format_numbers,
    list_carriers,
    list_components,
    name_components,
    reserve_name,
)
from ikde.kernels.arrays import Floats
from ikde.model.arguments import RobotLike, read_robot
from ikde.model.collision_model import CollisionChoice, CollisionModel
from ikde.model.robot import WORLD, Frame, Inertia, Robot
from ikde.model.spheres import Sphere


def format_urdf(robot: RobotLike, *, collision: CollisionChoice = None) -> str:
    """The robot as the text of a URDF file, in m and rad.

    Every frame is a link of its name and every joint keeps its name; a fixed frame hangs on the joint `fixed_<frame>`.
    Each component is a link `component_<name>`, fixed to the link that its joint moves, so that pairs of components
    are pairs of links; its spheres are the collision (and visual) elements `<name>_0`, `<name>_1` and so on. A name
    that is taken gets an underscore. URDF cannot say which pairs count: `format_srdf` writes that. Of a joint without
    a speed or effort, and a link without a mass, there are placeholders. The element `<ikde>`, which others pass over,
    says which they are, names the tool, the joints in the order of q and the components, and has accelerations and the
    safe distance: `ikde.import_urdf` makes the same robot of it.

    Args:
        robot: the robot, its name or the path of its file.
        collision: whose spheres to write, as for `ikde.solve`.

    Raises:
        InputError: for an unknown detector, or a name that XML cannot hold.
    """
    robot = read_robot(robot)
    model = CollisionModel.of(robot, collision)
    robot = robot.whole
    root = ET.Element("robot", name=robot.name)
    links, joints = name_components(model), set(robot.joint_names)
    _add_link(root, WORLD)
    for frame in robot.frames:
        link = _add_link(root, frame.name)
        if frame.joint is not None or frame.name in robot.inertias:
            _add_mass(link, robot.inertias.get(frame.name))
        _add_joint(root, robot, frame, joints)
    carriers = list_carriers(robot)
    for component, spheres in list_components(model).items():
        link = _add_link(root, links[component])
        _add_spheres(link, component, spheres)
        joint = ET.SubElement(root, "joint", name=reserve_name(f"fixed_{link.attrib['name']}", joints), type="fixed")
        ET.SubElement(joint, "parent", link=carriers[spheres[0].body])
        ET.SubElement(joint, "child", link=link.attrib["name"])
    _add_marks(root, robot, links, model.limit_m)
    tool = f"The tool is the link {robot.tool!r}."
    unheld = describe_unheld(list_unheld(model, "URDF"))
    return format_document(root, (describe_collision(model), tool, *_note_placeholders(robot), *unheld))


def _add_link(root: ET.Element, name: str) -> ET.Element:
    return ET.SubElement(root, "link", name=name)


def _add_mass(link: ET.Element, known: Inertia | None) -> None:
    """The mass that is known, or a placeholder."""
    mass_kg, moments = (known.mass_kg, known.I_com_frame) if known else (MASS_KG, INERTIA_KG_M2 * np.eye(3))
    inertial = ET.SubElement(link, "inertial")
    if known:
        _add_origin(inertial, known.p_frame_com, np.eye(3))
    ET.SubElement(inertial, "mass", value=repr(mass_kg))
    places = {"ixx": (0, 0), "iyy": (1, 1), "izz": (2, 2), "ixy": (0, 1), "ixz": (0, 2), "iyz": (1, 2)}
    ET.SubElement(inertial, "inertia", {key: format_numbers([moments[place]]) for key, place in places.items()})


def _list_placeholders(robot: Robot) -> Iterator[dict[str, str]]:
    """What stands for something that is not known: `{joint or link: name, key: value}`."""
    for joint in robot.joints:
        missing = {"velocity": VELOCITY if joint.max_speed is None else None}
        missing |= {"effort": EFFORT if joint.max_effort is None else None}
        keys = {key: format_numbers([value]) for key, value in missing.items() if value is not None}
        if keys:
            yield {"joint": joint.name, **keys}
    for frame in robot.frames:
        if frame.joint is not None and frame.name not in robot.inertias:
            yield {"link": frame.name, "mass": repr(MASS_KG)}


def _note_placeholders(robot: Robot) -> Iterator[str]:
    keys = {key for own in _list_placeholders(robot) for key in own}
    if "mass" in keys:
        yield f"Masses ({MASS_KG:g} kg) and inertias ({INERTIA_KG_M2:g} kg m2) of <placeholder>: put in your own."
    for key, what in (
        ("effort", f"Efforts ({EFFORT:g} N or N m)"),
        ("velocity", f"Velocities ({VELOCITY:g} a second)"),
    ):
        if key in keys:
            yield f"{what} of <placeholder>: not known."


def _add_marks(root: ET.Element, robot: Robot, links: Mapping[str, str], limit_m: float) -> None:
    """What the elements of URDF cannot say, for an import."""
    own = ET.SubElement(root, "ikde", tool=robot.tool)
    if limit_m:
        own.attrib["safe_distance"] = format_numbers([limit_m])
    for joint in robot.joints:
        limit = joint.max_acceleration
        known = {} if limit is None else {"acceleration": format_numbers([limit])}
        ET.SubElement(own, "coordinate", {"joint": joint.name, **known})
    for component, link in links.items():
        ET.SubElement(own, "component", name=component, link=link)
    for placeholder in _list_placeholders(robot):
        ET.SubElement(own, "placeholder", placeholder)


def _add_joint(root: ET.Element, robot: Robot, frame: Frame, taken: set[str]) -> None:
    moving = next((joint for joint in robot.joints if joint.name == frame.joint), None)
    name = moving.name if moving else reserve_name(f"fixed_{frame.name}", taken)
    joint = ET.SubElement(root, "joint", name=name, type=moving.kind if moving else "fixed")
    ET.SubElement(joint, "parent", link=frame.parent)
    ET.SubElement(joint, "child", link=frame.name)
    _add_origin(joint, frame.p_parent_frame, frame.R_parent_frame)
    if moving and frame.axis is not None:
        ET.SubElement(joint, "axis", xyz=format_numbers(frame.axis))
        ends = {} if moving.kind == "continuous" else {"lower": moving.lower, "upper": moving.upper}
        effort, speed = moving.max_effort, moving.max_speed
        limits = {
            **ends,
            "effort": EFFORT if effort is None else effort,
            "velocity": VELOCITY if speed is None else speed,
        }
        ET.SubElement(joint, "limit", {key: format_numbers([value]) for key, value in limits.items()})


def _add_spheres(link: ET.Element, component: str, spheres: list[Sphere]) -> None:
    for kind in ("visual", "collision"):
        for index, sphere in enumerate(spheres):
            element = ET.SubElement(link, kind, name=f"{component}_{index}")
            _add_origin(element, sphere.p_body_sphere, np.eye(3))
            ET.SubElement(ET.SubElement(element, "geometry"), "sphere", radius=format_numbers([sphere.radius_m]))


def _add_origin(parent: ET.Element, p: Floats, R: Floats) -> None:
    ET.SubElement(parent, "origin", xyz=format_numbers(p), rpy=format_numbers(rpy_from_rotation(R)))


def rpy_from_rotation(R: Floats) -> Floats:
    """Roll, pitch, yaw [3] in rad about the fixed x, y, z axes, so that Rz(yaw) Ry(pitch) Rx(roll) = R [3, 3].

    Yaw is read off after roll is taken back, so that R comes back to rounding even where roll and yaw rotate about one
    axis, at a pitch of +-90 degrees.
    """
    roll = np.arctan2(R[2, 1], R[2, 2])
    pitch = np.arctan2(-R[2, 0], np.hypot(R[2, 1], R[2, 2]))
    s, c = np.sin(roll), np.cos(roll)
    yaw = np.arctan2(s * R[0, 2] - c * R[0, 1], c * R[1, 1] - s * R[1, 2])
    return np.array([roll, pitch, yaw])

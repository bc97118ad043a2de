"""A robot as URDF, for programs that read that: the same frames, joints, limits and spheres."""

import xml.etree.ElementTree as ET

import numpy as np

from ikde.io.xml_file import (
    EFFORT,
    INERTIA_KG_M2,
    MASS_KG,
    PLACEHOLDERS,
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
from ikde.model.robot import WORLD, Frame, Robot
from ikde.model.spheres import Sphere


def format_urdf(robot: RobotLike, *, collision: CollisionChoice = None) -> str:
    """The robot as the text of a URDF file, in m and rad.

    Every frame is a link of its name and every joint keeps its name; a fixed frame hangs on the joint `fixed_<frame>`.
    Each component is a link `component_<name>`, fixed to the link that its joint moves, so that pairs of components
    are pairs of links; its spheres are the collision (and visual) elements `<name>_0`, `<name>_1` and so on. A name
    that is taken gets an underscore. URDF cannot say which pairs count: `format_srdf` writes that.

    Args:
        robot: the robot, its name or the path of its file.
        collision: whose spheres to write, as for `ikde.solve`.

    Raises:
        InputError: for an unknown detector, or a name that XML cannot hold.
    """
    robot = read_robot(robot)
    model = CollisionModel.of(robot, collision)
    root = ET.Element("robot", name=robot.name)
    links, joints = name_components(model), set(robot.joint_names)
    _add_link(root, WORLD)
    for frame in robot.frames:
        _add_link(root, frame.name, has_mass=frame.joint is not None)
        _add_joint(root, robot, frame, joints)
    carriers = list_carriers(robot)
    for component, spheres in list_components(model).items():
        link = _add_link(root, links[component])
        _add_spheres(link, component, spheres)
        joint = ET.SubElement(root, "joint", name=reserve_name(f"fixed_{link.attrib['name']}", joints), type="fixed")
        ET.SubElement(joint, "parent", link=carriers[spheres[0].body])
        ET.SubElement(joint, "child", link=link.attrib["name"])
    limits = f"Efforts ({EFFORT:g} N or N m) and velocities ({VELOCITY:g} m/s or rad/s) are placeholders as well."
    ET.SubElement(root, "ikde", tool=robot.tool)
    tool = f"The tool is the link {robot.tool!r}."
    return format_document(root, (describe_collision(model), tool, PLACEHOLDERS, limits))


def _add_link(root: ET.Element, name: str, *, has_mass: bool = False) -> ET.Element:
    link = ET.SubElement(root, "link", name=name)
    if has_mass:
        inertial = ET.SubElement(link, "inertial")
        ET.SubElement(inertial, "mass", value=repr(MASS_KG))
        diagonal, zero = repr(INERTIA_KG_M2), "0.0"
        moments = {"ixx": diagonal, "iyy": diagonal, "izz": diagonal, "ixy": zero, "ixz": zero, "iyz": zero}
        ET.SubElement(inertial, "inertia", moments)
    return link


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
        limits = {**ends, "effort": EFFORT, "velocity": VELOCITY}
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

"""A robot as MJCF, MuJoCo's own format: the same frames, joints, limits, spheres, and contacts of compared pairs."""

import xml.etree.ElementTree as ET
from itertools import combinations, product

import numpy as np

from ikde.io.unheld import describe_unheld, list_unheld
from ikde.io.xml_file import (
    INERTIA_KG_M2,
    MASS_KG,
    PLACEHOLDERS,
    describe_collision,
    format_document,
    format_numbers,
    list_carriers,
    list_components,
    name_components,
)
from ikde.model.arguments import RobotLike, read_robot
from ikde.model.collision_model import CollisionChoice, CollisionModel
from ikde.model.robot import WORLD, Frame, Joint, Robot
from ikde.model.rotation import quat_wxyz_from_rotation

JOINT_TYPES = {"revolute": "hinge", "prismatic": "slide", "continuous": "hinge"}


def format_mjcf(robot: RobotLike, *, collision: CollisionChoice = None) -> str:
    """The robot as the text of an MJCF file, in m and rad; its contacts are the detector's collisions.

    Every frame is a body of its name and every joint keeps its name; the key frame `home` is the robot's home. Each
    component is a body `component_<name>`, fixed to the body that its joint moves, with its spheres as the geoms
    `<name>_0`, `<name>_1` and so on; a name that is taken gets an underscore. Pairs of components that the detector
    does not compare are excluded, so that MuJoCo has a contact where ikde sees a clearance below 0. The safe distance
    is not in the file, since MuJoCo's versions differ in what a margin is. Gravity is off.

    Args:
        robot: the robot, its name or the path of its file.
        collision: whose spheres and pairs to write, as for `ikde.solve`.

    Raises:
        InputError: for an unknown detector, or a name that XML cannot hold.
    """
    robot = read_robot(robot)
    model = CollisionModel.of(robot, collision)
    robot = robot.whole
    root = ET.Element("mujoco", model=robot.name)
    ET.SubElement(root, "compiler", angle="radian", autolimits="true")
    # MuJoCo would leave out every pair that shares a joint, whatever the detector says.
    ET.SubElement(ET.SubElement(root, "option", gravity="0 0 0"), "flag", filterparent="disable")
    ET.SubElement(ET.SubElement(root, "default"), "geom", type="sphere", density="0")
    bodies = _add_bodies(root, robot)
    _add_components(root, model, bodies)
    keys = ET.SubElement(root, "keyframe")
    home = {joint.name: joint.home for joint in robot.joints}
    moving = [home[frame.joint] for frame in robot.frames if frame.joint is not None]
    ET.SubElement(keys, "key", name="home", qpos=format_numbers(moving))
    tool = f"The tool is the body {robot.tool!r}."
    unheld = describe_unheld(list_unheld(model, "MJCF"))
    return format_document(root, (describe_collision(model), tool, PLACEHOLDERS, *unheld))


def _add_bodies(root: ET.Element, robot: Robot) -> dict[str, ET.Element]:
    bodies = {WORLD: ET.SubElement(root, "worldbody")}
    joints = {joint.name: joint for joint in robot.joints}
    for frame in robot.frames:
        quat = format_numbers(quat_wxyz_from_rotation(frame.R_parent_frame))
        place = format_numbers(frame.p_parent_frame)
        body = ET.SubElement(bodies[frame.parent], "body", name=frame.name, pos=place, quat=quat)
        bodies[frame.name] = body
        if frame.joint is not None:
            inertia = format_numbers([INERTIA_KG_M2] * 3)
            ET.SubElement(body, "inertial", pos="0 0 0", mass=repr(MASS_KG), diaginertia=inertia)
            _add_joint(body, frame, joints[frame.joint])
    return bodies


def _add_joint(body: ET.Element, frame: Frame, joint: Joint) -> None:
    # MuJoCo refuses an empty range: a joint that cannot move gets the smallest one.
    upper = max(joint.upper, float(np.nextafter(joint.lower, np.inf)))
    axis = format_numbers(frame.axis if frame.axis is not None else ())
    limits = {} if joint.kind == "continuous" else {"range": format_numbers([joint.lower, upper])}
    ET.SubElement(body, "joint", limits, name=joint.name, type=JOINT_TYPES[joint.kind], axis=axis)


def _add_components(root: ET.Element, collision: CollisionModel, bodies: dict[str, ET.Element]) -> None:
    carriers = list_carriers(collision.robot)
    components = list_components(collision)
    names = name_components(collision)
    for component, spheres in components.items():
        body = ET.SubElement(bodies[carriers[spheres[0].body]], "body", name=names[component])
        for index, sphere in enumerate(spheres):
            place = format_numbers(sphere.p_body_sphere)
            ET.SubElement(body, "geom", name=f"{component}_{index}", pos=place, size=format_numbers([sphere.radius_m]))
    compared = {frozenset(pair) for pair in collision.pairs}
    contact = ET.SubElement(root, "contact")
    for a, b in combinations(components, 2):
        if frozenset((a, b)) not in compared:
            ET.SubElement(contact, "exclude", body1=names[a], body2=names[b])
    for a, b in collision.pairs:
        if components[a][0].body == components[b][0].body:  # rigidly joined: MuJoCo compares only listed pairs
            for i, j in product(range(len(components[a])), range(len(components[b]))):
                ET.SubElement(contact, "pair", geom1=f"{a}_{i}", geom2=f"{b}_{j}")

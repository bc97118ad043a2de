"""What a robot's URDF cannot say, as SRDF: which pairs are not compared and why, and the home."""

import xml.etree.ElementTree as ET

from ikde.io.unheld import describe_unheld, list_unheld
from ikde.io.xml_file import describe_collision, format_document, format_numbers, list_components, name_components
from ikde.model.collision_model import CollisionChoice, CollisionModel
from ikde.model.robot import Robot

GROUP = "ikde"


def format_srdf(robot: Robot, *, collision: CollisionChoice = None) -> str:
    """The text of an SRDF file that belongs to what `format_urdf` writes for the same detector.

    The group `ikde` holds every joint of the robot, its state `home` their home in m and rad. Each pair of components
    that the detector does not compare is a `disable_collisions` of their links with the reason, and each that it does
    an `enable_collisions`, whatever joins them; its spheres are the `link_sphere_approximation` of its link.

    Args:
        robot: the robot.
        collision: whose pairs to write, as for `ikde.solve`.

    Raises:
        InputError: for an unknown detector, or a name that XML cannot hold.
    """
    model = CollisionModel.of(robot, collision)
    links, root = name_components(model), ET.Element("robot", name=robot.name)
    group = ET.SubElement(root, "group", name=GROUP)
    state = ET.SubElement(root, "group_state", name="home", group=GROUP)
    for joint in robot.joints:
        ET.SubElement(group, "joint", name=joint.name)
        ET.SubElement(state, "joint", name=joint.name, value=format_numbers([joint.home]))
    for component, spheres in list_components(model).items():
        approximation = ET.SubElement(root, "link_sphere_approximation", link=links[component])
        for sphere in spheres:
            center, radius = format_numbers(sphere.p_body_sphere), format_numbers([sphere.radius_m])
            ET.SubElement(approximation, "sphere", center=center, radius=radius)
    for pair in model.left_out_pairs:
        ET.SubElement(root, "disable_collisions", link1=links[pair.a], link2=links[pair.b], reason=pair.reason)
    for a, b in model.pairs:
        ET.SubElement(root, "enable_collisions", link1=links[a], link2=links[b])
    unheld = describe_unheld(list_unheld(model, "SRDF"))
    return format_document(root, (describe_collision(model), f"The tool is the link {robot.tool!r}.", *unheld))

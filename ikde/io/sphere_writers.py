"""A robot's spheres for other programs: cuRobo's robot file, and XRDF."""

from collections.abc import Iterable, Mapping
from typing import Any

from ikde.errors import printable
from ikde.io.sphere_files import Ball, Kind
from ikde.io.unheld import describe_unheld, list_unheld
from ikde.io.xml_file import list_components, name_components
from ikde.io.yaml_text import format_block
from ikde.model.arguments import RobotLike, read_robot
from ikde.model.collision_model import CollisionChoice, CollisionModel
from ikde.model.robot import WORLD, FreeSpheres, Robot
from ikde.model.spheres import Sphere

GEOMETRY = "ikde"
Links = dict[str, tuple[Ball, ...]]


def format_curobo(robot: RobotLike, *, collision: CollisionChoice = None, urdf_path: str = "") -> str:
    """The robot as the text of cuRobo's robot file, in m and rad: spheres, pairs that are ignored, joints and home.

    Where each component's spheres stand in a frame of its name, as an import from URDF makes them, links are those
    frames; otherwise components are the links of what `format_urdf` writes, which has those frames as links as well.

    Args:
        robot: the robot, its name or the path of its file.
        collision: whose spheres and pairs to write, as for `ikde.solve`.
        urdf_path: where cuRobo finds the URDF; nothing: it is left to be filled in.

    Raises:
        InputError: for an unknown detector.
    """
    model = CollisionModel.of(read_robot(robot), collision)
    names, links = _list_links(model)
    buffers = _list_buffers(model, links)
    accelerations = _max_accelerations(model.robot)
    kinematics = {
        "urdf_path": urdf_path,
        "base_link": _find_root(model.robot, names),
        "ee_link": model.robot.tool,
        "collision_link_names": list(links),
        "collision_spheres": {link: _entries(balls) for link, balls in links.items()},
        "collision_sphere_buffer": 0.0,
        "self_collision_ignore": _list_ignored(model, names),
        "self_collision_buffer": buffers,
        "cspace": {
            "joint_names": list(model.robot.joint_names),
            "retract_config": model.robot.home.tolist(),
            **({"max_acceleration": accelerations} if accelerations else {}),
        },
    }
    return _format(model, names, {"robot_cfg": {"kinematics": kinematics}}, "cuRobo")


def format_xrdf(robot: RobotLike, *, collision: CollisionChoice = None) -> str:
    """The robot as the text of an XRDF file, which stands beside a URDF: spheres, ignored pairs, joints, home and tool.

    Links are named as by `format_curobo`.

    Args:
        robot: the robot, its name or the path of its file.
        collision: whose spheres and pairs to write, as for `ikde.solve`.

    Raises:
        InputError: for an unknown detector.
    """
    model = CollisionModel.of(read_robot(robot), collision)
    names, links = _list_links(model)
    accelerations = _max_accelerations(model.robot)
    data: dict[str, Any] = {
        "format": "xrdf",
        "format_version": 1.0,
        "default_joint_positions": dict(zip(model.robot.joint_names, model.robot.home.tolist(), strict=True)),
        "cspace": {
            "joint_names": list(model.robot.joint_names),
            **({"acceleration_limits": accelerations} if accelerations else {}),
        },
        "tool_frames": [model.robot.tool],
    }
    if links:
        data |= {
            "collision": {"geometry": GEOMETRY},
            "self_collision": {
                "geometry": GEOMETRY,
                "buffer_distance": _list_buffers(model, links),
                "ignore": _list_ignored(model, names),
            },
            "geometry": {GEOMETRY: {"spheres": {link: _entries(balls) for link, balls in links.items()}}},
        }
    return _format(model, names, data, "XRDF")


def _list_links(model: CollisionModel) -> tuple[dict[str, str], Links]:
    """The link of each component, and the spheres of each link, m, in its frame."""
    if model.detector is None:
        return {}, {}
    rows = model.robot.approximations[model.detector.spheres]
    if all(isinstance(row, FreeSpheres) and row.component == row.frame for row in rows):
        own: dict[str, list[Ball]] = {}
        for row in rows:
            if isinstance(row, FreeSpheres):
                own.setdefault(row.frame, []).extend(row.spheres)
        return {component: component for component in own}, {link: tuple(balls) for link, balls in own.items()}
    names = name_components(model)
    return names, {
        names[component]: tuple(_ball(sphere) for sphere in spheres)
        for component, spheres in list_components(model).items()
    }


def _ball(sphere: Sphere) -> Ball:
    x, y, z = sphere.p_body_sphere.tolist()
    return x, y, z, float(sphere.radius_m)


def _find_root(robot: Robot, names: Mapping[str, str]) -> str:
    """The root link: the only frame whose parent is the world, if components are links of a URDF's own."""
    roots = [frame.name for frame in robot.frames if frame.parent == WORLD]
    is_own = bool(names) and all(component == link for component, link in names.items())
    return roots[0] if is_own and len(roots) == 1 and robot.frames[0].joint is None else WORLD


def _entries(balls: Iterable[Ball]) -> list[dict[str, Any]]:
    return [{"center": [x, y, z], "radius": r} for x, y, z, r in balls]


def _list_ignored(model: CollisionModel, names: Mapping[str, str]) -> dict[str, list[str]]:
    ignored: dict[str, list[str]] = {}
    for pair in model.left_out_pairs:
        ignored.setdefault(names[pair.a], []).append(names[pair.b])
    return ignored


def _list_buffers(model: CollisionModel, links: Links) -> dict[str, float]:
    """Half of the safe distance each: two links' buffers add up."""
    return dict.fromkeys(links, 0.5 * model.limit_m)


def _max_accelerations(robot: Robot) -> list[float]:
    """Of each joint; none unless all are known."""
    found = [joint.max_acceleration for joint in robot.joints if joint.max_acceleration is not None]
    return found if len(found) == len(robot.joints) else []


def _format(model: CollisionModel, names: Mapping[str, str], data: Mapping[str, Any], kind: Kind) -> str:
    """YAML with a comment on top: what it belongs to, and what it does not hold."""
    is_own = all(component == link for component, link in names.items())
    own = ", and the URDF that the robot comes from" if names and is_own else ""
    belongs = f"It belongs to what `ikde robots export --urdf` writes{own}."
    notes = [f"{kind}'s robot file" if kind == "cuRobo" else kind, f"of {model.robot.name}, by ikde; m and rad."]
    notes = [" ".join([*notes, belongs]), *describe_unheld(list_unheld(model, kind))]
    return "\n".join([*(f"# {printable(note)}" for note in notes), *format_block(data)]) + "\n"

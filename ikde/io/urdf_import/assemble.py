"""The robot out of its parts: spheres with their detector, pairs that are left out, a home that is free."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from ikde.errors import InputError
from ikde.io.robot_file import MAX_ENTRIES, MAX_JOINTS
from ikde.io.srdf import Srdf
from ikde.io.urdf_import.choose_pairs import SPHERES, ChosenPairs, PairChoice, choose_pairs
from ikde.io.urdf_import.cover_links import LinkSpheres
from ikde.io.urdf_import.description import Description
from ikde.io.urdf_import.frames import Skeleton
from ikde.io.urdf_import.free_home import find_free_home
from ikde.io.urdf_import.options import ImportOptions
from ikde.model.collision_model import CollisionModel
from ikde.model.robot import NO_DETECTOR, WORLD, Drive, FreeSpheres, Joint, Robot
from ikde.model.validate import check_robot

DRIVES: dict[str, Drive] = {"omni": "omnidirectional", "differential": "differential", "mecanum": "mecanum"}


def assemble(description: Description, skeleton: Skeleton, tool: str, options: ImportOptions) -> Robot:
    """The robot without spheres, not yet checked."""
    frames = {link: frame for link, frame in skeleton.frame_of.items() if frame != WORLD and link not in skeleton.parts}
    masses = {frame: description.links[link].inertia for link, frame in frames.items()}
    return Robot(
        name=description.name,
        title=f"from {description.path.name}",
        joints=tuple(skeleton.joints),
        frames=tuple(skeleton.frames),
        tool=tool,
        approximations={},
        adjacent=(),
        pair_lists={},
        detectors={},
        default_detector=NO_DETECTOR,
        convention="own",
        conventions={},
        provenance={},
        drive=DRIVES.get(options.base),
        inertias={frame: inertia for frame, inertia in masses.items() if inertia},
    )


def set_home(draft: Robot, values: Mapping[str, float]) -> Robot:
    """Joints at these values, within their limits; others stay."""

    def move(joint: Joint) -> Joint:
        return replace(joint, home=min(max(values.get(joint.name, joint.home), joint.lower), joint.upper))

    return replace(draft, joints=tuple(map(move, draft.joints)))


def add_spheres(draft: Robot, skeleton: Skeleton, covered: Mapping[str, LinkSpheres], ask: PairChoice) -> ChosenPairs:
    """The robot with spheres and a detector of the pairs that are chosen, checked."""
    free = _place_spheres(skeleton, covered)
    for what, number, most in (
        ("joints", len(draft.joints), MAX_JOINTS),
        ("frames", len(draft.frames), MAX_ENTRIES),
        ("spheres", sum(own.count for own in free), MAX_ENTRIES),
    ):
        if number > most:
            raise InputError(f"a robot has at most {most:,} {what}, and this one {number:,}", (what,))
    if not free:
        return ChosenPairs(robot=check_robot(draft), warnings=("no link has spheres: self-collision is not checked",))
    return choose_pairs(replace(draft, approximations={SPHERES: free}), skeleton.component_of, ask)


def _place_spheres(skeleton: Skeleton, covered: Mapping[str, LinkSpheres]) -> tuple[FreeSpheres, ...]:
    """The spheres of each link that has any, in its frame, or that which it is part of."""
    placed = []
    for link, own in covered.items():
        frame = skeleton.frame_of[link]
        component, p, R = skeleton.parts.get(link, (frame, np.zeros(3), np.eye(3)))
        rows = np.column_stack([own.centres @ R.T + p if link in skeleton.parts else own.centres, own.radii])
        if len(rows):
            balls = tuple((x, y, z, r) for x, y, z, r in rows.tolist())
            placed.append(FreeSpheres(component=component, frame=frame, spheres=balls))
    return tuple(placed)


def free_home(robot: Robot, states: tuple[str, ...], srdf: Srdf) -> tuple[Robot, str, bool | None]:
    """The robot with a home that is free if one is found, where it comes from, and whether it is free."""
    named = f"{srdf.source.removeprefix('the ')} state {', '.join(states)}"
    source = named if states else "0, or mid-range where 0 is outside the limits"
    if not robot.detectors:
        return robot, source, None
    found = find_free_home(CollisionModel.of(robot), robot.home)
    if found is None:
        return robot, f"{source}; it collides, and no free one was found near it", False
    if np.array_equal(found, robot.home):
        return robot, source, True
    return _with_home(robot, found.tolist()), f"{source}; moved to a free configuration near it", True


def _with_home(robot: Robot, home: list[float]) -> Robot:
    joints = tuple(replace(joint, home=value) for joint, value in zip(robot.joints, home, strict=True))
    return replace(robot, joints=joints)

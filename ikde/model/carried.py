"""A robot with what is attached to it as parts of its own: rows of spheres, and pairs behind those of the robot."""

from collections.abc import Sequence
from dataclasses import replace

from ikde.errors import InputError, nearest
from ikde.model.detectors import check_size
from ikde.model.pairs import component_bodies
from ikde.model.robot import Detector, FreeSpheres, LeftOutPair, Robot
from ikde.model.tree import build_tree
from ikde.model.world import Attached

ONE_BODY, ALLOWED = "one body", "may touch"


def carry(robot: Robot, detector: Detector, attached: Sequence[Attached]) -> Robot:
    """The robot that carries objects: each is one more component, compared with all others but those of its body.

    Raises `InputError` for a frame that the robot does not have or no joint moves, and for a component's name.
    """
    tree, rows = build_tree(robot), [*robot.approximations[detector.spheres]]
    bodies, pairs, left_out = (
        component_bodies(tuple(rows), tree),
        [*robot.pair_lists[detector.pairs]],
        [*robot.neighbours],
    )
    allowed = {thing.name: set(thing.may_touch) for thing in attached}
    for thing in attached:
        where, body = ("attached", thing.name), find_carrier(robot, thing.frame, ("attached", thing.name, "frame"))
        if thing.name in bodies:
            raise InputError(f"{robot.name} has a component of this name: give the obstacle another one", where)
        for other, other_body in bodies.items():
            may_touch = other in allowed[thing.name] or thing.name in allowed.get(other, ())
            if body == other_body or may_touch:
                reason = ONE_BODY if body == other_body else ALLOWED
                left_out.append(LeftOutPair(a=other, b=thing.name, reason=reason))
            else:
                pairs.append((other, thing.name))
        bodies[thing.name] = body
        rows.append(FreeSpheres(component=thing.name, frame=thing.frame, spheres=place_spheres(thing)))
    laden = replace(
        robot,
        approximations={**robot.approximations, detector.spheres: tuple(rows)},
        pair_lists={**robot.pair_lists, detector.pairs: tuple(pairs)},
        neighbours=tuple(left_out),
    )
    check_size(laden, detector, ("attached",))
    return laden


def find_carrier(robot: Robot, frame: str, where: tuple[str | int, ...]) -> int:
    """The body that carries a frame; raises `InputError` unless it is one of the robot's that a joint moves."""
    bodies = build_tree(robot).frame_body
    if frame not in bodies:
        raise InputError(f"{robot.name} has no frame {frame!r}{nearest(str(frame), bodies)}", where)
    if bodies[frame] == 0:
        raise InputError(f"no joint moves {frame!r}: what is fixed there is an obstacle", where)
    return bodies[frame]


def place_spheres(thing: Attached) -> tuple[tuple[float, float, float, float], ...]:
    """Centre and radius of each sphere of an attached object, in the frame that holds it, m."""
    R, p = thing.T_frame_object[:, :3], thing.T_frame_object[:, 3]
    rows = zip((thing.spheres[:, :3] @ R.T + p).tolist(), thing.spheres[:, 3].tolist(), strict=True)
    return tuple((x, y, z, radius) for (x, y, z), radius in rows)

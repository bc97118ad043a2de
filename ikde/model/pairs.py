"""Which components are neighbours, so that their contact means nothing, and why; all other pairs are non-adjacent."""

from itertools import combinations

from ikde.model.robot import LeftOutPair, Pairs, Robot, Spheres
from ikde.model.tree import Tree


def component_bodies(rows: tuple[Spheres, ...], tree: Tree) -> dict[str, int]:
    """Body of each component; a component's rows all lie on one body (`model.validate`)."""
    return {row.component: tree.frame_body[row.start] for row in rows}


def find_neighbours(robot: Robot, tree: Tree, bodies: dict[str, int]) -> tuple[LeftOutPair, ...]:
    """Every pair of components that is of one body, or joined by a joint, or declared adjacent in the robot's file.

    But for those that the file says are compared.
    """
    declared = {frozenset((pair.a, pair.b)): f"adjacent: {pair.reason}" for pair in robot.adjacent}
    compared = set(map(frozenset, robot.compared))
    reasons = {
        (a, b): declared.get(frozenset((a, b))) or describe_link(robot, tree, bodies[a], bodies[b])
        for a, b in combinations(bodies, 2)
        if frozenset((a, b)) not in compared
    }
    return tuple(LeftOutPair(a=a, b=b, reason=reason) for (a, b), reason in reasons.items() if reason)


def describe_link(robot: Robot, tree: Tree, a: int, b: int) -> str | None:
    """What links two bodies: they are one, or one joint of the tree joins them; None for all others.

    What the bodies carry, and those in between, does not matter.
    """
    if a == b:
        return "one body"
    for child, parent in ((a, b), (b, a)):
        joint = tree.bodies[child].joint
        if joint is not None and tree.bodies[child].parent == parent:
            return f"joined by joint {robot.joint_names[joint]}"
    return None


def non_adjacent_pairs(bodies: dict[str, int], neighbours: tuple[LeftOutPair, ...]) -> Pairs:
    """Every pair of components that are no neighbours."""
    left_out = {(pair.a, pair.b) for pair in neighbours}
    return tuple(pair for pair in combinations(bodies, 2) if pair not in left_out)


def explain_no_detector(robot: Robot) -> str:
    """Why a robot has no default detector, so that self-collision is not checked unless one is named."""
    if not any(robot.approximations.values()):
        return f"{robot.name} has no spheres"
    if not robot.detectors:
        return f"{robot.name} has spheres, but no detector"
    return f"the default detector of {robot.name} is none; it has {', '.join(robot.detectors)}"

"""Whether spheres of two bodies can touch, or can ever be free of each other, proved for all values of the joints.

A branch and bound over the joints between two bodies. A joint that turns by a moves what it carries by at most a times
the length that it carries, so in a box of joint values the smallest gap differs from that in its middle by no more than
the half-widths can move the spheres. A box that this decides is done, any other is halved.
"""

from typing import Literal, NamedTuple

import numpy as np

from ikde.kernels.arrays import COORDINATE, PARENT, PRISMATIC, CollisionArrays, Floats, RobotArrays

MAX_JOINTS = 4  # between two bodies; beyond it a proof is seldom worth its time
Answer = Literal["apart", "touching", "both", "unknown"]
"""Of a pair in all configurations: never within the limit, always, sometimes, or not decided within the budget."""


class Cluster(NamedTuple):
    """Spheres of one body, in its packed frame."""

    body: int
    centres: Floats
    """[n, 3] m"""
    radii: Floats
    """[n] m"""


class Chains(NamedTuple):
    """Two clusters, and the bodies from the last one that carries both (without it) to either, parents first."""

    sides: tuple[Cluster, Cluster]
    bodies: tuple[tuple[int, ...], tuple[int, ...]]

    @property
    def joined(self) -> list[int]:
        """Bodies of both chains: each has a joint that moves the clusters against each other."""
        return [*self.bodies[0], *self.bodies[1]]


class Verdict(NamedTuple):
    """What came of it."""

    answer: Answer
    depth_m: float = 0.0
    """Of `touching`: how far below the limit the gap stays by proof."""
    boxes: int = 0
    """Tried."""


def list_clusters(collision: CollisionArrays) -> list[Cluster]:
    """The spheres of each packed component, to which the indices in `collision.pairs` belong."""
    spans = collision.components.astype(int).tolist()
    centres, radii = collision.p_body_sphere.T, collision.radius
    return [Cluster(body, centres[first:last], radii[first:last]) for body, first, last in spans]


def find_chains(robot: RobotArrays, a: Cluster, b: Cluster) -> Chains:
    """The bodies between two clusters."""
    above = [_list_carriers(robot, side.body) for side in (a, b)]
    shared = max(set(above[0]) & set(above[1]))
    one, other = (tuple(body for body in chain[::-1] if body > shared) for chain in above)
    return Chains((a, b), (one, other))


def decide(robot: RobotArrays, chains: Chains, limit_m: float, ranges: tuple[Floats, Floats], boxes: int) -> Verdict:
    """Whether the smallest gap of the spheres stays above a limit, or stays at or below it.

    Args:
        robot: packed.
        chains: two clusters, as `find_chains` gives them.
        limit_m: gaps at or below it count as touching.
        ranges: lower and upper limits [N] of all joints, m or rad, finite.
        boxes: how many are tried before it is given up.
    """
    return _bound(robot, chains, limit_m, ranges, boxes, is_hit_enough=False)


def is_apart(robot: RobotArrays, chains: Chains, limit_m: float, ranges: tuple[Floats, Floats], boxes: int) -> bool:
    """Whether the gap is proved to stay above a limit; arguments as of `decide`.

    Given up at the first contact, and at once if more than 4 joints are in between.
    """
    return (
        len(chains.joined) <= MAX_JOINTS
        and _bound(robot, chains, limit_m, ranges, boxes, is_hit_enough=True).answer == "apart"
    )


def _bound(
    robot: RobotArrays,
    chains: Chains,
    limit_m: float,
    ranges: tuple[Floats, Floats],
    boxes: int,
    *,
    is_hit_enough: bool,
) -> Verdict:
    bodies = chains.joined
    joints = robot.bodies[bodies, COORDINATE].astype(int)
    lower, upper = _one_turn(robot, bodies, ranges[0][joints], ranges[1][joints])
    middles, halves = 0.5 * (lower + upper)[None], 0.5 * (upper - lower)[None]
    travel = _find_travel(robot, chains, np.maximum(np.abs(lower), np.abs(upper)))
    seen, is_free, is_hit, depth = 0, False, False, np.inf
    while len(middles):
        seen += len(middles)
        gaps = compute_gaps(robot, chains, middles) - limit_m
        is_free, is_hit = is_free or bool((gaps > 0.0).any()), is_hit or bool((gaps <= 0.0).any())
        if is_hit and (is_free or is_hit_enough):
            return Verdict("both" if is_free else "unknown", boxes=seen)
        if seen > boxes:
            return Verdict("unknown", boxes=seen)
        reach = halves @ travel
        left = (np.abs(gaps) <= reach) & (reach > 0.0)  # what cannot move is decided, at the limit itself as well
        if is_hit and not left.all():
            depth = min(depth, float((-gaps - reach)[~left].min()))
        middles, halves = _halve(middles[left], halves[left], travel)
    return Verdict("touching", depth, seen) if is_hit else Verdict("apart", boxes=seen)


def compute_gaps(robot: RobotArrays, chains: Chains, q: Floats) -> Floats:
    """Smallest gap [K], m, for the values `q` [K, J] of the joints of `chains.joined`."""
    (a, b), split = chains.sides, len(chains.bodies[0])
    one = _place(robot, chains.bodies[0], a, q[:, :split])
    other = _place(robot, chains.bodies[1], b, q[:, split:])
    gaps = np.linalg.norm(one[:, :, None] - other[:, None], axis=3)
    return (gaps - (a.radii[:, None] + b.radii)).min(axis=(1, 2))


def _list_carriers(robot: RobotArrays, body: int) -> list[int]:
    chain = [body]
    while chain[-1] != 0:
        chain.append(int(robot.bodies[chain[-1], PARENT]))
    return chain


def _one_turn(robot: RobotArrays, bodies: list[int], lower: Floats, upper: Floats) -> tuple[Floats, Floats]:
    """Ranges of which those of turning joints are one turn at most."""
    turns = robot.bodies[bodies, PRISMATIC] == 0
    return lower, np.where(turns, np.minimum(upper, lower + 2.0 * np.pi), upper)


def _halve(middles: Floats, halves: Floats, travel: Floats) -> tuple[Floats, Floats]:
    """Both halves of every box, cut across the joint that moves the spheres most."""
    if not len(middles):
        return middles, halves
    rows, widest = np.arange(len(middles)), (travel * halves).argmax(axis=1)
    halves = halves.copy()
    halves[rows, widest] *= 0.5
    shift = np.zeros_like(halves)
    shift[rows, widest] = halves[rows, widest]
    return np.concatenate([middles - shift, middles + shift]), np.concatenate([halves, halves])


def _place(robot: RobotArrays, bodies: tuple[int, ...], side: Cluster, q: Floats) -> Floats:
    """Centres [K, n, 3] of a cluster, seen from the body that carries all of its chain."""
    R, p = np.broadcast_to(np.eye(3), (len(q), 3, 3)), np.zeros((len(q), 3))
    for number, body in enumerate(bodies):
        T = robot.T_parent_body[body]
        p = p + R @ T[:, 3]
        R = R @ T[:, :3]
        if robot.bodies[body, PRISMATIC]:
            p = p + q[:, number, None] * R[:, :, 2]
        else:
            R = R @ _turns(q[:, number])
    return p[:, None] + np.einsum("kij,nj->kni", R, side.centres)


def _find_travel(robot: RobotArrays, chains: Chains, sizes: Floats) -> Floats:
    """How far one unit of each joint moves the spheres that it carries at most [J]; `sizes` [J] of its values."""
    split = len(chains.bodies[0])
    parts = ((chains.bodies[0], sizes[:split]), (chains.bodies[1], sizes[split:]))
    both = [_travel(robot, own, side, largest) for side, (own, largest) in zip(chains.sides, parts, strict=True)]
    return np.concatenate(both)


def _travel(robot: RobotArrays, bodies: tuple[int, ...], side: Cluster, sizes: Floats) -> Floats:
    """Of one chain: 1 for a prismatic joint, else the length that it carries; for the last, the distance from its axis.

    `sizes` [J]: the largest size of each joint's value; a prismatic joint lengthens the chain by as much.
    """
    length = float(np.linalg.norm(side.centres, axis=1).max())
    about_axis = float(np.linalg.norm(side.centres[:, :2], axis=1).max())
    travel = []
    for body, size in zip(reversed(bodies), reversed(sizes.tolist()), strict=True):
        is_prismatic = bool(robot.bodies[body, PRISMATIC])
        travel.append(1.0 if is_prismatic else length if travel else about_axis)
        length += float(np.linalg.norm(robot.T_parent_body[body][:, 3])) + (size if is_prismatic else 0.0)
    return np.array(travel[::-1])


def _turns(angle: Floats) -> Floats:
    R = np.zeros((len(angle), 3, 3))
    R[:, 0, 0] = R[:, 1, 1] = np.cos(angle)
    R[:, 1, 0] = np.sin(angle)
    R[:, 0, 1] = -R[:, 1, 0]
    R[:, 2, 2] = 1.0
    return R

"""Whether pairs of components touch always, sometimes or never: proved where it can be, else what random poses show."""

from functools import lru_cache
from typing import Literal, NamedTuple

import numpy as np

from ikde.kernels.arrays import COORDINATE
from ikde.model.apart import decide, find_chains, list_clusters
from ikde.model.collision_model import CollisionModel
from ikde.model.pack import pack_robot
from ikde.model.robot import Pairs
from ikde.solver.plain import compute_gaps
from ikde.solver.touching import CONFIGURATIONS, FIRST, count_at_once, draw_configurations

Touch = Literal["always", "sometimes", "never"]
BOXES = 10_000  # of joint values for one proof
EFFORT, ALL_EFFORT = 3e6, 6e7  # gaps of spheres for one proof, and for all of a robot: 1 s


class PairVerdict(NamedTuple):
    """What is known of one pair within the joints' ranges."""

    touches: Touch
    is_proved: bool
    """False: nothing else was seen in 1,000 random configurations."""
    joints: tuple[str, ...]
    """Those between the two."""
    depth_m: float = 0.0
    """Of what always touches: how deep at least, by proof."""

    @property
    def reason(self) -> str:
        """In words, with how it is known."""
        if not self.is_proved:
            seen = "in each" if self.touches == "always" else "in none"
            return f"{self.touches} touching: {seen} of {CONFIGURATIONS:,} random configurations"
        deep = f"{1e3 * self.depth_m:.3g} mm deep at least, " if self.depth_m > 1e-4 else ""
        how = f"proved for all values of {', '.join(self.joints)}" if self.joints else "they do not move"
        return f"{self.touches} touching: {deep}{how}"


def judge_pairs(collision: CollisionModel) -> dict[tuple[str, str], PairVerdict]:
    """What is known of each compared pair; contact is a clearance at or below the safe distance.

    All pairs are compared in 1,000 random configurations inside the limits, the same every time. Of those that touch in
    all or in none, a branch and bound over the joints in between tries to prove it (`model.apart`). What it does not
    prove within its budget, for a pair and for all, is not called proved. Nothing without a detector.
    """
    return dict(_judge(collision))


@lru_cache(maxsize=64)
def _judge(collision: CollisionModel) -> tuple[tuple[tuple[str, str], PairVerdict], ...]:
    if not collision.pairs:
        return ()
    robot, packed = collision.robot, pack_robot(collision.robot)
    clusters, left, found = list_clusters(collision.arrays), ALL_EFFORT, []
    places, seen = collision.arrays.pairs.astype(int).tolist(), _try(collision)
    for pair, (a, b), touches in zip(collision.pairs, places, seen, strict=True):
        chains = find_chains(packed, clusters[a], clusters[b])
        joints = tuple(robot.joint_names[int(packed.bodies[body, COORDINATE])] for body in chains.joined)
        verdict = PairVerdict(touches, touches == "sometimes", joints)
        size = len(clusters[a].radii) * len(clusters[b].radii)
        boxes = int(min(BOXES, min(EFFORT, left) / size))
        if touches != "sometimes" and boxes > 0:
            proof = decide(packed, chains, collision.limit_m, robot.drawn, boxes)
            left -= proof.boxes * size
            verdict = {
                "apart": PairVerdict("never", True, joints),
                "touching": PairVerdict("always", True, joints, proof.depth_m),
                "both": PairVerdict("sometimes", True, joints),
                "unknown": verdict,
            }[proof.answer]
        found.append((pair, verdict))
    return tuple(found)


def _try(collision: CollisionModel) -> list[Touch]:
    """Whether each pair touches in all of the random configurations, in some or in none."""
    drawn, done = draw_configurations(collision.robot), 0
    is_hit, is_free = (dict.fromkeys(collision.pairs, False) for _ in range(2))
    pairs: Pairs = collision.pairs
    while pairs and done < CONFIGURATIONS:
        piece = drawn[done : done + min(count_at_once(collision, pairs), FIRST if done == 0 else CONFIGURATIONS)]
        hits = compute_gaps(collision, piece, pairs) <= collision.limit_m
        for pair, own in zip(pairs, np.moveaxis(hits, -1, 0), strict=True):
            is_hit[pair], is_free[pair] = is_hit[pair] or bool(own.any()), is_free[pair] or not own.all()
        pairs = tuple(pair for pair in pairs if not (is_hit[pair] and is_free[pair]))
        done += len(piece)
    return [("sometimes" if is_free[pair] else "always") if is_hit[pair] else "never" for pair in collision.pairs]

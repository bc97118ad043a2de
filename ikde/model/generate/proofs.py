"""Tests that can be left out: implied by another one, or proved never to fail, whatever the joints do.

The proof is a branch and bound over the joints between two bodies. A joint that turns by a moves what it carries by at
most a times the length of the chain it carries, so a box of joint values whose middle is farther from contact than its
half-widths can move the spheres is free of contact; other boxes are halved. What is not proved within the budget stays.
"""

import numpy as np

from ikde.kernels.arrays import COORDINATE, PARENT, PRISMATIC, Floats, RobotArrays
from ikde.model.collision_model import CollisionModel
from ikde.model.generate.collision import Test
from ikde.model.generate.lattice import Lattice

BOXES = 4_000  # tested for one proof before it is given up
SAMPLES = 512
MARGINS_M = (0.01, 0.1, 1.0)  # proofs hold up to such a safe distance; beyond the last nothing is proved
MAX_JOINTS = 4  # between two bodies; beyond it a proof is hopeless


def proof_margin(collision: CollisionModel) -> float:
    """What proofs must allow for."""
    return next((margin for margin in MARGINS_M if collision.limit_m < margin), np.inf)


def drop_implied(tests: list[Test]) -> list[Test]:
    """Without tests that cannot fail unless another one fails too: a smaller sphere inside one of the same body."""
    kept = []
    for test in tests:
        if not any(_implies(other, test) for other in tests if other is not test):
            kept.append(test)
    return kept


def drop_proved(robot: RobotArrays, tests: list[Test], margin: float, lower: Floats, upper: Floats) -> list[Test]:
    """Without tests proved to stay farther apart than their reach and `margin` for lower <= q <= upper [N]."""
    return [test for test in tests if not _is_apart(robot, test, margin, lower, upper)]


def _implies(other: Test, test: Test) -> bool:
    """True if `other` fails whenever `test` does."""
    for (lattice, sphere), (wider, larger) in (
        ((test.lattice, test.sphere), (other.lattice, other.sphere)),
        ((test.lattice, test.sphere), (other.sphere, other.lattice)),
    ):
        if lattice.body != wider.body or sphere.body != larger.body:
            continue
        if _covers(wider, lattice) and _covers(larger, sphere):
            equal = _covers(lattice, wider) and _covers(sphere, larger)
            return not equal or other.pair < test.pair
    return False


def _covers(outer: Lattice, inner: Lattice) -> bool:
    """True if every sphere of `inner` lies inside one of `outer`."""
    gaps = np.linalg.norm(outer.centres[:, None] - inner.centres[None], axis=2)
    return bool((gaps.min(axis=0) <= outer.radius - inner.radius).all())


def estimate_hits(robot: RobotArrays, tests: list[Test], lower: Floats, upper: Floats) -> Floats:
    """Which of some random configurations fail each test [tests, K]: a guess at what is worth looking at first."""
    q = np.random.default_rng(0).uniform(lower, upper, (SAMPLES, len(lower)))
    hits = np.zeros((len(tests), SAMPLES), dtype=bool)
    for row, test in zip(hits, tests, strict=True):
        near, far, bodies = _chain(robot, test)
        if bodies is not None:
            row[:] = _distances(robot, bodies, near, far, q[:, robot.bodies[bodies, COORDINATE]]) <= test.reach
    return hits


def _is_apart(robot: RobotArrays, test: Test, margin: float, lower: Floats, upper: Floats) -> bool:
    near, far, bodies = _chain(robot, test)
    if bodies is None or len(bodies) > MAX_JOINTS:
        return False
    joints = robot.bodies[bodies, COORDINATE]
    lower, upper, reach, seen = lower[joints], upper[joints], test.reach + margin, 0
    middles, halves = 0.5 * (lower + upper)[None], 0.5 * (upper - lower)[None]
    travel = _travel(robot, bodies, far, np.maximum(np.abs(lower), np.abs(upper)))
    while len(middles):
        seen += len(middles)
        gaps = _distances(robot, bodies, near, far, middles) - reach
        if seen > BOXES or (gaps <= 0.0).any():
            return False
        left = gaps <= halves @ travel
        middles, halves = _halve(middles[left], halves[left], travel)
    return True


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


def _chain(robot: RobotArrays, test: Test) -> tuple[Lattice, Lattice, list[int] | None]:
    """Both sides of a test and the bodies after the near one up to the far one; None if the near one carries it not."""
    near, far = sorted((test.lattice, test.sphere), key=lambda side: side.body)
    bodies = [far.body]
    while bodies[-1] not in (near.body, 0):
        bodies.append(int(robot.bodies[bodies[-1], PARENT]))
    return near, far, bodies[-2::-1] if bodies[-1] == near.body else None


def _distances(robot: RobotArrays, bodies: list[int], near: Lattice, far: Lattice, q: Floats) -> Floats:
    """Smallest distance [K] between centres for the values `q` [K, J] of the joints of `bodies`."""
    R, p = np.broadcast_to(np.eye(3), (len(q), 3, 3)), np.zeros((len(q), 3))
    for number, body in enumerate(bodies):
        T = robot.T_parent_body[body]
        p = p + R @ T[:, 3]
        R = R @ T[:, :3]
        if robot.bodies[body, PRISMATIC]:
            p = p + q[:, number, None] * R[:, :, 2]
        else:
            R = R @ _turns(q[:, number])
    centres = p[:, None] + np.einsum("kij,nj->kni", R, far.centres)
    return np.linalg.norm(centres[:, :, None] - near.centres, axis=3).min(axis=(1, 2))


def _travel(robot: RobotArrays, bodies: list[int], far: Lattice, farthest: Floats) -> Floats:
    """How far one unit of each joint moves the far spheres at most [J]: 1 for a slide, else the length it carries.

    `farthest` [J]: the largest size of each joint's value; a slide lengthens the chain by as much.
    """
    length = float(np.linalg.norm(far.centres, axis=1).max())
    travel = []
    for body, size in zip(reversed(bodies), reversed(farthest.tolist()), strict=True):
        slides = bool(robot.bodies[body, PRISMATIC])
        travel.append(1.0 if slides else length)
        length += float(np.linalg.norm(robot.T_parent_body[body][:, 3])) + (size if slides else 0.0)
    return np.array(travel[::-1])


def _turns(angle: Floats) -> Floats:
    R = np.zeros((len(angle), 3, 3))
    R[:, 0, 0] = R[:, 1, 1] = np.cos(angle)
    R[:, 1, 0] = np.sin(angle)
    R[:, 0, 1] = -R[:, 1, 0]
    R[:, 2, 2] = 1.0
    return R

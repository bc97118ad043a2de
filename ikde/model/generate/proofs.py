"""Tests that can be left out: implied by another one, or proved never to fail, whatever the joints do (`apart.py`)."""

import numpy as np

from ikde.kernels.arrays import COORDINATE, Floats, RobotArrays
from ikde.model.apart import Chains, Cluster, compute_gaps, find_chains, is_apart
from ikde.model.collision_model import CollisionModel
from ikde.model.generate.collision import Test
from ikde.model.generate.lattice import Lattice

BOXES = 4_000  # tested for one proof before it is given up
SAMPLES = 512
MARGINS_M = (0.01, 0.1, 1.0)  # proofs hold up to such a safe distance; beyond the last nothing is proved


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
    return [t for t in tests if not is_apart(robot, _find_chains(robot, t), margin, (lower, upper), BOXES)]


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
        chains = _find_chains(robot, test)
        row[:] = compute_gaps(robot, chains, q[:, robot.bodies[chains.joined, COORDINATE]]) <= 0.0
    return hits


def _find_chains(robot: RobotArrays, test: Test) -> Chains:
    sides = (
        Cluster(one.body, one.centres, np.full(len(one.centres), one.radius)) for one in (test.lattice, test.sphere)
    )
    return find_chains(robot, *sides)

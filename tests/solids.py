"""Solids of every kind, and points about them."""

import numpy as np

from ikde.model.rotation import rotation_from_rpy
from ikde.model.solids import SIZES, make_solid
from ikde.model.world import make_obstacle, make_world

CONVEX = ("sphere", "box", "cylinder", "capsule", "cone", "half_space", "hull")


def random_solid(kind, rng, T=None):
    """One of this kind, of 2 to 40 cm."""
    points = {"hull": (12, 0.3), "cloud": (200, 0.5)}.get(kind)
    own = None if points is None else rng.uniform(-points[1], points[1], (points[0], 3))
    return make_solid(kind, rng.uniform(0.02, 0.4, len(SIZES[kind])), T, own)


def random_pose(rng, far=1.0):
    """A pose [3, 4] up to so many m away."""
    return np.hstack([rotation_from_rpy(rng.uniform(-3.0, 3.0, 3)), rng.uniform(-far, far, (3, 1))])


def random_world(rng, count, kinds=(*CONVEX, "cloud"), far=1.0, **options):
    """Obstacles of one or two solids each, of all kinds in turn, called o0, o1 and so on."""
    obstacles = []
    for k in range(count):
        solids = [random_solid(kinds[(k + j) % len(kinds)], rng, random_pose(rng, 0.1)) for j in range(1 + k % 2)]
        obstacles.append(make_obstacle(f"o{k}", solids, random_pose(rng, far), **options))
    return make_world(obstacles)

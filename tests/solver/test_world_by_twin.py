"""What `check_many` and `solve` say in random worlds is what distances by other means say (`tests/world_twin.py`)."""

import numpy as np

import ikde
from ikde.model.collision_model import CollisionModel
from tests import reference
from tests.solids import random_world
from tests.three_joints import ROBOT, free_q, meet
from tests.world_twin import measure_placed

OWN = CollisionModel.of(ROBOT)
KEPT = {"hand": 0.03}


def draw_model(rng, count):
    """A world of all kinds, about a robot whose foot and post may touch it, with margins of all sorts."""
    world = random_world(rng, count, far=0.9, margin_m=0.01, ignore=("floor", "post"))
    return OWN.in_world(world, 0.02, KEPT)


def list_gaps(model, q):
    """By (component, obstacle) the distance, and what is asked for, m."""
    found = {}
    for name, P, radii in list_spheres(q):
        for obstacle in model.world.active:
            if name not in obstacle.ignore:
                gap = float((measure_placed(obstacle, P) - radii).min())
                found[name, obstacle.name] = gap, obstacle.margin_m + KEPT.get(name, 0.02)
    return found


def list_spheres(q):
    """Names of components, the centres [K, 3] of their spheres in the world, and their radii [K], m."""
    spheres = reference.list_spheres(ROBOT, OWN.detector, q)
    for name in dict.fromkeys(sphere[0] for sphere in spheres):
        own = [sphere for sphere in spheres if sphere[0] == name]
        yield name, np.array([sphere[1] for sphere in own]), np.array([sphere[2] for sphere in own])


def test_clearances_and_verdicts_in_random_worlds(rng):
    verdicts = []
    for count in (1, 2, 8, 3, 5, 8):
        model, Q = draw_model(rng, count), rng.uniform(ROBOT.lower, ROBOT.upper, (12, 3))
        rows = ikde.check_many(ROBOT, Q, model)
        own_m = rows.gaps_m[:, : len(model.pairs)].min(axis=1)
        for k, q in enumerate(Q):
            found = list_gaps(model, q)
            of_pair = dict(zip(rows.pairs[len(model.pairs) :], rows.gaps_m[k, len(model.pairs) :], strict=True))
            assert max(abs(of_pair[pair] - gap) for pair, (gap, _) in found.items()) < 1e-12
            assert all(np.isinf(gap) for pair, gap in of_pair.items() if pair not in found)
            short = {pair: gap - asked for pair, (gap, asked) in found.items()}
            assert bool(rows.collision[k]) == (min(short.values()) <= 0.0 or own_m[k] <= model.limit_m)
            deepest = min(short, key=lambda pair: short[pair])
            if short[deepest] < own_m[k] - model.limit_m:
                assert rows.pairs[rows.closest_pair[k]] == deepest
                assert abs(rows.clearance_m[k] - found[deepest][0]) < 1e-12
            verdicts.append(bool(rows.collision[k]))
    assert 0 < sum(verdicts) < len(verdicts)


def test_what_solve_reaches_in_random_worlds_is_free(rng):
    reached = 0
    for count, q in zip((1, 3, 6, 8), free_q(4), strict=True):
        model = draw_model(rng, count)
        result = ikde.solve(ROBOT, meet(ROBOT, q, "position"), collision=model, near=q)
        is_free = all(gap > asked for gap, asked in list_gaps(model, result.q).values())
        assert is_free or not result.reached
        reached += result.reached
    assert reached

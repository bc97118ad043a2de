"""A robot of three joints that holds things, and a judge of its own: which pairs are compared, and how far apart."""

import numpy as np

from ikde.model.collision_model import CollisionModel
from ikde.model.solids import make_solid
from ikde.model.world import make_obstacle
from tests import reference
from tests.three_joints import ROBOT
from tests.world_twin import measure_placed

OWN = CollisionModel.of(ROBOT)
STICK = [[0.1, 0.0, 0.0, 0.05], [0.2, 0.0, -0.1, 0.05], [0.3, 0.0, -0.2, 0.06]]
"""Centres and radii of what is held, m."""


def place(x=0.0, y=0.0, z=0.0):
    T = np.eye(4)
    T[:3, 3] = x, y, z
    return T


def hold(world, *, margin_m=0.0, may_touch=(), ball=True):
    """The world with a stick in the hand and, if asked, a ball on the sleeve that the arm may touch."""
    solid = make_solid("sphere", (0.02,))
    world = world.add(make_obstacle("stick", [solid], margin_m=margin_m), make_obstacle("ball", [solid]))
    world = world.attach("stick", "tip", T_frame_object=place(0.01, 0.0, 0.04), spheres=STICK, may_touch=may_touch)
    if not ball:
        return world.remove("ball")
    spheres = [[0.0, 0.05, 0.0, 0.04]]
    return world.attach("ball", "sleeve", T_frame_object=place(0.08, 0.0, 0.1), spheres=spheres, may_touch=("floor",))


BODIES = {"floor": "world", "post": "column", "arm": "sleeve", "hand": "rod"}
"""What moves the robot's own components."""
CARRIED = {"stick": "rod", "ball": "sleeve"}


def list_placed(model, q):
    """Of each component its name, and the centres [K, 3] and radii [K] of its spheres in the world, m."""
    found, Ts_world = {}, reference.compute_frames(ROBOT, q)
    for name, centre, radius in reference.list_spheres(ROBOT, OWN.detector, q):
        found.setdefault(name, []).append((*centre, radius))
    for thing in model.world.attached:
        T = Ts_world[thing.frame] @ np.vstack([thing.T_frame_object, [0, 0, 0, 1]])
        found[thing.name] = [(*(T[:3, :3] @ (x, y, z) + T[:3, 3]), r) for x, y, z, r in thing.spheres]
    return {name: (np.array(rows)[:, :3], np.array(rows)[:, 3]) for name, rows in found.items()}


def list_gaps(model, q):
    """By pair the distance, and what is asked for, m: of the robot's list, of what it holds, and of obstacles."""
    placed, found = list_placed(model, q), {}
    touch = {thing.name: thing.may_touch for thing in model.world.attached}
    own_m = {thing.name: thing.obstacle.margin_m for thing in model.world.attached}
    moved = {**BODIES, **CARRIED}
    names = list(placed)
    for k, b in enumerate(names):
        for a in names[:k]:
            held = b in touch and moved[a] != moved[b] and a not in touch[b] and b not in touch.get(a, ())
            if held or {a, b} in [set(pair) for pair in OWN.pairs]:
                (P, r), (Q, s) = placed[a], placed[b]
                gap = np.linalg.norm(P[:, None] - Q, axis=2) - r[:, None] - s
                found[a, b] = float(gap.min()), model.limit_m
    for name, (P, r) in placed.items():
        for obstacle in model.world.active:
            if name not in ("floor", *obstacle.ignore) and obstacle.name not in touch.get(name, ()):
                asked = obstacle.margin_m + dict(model.margins_m).get(name, model.margin_m) + own_m.get(name, 0.0)
                found[name, obstacle.name] = float((measure_placed(obstacle, P) - r).min()), asked
    return found


def is_free(model, q):
    """By these distances."""
    return all(gap > asked for gap, asked in list_gaps(model, q).values())

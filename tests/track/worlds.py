"""A made-up motion in a made-up world."""

import numpy as np

import ikde
from ikde.model.collision_model import CollisionModel
from ikde.solver.plain import compute_components
from ikde.track.moving import ObjectMotion
from tests.track.measured import make_measured

OBSTACLES = {
    "floor": {"half_space": {}, "position": [0, 0, -0.5]},
    "post": {"cylinder": {"radius": 0.05, "height": 0.4}, "position": [0.74, -0.3, 0.96]},
    "far": {"sphere": {"radius": 0.1}, "position": [0, 0, 60]},
    "dust": {"cloud": {"points": [[0.3, 0.45, 0.4], [0.4, 0.48, 0.5], [0.5, 0.5, 0.6]], "radius": 0.01}},
}


TOUCHED = {"ball": {"sphere": {"radius": 0.05}, "position": [0.74, -0.2, 0.96]}}
"""What the elbow touches on its way, but neither at its start nor at its end."""


def make_among(robot, margin_m=0.0, obstacles=None, margins_m=None, **changes):
    """A waving motion of `make_measured` among obstacles; the elbow comes nearest to the post in its middle."""
    world = ikde.load_world({"obstacles": OBSTACLES if obstacles is None else obstacles})
    model = CollisionModel.of(robot).in_world(world, margin_m, margins_m)
    return make_measured(robot, detector=model, **{"amplitude": 0.5, **changes})


def make_passing(robot, places=((1.5, -0.5, 1), (1.5, 0.5, 1))):
    """The waving motion beside a post, while a ball passes from one place to another in 0.4 s."""
    obstacles = {"ball": {"sphere": {"radius": 0.1}}, "post": OBSTACLES["post"]}
    poses = [np.column_stack([np.eye(3), p]) for p in places]
    moving = {"ball": ObjectMotion(times_s=np.array([0.0, 0.4]), T_world_object=np.array(poses))}
    return make_among(robot, obstacles=obstacles, moving=moving)


def measure_apart(motion, name):
    """Distance of the nearest sphere to the ball `name` at each sample [M + 1], m, by another formula."""
    ball, model = motion.collision.world[name], motion.collision
    found = []
    for component, (centres, radii) in compute_components(model, motion.trajectory.q).items():
        if component not in ball.ignore:
            away = np.linalg.norm(centres - ball.T_world_obstacle[:, 3], axis=-1)
            found.append((away - radii).min(axis=1) - ball.solids[0].size_m[0])
    return np.min(found, axis=0)

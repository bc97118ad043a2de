"""What is placed when it is asked for stands where everything is placed at once."""

import numpy as np
import pytest

from ikde.kernels.frames import compute_bodies
from ikde.kernels.placing import PLACED, place_bodies, place_bounds, place_component
from ikde.kernels.spheres import compute_bounds, compute_centres
from ikde.model.collision_model import CollisionModel
from ikde.model.pack import pack_robot
from tests.collision_robots import RANDOM, SHIPPED, name_case
from tests.conftest import random_q


@pytest.mark.parametrize("case", [*SHIPPED, *RANDOM[:3]], ids=name_case)
def test_bodies_middles_and_spheres_are_those_of_the_graders(case, rng):
    robot, detector = case
    arrays, collision = pack_robot(robot), CollisionModel(robot=robot, detector=detector).arrays
    q, count = random_q(robot, rng, 1)[0], len(collision.components)
    T, expected = np.empty((len(arrays.bodies), 3, 4)), np.empty((len(arrays.bodies), 3, 4))
    bounds, middles = np.full((count, 4), np.nan), np.empty((count, 3))
    centres, all_centres = np.full((3, collision.radius.size), np.nan), np.empty((3, collision.radius.size))
    place_bodies.plain(arrays, q, T)
    place_bounds.plain(collision, T, bounds)
    compute_bodies.plain(arrays, q, expected)
    compute_bounds.plain(collision, expected, middles)
    compute_centres.plain(collision, expected, all_centres)
    assert np.abs(T - expected).max() < 1e-14
    assert np.abs(bounds[:, :3] - middles).max(initial=0.0) < 1e-14
    assert not bounds[:, PLACED].any()
    for component in rng.permutation(count):
        first, last = (int(end) for end in collision.components[component, 1:])
        assert np.isnan(centres[:, first:last]).all()
        place_component.plain(collision, T, component, bounds, centres)
        assert np.abs(centres - all_centres)[:, first:last].max() < 1e-14
        before = centres.copy()
        place_component.plain(collision, T * np.nan, component, bounds, centres)  # there already
        assert centres.tobytes() == before.tobytes()

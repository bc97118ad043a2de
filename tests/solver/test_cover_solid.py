"""Spheres hold all of a solid, and stand out of it by what is said."""

import numpy as np
import pytest

from ikde.errors import InputError
from ikde.model.solids import make_solid
from ikde.solver.cover_solid import FEW, cover_solids
from ikde.solver.plain_world import measure_solid
from tests.solids import CONVEX, random_pose, random_solid

KINDS = tuple(kind for kind in CONVEX if kind != "half_space")


def list_inside(solid, rng, count=400):
    """Points [K, 3] of the object's frame in a solid, many of them near its surface."""
    P = rng.uniform(-0.7, 0.7, (60 * count, 3)) @ solid.T_obstacle_solid[:, :3].T + solid.T_obstacle_solid[:, 3]
    return P[measure_solid(solid, P) <= 0.0][:count]


@pytest.mark.parametrize("kind", KINDS)
def test_all_of_a_solid_is_held(kind, rng):
    solid = random_solid(kind, rng, random_pose(rng, 0.2))
    spheres, out_m = cover_solids([solid], 0.03 if kind != "hull" else 0.06)
    P = list_inside(solid, rng)
    away = np.linalg.norm(P[:, None] - spheres[:, :3], axis=2) - spheres[:, 3]
    assert len(P) > 20
    assert away.min(axis=1).max() <= 1e-9
    ways = rng.normal(size=(300, 3))
    ways /= np.linalg.norm(ways, axis=1, keepdims=True)
    farthest = measure_solid(solid, spheres[:, None, :3] + spheres[:, None, 3:] * ways).max()
    assert farthest <= out_m + 1e-9 <= 0.06 + 1e-9


def test_a_cones_tip_and_rim_are_held(rng):
    cone = make_solid("cone", (0.05, 0.2))
    spheres, out_m = cover_solids([cone], 0.012)
    angles = np.linspace(0.0, 6.3, 50)
    rim = np.column_stack([0.05 * np.cos(angles), 0.05 * np.sin(angles), np.full(50, -0.1)])
    P = np.vstack([rim, [[0.0, 0.0, 0.1]]])
    assert (np.linalg.norm(P[:, None] - spheres[:, :3], axis=2) - spheres[:, 3]).min(axis=1).max() <= 0.0
    assert 0.0 < out_m <= 0.012


def test_few_spheres_unless_the_protrusion_is_asked_for():
    for solid in (make_solid("box", (0.3, 0.2, 0.1)), make_solid("cylinder", (0.04, 0.12))):
        spheres, out_m = cover_solids([solid])
        assert len(spheres) <= FEW
        finer, less_m = cover_solids([solid], 0.006)
        assert len(finer) > len(spheres)
        assert less_m <= 0.006 < out_m
    ball = cover_solids([make_solid("sphere", (0.1,))])
    assert (ball.spheres.tolist(), ball.protrusion_m) == ([[0.0, 0.0, 0.0, 0.1]], 0.0)


def test_several_solids_each_in_its_place():
    far = np.eye(4)
    far[0, 3] = 1.0
    spheres, _ = cover_solids([make_solid("sphere", (0.1,)), make_solid("sphere", (0.2,), far)])
    assert spheres.tolist() == [[0.0, 0.0, 0.0, 0.1], [1.0, 0.0, 0.0, 0.2]]


def test_what_has_no_end_or_no_inside_is_refused():
    with pytest.raises(InputError, match="a half-space has no end"):
        cover_solids([make_solid("half_space")])
    with pytest.raises(InputError, match="a cloud has no inside: give it as solids"):
        cover_solids([make_solid("cloud", (0.01,), None, [[0, 0, 0]])])
    for kind, size in (("box", (9.0, 9.0, 9.0)), ("cylinder", (9.0, 9.0))):
        with pytest.raises(InputError, match=r"protrusion_m: more than 2,000 spheres .* 1 mm at most: allow more$"):
            cover_solids([make_solid(kind, size)], 0.001)
    with pytest.raises(InputError, match="more than 2,000 spheres would be needed"):
        cover_solids([make_solid("cone", (9.0, 9.0))], 0.001)


def test_an_equal_object_is_not_covered_again():
    one, other = (cover_solids([make_solid("cylinder", (0.04, 0.1))]) for _ in range(2))
    assert one is other
    assert not one.spheres.flags.writeable

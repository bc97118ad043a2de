"""Obstacles to draw: every polygon lies on its solid, whichever way that is posed."""

import numpy as np
import pytest

from ikde.io.world_file import load_world
from ikde.model.rotation import rotation_from_rpy
from ikde.model.solids import make_solid
from ikde.model.world import World, make_obstacle, make_world
from ikde.scene.drawn_world import MAX_POINTS, draw_world
from tests.world_files import write_good

T = np.eye(4)[:3]
T[:, :3], T[:, 3] = rotation_from_rpy(np.array([0.3, -0.5, 2.0])), [1.0, 2.0, 3.0]


def draw(kind, sizes=(), points=None):
    """What is drawn of one solid, back in its own frame."""
    solid = make_solid(kind, sizes, T, points)
    (obstacle,) = draw_world(make_world([make_obstacle("a", [solid], T)]), "t").obstacles
    (drawn,) = obstacle.solids
    P = np.concatenate([*drawn.polygons_m, drawn.points_m])
    for _ in range(2):
        P = (P - T[:, 3]) @ T[:, :3]
    return P, drawn


@pytest.mark.parametrize(
    ("kind", "sizes", "half"),
    [
        ("sphere", (0.5,), (0.5, 0.5, 0.5)),
        ("box", (1, 2, 3), (0.5, 1, 1.5)),
        ("cylinder", (0.5, 3), (0.5, 0.5, 1.5)),
        ("capsule", (0.5, 3), (0.5, 0.5, 2)),
        ("cone", (0.5, 3), (0.5, 0.5, 1.5)),
    ],
)
def test_a_solid_is_drawn_in_its_size(kind, sizes, half):
    P, drawn = draw(kind, sizes)
    assert np.abs(P).max(axis=0) == pytest.approx(half)
    assert not drawn.is_endless
    assert not len(drawn.points_m)


def test_a_hull_is_drawn_by_its_triangles():
    P, drawn = draw("hull", points=np.vstack([np.zeros(3), np.eye(3)]))
    assert len(drawn.polygons_m) == 4
    assert P.min() == pytest.approx(0, abs=1e-12)


def test_a_cloud_is_drawn_by_some_of_its_points():
    points = np.random.default_rng(1).normal(size=(3 * MAX_POINTS, 3))
    P, drawn = draw("cloud", (0.01,), points)
    assert 0 < len(drawn.points_m) <= MAX_POINTS
    assert np.allclose(P, points[::3])


def test_of_a_half_space_its_surface_is_drawn():
    P, drawn = draw("half_space")
    assert drawn.is_endless
    assert np.allclose(P[:, 2], 0.0, atol=1e-9)


def test_all_of_a_world(tmp_path):
    world = load_world(write_good(tmp_path))
    drawn = draw_world(world, "kitchen")
    assert [obstacle.name for obstacle in drawn.obstacles] == list(world.names)
    assert [obstacle.name for obstacle in drawn.obstacles if not obstacle.is_on] == ["can", "scan"]
    assert drawn.title == "kitchen  ·  frame flange"
    assert draw_world(World(), "empty").box_m.tolist() == [[0, 0, 0], [0, 0, 0]]

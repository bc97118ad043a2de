"""Points on the robot are removed and counted: those within its spheres and the padding, no others."""

import numpy as np
import pytest

import ikde
from ikde.errors import InputError
from ikde.model.collision_model import CollisionModel
from ikde.model.solids import make_solid
from ikde.model.world import make_obstacle, make_world
from ikde.solver.clear_cloud import clear_cloud
from ikde.solver.plain import compute_components

UR5 = ikde.load_robot("ur5")
Q = np.array([0.3, -1.2, 1.1, 0.2, 0.7, -0.4])
BOX = make_obstacle("box", [make_solid("box", [0.1] * 3, [[1, 0, 0, 2], [0, 1, 0, 0], [0, 0, 1, 0]])])


def measure(points_world, q=Q):
    """Distance of points from the nearest sphere of the robot, m."""
    placed = compute_components(CollisionModel.of(UR5), q).values()
    centres, radii = np.concatenate([c for c, _ in placed]), np.concatenate([r for _, r in placed])
    return (np.linalg.norm(points_world[:, None] - centres, axis=2) - radii).min(axis=1)


def make_scan(rng, radius=0.002, group=None):
    """A cloud about the robot, turned and moved twice; and its points in the world."""
    points = rng.uniform(-0.6, 0.6, (4000, 3))
    turn, move = np.eye(4), np.eye(4)
    turn[:3, :3], move[:3, 3] = [[0, -1, 0], [1, 0, 0], [0, 0, 1]], [0.1, 0.0, 0.3]
    solid = make_solid("cloud", [radius], turn[:3], points)
    return make_obstacle("scan", [solid], move, group=group), points @ turn[:3, :3].T + move[:3, 3]


@pytest.mark.parametrize("padding_m", [0.0, 0.02])
def test_what_lies_on_the_robot_is_removed_and_counted(padding_m, rng):
    scan, places = make_scan(rng)
    world, removed = clear_cloud(make_world([BOX, scan]), UR5, Q, padding_m=padding_m)
    is_on = measure(places) <= padding_m + 0.002
    assert removed == is_on.sum() > 20
    assert world["box"] is BOX
    np.testing.assert_array_equal(world["scan"].solids[0].points, scan.solids[0].points[~is_on])
    assert world["scan"].solids[0].size_m == scan.solids[0].size_m
    gaps = [row.clearance_m for row in ikde.check(UR5, Q, world).obstacles if row.obstacle == "scan"]
    assert gaps[0] > padding_m


def test_nothing_else_is_touched(rng):
    scan, _ = make_scan(rng, group="scans")
    off = make_world([BOX, scan], ["scans"])
    assert clear_cloud(off, UR5, Q) == (off, 0)
    far = make_world([make_obstacle("far", [make_solid("cloud", [1e-6], points=rng.uniform(5, 6, (10, 3)))])])
    assert clear_cloud(far, UR5, Q) == (far, 0)


def test_a_cloud_of_which_nothing_is_left_is_left_out():
    centre = next(iter(compute_components(CollisionModel.of(UR5), Q).values()))[0][:1]
    scan = make_obstacle("scan", [make_solid("cloud", [1e-6], points=centre)], group="scans")
    world, removed = clear_cloud(make_world([scan, BOX]), UR5, Q)
    assert (world.names, removed) == (("box",), 1)


def test_what_the_robot_holds_is_part_of_it():
    ball = make_obstacle("ball", [make_solid("sphere", [0.05])], np.eye(4))
    T = np.eye(4)
    T[:3, 3] = 0.0, 0.0, 0.3
    held = make_world([ball]).attach("ball", "tool", robot=UR5, T_frame_object=T)
    where = (ikde.forward(UR5, Q)["tool"] @ T)[:3, 3]
    scan = make_obstacle("scan", [make_solid("cloud", [1e-6], points=[where, where + 1.0])])
    world, removed = clear_cloud(held.add(scan), UR5, Q)
    assert removed == 1
    assert world.attached == held.attached
    assert clear_cloud(make_world([scan]), UR5, Q)[1] == 0


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"padding_m": -1.0}, "padding_m: expected a distance of at least 0 m, got -1.0"),
        ({"world": 3}, "world: expected a World, got 3"),
        ({"collision": "none"}, "collision: ur5 has no spheres"),
        ({"q": [0.0]}, "q: expected"),
    ],
)
def test_what_is_wrong_is_said(change, message, rng):
    given = {"world": make_world([make_scan(rng)[0]]), "robot": UR5, "q": Q, **change}
    with pytest.raises(InputError) as caught:
        clear_cloud(given.pop("world"), given.pop("robot"), given.pop("q"), **given)
    assert str(caught.value).startswith(message)


def test_a_frame_that_the_robot_does_not_have_is_named():
    scan = make_obstacle("scan", [make_solid("cloud", [1e-6], points=[[0, 0, 0]])], frame="tabel")
    with pytest.raises(InputError, match="tabel"):
        clear_cloud(make_world([scan]), UR5, Q)

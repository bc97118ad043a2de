"""What of a world is drawn beside a robot: cut where the picture ends, in the robot's frames, with who touches it."""

import numpy as np

from ikde.model.collision_model import CollisionModel
from ikde.model.pack_world import find_fixed_frames
from ikde.model.solids import make_solid
from ikde.model.world import make_obstacle, make_world
from ikde.scene.drawn_near import cut_polygon, reach_obstacle
from ikde.scene.drawn_pose import Role, draw_pose
from ikde.solver.plain import compute_components
from tests.three_joints import ROBOT, free_q

OWN, Q = CollisionModel.of(ROBOT), free_q(1)[0]
UP = np.array([0.0, 0.0, 1.0])
UNIT = np.array([np.zeros(3), np.ones(3)])
SQUARE = np.array([[-1.0, -1.0, 0.5], [3.0, -1.0, 0.5], [3.0, 3.0, 0.5], [-1.0, 3.0, 0.5]])


def ball(name, p, radius=0.02, **options):
    T = np.eye(4)
    T[:3, 3] = p
    return make_obstacle(name, [make_solid("sphere", (radius,))], T, **options)


def draw(*obstacles, margin_m=0.0):
    return draw_pose(OWN.in_world(make_world(list(obstacles)), margin_m), Q)


def roles_of(pose):
    return dict(zip(pose.robot.components, pose.robot.roles, strict=True))


def test_a_polygon_is_cut_to_a_box():
    cut = cut_polygon(SQUARE, UNIT)
    assert {tuple(corner) for corner in cut.tolist()} == {(0, 0, 0.5), (1, 0, 0.5), (1, 1, 0.5), (0, 1, 0.5)}
    assert len(cut_polygon(SQUARE + UP, UNIT)) == 0
    inside = 0.5 * UNIT[1] + 0.1 * np.eye(3)
    assert cut_polygon(inside, UNIT).tolist() == inside.tolist()


def test_the_component_and_the_obstacle_that_touch_are_marked():
    hand = compute_components(OWN, Q)["hand"][0].mean(axis=0)
    pose = draw(ball("bead", hand), ball("arm", hand + 0.3 * UP))  # called like a component, and free
    assert roles_of(pose)["hand"] == Role.COLLIDING
    assert roles_of(pose)["arm"] != Role.COLLIDING
    assert [(o.name, o.is_touched) for o in pose.obstacles] == [("bead", True), ("arm", False)]
    assert pose.title.endswith("in collision with the world")
    assert pose.marks[0].text.startswith("closest pair, ")
    assert pose.marks[1].text.startswith("closest, hand - bead: -")
    assert pose.marks[1].text.endswith(" mm")


def test_a_pose_that_is_free_says_so_and_a_margin_counts():
    centre = compute_components(OWN, Q)["hand"][0][-1]
    near = ball("bead", centre + 0.13 * UP)
    assert draw(near).title.endswith("free of self-collision and of the world")
    asked = draw(near, margin_m=0.2)
    assert asked.obstacles[0].is_touched
    assert asked.marks[1].text.endswith(" mm, 200 mm asked for")


def test_what_is_far_is_left_out_and_a_plane_ends_with_the_picture():
    floor = make_obstacle("ground", [make_solid("half_space")], [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, -0.3]])
    pose = draw(ball("moon", (50.0, 0.0, 0.0)), ball("planet", (0.0, 0.0, 40.0), 39.0), floor)
    names = [obstacle.name for obstacle in pose.obstacles]
    assert "moon" not in names
    assert np.ptp(pose.compute_box(), axis=0).max() < 5.0


def test_the_nearest_point_lies_on_the_obstacle():
    obstacle, spheres = ball("ball", (1.0, 2.0, 3.0), 0.5), (np.array([[1.0, 2.0, 5.0], [9.0, 9.0, 9.0]]), np.ones(2))
    T = np.eye(4)
    np.testing.assert_allclose(reach_obstacle(obstacle, spheres, {"world": T}), [[1, 2, 5], [1, 2, 3.5]], atol=1e-6)


def test_obstacles_stand_in_frames_of_the_robot():
    frame, T = max(find_fixed_frames(ROBOT).items(), key=lambda known: np.abs(known[1] - np.eye(4)).max())
    (drawn,) = draw(ball("ball", 0.4 * UP, frame=frame)).obstacles
    middle = np.concatenate(drawn.solids[0].polygons_m).mean(axis=0)
    np.testing.assert_allclose(middle, T[:3, 3] + 0.4 * T[:3, :3] @ UP, atol=0.02)

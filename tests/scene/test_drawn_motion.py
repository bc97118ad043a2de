"""A motion as data: the robot at its samples, in the roles that were measured there."""

import numpy as np
import pytest

import ikde
from ikde.scene.drawn_motion import (
    MAX_OBSTACLES,
    choose_frames,
    choose_moments,
    draw_motion,
    list_nearest,
    spread_samples,
)
from ikde.solver.plain_world import measure_obstacle
from tests.track.measured import make_measured
from tests.track.worlds import TOUCHED, make_among, make_passing


@pytest.fixture(scope="module")
def motion(qiao):
    return make_measured(qiao, further=5)


@pytest.fixture(scope="module")
def folded(qiao):
    return make_measured(qiao, amplitude=2.6)


def test_samples_are_spread_from_first_to_last(qiao, motion):
    assert spread_samples(motion, 3).tolist() == [0, 10, 20]
    assert spread_samples(motion, 251).tolist() == list(range(21))


def test_moments_are_even_where_nothing_collides(motion):
    assert choose_moments(motion, 8) == [0, 3, 6, 9, 11, 14, 17, 20]


def test_a_short_motion_shows_each_sample_once(qiao):
    assert choose_moments(make_measured(qiao, steps=2), 8) == [0, 1, 2]


def test_a_collision_nearby_is_shown_instead(folded):
    chosen = choose_moments(folded, 3)
    assert any(folded.colliding[k] for k in chosen)
    assert folded.grade.gaps_m.min() == folded.grade.gaps_m[chosen].min()


def test_each_frame_is_the_robot_at_its_sample(qiao, motion):
    drawn = draw_motion(motion, [2, 20])
    assert drawn.samples.tolist() == [2, 20]
    np.testing.assert_allclose(drawn.times_s, [0.04, 0.4])
    assert drawn.duration_s == 0.5
    np.testing.assert_array_equal(drawn.path_m, motion.trajectory.path.p_world_tool)
    for frame, sample in enumerate(drawn.samples):
        tool = ikde.forward(qiao, motion.trajectory.q[sample])["tool"][:3, 3]
        np.testing.assert_allclose(drawn.robot.links_m[frame, -1], tool, atol=1e-12)


def test_components_collide_that_were_measured_to_collide(folded):
    drawn = draw_motion(folded, range(21))
    assert [set(drawn.list_colliding(frame)) for frame in range(21)] == folded.colliding
    assert drawn.robot.centres_m.shape == (21, len(drawn.robot.radii_m), 3)


def test_without_a_detector_nothing_collides(qiao):
    drawn = draw_motion(make_measured(qiao, detector="none"), [0, 5])
    assert [drawn.list_colliding(frame) for frame in range(2)] == [[], []]
    assert drawn.robot.centres_m.shape == (2, 0, 3)


@pytest.fixture(scope="module")
def among(qiao):
    return make_among(qiao)


def test_obstacles_near_the_motion_are_drawn_and_far_ones_are_not(among):
    drawn = draw_motion(among, [0, 20])
    assert [obstacle.name for obstacle in drawn.obstacles] == ["post", "dust"]
    assert drawn.touched == (frozenset(), frozenset())
    box = drawn.robot.compute_box(np.eye(3))
    corners = np.concatenate([*drawn.obstacles[0].solids[0].polygons_m, drawn.obstacles[1].solids[0].points_m])
    assert (np.abs(corners - box.mean(axis=0)) < np.ptp(box, axis=0).max()).all()


def test_the_moment_of_least_room_is_marked_where_it_is(qiao, among):
    found, seen = draw_motion(among, [0]).nearest, [ikde.check(qiao, q, among.collision) for q in among.trajectory.q]
    least = [next(row.clearance_m for row in one.obstacles if row.obstacle == "post") for one in seen]
    assert (found.sample, found.obstacle) == (int(np.argmin(least)), "post")
    assert found.clearance_m == pytest.approx(min(least))
    assert found.kept_m == 0.0
    gap = measure_obstacle(among.collision.world["post"], found.points_m)
    np.testing.assert_allclose(gap[1], 0.0, atol=1e-6)
    np.testing.assert_allclose(np.linalg.norm(np.diff(found.points_m, axis=0)), gap[0], atol=1e-6)
    assert found.component == next(row.component for row in seen[found.sample].obstacles if row.obstacle == "post")


def test_that_moment_is_among_frames_and_views(among):
    sample = among.closest_obstacle[0]
    assert sample not in spread_samples(among, 4)
    assert sorted({*spread_samples(among, 4).tolist(), sample}) == choose_frames(among, 4).tolist()
    assert sample in choose_moments(among, 4)
    assert len(choose_moments(among, 4)) == 4


def test_margins_are_what_is_asked_for_there(qiao):
    found = draw_motion(make_among(qiao, 0.02), [0]).nearest
    assert found.kept_m == pytest.approx(0.02)
    assert found.clearance_m == pytest.approx(draw_motion(make_among(qiao), [0]).nearest.clearance_m)


def test_what_is_touched_is_known_by_frame(qiao):
    motion = make_among(qiao, obstacles=TOUCHED)
    touched = [bool(names) for names in motion.touched]
    assert any(touched)
    assert not all(touched)
    drawn = draw_motion(motion, range(21))
    assert [bool(names) for names in drawn.touched] == touched
    assert set().union(*drawn.touched) == {"ball"}


def test_of_many_obstacles_the_nearest_are_drawn(qiao):
    balls = {f"b{k}": {"sphere": {"radius": 0.01}, "position": [0.1 * k - 20, 1.5, 1.0]} for k in range(300)}
    motion = make_among(qiao, obstacles=balls)
    chosen = [obstacle.name for obstacle in list_nearest(motion)]
    gaps = motion.grade.gaps_m[:, len(motion.collision.pairs) :].reshape(21, -1, 300).min(axis=(0, 1))
    assert len(chosen) == MAX_OBSTACLES
    assert set(chosen) == {f"b{k}" for k in np.argsort(gaps)[:MAX_OBSTACLES]}
    assert chosen == sorted(chosen, key=lambda name: int(name[1:]))


def test_without_a_world_nothing_of_one_is_drawn(motion):
    drawn = draw_motion(motion, [0, 5])
    assert (drawn.obstacles, drawn.nearest) == ((), None)
    assert choose_frames(motion, 3).tolist() == spread_samples(motion, 3).tolist()


def test_what_moves_is_drawn_where_it_is(qiao):
    motion = make_passing(qiao)
    drawn = draw_motion(motion, [0, 10, 20])
    assert [obstacle.name for obstacle in drawn.obstacles] == ["post"]
    ((ball, poses),) = drawn.moved
    assert ball.name == "ball"
    np.testing.assert_allclose(poses[:, :, 3], [[1.5, -0.5, 1], [1.5, 0, 1], [1.5, 0.5, 1]], atol=1e-12)
    for frame, y in enumerate((-0.5, 0.0, 0.5)):
        there = drawn.list_obstacles(frame)[-1]
        points = np.concatenate(there.solids[0].polygons_m)
        np.testing.assert_allclose(np.linalg.norm(points - [1.5, y, 1.0], axis=1), 0.1, atol=1e-12)


def test_the_least_room_is_where_what_moves_was(qiao):
    motion = make_passing(qiao, [[0.74, -1.0, 0.96], [0.74, -0.1, 0.96]])
    found = draw_motion(motion, [0]).nearest
    assert found.obstacle == "ball"
    assert found.sample > 0
    _, (p,) = motion.trajectory.moving["ball"].place(np.array([0.02 * found.sample]))
    away = np.linalg.norm(found.points_m - p, axis=1)
    assert away[1] == pytest.approx(0.1, abs=1e-5)
    radius = away[0] - 0.1 - found.clearance_m
    assert 0.04 < radius < 0.27  # of the sphere that is nearest

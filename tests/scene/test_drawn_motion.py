"""A motion as data: the robot at its samples, in the roles that were measured there."""

import numpy as np
import pytest

import ikde
from ikde.scene.drawn_motion import choose_moments, draw_motion, spread_samples
from tests.track.measured import make_measured


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

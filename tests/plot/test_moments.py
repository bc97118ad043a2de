"""Views of the robot: as many as asked for, collisions first."""

from dataclasses import replace

import numpy as np
import pytest
from matplotlib.colors import to_rgb
from matplotlib.patches import Circle

from ikde.plot.images import to_png
from ikde.plot.moments import choose_moments, plot_moments
from ikde.plot.pose import COLLIDING
from tests.track.measured import make_measured


@pytest.fixture(scope="module")
def motion(qiao):
    return make_measured(qiao)


@pytest.fixture(scope="module")
def folded(qiao):
    return make_measured(qiao, amplitude=2.6)


def circles(axes):
    return [patch for patch in axes.patches if isinstance(patch, Circle)]


def test_moments_are_even_from_first_to_last(motion):
    assert choose_moments(motion) == [0, 3, 6, 9, 11, 14, 17, 20]
    assert choose_moments(motion, 3) == [0, 10, 20]


def test_a_short_motion_shows_each_sample_once(qiao):
    assert choose_moments(make_measured(qiao, steps=2)) == [0, 1, 2]


def test_a_collision_nearby_is_shown_instead(folded):
    chosen = choose_moments(folded, 3)
    assert any(folded.colliding[k] for k in chosen)
    assert folded.verification.gaps_m.min() == folded.verification.gaps_m[chosen].min()


def test_every_sphere_is_a_circle_and_collisions_are_black(qiao, motion, folded):
    count = sum(row.count for row in qiao.approximations[motion.collision.detector.spheres])
    views = plot_moments(motion, [0, 20]).axes
    assert [len(circles(axes)) for axes in views] == [count, count]
    worst = int(np.argmin(folded.verification.gaps_m.min(axis=1)))
    (view,) = plot_moments(folded, [worst]).axes
    black = [patch for patch in circles(view) if patch.get_facecolor()[:3] == to_rgb(COLLIDING)]
    names = folded.colliding[worst]
    rows = qiao.approximations[folded.collision.detector.spheres]
    assert len(black) == sum(row.count for row in rows if row.component in names)
    assert "collide" in view.get_title()


def test_a_title_names_two_parts_at_most(folded):
    for names, told in ((set(), ""), ({"M", "J2"}, ": J2, M collide"), ({"M", "J2", "L1"}, ": 3 parts collide")):
        motion = replace(folded)
        motion.__dict__["colliding"] = [names] * len(folded.trajectory.q)
        assert plot_moments(motion, [5]).axes[0].get_title() == f"t = 0.10 s{told}"


def test_without_a_detector_the_bones_are_drawn(qiao):
    (view,) = plot_moments(make_measured(qiao, detector="none"), [5]).axes
    assert circles(view) == []
    assert len(view.lines) > 3


def test_it_becomes_a_picture(motion):
    assert to_png(plot_moments(motion, [0]), dpi=50).startswith(b"\x89PNG")

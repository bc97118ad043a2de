"""Views of a robot at moments: a circle a sphere, collisions black and named."""

from dataclasses import replace

import numpy as np
import pytest
from matplotlib.colors import to_rgb
from matplotlib.patches import Circle

from ikde.plot.images import to_png
from ikde.plot.moments import plot_moments
from ikde.scene.drawn_motion import draw_motion
from ikde.scene.drawn_pose import COLORS, Role
from tests.track.measured import make_measured


@pytest.fixture(scope="module")
def folded(qiao):
    return draw_motion(make_measured(qiao, amplitude=2.6), [0, 10])


def circles(axes):
    return [patch for patch in axes.patches if isinstance(patch, Circle)]


def test_every_sphere_is_a_circle_in_the_colour_of_its_role(folded):
    views = plot_moments(folded).axes
    for view, roles in zip(views, folded.robot.roles[:, folded.robot.parts], strict=True):
        drawn = sorted(patch.get_facecolor()[:3] for patch in circles(view))
        assert drawn == sorted(to_rgb(COLORS[role]) for role in roles)
    assert "collide" in views[1].get_title()


def test_far_spheres_are_drawn_first(folded):
    robot = folded.robot
    drawn = sorted(circles(plot_moments(folded).axes[0]), key=lambda circle: circle.zorder)
    towards_eye = np.array([np.cos(np.radians(-55)), np.sin(np.radians(-55)), np.tan(np.radians(22))])
    order = np.argsort(robot.centres_m[0] @ towards_eye, kind="stable")
    assert [circle.radius for circle in drawn] == robot.radii_m[order].tolist()


@pytest.mark.parametrize(
    ("names", "text"),
    [(set(), ", 20.5 mm clear"), ({"M", "J2"}, ": J2, M collide"), ({"M", "J2", "L1"}, ": 3 parts collide")],
)
def test_a_title_names_two_components_at_most(folded, names, text):
    robot = folded.robot
    roles = np.where(np.isin(robot.components, list(names)), Role.COLLIDING, Role.ARM)
    motion = replace(folded, robot=replace(robot, roles=np.array([roles, roles])), clearances_m=np.array([1, 0.0205]))
    assert plot_moments(motion).axes[1].get_title() == f"t = 0.20 s{text}"


def test_without_a_detector_the_links_are_drawn(qiao):
    (view,) = plot_moments(draw_motion(make_measured(qiao, detector="none"), [5])).axes
    assert circles(view) == []
    assert len(view.lines) > 3
    assert view.get_title() == "t = 0.10 s"


def test_it_becomes_a_picture(folded):
    assert to_png(plot_moments(folded), dpi=50).startswith(b"\x89PNG")

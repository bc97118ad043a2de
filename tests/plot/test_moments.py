"""Views of a robot at moments: a circle a sphere, collisions black and named."""

from dataclasses import replace

import numpy as np
import pytest
from matplotlib.colors import to_rgb
from matplotlib.patches import Circle, Polygon

from ikde.plot.images import to_png
from ikde.plot.moments import plot_moments
from ikde.scene.drawn_motion import draw_motion
from ikde.scene.drawn_pose import COLORS, Role
from tests.track.measured import make_measured
from tests.track.worlds import TOUCHED, make_among, make_passing


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


def polygons(axes):
    return [patch for patch in axes.patches if isinstance(patch, Polygon)]


def test_obstacles_are_outlines_and_what_is_touched_has_a_colour_of_its_own(qiao):
    motion = make_among(qiao)
    sample = motion.closest_obstacle[0]
    views = plot_moments(draw_motion(motion, sorted({0, sample}))).axes
    for view in views:
        assert {patch.get_edgecolor()[:3] for patch in polygons(view) if not patch.get_fill()} == {
            to_rgb(COLORS[Role.OBSTACLE])
        }
        outline = max((patch.get_path().vertices for patch in polygons(view)), key=len)
        (low, high), window = (outline.min(axis=0), outline.max(axis=0)), np.array([view.get_xlim(), view.get_ylim()])
        assert (window[:, 0] < low).all()
        assert (high < window[:, 1]).all()
    (view,) = plot_moments(draw_motion(make_among(qiao, obstacles=TOUCHED), [10])).axes
    assert to_rgb(COLORS[Role.TOUCHED]) in {patch.get_edgecolor()[:3] for patch in polygons(view)}


def test_the_least_room_has_a_ring_at_its_moment_alone(qiao):
    motion = make_among(qiao)
    sample = motion.closest_obstacle[0]
    drawn = draw_motion(motion, sorted({0, sample}))
    views = plot_moments(drawn).axes
    rings = [[line for line in view.lines if line.get_color() == COLORS[Role.CLOSEST]] for view in views]
    assert [bool(ring) for ring in rings] == [kept == sample for kept in drawn.samples]


def test_what_moves_stands_elsewhere_in_each_view(qiao):
    views = plot_moments(draw_motion(make_passing(qiao), [0, 20])).axes
    outlines = [max((patch.get_path().vertices for patch in polygons(view)), key=len) for view in views]
    assert np.linalg.norm(outlines[1].mean(axis=0) - outlines[0].mean(axis=0)) > 0.5
    for view, outline in zip(views, outlines, strict=True):
        assert view.get_xlim()[0] < outline[:, 0].min()
        assert outline[:, 0].max() < view.get_xlim()[1]

"""A link's surface and spheres from three sides."""

import numpy as np

from ikde.plot import covers
from ikde.plot.covers import plot_cover
from tests.mesh_bodies import make_l

SPHERES = np.array([[0.05, 0.05, 0.05], [0.15, 0.05, 0.05]])


def test_three_charts_show_all_of_it_in_mm():
    figure = plot_cover(make_l(), SPHERES, np.array([0.09, 0.08]))
    assert [axes.get_title() for axes in figure.axes] == ["from the front", "from the side", "from above"]
    above = figure.axes[2]
    assert (above.get_xlabel(), above.get_ylabel()) == ("x [mm]", "y [mm]")
    assert above.get_xlim()[0] < -40.0
    assert above.get_xlim()[1] > 230.0
    surface, circles = above.collections
    assert len(surface.get_paths()) == len(make_l())
    np.testing.assert_allclose(circles.get_offsets(), 1e3 * SPHERES[:, :2])


def test_of_a_large_mesh_the_largest_triangles_are_drawn(monkeypatch):
    monkeypatch.setattr(covers, "MAX_TRIANGLES", 4)
    surface, _ = plot_cover(make_l(), SPHERES, np.ones(2)).axes[0].collections
    assert len(surface.get_paths()) == 4


def test_a_link_may_have_no_shapes_or_no_spheres():
    assert len(plot_cover(np.empty((0, 3, 3)), SPHERES, np.ones(2)).axes[0].collections) == 2
    assert len(plot_cover(make_l(), np.empty((0, 3)), np.empty(0)).axes[0].collections) == 1

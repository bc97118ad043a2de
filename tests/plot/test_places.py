"""Targets from above and from the side."""

import numpy as np
import pytest

from ikde.plot.places import Places, plot_places

GROUPS = (
    Places(label="reached", points_m=np.array([[0.1, 0.2, 0.3], [1.0, -2.0, 3.0]]), color="#0072B2"),
    Places(label="not reached", points_m=np.array([[4.0, 5.0, 6.0]]), color="#CC79A7", marker="x"),
)


@pytest.fixture(scope="module")
def figure():
    return plot_places(GROUPS)


def test_each_point_is_in_both_views(figure):
    above, side = figure.axes[:2]
    for axes, across in ((above, 1), (side, 2)):
        drawn = [np.asarray(marks.get_offsets()) for marks in axes.collections]
        for points, group in zip(drawn, GROUPS, strict=True):
            np.testing.assert_array_equal(points, group.points_m[:, [0, across]])


def test_lengths_are_to_scale_and_the_origin_is_marked(figure):
    for axes in figure.axes[:2]:
        assert axes.get_aspect() == 1.0
        assert [line.get_xydata().tolist() for line in axes.lines] == [[[0.0, 0.0]]]
        assert {"reached", "not reached", "world origin"} <= set(axes.get_legend_handles_labels()[1])

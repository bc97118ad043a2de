"""Frames drawn: one label a place, one scale for all axes."""

import numpy as np
import pytest

from ikde.plot.frames import plot_frames

NAMES = ["Ob", "O1", "Oc12", "O2", "Oc23", "O3", "O4", "O5", "O6", "tool"]


@pytest.fixture
def axes(qiao):
    return plot_frames(qiao, qiao.home, NAMES, title="home").axes[0]


def test_every_frame_has_its_name_and_three_axes(axes):
    assert [text.get_text() for text in axes.texts] == NAMES
    assert len(axes.lines) == 1 + 3 * len(NAMES)


def test_frames_at_one_place_share_their_label(qiao):
    axes = plot_frames(qiao, qiao.home, ["Ob", "O1", "O1"], title="").axes[0]
    assert [text.get_text() for text in axes.texts] == ["Ob", "O1, O1"]


def test_a_metre_is_a_metre_in_every_direction(axes):
    spans = [np.ptp(axis.get_view_interval()) for axis in (axes.xaxis, axes.yaxis, axes.zaxis)]
    box = axes.get_box_aspect() if hasattr(axes, "get_box_aspect") else axes._box_aspect
    box = axes._box_aspect if box is None else box
    assert np.ptp(np.array(box) / spans) < 0.05 * np.mean(np.array(box) / spans)


def test_axes_are_named_with_their_unit(axes):
    assert [axes.get_xlabel(), axes.get_ylabel(), axes.get_zlabel()] == ["x [m]", "y [m]", "z [m]"]

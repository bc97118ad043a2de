"""The path in space."""

import numpy as np

import ikde
from ikde.plot.path import plot_path
from tests.track.measured import make_measured, make_still


def test_path_tool_and_base_are_drawn(qiao):
    motion = make_measured(qiao)
    axes = plot_path(motion).axes[0]
    drawn = {line.get_label(): np.array(line.get_data_3d()).T for line in axes.lines}
    np.testing.assert_allclose(drawn["path"], motion.trajectory.path.p_world_tool)
    np.testing.assert_allclose(drawn["tool"], motion.trajectory.path.p_world_tool)
    np.testing.assert_allclose(drawn["base, on the floor"][:, :2], motion.trajectory.q[:, :2])
    assert [text.get_text() for text in axes.figure.legends[0].get_texts()] == ["path", "tool", "base, on the floor"]


def test_a_robot_that_stands_still_drives_nowhere():
    axes = plot_path(make_still(ikde.load_robot("ur5"))).axes[0]
    assert [text.get_text() for text in axes.figure.legends[0].get_texts()] == ["path", "tool"]

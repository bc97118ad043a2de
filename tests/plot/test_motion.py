"""Figures of a motion: every curve is the motion's, with its limits."""

import numpy as np
import pytest

from ikde.plot.motion import plot_base, plot_clearance, plot_errors, plot_joint_speeds, plot_joints
from tests.track.measured import make_measured


@pytest.fixture(scope="module")
def motion(qiao):
    return make_measured(qiao)


def levels(axes):
    """Horizontal lines across a chart."""
    return sorted(line.get_ydata()[0] for line in axes.lines if line.get_transform() != axes.transData)


def test_joints_are_in_degrees_between_their_ranges(qiao, motion):
    charts = plot_joints(motion).axes
    assert [axes.get_ylabel() for axes in charts] == [f"q{k} [deg]" for k in range(1, 7)]
    np.testing.assert_allclose(charts[2].lines[0].get_ydata(), np.degrees(motion.trajectory.q[:, 5]))
    np.testing.assert_allclose(levels(charts[3]), [-102.5, 102.5])


def test_speeds_hold_from_a_sample_to_the_next(motion):
    axes = plot_joint_speeds(motion).axes[0]
    x, y = axes.lines[0].get_data()
    np.testing.assert_allclose(y[::2], y[1::2])
    np.testing.assert_allclose(y[::2], np.degrees(motion.trajectory.joint_speeds[:, 3]))
    np.testing.assert_allclose((x[0], x[-1]), (0.0, 0.4))
    np.testing.assert_allclose(levels(axes), [-90.0, 90.0])


def test_a_base_with_wheels_shows_them(motion):
    charts = {axes.get_ylabel(): axes for axes in plot_base(motion).axes}
    assert list(charts) == ["place [m]", "heading [deg]", "v [m/s]", "ω [deg/s]", "wheels [rad/s]"]
    np.testing.assert_allclose(charts["v [m/s]"].lines[0].get_ydata(), 0.2)
    np.testing.assert_allclose(levels(charts["v [m/s]"]), [-0.5, 0.5])
    assert levels(charts["wheels [rad/s]"])[1] == pytest.approx(motion.wheel_limit_rad_s)


def test_a_base_on_arcs_may_have_no_wheels(unwheeled):
    charts = plot_base(make_measured(unwheeled)).axes
    assert [axes.get_ylabel() for axes in charts][2:] == ["v [m/s]", "ω [deg/s]"]
    np.testing.assert_allclose(charts[2].lines[0].get_ydata(), 0.2)


def test_a_base_without_wheels_has_two_speeds(qiao):
    charts = plot_base(make_measured(qiao, drive="omnidirectional")).axes
    assert [axes.get_ylabel() for axes in charts][2:] == ["v [m/s]", "ω [deg/s]"]
    assert len(charts[2].lines) == 4


def test_errors_have_their_tolerance_and_orientation_if_asked_for(qiao, motion):
    charts = plot_errors(motion).axes
    assert [axes.get_ylabel() for axes in charts] == ["error [mm]", "turned by [deg]", "off path [mm]"]
    assert levels(charts[0]) == pytest.approx([1e-3])
    free = plot_errors(make_measured(qiao, orientation="free")).axes
    assert [axes.get_ylabel() for axes in free] == ["error [mm]", "off path [mm]"]


def test_clearance_is_above_what_is_certain(motion):
    axes = plot_clearance(motion).axes[0]
    samples, certain = (line.get_ydata() for line in axes.lines[:2])
    np.testing.assert_allclose(samples, 1e3 * motion.verification.gaps_m.min(axis=1))
    assert certain.min() <= samples.min()


def test_collisions_are_marked(qiao):
    motion = make_measured(qiao, amplitude=2.6)
    legend = [text.get_text() for text in plot_clearance(motion).legends[0].get_texts()]
    assert legend == ["at samples", "certified between them", "safe distance", "collision"]


def test_without_a_detector_there_is_no_clearance(qiao):
    assert plot_clearance(make_measured(qiao, detector="none")) is None

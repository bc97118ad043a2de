"""Figures of a motion: every curve is the motion's, with its limits."""

from dataclasses import replace

import numpy as np
import pytest

import ikde
from ikde.plot.motion import plot_base, plot_errors, plot_joint_speeds, plot_joints, plot_margins, plot_path
from tests.random_robots import make_frame, make_robot
from tests.track.measured import make_measured, make_still
from tests.track.worlds import TOUCHED, make_among


@pytest.fixture(scope="module")
def motion(qiao):
    return make_measured(qiao)


def levels(axes):
    """Horizontal lines across a chart."""
    return sorted(line.get_ydata()[0] for line in axes.lines if line.get_transform() != axes.transData)


def names(figure):
    """What stands above the charts."""
    return [axes.get_title(loc="left") for axes in figure.axes]


def test_path_tool_and_base_are_drawn(motion):
    axes = plot_path(motion).axes[0]
    drawn = {line.get_label(): np.array(line.get_data_3d()).T for line in axes.lines}
    np.testing.assert_allclose(drawn["path"], motion.trajectory.path.p_world_tool)
    np.testing.assert_allclose(drawn["tool"], motion.trajectory.path.p_world_tool)
    np.testing.assert_allclose(drawn["base, on the floor"][:, :2], motion.trajectory.q[:, :2])
    assert [text.get_text() for text in axes.figure.legends[0].get_texts()] == ["path", "tool", "base, on the floor"]


def test_a_robot_that_stands_still_drives_nowhere():
    axes = plot_path(make_still(ikde.load_robot("ur5"))).axes[0]
    assert [text.get_text() for text in axes.figure.legends[0].get_texts()] == ["path", "tool"]


def test_joints_are_named_above_and_in_degrees(motion):
    figure = plot_joints(motion)
    assert names(figure) == [f"q{k}" for k in range(1, 7)]
    assert {axes.get_ylabel() for axes in figure.axes} == {"deg"}
    np.testing.assert_allclose(figure.axes[2].lines[0].get_ydata(), np.degrees(motion.trajectory.q[:, 5]))


def test_ends_of_ranges_are_drawn(motion):
    charts = plot_joints(motion).axes
    assert levels(charts[2]) == pytest.approx([-150.0, 150.0])
    assert levels(charts[3]) == pytest.approx([-102.5, 102.5])
    assert levels(plot_base(motion).axes[1]) == pytest.approx([-180.0, 180.0])


def test_an_end_beyond_a_full_turn_presses_no_curve_flat(qiao):
    joints = [replace(joint, lower=-31.0, upper=6.0) if joint.name == "q_z" else joint for joint in qiao.joints]
    heading = plot_base(make_measured(replace(qiao, joints=tuple(joints)))).axes[1]
    assert levels(heading) == pytest.approx([np.degrees(6.0)])


def test_what_stands_still_is_a_flat_line(motion):
    still = np.tile(motion.trajectory.q[0], (21, 1)) + 1e-12 * np.arange(21)[:, None]
    for axes in plot_joints(replace(motion, trajectory=replace(motion.trajectory, q=still))).axes:
        low, high = axes.get_ylim()
        assert high - low > 1.0
        assert low < axes.lines[0].get_ydata()[0] < high


def overlaps(figure):
    """Pairs of titles and labels that cover each other, or leave the figure."""
    figure.draw_without_rendering()
    texts = [text for axes in figure.axes for text in (axes._left_title, axes.yaxis.label, axes.xaxis.label)]
    boxes = [text.get_window_extent() for text in texts if text.get_text()]
    outside = [box for box in boxes if box.x0 < 0 or box.y0 < 0 or box.x1 > figure.bbox.x1 or box.y1 > figure.bbox.y1]
    return outside + [box for k, box in enumerate(boxes) if box.count_overlaps(boxes[:k])]


def test_long_names_have_their_place():
    arm = ikde.load_robot("ur5")
    figure = plot_joints(make_still(arm))
    assert names(figure) == list(arm.joint_names)
    assert overlaps(figure) == overlaps(plot_joint_speeds(make_still(arm))) == []
    longer = replace(arm, joints=tuple(replace(joint, name=f"left_robot_{joint.name}") for joint in arm.joints))
    longer = replace(longer, frames=tuple(_renamed(frame) for frame in arm.frames))
    figure = plot_joints(make_still(longer))
    assert names(figure)[0] == "left_robot_shoulder_pan_joint"
    assert overlaps(figure) == []


def _renamed(frame):
    return frame if frame.joint is None else replace(frame, joint=f"left_robot_{frame.joint}")


def test_a_base_without_an_arm_has_no_joints_to_show():
    kinds = {"d_x": "prismatic", "d_y": "prismatic", "q_z": "revolute"}
    axes = zip(kinds, [(1, 0, 0), (0, 1, 0), (0, 0, 1)], ["world", "d_x", "d_y"], strict=True)
    base = make_robot(
        kinds, [make_frame(name, parent, joint=name, axis=axis) for name, axis, parent in axes], tool="q_z"
    )
    motion = make_still(base, detector="none")
    assert plot_joints(motion) is None
    assert plot_joint_speeds(motion) is None
    assert plot_base(motion).axes


def test_slides_are_in_millimetres():
    frames = [
        make_frame("a", "world", joint="s1", axis=(1, 0, 0)),
        make_frame("b", "a", joint="s2", axis=(0, 0, 1)),
    ]
    gantry = make_robot({"s1": "prismatic", "s2": "prismatic"}, frames, tool="b")
    motion = make_still(gantry, detector="none")
    axes = plot_joints(motion).axes[0]
    assert axes.get_ylabel() == "mm"
    assert axes.lines[0].get_ydata()[-1] == pytest.approx(-800.0)
    assert levels(axes) == [-1000.0, 1000.0]
    assert plot_joint_speeds(motion).axes[0].get_ylabel() == "mm/s"


def test_speeds_hold_from_a_sample_to_the_next(motion):
    axes = plot_joint_speeds(motion).axes[0]
    x, y = axes.lines[0].get_data()
    np.testing.assert_allclose(y[::2], y[1::2])
    np.testing.assert_allclose(y[::2], np.degrees(motion.trajectory.joint_speeds[:, 3]))
    np.testing.assert_allclose((x[0], x[-1]), (0.0, 0.4))


def test_speed_limits_are_drawn_both_ways(motion):
    assert levels(plot_joint_speeds(motion).axes[2]) == pytest.approx([-90.0, 90.0])


def test_a_base_with_wheels_shows_them(motion):
    charts = {axes.get_ylabel(): axes for axes in plot_base(motion).axes}
    assert list(charts) == ["place [m]", "heading [deg]", "v [m/s]", "ω [deg/s]", "wheels [rad/s]"]
    v = charts["v [m/s]"]
    np.testing.assert_allclose(v.lines[0].get_ydata(), 0.2)
    np.testing.assert_allclose(levels(v), [-0.5, 0.5])
    assert len(v.lines) == 3
    assert levels(charts["wheels [rad/s]"])[1] == pytest.approx(motion.wheel_limit_rad_s)


def test_a_base_shows_its_limits(qiao):
    limits = {"speed": np.full(9, 0.2), "wheel_speed_rad_s": 3.0}
    v, omega, wheels = plot_base(make_measured(qiao, **limits)).axes[2:]
    assert levels(v) == pytest.approx([-0.2, 0.2])
    assert levels(omega) == pytest.approx(np.degrees([-0.2, 0.2]))
    assert levels(wheels) == [-3.0, 3.0]


def test_wheels_that_are_not_known_are_left_out(motion):
    unknown = replace(motion, trajectory=replace(motion.trajectory, wheel_speeds=None))
    charts = plot_base(unknown).axes
    assert [axes.get_ylabel() for axes in charts] == ["place [m]", "heading [deg]", "v [m/s]", "ω [deg/s]"]
    assert len(charts[2].lines) == 3


def test_a_base_on_arcs_may_have_no_wheels(unwheeled):
    charts = plot_base(make_measured(unwheeled)).axes
    assert [axes.get_ylabel() for axes in charts][2:] == ["v [m/s]", "ω [deg/s]"]
    np.testing.assert_allclose(charts[2].lines[0].get_ydata(), 0.2)


def test_a_base_without_wheels_has_two_speeds(qiao):
    charts = plot_base(make_measured(qiao, drive="omnidirectional")).axes
    assert [axes.get_ylabel() for axes in charts][2:] == ["v [m/s]", "ω [deg/s]"]
    assert len(charts[2].lines) == 4
    assert len([line for line in charts[2].lines if line.get_label().startswith("v along")]) == 2


def test_a_robot_that_stands_still_has_no_base():
    assert plot_base(make_still(ikde.load_robot("ur5"))) is None


def test_errors_have_their_tolerance_and_orientation_if_asked_for(qiao, motion):
    off = with_errors(motion, 1e-6)
    charts = plot_errors(off).axes
    assert [axes.get_ylabel() for axes in charts] == ["error [mm]", "turned by [deg]", "off path [mm]"]
    assert levels(charts[0]) == pytest.approx([1e-3])
    free = plot_errors(with_errors(make_measured(qiao, orientation="free"), 1e-6)).axes
    assert [axes.get_ylabel() for axes in free] == ["error [mm]", "off path [mm]"]


def with_errors(motion, size):
    """The same motion, measured to be off by so much, m and rad, at its second sample."""
    was = motion.grade
    errors = {"error_m": np.zeros_like(was.error_m), "orientation_error_rad": np.zeros_like(was.orientation_error_rad)}
    for error in errors.values():
        error[1] = size
    return replace(motion, trajectory=replace(motion.trajectory, grade=replace(was, **errors)))


def test_errors_below_a_nanometre_are_no_curve(qiao, motion):
    assert [axes.get_ylabel() for axes in plot_errors(with_errors(motion, 0.9e-9)).axes] == ["off path [mm]"]
    assert plot_errors(with_errors(make_measured(qiao, steps=1), 0.0)) is not None
    assert plot_errors(make_measured(qiao, steps=0, further=5)) is None
    least = plot_errors(with_errors(motion, 1.1e-9)).axes[0]
    assert min(line.get_ydata().min() for line in least.lines[:3]) == pytest.approx(1e-6)


def margins(motion):
    return {axes.get_ylabel(): axes for axes in plot_margins(motion).axes}


def test_margins_are_those_of_the_worst_joint(motion):
    charts = margins(motion)
    assert list(charts) == ["clearance [mm]", "range left [%]", "speed [% of limit]"]
    q, robot = motion.trajectory.q[:, 2:], motion.robot
    left = np.minimum(q - robot.lower[2:], robot.upper[2:] - q) / (robot.upper - robot.lower)[2:]
    np.testing.assert_allclose(charts["range left [%]"].lines[0].get_ydata(), 100.0 * left.min(axis=1))
    used = np.abs(motion.grade.driven / motion.limits.speed).max(axis=1)
    np.testing.assert_allclose(charts["speed [% of limit]"].lines[0].get_ydata()[::2], 100.0 * used)
    assert levels(charts["speed [% of limit]"]) == [100.0]


def test_clearance_is_above_what_is_certain(motion):
    axes = margins(motion)["clearance [mm]"]
    samples, certain = (line.get_ydata() for line in axes.lines[:2])
    np.testing.assert_allclose(samples, 1e3 * motion.grade.gaps_m.min(axis=1))
    assert certain.min() <= samples.min()


def test_a_start_alone_has_nothing_certified_between(qiao):
    axes = margins(make_measured(qiao, steps=0, further=5))["clearance [mm]"]
    assert [line.get_label() for line in axes.lines][:1] == ["at samples"]
    assert "certified between them" not in [line.get_label() for line in axes.lines]


def test_collisions_are_marked(qiao):
    motion = make_measured(qiao, amplitude=2.6)
    legend = [text.get_text() for text in plot_margins(motion).legends[0].get_texts()]
    assert legend[:4] == ["at samples", "certified between them", "safe distance", "collision"]


def test_without_a_detector_and_limits_there_is_no_margin(qiao):
    assert list(margins(make_measured(qiao, detector="none"))) == ["range left [%]", "speed [% of limit]"]
    frames = [make_frame("a", "world", joint="s1", axis=(0, 0, 1))]
    endless = make_robot({"s1": "revolute"}, frames, tool="a")
    joints = tuple(replace(joint, lower=-np.inf, upper=np.inf) for joint in endless.joints)
    assert plot_margins(make_still(replace(endless, joints=joints), detector="none", speed=None)) is None


def curve(axes, label):
    return next(line for line in axes.lines if line.get_label() == label)


def test_in_a_world_clearance_to_itself_and_to_it_are_apart(qiao):
    motion = make_among(qiao, 0.02)
    own, world = plot_margins(motion).axes[:2]
    assert (own.get_ylabel(), world.get_ylabel()) == ("to itself [mm]", "to the world [mm]")
    alone = make_measured(qiao, amplitude=0.5)
    np.testing.assert_allclose(curve(own, "at samples").get_ydata(), 1e3 * alone.grade.clearances_m)
    between = curve(own, "certified between them").get_ydata()
    np.testing.assert_allclose(between, np.repeat(1e3 * alone.certificate.segment_m, 2))
    seen = [ikde.check(qiao, q, motion.collision) for q in motion.trajectory.q]
    least = np.array([1e3 * min(row.clearance_m for row in one.obstacles) for one in seen])
    np.testing.assert_allclose(curve(world, "at samples").get_ydata(), least)
    assert (curve(world, "certified between them").get_ydata()[::2] <= np.minimum(least[:-1], least[1:]) + 1e-9).all()
    assert levels(world) == pytest.approx([20.0])
    (time,), (gap,) = curve(world, "least room of the world").get_data()
    assert (time, gap) == pytest.approx((0.02 * int(np.argmin(least)), min(least)))


def test_where_margins_differ_no_line_is_drawn_and_what_is_touched_is_marked(qiao):
    motion = make_among(qiao, margins_m={"M": 0.001}, obstacles=TOUCHED)
    world = plot_margins(motion).axes[1]
    times = motion.trajectory.times_s[[bool(names) for names in motion.touched]]
    assert 0 < len(times) < 21
    np.testing.assert_array_equal(curve(world, "collision").get_xdata(), times)
    assert "margin" not in [line.get_label() for line in world.lines]


def test_a_world_that_nothing_is_compared_with_has_no_chart(qiao):
    names = list(qiao.components("improved"))
    motion = make_among(qiao, obstacles={"ball": {"sphere": {"radius": 0.1}, "ignore": names}})
    assert [axes.get_ylabel() for axes in plot_margins(motion).axes][:2] == ["to itself [mm]", "range left [%]"]

"""A motion as text and as plain data."""

import json
from dataclasses import replace

import numpy as np
import pytest

import ikde
from ikde.model.collision_model import CollisionModel
from ikde.report.track import format_track, gap_mm, largest_wheel_speed, list_figures, singular, track_json
from ikde.track.trajectory import TrackStop, TrackStopReason
from tests.random_robots import make_frame, make_robot
from tests.track.measured import make_measured, make_still

STOP = TrackStop(
    sample=21,
    reason=TrackStopReason.COLLISION,
    text="sample 21 (0.42 s): J4 and J6 overlap by 3 mm in the only step that was found",
    pair=("J4", "J6"),
)


@pytest.fixture(scope="module")
def plan():
    path = {"expressions": {"x": 1, "y": 0, "z": 1}}
    return ikde.load_track({"name": "wave [1]", "robot": "qiao2021", "dt_s": 0.02, "samples": 20, "path": path})


def test_a_followed_path_is_green_with_its_figures(qiao, plan):
    text = format_track(plan, make_measured(qiao))
    assert text.startswith("followed: 20 of 20 points of wave [1] by qiao2021, 0.4 s, differential\n")
    rows = {name: (value, asked) for name, value, asked in list_figures(make_measured(qiao))}
    assert rows["points reached"] == ("20", "20")
    assert rows["largest error along x / y / z"] == ("0 each", "1 µm")
    assert rows["largest speed, base, 40 %"] == ("0.2 m/s", "0.5 m/s")
    assert rows["time of a single step, median / p99"] == ("20 µs / 20 µs", "20 ms")
    assert rows["time of the whole search"] == ("250 ms", "")
    assert all(name in text for name in rows)


def test_a_stop_is_the_second_line(qiao, plan):
    motion = make_measured(qiao, further=5, stop=STOP)
    lines = format_track(plan, motion).splitlines()
    assert lines[:2] == ["stopped after 20 of 25 points of wave [1] by qiao2021", STOP.text]
    data = track_json(plan, motion)
    assert (data["reached"], data["stop"]["reason"], data["stop"]["pair"]) == (False, "collision", ("J4", "J6"))


def test_broken_limits_are_counted(qiao, plan):
    motion = make_measured(qiao, amplitude=2.6)
    text = format_track(plan, motion)
    assert text.startswith("followed 20 of 20 points of wave [1] by qiao2021, against its limits: ")
    assert f"collision {motion.grade.violations.collision} times" in text
    assert track_json(plan, motion)["accepted"] is False


def test_plain_data_is_json(qiao, plan):
    for motion in (make_measured(qiao), make_measured(qiao, detector="none", drive="omnidirectional")):
        data = track_json(plan, motion)
        assert json.loads(json.dumps(data, allow_nan=False))["reached_points"] == 20


def test_without_a_detector_collision_is_not_checked(qiao, plan):
    motion = make_measured(qiao, detector="none")
    assert rows_of(motion)["self-collision"] == ("not checked", "")
    assert format_track(plan, motion).splitlines()[0].endswith(", 0.4 s, differential, self-collision not checked")
    data = track_json(plan, motion)
    for name in ("detector", "clearance_m", "closest_pair", "certified_clearance_m"):
        assert data[name] is None
    assert (data["violations"]["collision"], data["reached"]) == (None, True)
    assert "self-collision" not in rows_of(make_measured(qiao))


def test_what_does_not_apply_has_no_row(qiao):
    names = [row[0] for row in list_figures(make_measured(qiao, detector="none", orientation="free", speed=None))]
    assert not any(word in name for name in names for word in ("clearance", "orientation", "speed,"))


def test_the_faster_wheel_counts(qiao):
    motion = make_measured(qiao)
    assert largest_wheel_speed(motion) == pytest.approx((0.2 + 0.259 * 0.3) / 0.1)
    assert largest_wheel_speed(make_measured(qiao, drive="omnidirectional")) is None
    assert np.isfinite(motion.wheel_limit_rad_s)


def test_a_base_without_wheels_has_all_rows_but_theirs(qiao, unwheeled, plan):
    motion = make_measured(unwheeled)
    rows = [row[0] for row in list_figures(motion)]
    assert rows == [row[0] for row in list_figures(make_measured(qiao)) if "wheel" not in row[0]]
    assert "sideways slip of the base" in rows
    data = track_json(plan, motion)
    assert (data["drive"], data["largest_wheel_speed_rad_s"], data["wheel_limit_rad_s"]) == ("differential", None, None)


def test_what_was_asked_for_is_on_record(qiao, plan):
    data = track_json(plan.with_changes(seed=3, start=qiao.home), make_measured(qiao))
    home = dict(zip(qiao.joint_names, qiao.home.tolist(), strict=True))
    assert (data["seed"], data["asked_start"]) == (3, home)
    assert (data["limits"]["speed"]["d_x"], data["limits"]["acceleration"]) == (0.5, None)
    free = make_measured(qiao, speed=np.full(9, np.inf), wheel_speed_rad_s=8.0)
    limits = track_json(plan, free)["limits"]
    assert (limits["speed"]["q1"], limits["wheel_speed_rad_s"], limits["ranges"]) == (None, 8.0, True)
    assert track_json(plan, free)["asked_start"] is None


def make_missing(motion):
    """The same, but two samples miss their tolerance."""
    error = motion.grade.error_m.copy()
    error[[4, 7], 0] = 1e-3
    graded = replace(motion.grade, error_m=error)
    return replace(motion, trajectory=replace(motion.trajectory, grade=graded))


def test_a_point_that_is_missed_is_not_reached(qiao, plan):
    motion = make_missing(make_measured(qiao))
    assert next(list_figures(motion)) == ("points reached", "18", "20")
    assert format_track(plan, motion).startswith("followed: 18 of 20 points")
    data = track_json(plan, motion)
    assert (data["reached_points"], data["met_points"]) == (20, 18)


def rows_of(motion):
    """What was measured and what was asked, by name."""
    return {name: (value, asked) for name, value, asked in list_figures(motion)}


def test_what_is_left_of_a_range_has_the_units_of_its_joint(qiao, plan):
    turning = make_measured(qiao)
    left = turning.range_left[1]
    assert rows_of(turning)["joint-limit margin, q1"] == (f"{np.degrees(left):.1f} deg", "to 169 deg")
    frames = [make_frame("a", "world", joint="s1", axis=(1, 0, 0)), make_frame("b", "a", joint="s2", axis=(0, 0, 1))]
    gantry = make_robot({"s1": "prismatic", "s2": "prismatic"}, frames, tool="b")
    q = [[0.0, 0.5], [0.0, 1.0 + 1e-15]]
    sliding = make_measured(gantry, q=q, drive="omnidirectional", detector="none")
    assert rows_of(sliding)["joint-limit margin, s2"] == ("0.0 mm", "to 1000 mm")
    least = track_json(plan, sliding)["smallest_range_left"]
    assert (least["joint"], least["limit"]) == ("s2", 1.0)
    assert least["value"] == pytest.approx(0.0, abs=1e-12)


def test_joints_without_ends_have_no_range_left(qiao, plan):
    joints = tuple(replace(joint, lower=-np.inf, upper=np.inf) for joint in qiao.joints)
    endless = CollisionModel.of(replace(qiao, joints=joints))
    motion = replace(make_measured(qiao), collision=endless)
    assert not any("range" in name for name in rows_of(motion))
    assert track_json(plan, motion)["smallest_range_left"] is None


def test_a_limited_distance_is_told(qiao, plan):
    motion = make_measured(qiao, max_distance_m=0.5, center="Oc")
    farthest = motion.grade.distance_m.max()
    row = "largest distance of the tool from Oc, 21 beyond"
    assert rows_of(motion)[row] == (f"{1e3 * farthest:.2f} mm", "500 mm")
    assert track_json(plan, motion)["largest_distance_m"] == farthest
    kept = make_measured(qiao, max_distance_m=5.0, center="Oc")
    assert "largest distance of the tool from Oc" in rows_of(kept)
    assert track_json(plan, make_measured(qiao))["largest_distance_m"] is None


def test_what_is_not_asked_for_is_none(qiao, plan):
    motion = make_measured(qiao, orientation="axis")
    pose, free = (track_json(plan, asked) for asked in (motion, make_measured(qiao, orientation="free")))
    figures = motion.grade.largest_orientation_error_rad, motion.trajectory.deviation_rad.max()
    for key, figure in zip(("largest_orientation_error_rad", "largest_deviation_rad"), figures, strict=True):
        assert (pose[key], free[key]) == (figure, None)
    assert pose["largest_sideways_m_s"] < 1e-9
    assert track_json(plan, make_measured(qiao, drive="omnidirectional"))["largest_sideways_m_s"] is None
    assert pose["ikde"] == ikde.__version__


def test_a_base_whose_wheels_are_not_known_still_drives_on_arcs(qiao, plan):
    motion = make_measured(qiao)
    unknown = replace(motion, trajectory=replace(motion.trajectory, wheel_speeds=None))
    assert {"sideways slip of the base", "largest speed, base, 40 %"} <= set(rows_of(unknown))
    assert "largest wheel speed" not in rows_of(unknown)
    assert track_json(plan, unknown)["largest_wheel_speed_rad_s"] is None


def test_a_robot_that_stands_still_has_a_fixed_base(plan):
    motion = make_still(ikde.load_robot("ur5"), detector="none", speed=None)
    assert format_track(plan, motion).startswith(
        "followed: 20 of 20 points of wave [1] by ur5, 0.4 s, fixed base, self"
    )


@pytest.mark.parametrize(("value", "told"), [(0.1749, "0.175"), (2e-12, "2.00e-12"), (1.8e-18, "0"), (0.0, "0")])
def test_rounding_is_no_singular_value(value, told):
    assert singular(value) == told


@pytest.mark.parametrize(("gap_m", "told"), [(0.0123, "12.30"), (3.1e-6, "0.00310"), (-2e-9, "-2.00e-06"), (0, "0.00")])
def test_a_small_gap_is_not_told_as_none(gap_m, told):
    assert gap_mm(gap_m) == told

"""Plans of track files: names resolved, m and rad, and what is wrong placed at its key."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import ikde
from ikde.errors import InputError
from ikde.track.limits import MotionLimits
from ikde.track.make_plan import make_plan
from ikde.track.spec import TrackSpec

LEAST = {
    "robot": "qiao2021",
    "units": {"length": "mm", "angle": "deg"},
    "dt_s": 0.1,
    "path": {"waypoints": [{"position": [1000, 0, 900]}, {"position": [1000, 100, 900]}]},
}


def plan(robot, file=None, **keys):
    return make_plan(TrackSpec.model_validate({**LEAST, **keys}), robot, folder=Path(), file=file)


def test_what_is_left_out_has_defaults(qiao):
    made = plan(qiao)
    assert (made.name, made.robot, made.drive, made.method, made.seed) == (
        "track",
        qiao,
        "differential",
        "continuation",
        0,
    )
    np.testing.assert_array_equal(made.limits.speed, MotionLimits.of(qiao).speed)
    assert (made.limits.acceleration, made.limits.wheel_speed_rad_s) == (None, None)
    assert (made.collision.detector, made.start, made.path.name) == (qiao.detectors["improved"], None, "track")


def test_it_is_called_by_its_name_or_its_file(qiao):
    assert plan(qiao, file="a/shelf.yaml").name == "shelf"
    assert plan(qiao, file="a/shelf.yaml", name="Shelf").path.name == "Shelf"


def test_limits_are_by_joint_and_a_joints_own_comes_first(qiao):
    speed = {"prismatic": 500, "revolute": 90, "q6": 180, "q5": None}
    limits = plan(qiao, limits={"speed": speed, "acceleration": {"q1": 360}, "wheel_speed": 360}).limits
    np.testing.assert_allclose(limits.speed, [0.5, 0.5] + [np.pi / 2] * 5 + [np.inf, np.pi])
    np.testing.assert_allclose(limits.acceleration, [np.inf] * 3 + [2 * np.pi] + [np.inf] * 5)
    assert limits.wheel_speed_rad_s == pytest.approx(2 * np.pi)


def test_a_limit_of_revolute_joints_holds_for_all_that_turn(qiao):
    endless = replace(qiao.joints[8], kind="continuous", lower=-np.inf, upper=np.inf)
    robot = replace(qiao, joints=(*qiao.joints[:8], endless))
    assert plan(robot, limits={"speed": {"revolute": 45}}).limits.speed[8] == np.pi / 4


def test_limits_of_the_file_come_before_the_robots_own(qiao):
    own = replace(qiao, joints=(*qiao.joints[:8], replace(qiao.joints[8], max_speed=2.0, max_acceleration=5.0)))
    left_out, given = (
        plan(own, limits=limits).limits for limits in ({}, {"speed": {"q6": 90}, "acceleration": {"q1": 1}})
    )
    assert (left_out.speed[8], left_out.acceleration[8], left_out.acceleration[3]) == (2.0, 5.0, np.inf)
    assert (given.speed[8], given.acceleration[8]) == (np.pi / 2, 5.0)
    assert given.acceleration[3] == np.radians(1)
    assert plan(own, limits={"speed": {"q6": None}}).limits.speed[8] == np.inf


def test_the_other_limits_are_in_metres_and_radians(qiao):
    asked = {"ranges": False, "max_distance": 1400, "center": "Oc", "position_error": 0.01, "orientation_error": 1}
    limits = plan(qiao, limits={**asked, "speed": {"q1": 0}}).limits
    assert (limits.ranges, limits.center, limits.speed[3]) == (False, "Oc", 0.0)
    assert (limits.max_distance_m, limits.position_error_m) == pytest.approx((1.4, 1e-5))
    assert limits.orientation_error_rad == pytest.approx(np.pi / 180)


def path_from(robot, start):
    """Waypoints in mm whose first is where the tool stands at joint values by name, m and rad."""
    q = np.array([start.get(joint.name, joint.home) for joint in robot.joints])
    p = 1e3 * ikde.forward(robot, q)["tool"][:3, 3]
    return {"waypoints": [{"position": p.tolist()}, {"position": (p + np.array([0, 50, 0])).tolist()}]}


def test_ranges_detector_and_start_are_those_of_the_file(qiao):
    path = path_from(qiao, {"d_x": -0.5, "q2": np.pi / 4})
    start = {"d_x": -500, "q2": 45}
    made = plan(qiao, ranges={"d_x": [-1000, 1000]}, detector="none", start=start, path=path, method="typical")
    assert (made.robot.joints[0].lower, made.collision.detector, made.method) == (-1.0, None, "typical")
    assert dict(zip(qiao.joint_names, made.start, strict=True)) == pytest.approx(
        {**dict(zip(qiao.joint_names, qiao.home, strict=True)), "d_x": -0.5, "q2": np.pi / 4}
    )


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ({"detector": "improvd"}, "detector: qiao2021 has no detector 'improvd'"),
        ({"ranges": {"d_z": [0, 1]}}, "ranges.d_z: qiao2021 has no joint 'd_z'"),
        ({"limits": {"speed": {"revolut": 1}}}, "limits.speed.revolut: qiao2021 has no joint 'revolut' (did you mean"),
        (
            {"limits": {"wheel_speed": 1}, "drive": "omnidirectional"},
            "limits.wheel_speed: an omnidirectional drive has",
        ),
        ({"limits": {"max_distance": 1}}, "limits.center: `max_distance` and `center` go together"),
        ({"limits": {"max_distance": 1, "center": "O0"}}, "limits.center: qiao2021 has no frame 'O0'"),
        ({"start": {"q1": 175}}, "start.q1: 3.05433 is outside the range"),
        ({"start": {"elbow": 0}}, "start.elbow: qiao2021 has no joint 'elbow'"),
        ({"start": {"q1": 10}}, "start: expected a configuration at the path's first pose, got one"),
        ({"start": {"q2": 140}}, "start: M and L1 collide"),
        ({"dt_s": 1e9}, "dt_s: expected 1e-09 to 1e+06 s"),
    ],
)
def test_what_does_not_fit_is_placed(qiao, keys, words):
    with pytest.raises(InputError) as caught:
        plan(qiao, **keys)
    assert str(caught.value).startswith(words)


@pytest.mark.parametrize("drive", [None, "differential", "omnidirectional"])
def test_a_robot_without_wheels_has_no_limit_of_theirs(unwheeled, drive):
    given = {} if drive is None else {"drive": drive}
    assert plan(unwheeled, **given).drive == (drive or "differential")
    with pytest.raises(InputError, match=r"^limits.wheel_speed: qiao2021 has no wheels: its file has no `wheels`$"):
        plan(unwheeled, limits={"wheel_speed": 360}, **given)


def test_a_robot_without_a_base_needs_no_drive():
    ur5 = ikde.load_robot("ur5")
    assert plan(ur5).drive == plan(ur5, drive="omnidirectional").drive == "omnidirectional"
    with pytest.raises(InputError, match=r"^drive: ur5 has no planar base .*; leave it out, or say omnidirectional$"):
        plan(ur5, drive="differential")


def test_a_start_may_be_outside_the_ranges_if_joints_may(qiao):
    made = plan(qiao, start={"q1": 175}, path=path_from(qiao, {"q1": np.radians(175)}), limits={"ranges": False})
    assert made.start[3] == pytest.approx(np.radians(175))

"""Plans of track files: names resolved, m and rad, and what is wrong placed at its key."""

from pathlib import Path

import numpy as np
import pytest

import ikde
from ikde.errors import InputError
from ikde.track.limits import MotionLimits
from ikde.track.plan import make_plan
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


def test_it_introduces_itself_in_a_line(qiao):
    assert repr(plan(qiao)) == "<TrackPlan track: qiao2021, continuation, differential, 1 points>"


def test_it_is_called_by_its_name_or_its_file(qiao):
    assert plan(qiao, file="a/shelf.yaml").name == "shelf"
    assert plan(qiao, file="a/shelf.yaml", name="Shelf").path.name == "Shelf"


def test_limits_are_by_joint_and_a_joints_own_comes_first(qiao):
    speed = {"prismatic": 500, "revolute": 90, "q6": 180, "q5": None}
    limits = plan(qiao, limits={"speed": speed, "acceleration": {"q1": 360}, "wheel_speed": 360}).limits
    np.testing.assert_allclose(limits.speed, [0.5, 0.5] + [np.pi / 2] * 5 + [np.inf, np.pi])
    np.testing.assert_allclose(limits.acceleration, [np.inf] * 3 + [2 * np.pi] + [np.inf] * 5)
    assert limits.wheel_speed_rad_s == pytest.approx(2 * np.pi)


def test_the_other_limits_are_in_metres_and_radians(qiao):
    asked = {"ranges": False, "farthest": 1400, "center": "Oc", "position_error": 0.01, "orientation_error": 1}
    limits = plan(qiao, limits={**asked, "speed": {"q1": 0}}).limits
    assert (limits.ranges, limits.center, limits.speed[3]) == (False, "Oc", 0.0)
    assert (limits.farthest_m, limits.position_error_m) == pytest.approx((1.4, 1e-5))
    assert limits.orientation_error_rad == pytest.approx(np.pi / 180)


def test_ranges_detector_and_start_are_those_of_the_file(qiao):
    made = plan(qiao, ranges={"d_x": [-1000, 1000]}, detector="none", start={"d_x": -500, "q2": 45}, method="typical")
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
        ({"limits": {"farthest": 1}}, "limits.center: `farthest` and `center` go together"),
        ({"limits": {"farthest": 1, "center": "O0"}}, "limits.center: qiao2021 has no frame 'O0'"),
        ({"start": {"q1": 175}}, "start.q1: 3.05433 is outside the range"),
        ({"start": {"elbow": 0}}, "start.elbow: qiao2021 has no joint 'elbow'"),
        ({"dt_s": 1e9}, "dt_s: expected 1e-09 to 1e+06 s"),
    ],
)
def test_what_does_not_fit_is_placed(qiao, keys, words):
    with pytest.raises(InputError) as caught:
        plan(qiao, **keys)
    assert str(caught.value).startswith(words)


@pytest.mark.parametrize("drive", [None, "differential", "omnidirectional"])
def test_a_robot_without_wheels_has_no_limit_of_theirs(unwheeled, drive):
    told = {} if drive is None else {"drive": drive}
    assert plan(unwheeled, **told).drive == (drive or "differential")
    with pytest.raises(InputError, match=r"^limits.wheel_speed: qiao2021 has no wheels: its file has no `wheels`$"):
        plan(unwheeled, limits={"wheel_speed": 360}, **told)


def test_a_robot_without_a_base_needs_no_drive():
    ur5 = ikde.load_robot("ur5")
    assert plan(ur5).drive == plan(ur5, drive="omnidirectional").drive == "omnidirectional"
    with pytest.raises(InputError, match=r"^drive: ur5 has no base .*; leave it out, or say omnidirectional$"):
        plan(ur5, drive="differential")


def test_a_start_may_be_outside_the_ranges_if_joints_may(qiao):
    made = plan(qiao, start={"q1": 175}, limits={"ranges": False})
    assert made.start[3] == pytest.approx(np.radians(175))


def test_changes_are_on_record(qiao):
    made = plan(qiao, drive="omnidirectional", seed=7)
    assert made.with_changes().replaced == ()
    changed = made.with_changes(seed=0, start=qiao.home).with_changes(method="typical")
    assert changed.replaced == ("seed", "start", "method")
    assert (changed.seed, changed.method, changed.drive) == (0, "typical", "omnidirectional")
    np.testing.assert_array_equal(changed.start, qiao.home)


def test_a_drive_without_wheels_has_no_limit_of_theirs(qiao):
    made = plan(qiao, limits={"wheel_speed": 360})
    with pytest.raises(InputError, match=r"^limits.wheel_speed: an omnidirectional drive has no such wheels$"):
        made.with_changes(drive="omnidirectional")
    assert made.with_changes(drive="differential").drive == "differential"
    assert made.with_changes(method="typical", drive="omnidirectional").drive == "omnidirectional"

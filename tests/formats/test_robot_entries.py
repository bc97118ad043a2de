"""Joints and detectors as files name them. What is wrong with them: `tests/batch/test_arms.py`."""

from dataclasses import replace

import numpy as np
import pytest

from ikde import load_robot
from ikde.errors import InputError
from ikde.formats.entries import DetectorEntry, UnitsEntry
from ikde.formats.robot_entries import read_collision, to_si, with_ranges
from tests.endless_robot import ENDLESS
from tests.robot_files import load_text

SI, MM_DEG = UnitsEntry(), UnitsEntry(length="mm", angle="deg")


def test_detectors_are_names_or_the_users_own(qiao):
    assert read_collision(qiao, None, SI).detector is qiao.detectors["improved"]
    assert read_collision(qiao, "none", SI).detector is None
    own = read_collision(qiao, DetectorEntry(name="own", spheres="single"), SI).detector
    assert (own.name, own.spheres, own.pairs, own.safe_distance_m) == ("own", "single", "non_adjacent", 0.0)


def test_a_detector_of_the_users_own_compares_something(qiao):
    robot = replace(qiao, pair_lists={**qiao.pair_lists, "empty": ()})
    with pytest.raises(
        InputError, match=r"^pairs: this detector compares nothing: all 55 pairs are left out: M - G \("
    ):
        read_collision(robot, DetectorEntry(name="own", spheres="single", pairs="empty"), SI)


def test_joint_values_become_metres_and_radians(qiao):
    values = to_si(qiao, "near", {"d_x": 500, "q1": 180, "q2": None}, MM_DEG)
    assert values == {"d_x": 0.5, "q1": pytest.approx(3.141592653589793), "q2": None}
    with pytest.raises(InputError, match=r"^near\.q9: qiao2021 has no joint 'q9'; it has d_x"):
        to_si(qiao, "near", {"q9": 0}, SI)


def test_ranges_replace_those_of_the_robot(qiao):
    robot = with_ranges(qiao, {"d_x": [-1, 1]}, SI)
    assert (robot.joints[0].lower, robot.joints[0].upper, robot.joints[1:]) == (-1.0, 1.0, qiao.joints[1:])
    assert with_ranges(qiao, {}, SI) is qiao
    with pytest.raises(InputError, match=r"^ranges\.d_x: the upper end of this range is below"):
        with_ranges(qiao, {"d_x": [1, -1]}, SI)


def test_a_continuous_joint_with_a_range_is_one_with_limits():
    robot = load_text(ENDLESS)
    ranged = with_ranges(robot, {"pan": [-90, 400], "lift": [0, 10]}, MM_DEG)
    assert [joint.kind for joint in ranged.joints] == ["revolute"] * 5 + ["continuous"]
    assert (ranged.joints[0].lower, ranged.joints[0].upper) == pytest.approx((-1.5707963267948966, 6.981317007977318))
    assert ranged.joints[2:] == robot.joints[2:]


def test_the_files_own_limits_stay_known_and_kernels_are_written_for_both(qiao):
    limits = list(zip(qiao.lower.tolist(), qiao.upper.tolist(), strict=True))
    narrow = with_ranges(qiao, {"q1": [-1, 1]}, SI)
    assert list(narrow.file_ranges) == limits
    assert np.array(narrow.written_ranges).tobytes() == np.array([qiao.lower, qiao.upper]).tobytes()
    both = with_ranges(narrow, {"d_x": [-9, 1], "q1": [-2, 2]}, SI)
    assert both.file_ranges == narrow.file_ranges
    lower, upper = both.written_ranges
    assert (lower[0], upper[0]) == (-9.0, qiao.upper[0])
    assert lower[1:].tolist() == qiao.lower[1:].tolist()
    assert upper.tolist() == qiao.upper.tolist()
    assert qiao.file_ranges == ()


def test_a_joint_that_turns_all_around_needs_no_kernels_for_other_turns():
    ur5 = load_robot("ur5")  # two turns each
    wide = with_ranges(ur5, {"elbow_joint": [-20, 20], "wrist_1_joint": [8, 9]}, SI)
    assert np.array(wide.written_ranges).tobytes() == np.array(ur5.written_ranges).tobytes()
    endless = with_ranges(without_limits(ur5), {"elbow_joint": [5, 6]}, SI)
    assert np.array(endless.written_ranges).tobytes() == np.array(without_limits(ur5).drawn).tobytes()


def without_limits(robot):
    """All joints continuous."""
    joints = (replace(joint, kind="continuous", lower=-np.inf, upper=np.inf) for joint in robot.joints)
    return replace(robot, joints=tuple(joints))


@pytest.mark.parametrize("interval", [[-1.01e5, 0], [0, 1.01e5]])
def test_ranges_end_where_joint_values_do(qiao, interval):
    with pytest.raises(InputError, match=r"^ranges\.d_x: expected at most 100000 m or rad"):
        with_ranges(qiao, {"d_x": interval}, SI)

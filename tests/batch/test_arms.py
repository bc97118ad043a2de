"""Arms: laid over `solve`, in m and rad, and wrong where they were written."""

import numpy as np
import pytest

from ikde.batch.arms import describe_arm, make_arm, make_arms
from ikde.batch.spec import BatchSpec, SolveEntry
from ikde.errors import InputError
from ikde.formats.entries import UnitsEntry
from tests.endless_robot import ENDLESS
from tests.robot_files import load_text

MM_DEG = UnitsEntry(length="mm", angle="deg")
SI = UnitsEntry()


def spec(**keys):
    return BatchSpec.model_validate({"robot": "qiao2021", "targets": {"inline": [{"position": [1, 2, 3]}]}, **keys})


def arm(robot, units=MM_DEG, **keys):
    return make_arm("a", robot, SolveEntry.model_validate(keys), units).problem


def complaint(call, *arguments, **keys):
    with pytest.raises(InputError) as caught:
        call(*arguments, **keys)
    return str(caught.value)


def test_units_become_metres_and_radians(qiao):
    problem = arm(
        qiao,
        settings={"position_tolerance": 0.05, "orientation_tolerance": 1, "timeout_s": 2},
        ranges={"d_x": [-60, 60], "q1": [-90, 90]},
        near={"d_y": 100, "q2": 45},
        weights={"q2": 2, "d_x": 0.5},
        freeze={"q_z": 30, "d_x": None},
        detector={"name": "own", "spheres": "typical", "pairs": "non_adjacent", "safe_distance": 5},
    )
    named = dict(zip(qiao.joint_names, zip(problem.lower, problem.upper, strict=True), strict=True))
    assert problem.settings.position_tolerance_m == pytest.approx(5e-5)
    assert problem.settings.timeout_s == 2
    assert problem.settings.orientation_tolerance_rad == pytest.approx(np.pi / 180)
    assert named["q1"] == pytest.approx((-np.pi / 2, np.pi / 2))
    assert named["q_z"] == pytest.approx((np.pi / 6, np.pi / 6))
    assert named["d_x"] == (0.0, 0.0)
    assert problem.weights[[0, 4]].tolist() == [0.5, 2.0]
    assert problem.near[[1, 4]] == pytest.approx([0.1, np.pi / 4])
    assert (problem.robot.joints[0].lower, problem.robot.joints[0].upper) == pytest.approx((-0.06, 0.06))
    assert problem.collision.detector.safe_distance_m == pytest.approx(0.005)


def test_a_range_may_be_wider_than_the_robots(qiao):
    assert arm(qiao, ranges={"d_x": [-9000, 9000]}).upper[0] == pytest.approx(9.0)


def test_without_ranges_the_robot_stays_the_same_object(qiao):
    assert arm(qiao).robot is qiao


def test_one_arm_is_called_like_its_method(qiao):
    assert [(a.name, a.method) for a in make_arms(spec(solve={"method": "de"}), qiao)] == [("de", "de")]


def test_arms_are_laid_over_solve(qiao):
    solve = {
        "method": "de",
        "settings": {"restarts": 3, "de": {"population": 20, "weight": 0.7}},
        "ranges": {"d_x": [-1, 1]},
    }
    over = {"detector": "typical", "settings": {"de": {"population": 30}}, "ranges": {"d_y": [-2, 2]}}
    plain, changed = make_arms(spec(solve=solve, arms={"plain": {}, "changed": over}), qiao)
    assert (plain.method, changed.method) == ("de", "de")
    assert (plain.problem.collision.name, changed.problem.collision.name) == ("improved", "typical")
    assert (plain.problem.settings.de.population, changed.problem.settings.de.population) == (20, 30)
    assert (changed.problem.settings.de.weight, changed.problem.settings.restarts) == (0.7, 3)
    np.testing.assert_array_equal(plain.problem.upper[:2], [1, 5])
    np.testing.assert_array_equal(changed.problem.upper[:2], [1, 2])


def test_an_error_stands_where_it_was_written(qiao):
    few, more, weight = ({"settings": {"de": de}} for de in ({"population": 2}, {"population": 20}, {"weight": 0.6}))
    inherited = spec(solve={"method": "de", **few}, arms={"a": weight})
    assert complaint(make_arms, inherited, qiao).startswith("solve.settings.de.population: ")
    own = spec(solve={"method": "de", **more}, arms={"a": few})
    assert complaint(make_arms, own, qiao).startswith("arms.a.settings.de.population: ")


@pytest.mark.parametrize("method", ["auto", "lm", "memetic"])
def test_what_the_method_would_ignore_is_refused_where_it_was_written(qiao, method):
    de, refused = {"settings": {"de": {"population": 20}}}, "`population` is a setting of the method de; "
    inherited = spec(solve={"method": "de", **de}, arms={"a": {"method": method}})
    assert complaint(make_arms, inherited, qiao).startswith(f"solve.settings.de.population: {refused}{method} does not")
    own = spec(arms={"a": {"method": method, **de}})
    assert complaint(make_arms, own, qiao).startswith(f"arms.a.settings.de.population: {refused}{method} does not")


def test_an_arm_may_leave_out_the_settings_of_another_method(qiao):
    solve = {"method": "de", "settings": {"restarts": 3, "de": {"population": 20}}}
    (arm,) = make_arms(spec(solve=solve, arms={"a": {"method": "lm", "settings": {"de": None}}}), qiao)
    assert (arm.problem.settings.de, arm.problem.settings.restarts) == (None, 3)


def test_names_of_arms_can_name_files(qiao):
    assert "names files" in complaint(make_arms, spec(arms={"a/b": {}}), qiao)


@pytest.mark.parametrize(
    ("keys", "expected"),
    [
        ({"detector": "improvd"}, "detector: qiao2021 has no detector 'improvd'"),
        ({"detector": {"name": "x", "spheres": "typcal"}}, "detector.spheres: no approximation is called 'typcal'"),
        ({"detector": {"name": "none", "spheres": "typical"}}, "detector.name: 'none' is taken"),
        ({"settings": {"position_tolerance": -1}}, "settings.position_tolerance: expected a finite number above 0"),
        ({"method": "de", "settings": {"de": {"strategy": "best"}}}, "settings.de.strategy: expected one of rand/1"),
        ({"ranges": {"d_z": [0, 1]}}, "ranges.d_z: qiao2021 has no joint 'd_z' (did you mean"),
        ({"ranges": {"d_x": [1, 0]}}, "ranges.d_x: the upper end of this range is below"),
        ({"near": {"elbow": 0}}, "near.elbow: qiao2021 has no joint 'elbow'; it has d_x"),
        ({"weights": {"q1": 0}}, "weights.q1: expected a number from 1e-06 to 1e+06, got 0"),
        ({"near": {"q1": 1e9}}, "near.q1: expected at most 100000 m or rad"),
        ({"freeze": {"q1": 300}}, "freeze.q1: 5.23599 is outside the limits"),
    ],
)
def test_what_does_not_fit_the_robot_is_named(qiao, keys, expected):
    assert complaint(arm, qiao, **keys).startswith(expected)


def test_the_description_holds_what_the_answers_hang_on(qiao):
    entry = SolveEntry.model_validate({"freeze": {"q_z": 0.5}, "near": {"q1": 1}, "ranges": {"d_x": [-1, 1]}})
    plain = describe_arm(make_arm("a", qiao, entry, SI))
    assert plain["freeze"] == {"q_z": 0.5}
    assert (plain["near"]["q1"], plain["near"]["q_z"]) == (1.0, 0.5)
    assert (plain["ranges"]["d_x"], plain["ranges"]["d_y"]) == ([-1.0, 1.0], [-5.0, 5.0])
    assert plain["detector"]["spheres"] == "improved"
    assert (plain["method"], plain["settings"]["method"], plain["settings"]["de"]) == ("auto", "auto", None)


def test_the_description_of_a_joint_without_limits_has_nulls():
    robot = load_text(ENDLESS)
    plain = describe_arm(make_arm("a", robot, SolveEntry.model_validate({"freeze": {"pan": 100}}), SI))
    assert (plain["ranges"]["pan"], plain["freeze"]) == ([None, None], {"pan": 100.0})
    ranged = describe_arm(make_arm("a", robot, SolveEntry.model_validate({"ranges": {"pan": [-7, 7]}}), SI))
    assert ranged["ranges"]["pan"] == [-7.0, 7.0]

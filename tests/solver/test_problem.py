"""What holds in a search: ranges after freezing, the start, and the numbers that the kernels get."""

from dataclasses import replace

import numpy as np
import pytest

import ikde
from ikde.errors import InputError
from ikde.kernels.arrays import FEASIBILITY, IGNORE, REJECT
from ikde.kernels.mutation import REPAIRS, STRATEGIES
from ikde.model.collision_model import CollisionModel
from ikde.model.solids import make_solid
from ikde.model.world import make_obstacle, make_world
from ikde.solver.problem import make_problem, pack_search, pack_searched
from ikde.solver.settings import SolveSettings
from tests.endless_robot import ENDLESS
from tests.flat_settings import flat_settings
from tests.problems import problem_of
from tests.robot_files import load_text


def frozen_values(robot, problem):
    """Value of every joint whose range is one point; these are the joints called frozen."""
    fixed = {
        name: float(lower)
        for name, lower, upper in zip(robot.joint_names, problem.lower, problem.upper, strict=True)
        if lower == upper
    }
    assert set(problem.frozen) == set(fixed)
    return fixed


def test_nothing_frozen_leaves_the_limits(qiao):
    problem = problem_of(qiao)
    assert problem.lower.tolist() == qiao.lower.tolist()
    assert problem.upper.tolist() == qiao.upper.tolist()
    assert (problem.frozen, problem.near) == ((), None)
    assert problem.collision.detector == qiao.detectors["improved"]


@pytest.mark.parametrize(
    ("freeze", "near", "expected"),
    [
        ({"d_x": 0.2, "q1": -1.0}, None, {"d_x": 0.2, "q1": -1.0}),
        ({"q1": None}, None, {"q1": np.pi / 2}),
        (["q1", "d_y"], None, {"q1": np.pi / 2, "d_y": 0.0}),
        (("q1",), {"q1": 0.5}, {"q1": 0.5}),
        ({"q1": None, "q2": 0.1}, {"q1": 0.5, "q2": 0.9}, {"q1": 0.5, "q2": 0.1}),
        (iter(["q2"]), {"q1": 0.5}, {"q2": 0.0}),
        ({}, None, {}),
        ([], {"q1": 0.5}, {}),
    ],
)
def test_every_form_of_freeze(qiao, freeze, near, expected):
    assert frozen_values(qiao, problem_of(qiao, freeze=freeze, near=near)) == expected


@pytest.mark.parametrize("side", ["lower", "upper"])
def test_a_joint_may_be_frozen_on_its_limit(qiao, side):
    limit = float(getattr(qiao, side)[4])
    assert frozen_values(qiao, problem_of(qiao, freeze={"q2": limit})) == {"q2": limit}


@pytest.mark.parametrize(
    ("freeze", "words"),
    [
        ({"d_x": 5.1}, r"freeze\.d_x: 5\.1 is outside the limits \[-5, 5\]"),
        ({"q2": -3.0}, r"freeze\.q2: -3 is outside the limits"),
        ({"q9": 0.0}, "no joint 'q9'"),
        (["q9"], "no joint 'q9'"),
        ({"q1": np.nan}, "finite"),
        ({"q1": "a"}, "expected numbers"),
    ],
)
def test_a_bad_freeze_is_refused(qiao, freeze, words):
    with pytest.raises(InputError, match=words):
        problem_of(qiao, freeze=freeze)


def test_freezing_at_a_start_outside_the_limits_is_refused(qiao):
    with pytest.raises(InputError, match=r"freeze\.d_x: 7 is outside"):
        problem_of(qiao, near={"d_x": 7.0}, freeze=["d_x"])


def test_near_is_clipped_to_the_ranges_that_hold(qiao):
    problem = problem_of(qiao, near={"d_x": 9.0, "q2": -9.0, "q3": 0.5}, freeze={"q3": 0.1})
    assert problem.near[[0, 4, 5]].tolist() == [5.0, qiao.lower[4], 0.1]


def test_joints_that_near_leaves_out_start_at_home(qiao):
    problem = problem_of(qiao, near={"d_x": 1.0})
    assert problem.near.tolist() == [1.0, *qiao.home[1:]]


def test_the_robots_limits_are_not_written_over(qiao):
    before = qiao.lower.tolist()
    problem_of(qiao, freeze={"d_x": 0.2})
    assert qiao.lower.tolist() == before


def test_other_ranges_free_the_joints(qiao):
    problem = problem_of(qiao, freeze=["d_x"]).with_ranges(qiao.lower, qiao.upper)
    assert problem.frozen == ()
    assert problem.lower[0] == -5.0


def test_changed_settings_leave_the_rest(qiao):
    problem = problem_of(qiao, freeze=["d_x"])
    changed = problem.with_settings(restarts=3)
    assert (changed.settings.restarts, changed.frozen, problem.settings.restarts) == (3, ("d_x",), None)


@pytest.mark.parametrize(
    ("detector", "collision", "rule"),
    [(None, "reject", REJECT), (None, "feasibility", FEASIBILITY), ("none", "reject", IGNORE)],
)
def test_the_collision_rule_is_packed(qiao, detector, collision, rule):
    settings = flat_settings(collision=collision)
    assert pack_search(problem_of(qiao, settings, collision=detector)).collision_rule == rule


def test_numbers_are_packed_as_they_are(qiao):
    settings = flat_settings(
        population=9, generations=8, weight=1, crossover=0, strategy="best/2", bounds="clip", update="in_place"
    )
    packed = pack_search(problem_of(qiao, settings))
    assert (packed.population, packed.generations, packed.weight, packed.crossover) == (9, 8, 1.0, 0.0)
    assert packed.start_share == 1.0
    assert (STRATEGIES[packed.strategy], REPAIRS[packed.repair], packed.in_place) == ("best/2", "clip", True)
    assert packed.ranges[:2].tolist() == [qiao.lower.tolist(), qiao.upper.tolist()]


def test_an_engine_without_settings_of_the_de_is_packed_with_their_defaults(qiao):
    packed, asked = (pack_search(problem_of(qiao, ikde.SolveSettings(method=method))) for method in ("memetic", "de"))
    assert packed._replace(ranges=None) == asked._replace(ranges=None)


def test_without_near_the_whole_range_is_searched_at_once(qiao):
    assert pack_search(problem_of(qiao)).first_box == 1.0
    packed = pack_search(problem_of(qiao, near=qiao.home))
    assert packed.first_box == 1 / 64
    assert packed.ranges[2].tolist() == qiao.home.tolist()


@pytest.mark.parametrize("tolerance", [1e-3, 1e-5, 1e-12, 1e-300])
def test_kernels_aim_a_hair_below_the_tolerance(qiao, tolerance):
    settings = ikde.SolveSettings(position_tolerance_m=tolerance, orientation_tolerance_rad=tolerance)
    packed = pack_search(problem_of(qiao, settings))
    for aim in (packed.position_tolerance, packed.orientation_tolerance):
        assert 0.5 * tolerance <= aim < tolerance
        assert tolerance - aim <= 1e-12


def test_searches_keep_a_hair_more_than_the_safe_distance(qiao):
    """So that rounding cannot turn the grader's verdict."""
    collision = CollisionModel.of(qiao, replace(qiao.detectors["improved"], safe_distance_m=0.01))
    searched = pack_searched(collision)[1].safe_distance
    assert 0.01 < searched < 0.01 + 1e-9


# ---- joints without limits


@pytest.fixture(scope="module")
def endless():
    return load_text(ENDLESS)


def test_a_joint_without_limits_is_searched_two_turns_about_near_else_home(endless):
    for near, pan, spin in ((None, 0.0, 0.5 * np.pi), ({"pan": 50.0}, 50.0, 0.5 * np.pi), ({"spin": -7.0}, 0.0, -7.0)):
        problem = problem_of(endless, near=near)
        assert problem.lower[[0, 5]] == pytest.approx([pan - 4.0 * np.pi, spin - 4.0 * np.pi])
        assert problem.upper[[0, 5]] == pytest.approx([pan + 4.0 * np.pi, spin + 4.0 * np.pi])
        assert (problem.lower[1:5] == endless.lower[1:5]).all()
        assert (problem.upper[1:5] == endless.upper[1:5]).all()
        assert np.isfinite(pack_search(problem).ranges).all()


def test_it_is_drawn_from_one_turn_about_home_wherever_it_searches(endless):
    for near in (None, {"pan": 50.0}):
        lower, upper = problem_of(endless, near=near, freeze={"spin": 100.0, "lift": 0.1}).drawn
        assert (lower[0], upper[0]) == (-np.pi, np.pi)
        assert (lower[5], upper[5]) == (100.0, 100.0)
        assert (lower[1], upper[1]) == (0.1, 0.1)
        assert (lower[3], upper[3]) == (endless.lower[3], endless.upper[3])


def test_it_may_be_frozen_anywhere(endless):
    assert frozen_values(endless, problem_of(endless, freeze={"pan": -9e4})) == {"pan": -9e4}
    assert frozen_values(endless, problem_of(endless, freeze=["pan"], near={"pan": 60.0})) == {"pan": 60.0}
    with pytest.raises(InputError, match="outside the limits"):
        problem_of(endless, freeze={"roll": 7.0})


def test_without_freezing_the_ranges_are_those_of_the_search(endless):
    problem = problem_of(endless, freeze={"pan": 60.0, "lift": 0.1}, near={"spin": 5.0})
    assert np.array_equal(problem.free_ranges, endless.finite_limits(problem.centre, 2.0))


def test_turns_stay_inside_the_limits_where_a_probe_asks_for_more(endless):
    problem = problem_of(endless, freeze={"bend": 0.3}, near={"roll": 1.0})
    wide = problem.with_ranges(problem.lower - 1.0, problem.upper + 1.0)
    lower, upper, turning, centre = wide.turns
    assert (lower[3], upper[3]) == (endless.lower[3], endless.upper[3])
    assert (lower[0], upper[0]) == (wide.lower[0], wide.upper[0])
    lower, upper, turning, centre = problem.turns
    assert (lower[4], upper[4], centre[3]) == (0.3, 0.3, 1.0)
    assert turning.all()
    assert (problem_of(endless).turns[3] == endless.home).all()


def test_slides_do_not_turn(qiao):
    assert problem_of(qiao).turns[2].tolist() == [False, False] + [True] * 7


@pytest.mark.parametrize("freeze", [[3], b"abc", 3, [["q1"]], {"q1": 10**400}, {"q1": 1j}])
def test_what_names_no_joints_is_refused_as_freeze(qiao, freeze):
    with pytest.raises(InputError, match=r"^freeze: expected"):
        make_problem(qiao, SolveSettings(), collision=None, near=None, freeze=freeze)


def test_without_an_obstacle_the_other_distances_are_kept(qiao):
    balls = [make_obstacle(name, [make_solid("sphere", (0.1,))], T) for name, T in (("a", far(3.0)), ("b", far(4.0)))]
    model = CollisionModel.of(qiao).in_world(make_world(balls), 0.02, {"LT": 0.05})
    left = problem_of(qiao, collision=model).without_obstacle("a").collision
    assert left.world.names == ("b",)
    assert (left.margin_m, left.margins_m) == (0.02, (("LT", 0.05),))


def far(x):
    T = np.eye(4)
    T[0, 3] = x
    return T

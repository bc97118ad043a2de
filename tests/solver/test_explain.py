"""Why there is no solution: the word is right, the metrics are right, and the hint works."""

import re
from dataclasses import replace
from itertools import count

import numpy as np
import pytest

import ikde
from ikde.kernels.arrays import ATTEMPTS, COLLIDING, COUNTS, REACHED
from ikde.model.bounds import find_bounds
from ikde.model.collision_model import CollisionModel
from ikde.solver.engine_table import ENGINES
from ikde.solver.engines.search_state import keep_pairs, make_search_state
from ikde.solver.explain import PROVED
from ikde.solver.metrics import compute_metrics
from ikde.solver.search import SearchState, search
from ikde.solver.settings import BulkOptions
from ikde.solver.touching import find_always_touching
from tests.bare_robot import BARE
from tests.flat_settings import flat_settings
from tests.scara import make_scara
from tests.substitutes import never
from tests.targets import make_target

QUICK = flat_settings(restarts=6, generations=500)
TARGET = ikde.Target((0.8, 0.5, 1.0))
INSIDE_THE_PLATFORM = ikde.Target((0.34, 0.0, 0.2))
PARKED = {"d_x": 0.0, "d_y": 0.0, "q_z": 0.0}
STRAIGHT, CLOSE = PARKED | {"q3": 0.0}, ikde.Target((0.34, 0.2, 0.9))  # which a straight arm cannot come to


def with_base_range(robot, half_m):
    """The robot whose slides go from -half to half."""

    def cut(joint):
        return replace(joint, lower=-half_m, upper=half_m) if joint.kind == "prismatic" else joint

    return replace(robot, joints=tuple(cut(joint) for joint in robot.joints))


def excess_m(robot, position, *, frozen=False):
    lower, upper = robot.lower, robot.upper
    if frozen:
        lower[:3] = upper[:3] = 0.0
    return find_bounds(robot, lower, upper).reach.excess_m(np.array(position))


def test_out_of_reach_states_the_excess(qiao):
    result = ikde.solve(qiao, ikde.Target((20.0, 0.0, 1.0)), QUICK)
    assert result.stop_reason == "out_of_reach"
    excess = excess_m(qiao, (20.0, 0.0, 1.0))
    told = re.fullmatch(r"out of reach: at least ([\d.]+) m too far, whatever the joints do", result.reason)
    assert 0.0 <= excess - float(told[1]) < 1e-3
    assert 0.0 < excess <= result.position_error_m
    assert result.blocking_pairs == {}


def test_out_of_reach_is_known_after_a_few_attempts(qiao):
    result = ikde.solve(qiao, ikde.Target((20.0, 0.0, 1.0)), QUICK.with_changes(restarts=1000))
    assert result.attempts == 4


def test_no_range_helps_a_target_above_the_arm(qiao):
    result = ikde.solve(qiao, ikde.Target((0.0, 0.0, 5.0)), QUICK)
    assert result.stop_reason == "out_of_reach"
    assert result.hint == "a target closer to the robot; no joint range brings the tool there"
    assert excess_m(with_base_range(qiao, 1e5), (0.0, 0.0, 5.0)) > 3.0


def test_a_robot_without_a_base_is_told_nothing_about_one():
    result = ikde.solve(ikde.load_robot("ur5"), ikde.Target((0.8, 0.5, 1.0)))
    assert result.stop_reason == "out_of_reach"
    assert "base" not in result.reason + result.hint


@pytest.mark.parametrize("quill_m", [0.05, 0.5])
def test_a_tool_that_no_joint_tilts_is_told_by_how_much_it_stays_off(quill_m):
    robot, target = make_scara(quill_m), ikde.Target((0.74, 0.1, -0.2), axis_world_tool=(1, 0, -1))
    result = ikde.solve(robot, target, ikde.SolveSettings(restarts=2))
    assert result.stop_reason == "out_of_reach"
    off = "0.785 rad off in orientation, whatever the joints do"
    far = "0.149 m too far and " if quill_m < 0.2 else ""  # 0.15, rounded to the safe side
    assert result.reason == f"out of reach: at least {far}{off}"
    assert result.orientation_error_rad >= 0.785
    kept = "the tool's z axis stays 3.142 rad from 0 0 1 of the world"
    assert result.hint == f"another orientation ({kept}); no joint range brings the tool there"
    upright = ikde.Target((0.74, 0.1, -0.2), axis_world_tool=(0, 0, -1))
    assert ikde.solve(robot, upright).reached is (quill_m > 0.2)


@pytest.mark.parametrize(
    ("collision", "hint"),
    [("feasibility", "free d_x, d_y, q_z: a solution was found without freezing"), ("reject", None)],
)
def test_a_target_inside_the_platform_is_met_by_colliding_configurations_only(qiao, collision, hint):
    settings = QUICK.with_changes(de={"collision": collision})
    result = ikde.solve(qiao, INSIDE_THE_PLATFORM, settings, freeze=PARKED)
    assert result.stop_reason == "collision"
    assert not result.reached
    assert result.reason.startswith("only colliding solutions found")
    assert ("M", "LT") in result.blocking_pairs
    counts = list(result.blocking_pairs.values())
    assert counts == sorted(counts, reverse=True)
    assert counts[-1] > 0
    assert result.hint == hint


def test_blocking_pairs_count_at_most_once_an_attempt(qiao):
    result = ikde.solve(qiao, INSIDE_THE_PLATFORM, QUICK.with_changes(de={"collision": "reject"}), freeze=PARKED)
    assert max(result.blocking_pairs.values()) <= result.rejected <= result.attempts


def test_collision_names_frozen_joints_if_freeing_them_helps(qiao):
    result = ikde.solve(qiao, INSIDE_THE_PLATFORM, ikde.SolveSettings(restarts=6), freeze=PARKED)
    assert result.hint.startswith("free d_x, d_y, q_z")
    assert ikde.solve(qiao, INSIDE_THE_PLATFORM).reached


def test_a_detector_that_collides_everywhere_is_named_by_its_pairs(qiao):
    result = ikde.solve(qiao, INSIDE_THE_PLATFORM, QUICK, collision="single", freeze=PARKED)
    assert result.stop_reason == "collision"
    assert ("M", "LT") in result.blocking_pairs
    assert result.detector == "single"


def test_a_pair_that_always_touches_is_named_with_the_line_to_add(tmp_path):
    (tmp_path / "fat.yaml").write_text(BARE.replace("radius: 0.35", "radius: 0.9"))
    result = ikde.solve(ikde.load_robot(tmp_path / "fat.yaml"), ikde.Target((0.5, 0.5, 0.9)), QUICK)
    assert (result.reached, result.stop_reason) == (False, "collision")
    assert result.reason == (
        "platform - upper_arm touches in each of 1,000 random configurations; if that is meant, add to the robot file: "
        'adjacent: {pairs: {platform: {upper_arm: "why they may touch"}}}'
    )
    assert ("platform", "upper_arm") in result.blocking_pairs


@pytest.mark.parametrize(("target", "helps"), [(TARGET, True), (INSIDE_THE_PLATFORM, False)])
def test_leaving_out_what_always_touches_is_told_if_nothing_else_is_in_the_way(qiao, target, helps):
    result = ikde.solve(qiao, target, ikde.SolveSettings(restarts=4), collision="single", freeze=PARKED)
    assert result.reason.startswith("M - L1 touches in each of 1,000 random configurations")
    assert (result.hint == "these pairs left out: a solution was found that touches in no others") is helps
    assert result.hint is None or helps
    rest = tuple(pair for pair in CollisionModel.of(qiao, "single").pairs if pair != ("M", "L1"))
    spared = replace(qiao, pair_lists={**qiao.pair_lists, "rest": rest})
    detector = ikde.Detector(name="rest", spheres="single", pairs="rest")
    assert ikde.verify(spared, target, result.q, collision=detector).accepted is helps


def test_what_is_reached_is_not_searched_for_pairs_that_touch(qiao, substitute):
    substitute(find_always_touching, never)
    assert ikde.solve(qiao, TARGET).reached
    assert ikde.solve(qiao, ikde.Target((20.0, 0.0, 1.0)), QUICK).stop_reason == "out_of_reach"


def test_a_target_just_outside_the_joint_ranges_names_the_joints_to_widen(qiao):
    small, target = with_base_range(qiao, 0.1), ikde.Target((1.9, 0.0, 0.6))
    result = ikde.solve(small, target, QUICK)
    assert result.stop_reason == "limits"
    assert result.reason.startswith("no solution inside the joint ranges found in 6 attempts; the best is off by")
    assert result.hint.startswith("a wider range for d_x")
    wide = ikde.solve(with_base_range(qiao, 0.4), target)
    assert wide.reached
    assert abs(wide.q[0]) > 0.1


def test_a_target_that_frozen_joints_exclude_names_them(qiao):
    result = ikde.solve(qiao, CLOSE, QUICK, freeze=STRAIGHT)
    assert result.stop_reason == "limits"
    assert result.hint.startswith("free d_x, d_y, q_z, q3")
    assert ikde.solve(qiao, CLOSE).reached


def ask_of_ur5(q, **ranges):
    """What a UR5 with other ranges is told of the tool's pose at `q`, after how many attempts."""
    robot = ikde.load_robot("ur5")
    target = make_target(robot, np.array(q), "pose")
    joints = tuple(
        replace(joint, lower=ranges[joint.name][0], upper=ranges[joint.name][1]) if joint.name in ranges else joint
        for joint in robot.joints
    )
    return ikde.solve(replace(robot, joints=joints), target)


def test_a_pose_that_only_colliding_branches_reach_is_proved_to_have_no_solution():
    result = ask_of_ur5([0.3, -1.0, 2.95, 0.4, 1.2, 0.0])
    assert (result.reached, result.stop_reason, result.hint) == (False, "collision", None)
    assert result.attempts == 1 + ENGINES["lm"].attempts_before_proof
    told = re.fullmatch(r"no solution, proved: of (\d) .* with this pose \1 in collision \((.*)\)", result.reason)
    worst, count = next(iter(result.blocking_pairs.items()))
    assert told[2].startswith(f"{worst[0]}-{worst[1]} in {count}")
    assert result.position_error_m < 1e-9


def test_a_pose_that_all_branches_reach_beyond_the_limits_names_the_joint_in_the_way():
    result = ask_of_ur5([0.3, -1.2, 1.4, -1.5, 1.3, 0.4], wrist_2_joint=(-0.5, 0.5))
    assert (result.reached, result.stop_reason) == (False, "limits")
    assert result.reason.startswith("no solution, proved: of 8 configurations with this pose 8 outside the limits of ")
    assert re.search(r"\bwrist_2_joint\b", result.reason)
    assert result.hint == "a wider range for wrist_2_joint: a solution was found beyond the limits"


def test_a_pose_that_no_branch_reaches_is_out_of_reach_without_a_bound_on_the_arm():
    """Near enough, but the wrist would have to be inside the shoulder."""
    target = ikde.Target((0.0, 0.05, 0.5), R_world_tool=np.eye(3))
    result = ikde.solve(ikde.load_robot("ur5"), target)
    assert result.stop_reason == "out_of_reach"
    assert result.reason == "no solution, proved: no configuration of the arm, whatever its limits, has this pose"


def test_a_pose_that_a_frozen_base_rules_out_names_it(qiao):
    target = make_target(qiao, qiao.home + 0.1, "pose")
    away = {"d_x": float(qiao.home[0]) + 0.6, "d_y": float(qiao.home[1]), "q_z": float(qiao.home[2])}
    result = ikde.solve(qiao, target, freeze=away)
    if result.stop_reason != "reached":
        assert result.reason.startswith(("no solution, proved: ", "out of reach"))
        assert "d_x" in result.hint


def test_unexplained_rows_say_what_is_proved_and_no_more(rng):
    robot = ikde.load_robot("ur5")
    targets = ikde.Targets(rng.uniform(-0.9, 0.9, (200, 3)), R_world_tool=np.tile(np.eye(3), (200, 1, 1)))
    rows = ikde.solve_many(robot, targets, bulk=BulkOptions(explain=False))
    proved = np.flatnonzero(rows.found.ruled_out >= 0)
    assert len(proved) > 10
    for row in proved.tolist():
        assert rows.stop_reasons[row] == rows.found.ruled_out[row]
        assert rows[row].reason == f"no solution, proved: {PROVED[rows[row].stop_reason]}"


def test_a_spent_budget_is_called_so(qiao):
    settings = QUICK.with_changes(restarts=1, de={"generations": 3})
    result = ikde.solve(qiao, TARGET, settings)
    assert result.stop_reason == "budget"
    assert result.reason.startswith("1 attempt")
    assert f"{result.position_error_m:.3g} m" in result.reason
    assert result.hint is None  # nothing was found that would help


def after_the_first(function, other):
    """The first call goes to one function, that of the search itself, and those that follow, its probes, to another."""
    calls = count()

    def call(*arguments, **options):
        return (other if next(calls) else function)(*arguments, **options)

    return call


def test_a_free_solution_that_a_probe_finds_is_not_called_a_collision(qiao, substitute):
    solution = ikde.solve(qiao, TARGET)

    def probe(problem, targets, **options):
        counts = np.zeros((1, COUNTS), dtype=np.int64)
        counts[0, [REACHED, ATTEMPTS, COLLIDING]] = 1, 2, 1
        nothing, pair_counts = np.zeros(1), np.ones((1, 35), dtype=np.int64)
        some = {
            "score": np.zeros((1, 2)),
            "excess_m": nothing,
            "excess_rad": nothing,
            "seconds": nothing,
            "engine": np.zeros(1, dtype=np.int64),
            "ruled_out": np.full(1, -1),
            "metrics": compute_metrics(CollisionModel.of(qiao), targets, qiao.home[None]),
        }
        return SearchState(q=solution.q[None], counts=counts, pair_counts=keep_pairs(pair_counts), **some)

    substitute(search, after_the_first(search, probe))
    result = ikde.solve(qiao, TARGET, QUICK.with_changes(restarts=1, de={"generations": 3}))
    assert result.stop_reason == "budget"
    assert result.hint.startswith("collision reject: a solution was found")


def test_what_other_random_numbers_find_free_is_not_called_a_collision(qiao, substitute):
    """Colliding solutions are counted on other streams; a free one among them is the answer."""

    def unlucky(problem, targets, **options):
        found = make_search_state(problem, len(targets))
        found.counts[:, [ATTEMPTS, COLLIDING]] = 3
        metrics = compute_metrics(CollisionModel.of(qiao), targets, found.q, settings)
        found.metrics.put(np.arange(len(targets)), metrics)
        return found

    settings = ikde.SolveSettings(method="lm")
    substitute(search, after_the_first(unlucky, search))
    result = ikde.solve_many(qiao, [TARGET], settings, freeze=PARKED)[0]
    assert result.stop_reason == "budget"
    stream = int(re.fullmatch(r"other random numbers: with this seed and stream (\d+) .*", result.hint)[1])
    assert ikde.solve(qiao, TARGET, settings, freeze=PARKED, stream=stream).reached


def test_an_explanation_repeats(qiao):
    first, again = (ikde.solve(qiao, INSIDE_THE_PLATFORM, QUICK, freeze=PARKED, seed=3) for _ in range(2))
    assert (first.reason, first.hint, first.blocking_pairs) == (again.reason, again.hint, again.blocking_pairs)


@pytest.mark.parametrize("position", [(0.0, 0.0, 5.0), (0.34, 0.0, 0.2)])
def test_a_reason_and_a_hint_are_one_line(qiao, position):
    result = ikde.solve(qiao, ikde.Target(position), QUICK, freeze=PARKED)
    assert "\n" not in result.reason + result.hint


def test_a_target_that_runs_out_of_time_says_how_long_and_how_often_it_was_tried(qiao):
    timed = ikde.SolveSettings(restarts=10**6, timeout_s=1e-9)  # so that one call of the engine is made
    result = ikde.solve(qiao, INSIDE_THE_PLATFORM, timed, freeze=PARKED)
    assert (result.reached, result.stop_reason) == (False, "timed_out")
    assert result.reason.startswith(f"timed out after 1e-09 s and {result.attempts} attempts, ")
    assert f"{result.rejected} of them in collision at the target; the best is off by" in result.reason
    assert result.hint.startswith("a longer timeout, or none")
    assert result.blocking_pairs
    asked = {"freeze": PARKED, "bulk": BulkOptions(explain=False)}
    row = ikde.solve_many(qiao, [INSIDE_THE_PLATFORM], timed, **asked)[0]
    assert row.stop_reason == "timed_out"
    assert result.reason.startswith(row.reason)


def test_what_is_proved_or_reached_does_not_run_out_of_time(qiao):
    timed = ikde.SolveSettings(timeout_s=1e-9)
    assert ikde.solve(qiao, ikde.Target((20.0, 0.0, 1.0)), timed).stop_reason == "out_of_reach"
    assert ikde.solve(qiao, TARGET, timed).reached


def test_with_time_to_spare_the_reason_is_looked_for(qiao):
    timed = ikde.SolveSettings(restarts=6, timeout_s=1e6)
    result = ikde.solve(qiao, INSIDE_THE_PLATFORM, timed, freeze=PARKED)
    assert result.stop_reason == "collision"
    assert result.hint.startswith("free d_x, d_y, q_z")


def test_short_searches_share_what_is_left_of_the_time(qiao, substitute):
    spent = []

    def probe(problem, targets, spent_s, **options):
        spent.append(spent_s)
        found = make_search_state(problem, len(targets))
        found.seconds[:] = 2.0
        return found

    substitute(search, after_the_first(search, probe))
    timed = flat_settings(population=6, generations=1, restarts=1, timeout_s=1e6)
    waited_s, searched_s = ikde.solve(qiao, CLOSE, timed, freeze=STRAIGHT).solve_seconds, spent[0]
    assert 0.0 < searched_s < waited_s
    assert spent == [searched_s, searched_s + 2.0, searched_s + 4.0, searched_s + 6.0]

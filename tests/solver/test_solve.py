"""`solve` and `solve_many`: targets are met, metrics are true, and equal seeds give equal bits."""

import copy
import pickle
from dataclasses import replace

import numpy as np
import pytest

import ikde
from ikde.errors import InputError
from ikde.model.target import KINDS
from ikde.solver.settings import BulkOptions, DeSettings
from tests.bare_robot import BARE, platform_to_upper_arm
from tests.conftest import ROBOTS, random_q
from tests.problems import CHEAP, QUICK, TARGET, assert_true_to_its_figures
from tests.targets import free_q, make_target

WITH_SPHERES = [name for name in ROBOTS if ikde.load_robot(name).detectors]


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("name", WITH_SPHERES)
def test_targets_of_every_kind_are_reached_on_every_robot(name, kind, rng):
    robot = ikde.load_robot(name)
    target = make_target(robot, free_q(robot, rng), kind)
    result = ikde.solve(robot, target, seed=1)
    assert_true_to_its_figures(robot, target, result, ikde.SolveSettings.for_method("auto"))
    assert result.joint_names == robot.joint_names
    assert result.detector == robot.default_detector


@pytest.mark.parametrize("name", WITH_SPHERES)
def test_the_papers_method_reaches_its_own_tolerance(name, rng):
    robot = ikde.load_robot(name)
    target = make_target(robot, free_q(robot, rng), "position")
    result = ikde.solve(robot, target, method="de")
    assert_true_to_its_figures(robot, target, result, ikde.SolveSettings.for_method("de"))
    assert result.method == "de"


def test_a_method_is_a_set_of_defaults(qiao):
    implied = ikde.solve(qiao, TARGET, method="de", seed=3)
    stated = ikde.solve(qiao, TARGET, ikde.SolveSettings.for_method("de"), seed=3)
    assert implied.q.tobytes() == stated.q.tobytes()


def test_a_robot_without_spheres_is_solved_and_collision_is_not_checked():
    result = ikde.solve(ikde.load_robot("qiao2021_dh"), TARGET)
    assert result.reached
    assert (result.detector, result.clearance_m, result.closest_pair, result.collision) == (
        "none",
        None,
        None,
        None,
    )
    assert result.reason.endswith("self-collision not checked")


def test_no_answer_lets_parts_overlap_that_a_bare_body_joins(tmp_path, rng):
    """Platform and upper arm, with a shoulder in between that has no spheres, measured by hand."""
    (tmp_path / "bare.yaml").write_text(BARE)
    robot = ikde.load_robot(tmp_path / "bare.yaml")
    p_world_tool = ikde.forward(robot, random_q(robot, rng, 40))["tool"][:, :3, 3]
    rows = ikde.solve_many(robot, ikde.Targets(p_world_tool))
    assert rows.reached.sum() > 35
    assert platform_to_upper_arm(rows.q[rows.reached]).min() > 0.01


def test_the_same_seed_gives_the_same_bits(qiao):
    first, again, other = (ikde.solve(qiao, TARGET, QUICK, seed=seed) for seed in (5, 5, 6))
    assert first.q.tobytes() == again.q.tobytes() != other.q.tobytes()
    assert (first.evaluations, first.attempts, first.seed) == (again.evaluations, again.attempts, 5)


def test_the_result_cannot_be_written_over(qiao):
    with pytest.raises(ValueError, match="read-only"):
        ikde.solve(qiao, TARGET, CHEAP).q[0] = 1.0


def test_the_largest_seed_is_accepted(qiao):
    assert ikde.solve(qiao, TARGET, CHEAP, seed=2**64 - 1).seed == 2**64 - 1


@pytest.mark.parametrize("seed", [-1, 2**64, 1.0, True, "1", None])
def test_what_is_no_seed_is_refused(qiao, seed):
    for call in (
        lambda: ikde.solve(qiao, TARGET, CHEAP, seed=seed),
        lambda: ikde.solve_many(qiao, [TARGET], CHEAP, seed=seed),
        lambda: ikde.solve_distinct(qiao, TARGET, 1, CHEAP, seed=seed),
    ):
        with pytest.raises(InputError, match=r"^seed: expected a whole number"):
            call()


def test_near_finds_a_closer_answer(qiao, rng):
    start = free_q(qiao, rng)
    target = make_target(qiao, start + rng.uniform(-0.02, 0.02, start.size), "position")
    near, far = ikde.solve(qiao, target, near=start), ikde.solve(qiao, target)
    assert near.reached
    assert far.reached
    assert np.abs(near.q - start).max() < np.abs(far.q - start).max()


def test_an_answer_of_the_first_attempt_is_inside_the_first_box(qiao, rng):
    start = free_q(qiao, rng)
    result = ikde.solve(qiao, make_target(qiao, start, "position"), near=start)
    assert (result.reached, result.attempts) == (True, 1)
    assert np.all(np.abs(result.q - start) <= (qiao.upper - qiao.lower) / 64 + 1e-12)


def test_near_may_name_some_joints_only(qiao):
    by_name = ikde.solve(qiao, TARGET, QUICK, near={"d_x": 0.2})
    start = qiao.home
    start[0] = 0.2
    assert by_name.q.tobytes() == ikde.solve(qiao, TARGET, QUICK, near=start).q.tobytes()


@pytest.mark.parametrize("value", [0.1 + 0.2, -1 / 3, 0.0])
def test_a_frozen_joint_keeps_its_bits(qiao, value):
    result = ikde.solve(qiao, TARGET, freeze={"q_z": value})
    assert result.reached
    assert result.q[2].tobytes() == np.float64(value).tobytes()


def test_with_everything_frozen_the_configuration_is_judged_as_it_is(qiao, rng):
    q = free_q(qiao, rng)
    target = make_target(qiao, q, "pose")
    frozen = dict(zip(qiao.joint_names, q.tolist(), strict=True))
    result = ikde.solve(qiao, target, QUICK, freeze=frozen)
    assert result.q.tobytes() == q.tobytes()
    assert result.reached
    elsewhere = ikde.solve(qiao, TARGET, CHEAP, freeze=qiao.joint_names)
    assert elsewhere.q.tobytes() == qiao.home.tobytes()
    assert not elsewhere.reached


def test_a_frozen_joint_outside_its_limits_is_refused(qiao):
    with pytest.raises(InputError, match=r"freeze\.d_x: 6 is outside the limits \[-5, 5\]"):
        ikde.solve(qiao, TARGET, freeze={"d_x": 6})


def test_the_safe_distance_is_kept(qiao):
    careful = replace(qiao.detectors["improved"], safe_distance_m=0.03)
    result = ikde.solve(qiao, TARGET, collision=careful)
    assert result.reached
    assert result.clearance_m > 0.03


def test_an_unreached_target_gives_the_best_found_and_a_reason(qiao):
    result = ikde.solve(qiao, TARGET, CHEAP)
    assert not result.reached
    assert result.stop_reason != "reached"
    assert result.reason
    assert result.verified
    assert result.grade == ikde.verify(qiao, TARGET, result.q, settings=CHEAP)
    assert (result.attempts, result.position_error_m > 1e-5) == (1, True)


def test_the_cost_is_counted(qiao):
    result = ikde.solve(qiao, ikde.Target((0.0, 0.0, 9.0)), CHEAP)
    assert result.attempts == 1
    assert result.evaluations >= CHEAP.de.population * CHEAP.de.generations
    assert result.solve_seconds > 0.0


def test_many_targets_come_back_in_order(qiao, rng):
    targets = [make_target(qiao, free_q(qiao, rng), kind) for kind in KINDS * 2]
    results = ikde.solve_many(qiao, targets, seed=4, bulk=BulkOptions(verify="all"))
    assert [result.stream for result in results] == list(range(6))
    for target, result in zip(targets, results, strict=True):
        assert_true_to_its_figures(qiao, target, result, ikde.SolveSettings.for_method("auto"))


def test_many_targets_hang_on_seed_and_place_only(qiao):
    targets = [ikde.Target((0.8, 0.1 * k, 1.0)) for k in range(4)]
    whole = ikde.solve_many(qiao, targets, QUICK, seed=9)
    others = ikde.solve_many(qiao, [TARGET, TARGET, targets[2]], QUICK, seed=9, bulk=BulkOptions(threads=1))
    assert others[2].q.tobytes() == whole[2].q.tobytes()
    assert whole[0].q.tobytes() == ikde.solve(qiao, targets[0], QUICK, seed=9).q.tobytes()


def test_equal_targets_have_streams_of_their_own(qiao):
    first, second = ikde.solve_many(qiao, [TARGET, TARGET], QUICK, seed=9)
    assert first.q.tobytes() != second.q.tobytes()


def test_threads_do_not_change_the_bits(qiao):
    targets = [ikde.Target((0.8, 0.1 * k, 1.0)) for k in range(4)]
    one, two = (ikde.solve_many(qiao, targets, QUICK, bulk=BulkOptions(threads=threads)) for threads in (1, 2))
    assert [result.q.tobytes() for result in one] == [result.q.tobytes() for result in two]


def test_no_targets_give_no_results(qiao):
    assert len(ikde.solve_many(qiao, [])) == 0


@pytest.mark.parametrize("threads", [0, -1])
def test_fewer_than_one_thread_is_refused(qiao, threads):
    with pytest.raises(InputError, match="threads: expected a whole number of at least 1"):
        ikde.solve_many(qiao, [TARGET], CHEAP, bulk=BulkOptions(threads=threads))


def test_unreached_targets_are_told_from_bound_and_counts_alone(qiao):
    far = ikde.Target((0.0, 0.0, 9.0))
    plain, explained = (
        ikde.solve_many(qiao, [TARGET, far], CHEAP, bulk=BulkOptions(explain=explain))[1] for explain in (False, True)
    )
    assert (plain.reached, plain.stop_reason, plain.hint) == (False, "out_of_reach", None)
    assert (plain.reason, explained.stop_reason) == (explained.reason, "out_of_reach")
    assert plain.q.tobytes() == explained.q.tobytes()


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"method": "ga"}, "no method is called 'ga'"),
        ({"method": ["lm"]}, r"^method: expected the name of a method, got \['lm'\]$"),
        (
            {"settings": DeSettings()},
            "^settings: expected SolveSettings, which take these as `de`, or a mapping of them, got DeSettings",
        ),
        ({"settings": {"restart": 3}}, r"^settings: no setting is called 'restart' \(did you mean 'restarts'\?\)$"),
        (
            {"collision": ["improved"]},
            r"^collision: expected a name, a Detector, a World or a CollisionModel, got \['improved'\]$",
        ),
        ({"collision": "improv"}, "no detector 'improv'"),
        ({"near": [1, 2]}, "expected 9 joint values"),
        ({"near": [np.nan] * 9}, "finite"),
        ({"freeze": ["q9"]}, "no joint 'q9'"),
        ({"freeze": {"q1": np.inf}}, "finite"),
    ],
)
def test_what_does_not_fit_the_robot_is_refused(qiao, options, words):
    for call in (ikde.solve, lambda robot, target, **o: ikde.solve_many(robot, [target], **o)):
        with pytest.raises(InputError, match=words):
            call(qiao, TARGET, **options)


@pytest.mark.parametrize("stream", [-1, 2**63, 1.5, True, "1", None])
def test_a_stream_is_a_whole_number(qiao, stream):
    with pytest.raises(InputError, match=r"stream: expected a whole number from 0 to 2\^63 - 1"):
        ikde.solve(qiao, ikde.Target((0.8, 0.5, 1.0)), stream=stream)


def test_what_names_no_joints_freezes_nothing(qiao):
    with pytest.raises(InputError, match="freeze: expected names of joints, or values by name, got 3"):
        ikde.solve(qiao, ikde.Target((0.8, 0.5, 1.0)), freeze=3)


def test_nothing_makes_a_result_writable(qiao):
    result = ikde.solve(qiao, TARGET, near=qiao.home)
    _ = result.q, result.near  # what was read before is not packed: it would arrive as numpy's own, writable
    for same in (result, copy.copy(result), copy.deepcopy(result), pickle.loads(pickle.dumps(result))):
        for name in ("q", "near"):
            array = getattr(same, name)
            while isinstance(array, np.ndarray):
                with pytest.raises(ValueError, match="WRITEABLE"):
                    array.setflags(write=True)
                array = array.base
            assert getattr(same, name).tobytes() == getattr(result, name).tobytes()


def test_what_a_result_says_can_not_be_taken_away(qiao):
    result = ikde.solve(qiao, ikde.Target((99.0, 0.0, 1.0)))
    for name in ("q", "reached", "reason"):
        _ = getattr(result, name)
        with pytest.raises(AttributeError, match=f"cannot delete '{name}': a result stays as it is"):
            delattr(result, name)
    assert not result.reached

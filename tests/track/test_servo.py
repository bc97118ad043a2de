"""A servo keeps its limits, can always stop, slides where it is held, and says by what; plain numpy looks after it."""

import json

import numpy as np
import pytest

import ikde
from ikde.kernels.servo import servo_step
from ikde.track.servo import Servo
from tests.track.servo_oracle import find_better_step
from tests.track.servo_walks import draw_walk, draw_world, find_offences, limits_of, tool_error

DT_S = 0.01
ELBOW_UP = np.array([0.0, -1.2, 1.6, -0.4, 1.5, 0.0])


@pytest.fixture(scope="module")
def ur5():
    return ikde.load_robot("ur5")


def wall_before(robot, q, away_m=0.45):
    """A wall beside the tool, along x and z."""
    x, y, _ = ikde.forward(robot, q)[robot.tool][:3, 3]
    return ikde.read_world({"obstacles": {"wall": {"position": [x, y + away_m, 0.5], "box": [1, 0.04, 2]}}}).world


def tool_at(robot, q, dx=0.0, dy=0.0, dz=0.0):
    return np.add(ikde.forward(robot, q)[robot.tool][:3, 3], (dx, dy, dz))


def walk(servo, targets, dt_s=DT_S):
    return [servo.step(target, dt_s) for target in targets]


@pytest.mark.parametrize(
    ("name", "drive", "kind", "away_m", "has_acceleration"),
    [
        ("ur5", "omnidirectional", "pose", 0.0, True),
        ("ur5", "omnidirectional", "axis", 1.0, False),
        ("qiao2021", "differential", "position", 0.5, True),
        ("qiao2021", "omnidirectional", "pose", 1.0, True),
    ],
)
def test_every_step_keeps_the_limits_and_leaves_a_stop_that_is_free(name, drive, kind, away_m, has_acceleration):
    robot, rng = ikde.load_robot(name), np.random.default_rng(7)
    world = draw_world(robot, robot.home, rng)
    targets = draw_walk(robot, robot.home, rng, 250, DT_S, kind=kind, away_m=away_m)
    servo = Servo(robot, robot.home, world=world, limits=limits_of(robot, has_acceleration), drive=drive)
    steps = walk(servo, targets)
    assert find_offences(servo, robot.home, steps, DT_S, drive) == []
    assert all(step.stop_is_free for step in steps)


def test_a_target_that_stands_is_reached_and_stays_reached(ur5):
    servo, target = Servo(ur5, ur5.home, limits=limits_of(ur5)), tool_at(ur5, ur5.home, 0.1, 0.1, -0.1)
    steps = walk(servo, [target] * 120)
    assert steps[-1].reached
    assert steps[-1].held_by is None
    assert np.abs(steps[-1].dq).max() < 1e-3
    assert max(step.error_m for step in steps[-20:]) < 1e-6


def test_a_wall_is_slid_along_and_named(ur5):
    servo = Servo(ur5, ELBOW_UP, world=wall_before(ur5, ELBOW_UP), limits=limits_of(ur5))
    first = walk(servo, [tool_at(ur5, ELBOW_UP, 0.0, 0.6, 0.0)] * 150)[-1]
    assert (first.held_by.kind, first.held_by.names[1], first.contact) == ("object", "wall", None)
    assert 0.0 < first.clearance_m < 1e-3
    along = walk(servo, [tool_at(ur5, ELBOW_UP, 0.1, 0.6, 0.1)] * 100)
    assert along[-1].error_m < along[0].error_m - 0.03
    assert np.linalg.norm(tool_at(ur5, along[-1].q) - tool_at(ur5, first.q)) > 0.08


def test_the_edge_of_reach_is_slid_along_without_shaking(ur5):
    servo = Servo(ur5, ELBOW_UP, limits=limits_of(ur5))
    there = walk(servo, [tool_at(ur5, ELBOW_UP, -0.5, 0.6, 0.3)] * 200)
    assert there[-1].held_by.kind == "reach"
    assert max(np.abs(step.dq).max() for step in there[-20:]) < 0.1
    along = walk(servo, [tool_at(ur5, ELBOW_UP, -0.5, 0.9, 0.1)] * 80)
    assert along[-1].error_m < along[0].error_m - 0.05


def test_what_is_moved_into_the_robot_is_named_and_it_only_moves_out(ur5):
    servo = Servo(ur5, ELBOW_UP, limits=limits_of(ur5, has_acceleration=False))
    p = tool_at(ur5, ELBOW_UP)
    ball = {"position": tool_at(ur5, ELBOW_UP, 0.0, 0.0, -0.06).tolist(), "sphere": {"radius": 0.08}}
    servo.world = ikde.read_world({"obstacles": {"ball": ball}}).world
    steps = walk(servo, [p] * 80)
    depths = [step.contact.depth_m if step.contact else 0.0 for step in steps]
    assert steps[0].contact.pair[1] == "ball"
    assert depths[0] > 0.02
    assert (np.diff(depths) <= 1e-9).all()
    assert depths[-1] == 0.0
    model = servo.collision
    check = ikde.check(ur5, steps[0].q, model)
    assert steps[0].clearance_m == pytest.approx(check.clearance_m, abs=1e-12)


def test_a_target_that_is_none_brakes_and_says_so(ur5):
    servo = Servo(ur5, ur5.home, limits=limits_of(ur5))
    fast = walk(servo, [tool_at(ur5, ur5.home, 0.3, 0.0, 0.0)] * 20)[-1]
    assert np.abs(fast.dq).max() > 0.5
    for target in ([np.nan, 0.0, 0.0], np.full((4, 4), np.inf), np.ones((4, 4)), None):
        step = servo.step(target, DT_S)
        assert (step.is_braking, step.error_m, step.reached, step.stop_is_free) == (True, None, False, True)
        assert (step.held_by is None) == (target is None)
    assert "finite numbers" in str(servo.step([np.nan, 0, 0], DT_S).held_by)
    assert np.abs(walk(servo, [None] * 40)[-1].dq).max() == 0.0


@pytest.mark.parametrize("dt_s", [0.0, 10.0, np.nan, -0.01, "fast", None])
def test_a_time_that_is_none_is_refused_in_a_line(ur5, dt_s):
    servo = Servo(ur5, ur5.home)
    with pytest.raises(ikde.InputError, match="expected a time above 0 s and up to 1 s"):
        servo.step([0.4, 0.2, 0.3], dt_s)
    np.testing.assert_array_equal(servo.q, ur5.home)


def test_what_does_not_fit_is_refused_in_a_line(ur5):
    for q, message in (([0.0] * 5, "6"), ([np.nan] * 6, "finite|numbers"), ([7.0] + [0.0] * 5, "outside")):
        with pytest.raises(ikde.InputError, match=message):
            Servo(ur5, q)
    with pytest.raises(ikde.InputError):
        Servo("no such robot", [0.0])
    with pytest.raises(ikde.InputError, match="base"):
        Servo(ur5, ur5.home, drive="differential")
    servo = Servo(ur5, ur5.home)
    with pytest.raises(ikde.InputError, match="expected a Target"):
        servo.step([0.4, 0.2], DT_S)
    good = servo.state
    for state in ({}, {**good, "speeds": [0.0]}, {**good, "speeds": [np.nan] * 6}, [1.0]):
        with pytest.raises(ikde.InputError, match="speeds"):
            Servo.from_state(ur5, state)


def test_a_state_goes_on_bit_for_bit(ur5):
    rng = np.random.default_rng(3)
    targets = draw_walk(ur5, ur5.home, rng, 60, DT_S, kind="axis")
    options = {"limits": limits_of(ur5), "world": draw_world(ur5, ur5.home, rng, 5)}
    servo = Servo(ur5, ur5.home, **options)
    walk(servo, targets[:30])
    kept = json.loads(json.dumps(servo.state))
    rest = walk(servo, targets[30:])
    again = walk(Servo.from_state("ur5", kept, **options), targets[30:])
    assert [step.q.tolist() for step in again] == [step.q.tolist() for step in rest]
    assert [step.as_dict() for step in again] == [step.as_dict() for step in rest]


def test_another_world_compiles_nothing_and_counts_at_once(ur5):
    servo, p = Servo(ur5, ELBOW_UP), tool_at(ur5, ELBOW_UP)
    with ikde.compile_clock() as clock:
        free = servo.step(p, DT_S)
        for away_m in (0.5, 0.3, 0.2):
            servo.world = wall_before(ur5, ELBOW_UP, away_m)
            walk(servo, [p] * 3)
        near = servo.step(p, DT_S)
        servo.world = ikde.World()
    assert clock.seconds == 0.0
    assert near.clearance_m <= free.clearance_m
    assert len(servo.world) == 0


def test_without_a_detector_nothing_is_checked_and_nothing_claimed(ur5):
    step = Servo(ur5, ur5.home, collision="none").step([0.4, 0.2, 0.3], DT_S)
    assert (step.clearance_m, step.nearest, step.contact) == (None, None, None)


def test_python_and_machine_code_take_the_same_step(ur5, monkeypatch):
    servo = Servo(ur5, ELBOW_UP, world=wall_before(ur5, ELBOW_UP), limits=limits_of(ur5))
    state, target = servo.state, tool_at(ur5, ELBOW_UP, 0.05, 0.3, 0.0)
    fast = servo.step(target, DT_S)
    servo.state = state
    monkeypatch.setattr(Servo, "_kernel", property(lambda _: servo_step.plain))
    slow = servo.step(target, DT_S)
    assert slow.q.tolist() == fast.q.tolist()
    assert slow.as_dict() == fast.as_dict()


def test_where_a_quadratic_program_finds_a_better_step_it_takes_one():
    robot, rng = ikde.load_robot("ur5"), np.random.default_rng(1)
    world = draw_world(robot, robot.home, rng)
    servo = Servo(robot, robot.home, world=world, limits=limits_of(robot))
    length_m, found = servo.rotation_length_m, 0
    for k, target in enumerate(draw_walk(robot, robot.home, rng, 120, DT_S, away_m=0.6, speed_m_s=0.4)):
        better_m = find_better_step(servo, target, DT_S, length_m) if k % 8 == 7 else 0.0
        before = tool_error(robot, servo.q, target, length_m)
        step = servo.step(target, DT_S)
        if better_m > 1e-4:
            found += 1
            assert tool_error(robot, step.q, target, length_m) < before or step.held_by is not None
    assert found > 3

"""`ikde.velocity`: priority, limits, singular arms, and what it says of each task."""

import numpy as np
import pytest

import ikde
from ikde.errors import InputError
from ikde.model.base_motion import move_base
from ikde.model.rotation import rotation_about
from ikde.solver.plain import compute_frames
from ikde.track.limits import MotionLimits
from ikde.track.velocity import velocity
from ikde.track.velocity_task import VelocityTask

MECANUM, ARM, TWO_WHEELS = (ikde.load_robot(name) for name in ("ur5e_mecanum", "ur5", "qiao2021"))
FREE = MotionLimits(ranges=False, speed=None)
FORWARD = np.array([0, 0, 0, np.pi, -1.9, 1.9, -1.57, -1.57, 0.0])


def tool_at(robot, q):
    return compute_frames(robot, q)[robot.tool]


def move(robot, q, result, dt_s):
    """After `dt_s`: joints as they go, a base on its exact arc."""
    out = q + result.q_dot * dt_s
    if result.twist is not None:
        out[:3] = move_base(q[:3], result.twist, dt_s)
    return out


def follow(robot, q, make_tasks, steps, **options):
    dt_s, speeds = options.get("dt_s", 0.01), []
    for k in range(steps):
        result = velocity(robot, q, make_tasks(k * dt_s), **options)
        speeds.append(result.q_dot)
        q = move(robot, q, result, dt_s)
    return q, np.array(speeds), result


def draw(rng):
    return np.r_[rng.uniform(-1, 1, 3), FORWARD[3:] + rng.uniform(-0.4, 0.4, 6)]


def test_a_lower_task_disturbs_no_higher_one():
    rng = np.random.default_rng(0)
    for _ in range(20):
        q = draw(rng)
        T = tool_at(MECANUM, q)
        pose = ikde.Target(T[:3, 3] + 0.1, R_world_tool=rotation_about(np.array([0, 0, 1.0]), 0.2) @ T[:3, :3])
        tasks = [
            VelocityTask.tool(pose),
            VelocityTask.base(rng.uniform(-1, 1, 3)),
            VelocityTask.joints({"elbow_joint": 1}),
        ]
        alone, all_three = velocity(MECANUM, q, tasks[0], limits=FREE), velocity(MECANUM, q, tasks, limits=FREE)
        np.testing.assert_allclose(all_three.tasks[0].got, alone.tasks[0].got, atol=1e-9)
        assert np.abs(all_three.tasks[0].left).max() < 1e-9
        assert all_three.tasks[0].met


def test_at_full_rank_both_orders_are_one():
    rng = np.random.default_rng(1)
    for _ in range(20):
        q = draw(rng)
        tasks = [VelocityTask.tool(tool_at(MECANUM, q)[:3, 3] + 0.1), VelocityTask.base(rng.uniform(-1, 1, 3))]
        first, second = (velocity(MECANUM, q, some, limits=FREE, softest=0) for some in (tasks, tasks[::-1]))
        np.testing.assert_allclose(first.q_dot, second.q_dot, atol=1e-12)
        assert all(task.met for task in first.tasks)


def test_of_tasks_in_conflict_the_first_is_met():
    q = FORWARD
    goal = tool_at(MECANUM, q)[:3, 3]
    tasks = [VelocityTask.joints({"elbow_joint": q[5] + 1}), VelocityTask.joints({"elbow_joint": q[5] - 1})]
    up, down = velocity(MECANUM, q, tasks), velocity(MECANUM, q, tasks[::-1])
    assert up.q_dot[5] == pytest.approx(1.0)
    assert down.q_dot[5] == pytest.approx(-1.0)
    assert (up.tasks[0].met, up.tasks[1].met) == (True, False)
    assert up.tasks[1].smallest_singular_value == pytest.approx(0.0, abs=1e-12)
    np.testing.assert_allclose(up.tasks[1].left, [-2.0])
    levels = [
        VelocityTask.tool(goal, twist=[0.1, 0, 0], level=7),
        VelocityTask.tool(goal, twist=[-0.1, 0, 0], level=-1),
    ]
    assert velocity(MECANUM, q, levels).tasks[1].met
    both = [VelocityTask.tool(goal, twist=[s, 0, 0], level=0) for s in (0.1, 0.3)]
    np.testing.assert_allclose(velocity(MECANUM, q, both).tasks[0].got, [0.2, 0, 0], atol=1e-9)


def test_wheels_follow_from_the_twist_and_never_fight():
    rng = np.random.default_rng(2)
    for _ in range(10):
        q = draw(rng)
        result = velocity(MECANUM, q, VelocityTask.base(rng.uniform(-1, 1, 3)))
        assert abs(result.wheels @ [1, -1, -1, 1]) < 1e-12
        cos, sin = np.cos(q[2]), np.sin(q[2])
        np.testing.assert_allclose(result.q_dot[:2], [[cos, -sin], [sin, cos]] @ result.twist[:2], atol=1e-12)
    drive = velocity(TWO_WHEELS, TWO_WHEELS.home, VelocityTask.base(velocity=(0.3, 0.2, 0.4)))
    cos, sin = np.cos(TWO_WHEELS.home[2]), np.sin(TWO_WHEELS.home[2])
    assert abs(cos * drive.q_dot[1] - sin * drive.q_dot[0]) < 1e-12
    assert not drive.tasks[0].met
    assert len(drive.wheels) == 2
    fixed = velocity(ARM, ARM.home, VelocityTask.joints({ARM.joint_names[0]: 0.1}))
    assert fixed.twist is None
    assert fixed.wheels is None


def test_a_pose_is_reached_inside_all_limits():
    limits = MotionLimits.of(MECANUM, acceleration=np.full(9, 3.0), wheel_speed_rad_s=4.0)
    q, dt_s = FORWARD, 0.02
    T = tool_at(MECANUM, q)
    goal = ikde.Target(T[:3, 3] + [0.6, 0.4, 0.1], R_world_tool=rotation_about(np.array([0, 0, 1.0]), 0.9) @ T[:3, :3])
    before = np.zeros(9)
    for _ in range(350):
        result = velocity(MECANUM, q, VelocityTask.tool(goal, gain=3.0), dt_s=dt_s, limits=limits, before=before)
        assert (np.abs(result.q_dot) <= limits.speed + 1e-8).all()
        assert (np.abs(result.q_dot - before) <= 3.0 * dt_s + 1e-7).all()
        assert (np.abs(result.wheels) <= 4.0 + 1e-6).all()
        assert not result.broken
        q, before = move(MECANUM, q, result, dt_s), result.q_dot
    assert ikde.verify(MECANUM, goal, q, settings={"position_tolerance_m": 1e-6}).accepted


def test_a_range_is_never_overrun_and_named():
    q = ARM.home.copy()
    name, upper = ARM.joint_names[2], ARM.upper[2]
    task = VelocityTask.joints({name: upper + 1.0}, gain=5.0)
    for _ in range(200):
        result = velocity(ARM, q, task)
        q = q + 0.01 * result.q_dot
        assert q[2] <= upper
    assert q[2] == pytest.approx(upper, abs=1e-9)
    assert result.tasks[0].held_by == (f"{name}: range",)
    assert f"{name}: range" in result.at_limit


def test_through_a_stretched_arm_joint_speeds_stay_bounded():
    """Drawn out of reach at 0.1 m/s: undamped hundreds of rad/s, ours at most 2; where regular both are the same."""
    q0 = np.array([0.0, -1.0, 1.2, -1.6, -1.57, 0.0])
    start = tool_at(ARM, q0)[:3, 3]
    out = np.r_[start[:2] / np.linalg.norm(start[:2]), 0.0]

    def draw_out(t):
        return VelocityTask.tool(start + 0.1 * t * out, twist=0.1 * out, gain=2.0)

    peaks, ends = {}, {}
    for softest in (0.05, 0.0):
        limits = MotionLimits(ranges=False, speed=np.full(6, 50.0))
        _, speeds, _ = follow(ARM, q0, draw_out, 300, limits=limits, softest=softest, dt_s=0.02)
        peaks[softest], ends[softest] = np.abs(speeds).max(), speeds[80]
    assert peaks[0.0] > 40.0
    assert peaks[0.05] <= 2.0
    np.testing.assert_allclose(ends[0.05], ends[0.0], atol=1e-9)
    _, speeds, result = follow(ARM, q0, draw_out, 300, dt_s=0.02)
    assert np.abs(speeds).max() <= 2.0
    assert result.tasks[0].damped
    assert not result.tasks[0].met


def test_no_task_asks_for_more_than_what_is_wanted_over_the_threshold():
    rng = np.random.default_rng(4)
    for _ in range(30):
        q = rng.uniform(-3, 3, 6)
        if rng.random() < 0.5:
            q[2] = 0.0  # stretched
        twist = rng.standard_normal(3)
        result = velocity(ARM, q, VelocityTask.tool(twist=twist), limits=FREE, softest=0.1)
        assert np.linalg.norm(result.q_dot) <= np.linalg.norm(twist) / 0.1 + 1e-9


def test_a_task_that_nothing_serves_is_an_answer():
    stuck = MotionLimits.of(ARM, speed=np.zeros(6))
    result = velocity(ARM, ARM.home, VelocityTask.tool(twist=[0.1, 0, 0]), limits=stuck)
    np.testing.assert_array_equal(result.q_dot, np.zeros(6))
    assert not result.tasks[0].met
    zero = velocity(ARM, np.zeros(6), [VelocityTask.tool(twist=np.ones(6)), VelocityTask.tool(twist=-np.ones(6))])
    assert np.isfinite(zero.q_dot).all()
    assert "0 of 2 tasks met" in repr(zero)


def test_accelerations_give_way_where_nothing_else_is_left():
    limits = MotionLimits.of(ARM, acceleration=np.ones(6))
    fast = velocity(ARM, ARM.home, VelocityTask.joints({ARM.joint_names[0]: 0}), limits=limits, before=np.full(6, 9.0))
    assert set(fast.broken) == set(ARM.joint_names)
    assert (np.abs(fast.q_dot) <= limits.speed).all()
    wheels = MotionLimits.of(MECANUM, acceleration=np.ones(9), wheel_speed_rad_s=1.0)
    before = np.r_[0.5, np.zeros(8)]
    slow = velocity(MECANUM, FORWARD, VelocityTask.base((0, 0, 0)), limits=wheels, before=before)
    assert slow.broken == ("x",)
    assert (np.abs(slow.wheels) <= 1.0 + 1e-7).all()


def test_weights_say_who_moves():
    task = VelocityTask.tool(twist=[0.1, 0, 0])
    arm = velocity(MECANUM, FORWARD, task, weights={"x": 1e3, "y": 1e3, "heading": 1e3})
    base = velocity(MECANUM, FORWARD, task, weights=dict.fromkeys(MECANUM.joint_names[2:], 1e3))
    same = velocity(MECANUM, FORWARD, task, weights=dict.fromkeys(MECANUM.joint_names, 1e3))
    np.testing.assert_allclose(same.q_dot, velocity(MECANUM, FORWARD, task).q_dot, atol=1e-15)
    assert np.abs(arm.q_dot[:3]).max() < 1e-4
    np.testing.assert_allclose(base.q_dot[0], 0.1, atol=1e-4)
    assert arm.tasks[0].met
    assert base.tasks[0].met


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"q": [0.0] * 5}, "q: expected 6 joint values"),
        ({"q": [np.nan] * 6}, "q: expected finite joint values"),
        ({"q": np.zeros((2, 6))}, "q: expected one configuration"),
        ({"tasks": []}, "tasks: expected 1 to 20 of `VelocityTask`, got 0"),
        ({"tasks": "tool"}, "tasks: expected 1 to 20 of `VelocityTask`, got 'tool'"),
        ({"tasks": [(0.4, 0.2, 0.3)]}, r"tasks\[0\]: expected a `VelocityTask`, got"),
        ({"tasks": [VelocityTask.base((0, 0))]}, r"tasks\[0\].base: ur5 has no planar base"),
        ({"tasks": [VelocityTask.tool(twist=[0, 0, 1], frame="tol")]}, r"tasks\[0\].frame: ur5 has no frame 'tol'"),
        ({"tasks": [VelocityTask.joints({"x": 1})]}, r"tasks\[0\].joints: ur5 has no joint 'x'"),
        (
            {"tasks": [VelocityTask.tool((0, 0, 0), level=1), VelocityTask.tool((0, 0, 0))]},
            r"tasks\[1\]: it has no level",
        ),
        ({"tasks": [VelocityTask.tool((0, 0, 0), share=0.5)] * 5}, "tasks: at most 4 tasks may have a share"),
        ({"dt_s": 0.0}, "dt_s: expected a time from 1e-06 to 10 s, got 0.0"),
        ({"dt_s": np.nan}, "dt_s: expected a time"),
        ({"softest": -1}, "softest: expected a number from 0"),
        ({"before": [1.0]}, "before: expected 6 joint values"),
        ({"weights": {"x": 1.0}}, "weights: ur5 has no joint 'x'"),
        ({"weights": {"shoulder_pan_joint": 0.0}}, "weights.shoulder_pan_joint: expected a number from 1e-06"),
        ({"weights": [1]}, "weights: expected weights by joint name"),
        ({"limits": MotionLimits(speed=np.ones(3))}, "limits.speed: expected 6 numbers"),
    ],
)
def test_bad_input_is_one_line(given, words):
    whole = {"q": ARM.home, "tasks": VelocityTask.tool(twist=[0, 0, 0.1]), **given}
    with pytest.raises(InputError, match=f"^{words}"):
        velocity(ARM, **whole)


def draw_task(rng, robot):
    """Any task, of any size, in part or whole."""
    common = {"gain": float(rng.choice([0.0, 0.5, 50.0])), "share": float(rng.choice([0.0, 0.3, 1.0, 1.0]))}
    frame = robot.frames[rng.integers(len(robot.frames))].name
    p = rng.uniform(-2, 2, 3)
    kind = rng.integers(5)
    if kind == 0:
        return VelocityTask.tool(p, frame=frame, **common)
    if kind == 1:
        R = rotation_about(np.array([0.6, 0.0, 0.8]), rng.uniform(0, np.pi))
        return VelocityTask.tool(ikde.Target(p, R_world_tool=R), max_speed=0.3, **common)
    if kind == 2:
        return VelocityTask.tool(ikde.Target(p, axis_world_tool=rng.standard_normal(3)), twist=np.ones(6), **common)
    if kind == 3 and robot is not ARM:
        return VelocityTask.base(rng.standard_normal(3), **common)
    return VelocityTask.joints({name: float(rng.normal()) for name in robot.joint_names[2:]}, **common)


@pytest.mark.parametrize("robot", [ARM, TWO_WHEELS, MECANUM], ids=["ur5", "qiao2021", "ur5e_mecanum"])
def test_whatever_is_asked_limits_are_kept(robot):
    """Also in singular poses, at ends of ranges, and with joints that may not move."""
    rng, size = np.random.default_rng(7), len(robot.joints)
    for k in range(40):
        q = np.round(rng.uniform(*robot.drawn) / (np.pi / 2)) * np.pi / 2 if k % 2 else rng.uniform(*robot.drawn)
        q = np.clip(q, robot.lower, np.where(rng.random(size) < 0.2, q, robot.upper))
        q = np.where(np.isfinite(robot.upper) & (rng.random(size) < 0.2), robot.upper, np.minimum(q, robot.upper))
        speed = np.where(rng.random(size) < 0.2, 0.0, rng.uniform(0.1, 3.0, size))
        limits = MotionLimits.of(robot, speed=speed, acceleration=rng.uniform(0.5, 10.0, size))
        before, tasks = 0.3 * rng.standard_normal(size), [draw_task(rng, robot) for _ in range(3)]
        result = velocity(robot, q, tasks, limits=limits, before=before if k % 3 else None, dt_s=0.02)
        free = (
            slice(2, None) if robot is TWO_WHEELS else slice(None)
        )  # of two wheels the speed along the heading counts
        assert (np.abs(result.q_dot) <= speed + 1e-7)[free].all()
        assert (q + 0.02 * result.q_dot <= robot.upper + 1e-8).all()
        assert (q + 0.02 * result.q_dot >= robot.lower - 1e-8).all()
        if k % 3:
            excess = np.abs(result.q_dot - before) - 0.02 * limits.acceleration
            too_fast = {name for name, value in zip(robot.joint_names, excess, strict=True) if value > 1e-6}
            assert too_fast <= set(result.broken)


def test_what_rounding_spoils_stays_inside_too():
    """A task of 1500 m/s, hardly damped: what it leaves is no reason to give up any limit."""
    q = np.zeros(9)
    q[[1, 2, 4, 5]] = -2.1513906773774876, 0.6696076883281812, -1.9510870951242982, 1.8500539326433945
    twist = -1532.59969377, -833.35807543, -1346.23749888, -1499.50178147, 986.59920788, -382.54355083
    drive = VelocityTask.base((1.20746242, -0.17357238, -0.13241101), gain=10.0)
    result = velocity(MECANUM, q, [VelocityTask.tool(twist=twist, gain=0.001), drive], dt_s=10.0, softest=0.001)
    assert (np.abs(result.q_dot) <= MotionLimits.of(MECANUM).speed).all()


def test_a_base_is_exactly_inside_its_limits():
    """On two wheels along its own direction; one that may go anywhere in each of its joints."""
    leobot, rng = ikde.load_robot("leobot"), np.random.default_rng(3)
    for robot in (MECANUM, leobot):
        speed = MotionLimits.of(robot).speed
        for _ in range(20):
            q = np.clip(rng.uniform(-1, 1, len(robot.joints)), robot.lower, robot.upper)
            result = velocity(robot, q, VelocityTask.tool(twist=1e4 * rng.standard_normal(3)), softest=0.001)
            assert (np.abs(result.q_dot) <= speed + 1e-15).all()

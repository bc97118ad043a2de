"""Whole paths: the paper's tasks, singularities, refusals, and what holds of every motion."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import ikde
from ikde.errors import InputError
from ikde.model.collision_model import CollisionModel
from ikde.solver.forward import forward
from ikde.solver.plain import compute_gaps
from ikde.track.certify import certify
from ikde.track.follow_path import follow_path
from ikde.track.limits import MotionLimits
from ikde.track.path import ToolPath
from ikde.track.settings import ContinuationSettings, OptimizedSettings, TypicalSettings
from ikde.track.starts import draw_starts
from ikde.track.trajectory import TrackStopReason
from ikde.track.verify_track import verify_track
from tests.endless_robot import ENDLESS, LIMITED
from tests.robot_files import load_text
from tests.track.paper_tasks import plan_of, short_task, start_of
from tests.track.tracks import DRIVES, TASKS, follow_task, load_task, make_line, robot

BASE = ("d_x", "d_y", "q_z")
CART = """
name: cart
joints:
  x: {kind: prismatic, lower: -5, upper: 5}
  y: {kind: prismatic, lower: -5, upper: 5}
  turn: {kind: revolute, lower: -3, upper: 3}
  lift: {kind: prismatic, lower: -1, upper: 1}
frames:
  along: {parent: world, joint: x, axis: [1, 0, 0]}
  across: {parent: along, joint: y, axis: [0, 1, 0]}
  deck: {parent: across, joint: turn, axis: [0, 0, 1]}
  mast: {parent: deck, joint: lift, axis: [0, 0, 1]}
  post: {parent: world, xyz: [3, 0, 0]}
tool: mast
spheres: {round: [{component: mast, from: mast, radius: 0.05}, {component: post, from: post, radius: 0.05}]}
pairs: {post: {pairs: {post: [mast]}}}
"""


def judge(motion, detector="improved"):
    collision = CollisionModel.of(robot(), detector)
    verdict = verify_track(collision, motion.path, motion.q, limits=motion.limits, drive=motion.drive)
    return verdict, certify(collision, motion.q)


def must_hold(motion):
    """What holds of every motion, wherever it ends."""
    verdict, proof = judge(motion)
    assert verdict.violations.total == 0
    assert proof.is_free
    assert (motion.stop is None) == (motion.reached_points == motion.path.samples)
    if motion.stop is not None:
        assert motion.stop.sample == motion.reached_points + 1
        assert "\n" not in motion.stop.text
    return verdict, proof


@pytest.mark.parametrize("drive", DRIVES)
@pytest.mark.parametrize("task", TASKS)
def test_the_papers_tasks_are_followed_to_their_end(task, drive):
    motion = follow_task(task, drive)
    verdict, proof = must_hold(motion)
    assert motion.reached_points == 500
    assert verdict.largest_axis_error_m < 1e-8
    assert verdict.largest_orientation_error_rad < 1e-7
    assert np.abs(verdict.sideways_m_s).max() < 1e-9
    assert 0.01 < proof.clearance_m <= verdict.clearance_m
    assert motion.deviation_m.max() < 2e-4
    assert motion.certified_clearance_m == proof.clearance_m
    np.testing.assert_array_equal(motion.error_m, verdict.error_m)


def test_the_same_seed_is_the_same_motion_and_a_start_is_kept():
    motion = follow_task("task1", "differential")
    again = follow_path(robot(), motion.path, start=motion.q[0])
    np.testing.assert_array_equal(again.q[0], motion.q[0])
    np.testing.assert_array_equal(again.q, follow_path(robot(), motion.path, start=motion.q[0]).q)
    assert again.reached


def pass_through(orientation, turns, seed):
    """A path that an arm on a base at rest follows through joint angles of 0; and how."""
    rng = np.random.default_rng(seed)
    while True:
        middle = 0.6 * rng.uniform(robot().lower, robot().upper)
        rate = rng.uniform(-0.6, 0.6, 9) * 0.005 * np.pi
        middle[:3], rate[:3] = (0.0, 0.0, 0.3), 0.0
        for joint in turns:
            index = robot().joint_names.index(joint)
            middle[index], rate[index] = 0.0, 0.6 * 0.005 * np.pi
        q = middle + np.outer(np.sin(np.linspace(-0.5 * np.pi, 0.5 * np.pi, 201)) * 200 / np.pi, rate)
        inside = ((robot().lower < q) & (q < robot().upper)).all()
        if inside and compute_gaps(CollisionModel.of(robot()), q).min() > 0.02:
            break
    T = forward(robot(), q)["tool"]
    asked = {"pose": {"R_world_tool": T[:, :3, :3]}, "axis": {"axis_world_tool": T[:, :3, 2]}, "free": {}}[orientation]
    return ToolPath.through(T[:, :3, 3], dt_s=0.02, **asked), q


@pytest.mark.parametrize("frozen", [True, False])
@pytest.mark.parametrize(
    ("orientation", "turns"), [("free", ("q3",)), ("axis", ("q5",)), ("pose", ("q3",)), ("pose", ("q3", "q5"))]
)
def test_singularities_are_passed(orientation, turns, frozen):
    path, q = pass_through(orientation, turns, seed=len(turns))
    freeze = dict(zip(BASE, q[0, :3], strict=True)) if frozen else None
    motion = follow_path(robot(), path, start=q[0], freeze=freeze)
    must_hold(motion)
    assert motion.reached
    if frozen:
        np.testing.assert_array_equal(motion.q[:, :3], np.tile(q[0, :3], (201, 1)))


@pytest.mark.parametrize("drive", DRIVES)
def test_a_path_out_of_the_workspace_ends_at_its_rim(drive):
    motion = follow_path(robot(), make_line([0.9, 0, 1.64], [0.9, 0, 1.70], 240), drive=drive)
    must_hold(motion)
    assert motion.stop.reason == TrackStopReason.BUDGET  # the bound is not sharp enough to prove it
    at, height = motion.stop.sample, 1.64 + 0.06 / 240 * np.arange(241)
    assert ikde.solve(robot(), ikde.Target([0.9, 0, height[at - 1]])).reached
    assert not ikde.solve(robot(), ikde.Target([0.9, 0, height[at]])).reached


def random_task(seed):
    """A broken line near a base that has little room, at one of three speeds."""
    rng = np.random.default_rng(seed)
    corners = rng.uniform([-1, -1, 0.4], [1, 1, 1.5]) + np.cumsum(rng.normal(size=(4, 3)) * [0.3, 0.3, 0.1], axis=0)
    at = np.linspace(0.0, 3.0, int(rng.integers(20, 80)))
    path = ToolPath.through(np.transpose([np.interp(at, range(4), line) for line in corners.T]), dt_s=0.02)
    half = float(rng.choice([0.05, 0.1, 0.3, 1.0]))
    slides = [replace(joint, lower=-half, upper=half) for joint in robot().joints[:2]]
    small = replace(robot(), joints=(*slides, *robot().joints[2:]))
    return small, path, [None, MotionLimits.of(small).speed, np.full(9, 5.0)][int(rng.integers(3))]


def test_a_path_is_followed_to_its_end_or_a_reason_is_given():
    """A base that begins at the end of its range, as the solver likes to put it, must not leave it on its first arc."""
    reached = 0
    for seed in (1, 4, 12, 25, 28, 31, 38, 60):
        small, path, speed = random_task(seed)
        options = {"limits": MotionLimits.of(small, speed=speed), "drive": "differential"}
        motion = follow_path(small, path, settings=ContinuationSettings(max_backtracks=0), **options)
        motions = [motion]
        if len(motion.q):
            few = OptimizedSettings(max_redraws=1, generations=100)
            motions.append(follow_path(small, path, method="optimized", start=motion.q[0], settings=few, **options))
        for motion in motions:
            assert motion.violations.total == 0
            assert motion.reached is (motion.stop is None)
            reached += motion.reached
    assert reached >= 8


def test_what_is_proved_to_be_out_of_reach_is_told_at_its_sample():
    frozen = dict.fromkeys(BASE, 0.0)
    p = np.tile([0.9, 0.3, 1.0], (31, 1))
    p[20:, 0] = 3.0
    motion = follow_path(robot(), ToolPath.through(p, dt_s=0.02), freeze=frozen)
    must_hold(motion)
    assert (motion.stop.sample, motion.stop.reason) == (20, TrackStopReason.OUT_OF_REACH)
    nowhere = follow_path(robot(), make_line([0.9, 0.3, -5.0], [0.9, 0.3, 1.0], 10))
    assert (nowhere.stop.sample, nowhere.reached_points, len(nowhere.q)) == (0, 0, 0)
    assert nowhere.certified_clearance_m is None


@pytest.mark.parametrize("drive", DRIVES)
def test_a_path_that_is_too_fast_ends_where_it_is(drive):
    p = np.tile([0.9, 0.0, 1.0], (41, 1))
    p[:, 1] += 0.002 * np.arange(41)
    p[20:, 0] += 0.5
    motion = follow_path(robot(), ToolPath.through(p, dt_s=0.02), drive=drive)
    must_hold(motion)
    assert (motion.stop.sample, motion.stop.reason) == (20, TrackStopReason.SPEED_LIMIT)
    assert motion.stop.limit in (*robot().joint_names, "the base")


@pytest.mark.parametrize("drive", DRIVES)
def test_a_path_into_the_robot_itself_ends_before_contact(drive):
    load, radius = np.array([0.271, 0.0, 0.433]), 0.224 + 0.045  # of the load and of the tool's last sphere
    path = make_line([0.271, 0.75, 0.75], load, 300)
    first = int(np.argmax(np.linalg.norm(path.p_world_tool - load, axis=1) < radius))
    motion = follow_path(robot(), path, drive=drive, freeze=dict.fromkeys(BASE, 0.0))
    must_hold(motion)
    assert (motion.stop.sample, motion.stop.reason) == (first, TrackStopReason.COLLISION)
    assert "LT" in motion.stop.pair


@pytest.mark.parametrize("drive", DRIVES)
@pytest.mark.parametrize(
    "told",
    [
        {"acceleration": np.full(9, 0.5)},
        {"wheel_speed_rad_s": 2.0},
        {"max_distance_m": 0.95, "center": "Oc"},
        {"speed": None},
        {"speed": np.array([0.1] * 2 + [0.2] * 7)},
        {"ranges": False},
    ],
)
def test_every_limit_is_kept(told, drive):
    limits = MotionLimits.of(robot(), **told)
    motion = follow_path(robot(), make_line([0.9, 0, 1.0], [1.1, 0.3, 1.0], 150), drive=drive, limits=limits)
    must_hold(motion)
    assert motion.reached


def test_without_a_detector_nothing_is_said_about_clearance():
    motion = follow_path(robot(), make_line([0.9, 0, 1.0], [0.9, 0.1, 1.0], 20), collision="none")
    assert motion.reached
    assert (motion.clearance_m, motion.certified_clearance_m, motion.certificate) == (None, None, None)
    assert motion.violations.collision is None


def test_an_arm_on_the_floor_has_no_wheels():
    arm = ikde.load_robot("panda")
    p = forward(arm, arm.home)["tool"][:3, 3]
    path = make_line(p, p + np.array([0.05, 0.1, -0.05]), 60)
    motion = follow_path(arm, path, start=arm.home)
    assert motion.reached
    assert (motion.drive, motion.base_joints, motion.wheel_speeds) == ("omnidirectional", (), None)
    assert motion.v.shape == (60, 2)
    with pytest.raises(InputError, match="no planar base"):
        follow_path(arm, path, drive="differential")


def test_a_base_without_wheels_runs_on_the_same_arcs(unwheeled):
    path = make_line([0.9, 0, 1.0], [1.1, 0.3, 1.0], 150)
    motion, other = follow_path(unwheeled, path), follow_path(robot(), path)
    assert motion.reached
    assert (motion.drive, motion.wheel_speeds, motion.base_joints) == ("differential", None, BASE)
    for bare, wheeled in ((motion.q, other.q), (motion.v, other.v), (motion.omega, other.omega)):
        np.testing.assert_array_equal(bare, wheeled)
    with pytest.raises(InputError, match=r"limits.wheel_speed_rad_s: qiao2021 has no wheels"):
        follow_path(unwheeled, path, limits=MotionLimits.of(unwheeled, wheel_speed_rad_s=2.0))


def test_twists_and_wheels_are_those_of_the_motion():
    motion, other = follow_task("task2", "differential"), follow_task("task2", "omnidirectional")
    verdict, _ = judge(motion)
    np.testing.assert_array_equal(motion.v, verdict.v)
    np.testing.assert_array_equal(motion.wheel_speeds, verdict.wheel_speeds)
    np.testing.assert_allclose(other.v, np.diff(other.q[:, :2], axis=0) / 0.02)
    assert (other.wheel_speeds, other.omega.shape, len(motion.seconds)) == (None, (500,), 500)


@pytest.mark.parametrize(
    ("given", "where"),
    [
        ({"method": "magic"}, ("method",)),
        ({"drive": "legs"}, ("drive",)),
        ({"start": np.zeros(9)}, ("start",)),
        ({"seed": -1}, ("seed",)),
        ({"limits": MotionLimits(speed=np.ones(3))}, ("limits", "speed")),
    ],
)
def test_what_is_refused(given, where):
    with pytest.raises(InputError) as caught:
        follow_path(robot(), load_task("task1").path, **given)
    assert caught.value.where == where


@pytest.mark.parametrize("key", ["robot", "path", "limits"])
def test_what_is_something_else_is_refused(key):
    told = {"robot": robot(), "path": load_task("task1").path, "limits": None, key: {"speed": 1}}
    with pytest.raises(InputError, match=rf"^{key}: expected a \w+, .*got (dict|{{)"):
        follow_path(**told)


@pytest.mark.parametrize("method", ["continuation", "typical"])
def test_a_drive_that_does_not_exist_is_refused(method):
    with pytest.raises(InputError, match="expected one of differential, omnidirectional, mecanum, got 'tank'"):
        follow_path(robot(), load_task("task1").path, drive="tank", method=method)


def test_a_base_on_arcs_carries_all_that_is_compared(tmp_path):
    (tmp_path / "cart.yaml").write_text(CART)
    cart = ikde.load_robot(tmp_path / "cart.yaml")
    path = make_line([0.2, 0.0, 0.5], [0.21, 0.0, 0.5], 5)
    post = ikde.Detector(name="post", spheres="round", pairs="post")
    with pytest.raises(InputError, match=r"^detector: a base on arcs must carry all that can collide"):
        follow_path(cart, path, collision=post)
    assert follow_path(cart, path, collision=post, drive="omnidirectional").reached


def test_without_ranges_the_solver_that_keeps_them_has_no_say():
    ur5 = ikde.load_robot("ur5")
    joints = tuple(replace(joint, lower=-0.1, upper=0.1) if k == 0 else joint for k, joint in enumerate(ur5.joints))
    narrow, start = replace(ur5, joints=joints), np.array([0.0, -1.2, 1.5, -1.0, 1.0, 0.0])
    around = [start + k * 0.5 * np.eye(6)[0] for k in range(3)]
    path = ToolPath.through(np.array([forward(ur5, q)["tool"][:3, 3] for q in around]), dt_s=0.02)
    limits = MotionLimits.of(narrow, ranges=False)
    assert follow_path(narrow, path, limits=limits, start=start).stop.reason == TrackStopReason.SPEED_LIMIT


@settings(max_examples=12, suppress_health_check=list(HealthCheck))
@given(
    task=st.sampled_from(TASKS),
    drive=st.sampled_from(DRIVES),
    seed=st.integers(0, 2**63),
    pick=st.integers(0, 10**6),
    off_m=st.floats(0.0, 0.9e-6),
)
def test_from_any_start_the_motion_keeps_all_limits(task, drive, seed, pick, off_m):
    """Starts anywhere within the tolerance of 1e-6 m along each axis."""
    whole = load_task(task).path
    turns = None if whole.R_world_tool is None else whole.R_world_tool[:121]
    path = ToolPath(dt_s=0.02, p_world_tool=whole.p_world_tool[:121], orientation=whole.orientation, R_world_tool=turns)
    starts, _ = draw_starts(plan_of(robot(), path, drive=drive, seed=seed))
    start = move_tool(starts[pick % len(starts)], off_m, np.random.default_rng(seed))
    motion = follow_path(robot(), path, drive=drive, start=start, seed=seed)
    must_hold(motion)
    np.testing.assert_array_equal(motion.q[0], start)


def move_tool(q, off_m, rng):
    """All joints a little elsewhere, so that the tool is `off_m` away."""
    away = 1e-6 * rng.standard_normal(len(q))
    tool, moved = (forward(robot(), each)["tool"][:3, 3] for each in (q, q + away))
    return q + away * off_m / np.linalg.norm(moved - tool)


@pytest.mark.parametrize("method", ["optimized", "typical"])
def test_without_a_start_it_is_that_of_continuation(qiao, method):
    path = short_task(1, samples=2)
    motion = follow_path(qiao, path, method=method)
    np.testing.assert_array_equal(motion.q[0], follow_path(qiao, path, drive=motion.drive).q[0])
    assert motion.method == method
    assert motion.reached_points == 2
    assert len(motion.seconds) == 2
    assert motion.search_seconds > motion.seconds.sum()


@pytest.mark.parametrize("method", ["optimized", "typical"])
def test_a_start_that_is_elsewhere_is_refused(qiao, method):
    with pytest.raises(InputError, match="first pose"):
        follow_path(qiao, short_task(1), method=method, start=start_of("qiao2021", 3))


@pytest.mark.parametrize("method", ["optimized", "typical"])
def test_a_first_pose_out_of_reach_ends_all_at_once(qiao, method):
    motion = follow_path(qiao, short_task(1), method=method, freeze={"d_x": -4.0, "d_y": 0.0})
    assert motion.stop.reason == "out_of_reach"
    assert motion.stop.sample == 0
    assert len(motion.q) == 0


def test_settings_belong_to_their_method(qiao):
    with pytest.raises(InputError, match="method optimized: expected OptimizedSettings, got TypicalSettings"):
        follow_path(qiao, short_task(1), method="optimized", settings=TypicalSettings())
    with pytest.raises(InputError, match="method continuation: expected ContinuationSettings, got OptimizedSettings"):
        follow_path(qiao, short_task(1), settings=OptimizedSettings())
    with pytest.raises(InputError, match="expected one of continuation, optimized, typical"):
        follow_path(qiao, short_task(1), method="best")


@pytest.mark.parametrize("method", ["continuation", "optimized", "typical"])
def test_a_joint_without_limits_turns_on(method):
    """One and a half times around, across the far side; the same arm with limits comes to its end on the way."""
    angle = np.linspace(0.0, 3.0 * np.pi, 101)
    circle = 0.55 * np.column_stack([np.cos(angle), np.sin(angle), np.full(101, 0.9)])
    path = ToolPath.through(circle, dt_s=0.1, axis_world_tool=np.tile((0.0, 0.0, -1.0), (101, 1)))
    motion = follow_path(load_text(ENDLESS), path, method=method)
    assert motion.reached_points == 100
    assert motion.violations.range == 0
    if method == "typical":
        assert np.abs(np.diff(motion.q[:, [0, 5]], axis=0)).max() <= np.pi
        return
    assert motion.reached
    assert motion.certified_clearance_m > 0.005
    assert np.ptp(motion.q[:, 0]) > 2.5 * np.pi
    if method == "continuation":
        stopped = follow_path(load_text(LIMITED), path, method=method)
        assert stopped.stop.reason == TrackStopReason.JOINT_LIMIT
        assert stopped.stop.limit == "pan"

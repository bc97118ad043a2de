"""A generated step is the step of `kernels/damped.py`: for any robot, kind of target, bounds and settings."""

import numpy as np
import pytest

from ikde.kernels import damped
from ikde.kernels.arrays import DescentArrays
from ikde.model.generate.functions import SETTINGS, format_step
from ikde.model.generate.step import write_step
from ikde.model.generate.writer import Writer
from ikde.model.pack import pack_robot, pack_targets
from ikde.model.target import Target
from tests import reference
from tests.conftest import random_q
from tests.random_robots import make_frame, make_robot, random_robot
from tests.targets import make_target
from tests.uncompiled import evaluate, joint_names, plain, run_text

KINDS = ("position", "axis", "pose")
TWIN = plain(damped.take_step)
SEEDS = range(12)
each_kind = pytest.mark.parametrize("kind", KINDS)


def twin_step(robot, target, ranges, descent, q):
    """(q after a step of the data-driven kernel, both errors)."""
    q, arrays = q.copy(), pack_robot(robot)
    work = plain(damped.make_descent_workspace)(arrays, len(q), 6)
    errors = TWIN(arrays, pack_targets([target]), 0, ranges, descent, q, work)
    return q, errors


def assert_like_twin(robot, take_step, target, q, ranges=None, descent=None):
    """The same errors and the same step, but for rounding that the damping lets grow."""
    ranges = np.array([robot.lower, robot.upper]) if ranges is None else ranges
    descent = DescentArrays(least_damping=1e-3) if descent is None else descent
    expected, errors = twin_step(robot, target, ranges, descent, q)
    after = q.copy()
    np.testing.assert_allclose(
        take_step(0, pack_targets([target]), 0, ranges, descent, after, 0), errors, rtol=0, atol=1e-12
    )
    np.testing.assert_allclose(after, expected, rtol=0, atol=2e-15 / min(descent.least_damping, 1e-3))
    return after


def make_take_step(robot, kind):
    return run_text(format_step(pack_robot(robot), kind)).take_step


@each_kind
@pytest.mark.parametrize("seed", SEEDS)
def test_random_robots_step_like_the_twin(seed, kind, rng):
    robot = random_robot(seed)
    take_step = make_take_step(robot, kind)
    for _ in range(4):
        target = make_target(robot, random_q(robot, rng), kind)
        assert_like_twin(robot, take_step, target, random_q(robot, rng))


@each_kind
def test_shipped_robots_step_like_the_twin(any_robot, kind, rng):
    take_step = make_take_step(any_robot, kind)
    target = make_target(any_robot, random_q(any_robot, rng), kind)
    for change in ({}, {"damping": 0.5}, {"least_damping": 1e-2}, {"rotation_length": 0.1}, {"largest_step": 0.05}):
        assert_like_twin(any_robot, take_step, target, random_q(any_robot, rng), descent=DescentArrays(**change))


@each_kind
@pytest.mark.parametrize("seed", SEEDS)
def test_joints_at_their_bounds_step_like_the_twin(seed, kind, rng):
    robot = random_robot(seed)
    take_step = make_take_step(robot, kind)
    for _ in range(3):
        target = make_target(robot, random_q(robot, rng), kind)
        q = np.choose(rng.integers(3, size=len(robot.joints)), [robot.lower, robot.upper, random_q(robot, rng)])
        after = assert_like_twin(robot, take_step, target, q)
        assert np.all((robot.lower <= after) & (after <= robot.upper))


@each_kind
def test_frozen_joints_never_move(qiao, kind, rng):
    take_step = make_take_step(qiao, kind)
    q, frozen = random_q(qiao, rng), [0, 2, 5]
    ranges = np.array([qiao.lower, qiao.upper])
    ranges[:, frozen] = q[frozen]
    for _ in range(5):
        after = assert_like_twin(qiao, take_step, make_target(qiao, random_q(qiao, rng), kind), q, ranges)
        assert after[frozen].tobytes() == q[frozen].tobytes()
        assert not np.array_equal(after, q)


@each_kind
def test_half_a_turn_away_is_like_the_twin(qiao, kind, rng):
    take_step = make_take_step(qiao, kind)
    for q in random_q(qiao, rng, 4):
        T = reference.compute_frames(qiao, q)[qiao.tool]
        flip = reference.Rotation.from_rotvec(T[:3, 0] * (np.pi - 0.005)).as_matrix()
        extra = {"position": {}, "axis": {"axis_world_tool": -T[:3, 2]}, "pose": {"R_world_tool": flip @ T[:3, :3]}}
        assert_like_twin(qiao, take_step, Target(T[:3, 3] + 0.1, **extra[kind]), q)


@each_kind
def test_within_both_tolerances_it_stays(qiao, kind, rng):
    take_step = make_take_step(qiao, kind)
    q = random_q(qiao, rng)
    target = make_target(qiao, q + 1e-4, kind)
    _, errors = twin_step(qiao, target, np.array([qiao.lower, qiao.upper]), DescentArrays(), q)
    position, orientation = np.array(errors) * 1.01
    for tolerances in ((position, orientation), (0.99 * position, orientation), (position, 0.9 * orientation)):
        descent = DescentArrays(position_tolerance=tolerances[0], orientation_tolerance=tolerances[1])
        after = assert_like_twin(qiao, take_step, target, q, descent=descent)
        met = errors[0] <= tolerances[0] and errors[1] <= tolerances[1]
        assert np.array_equal(after, q) == met


@each_kind
def test_names_do_not_run_into_each_other_on_a_long_chain(kind, rng):
    """Twenty-five joints: numbers of joints have two digits, as entries of the target's rotation have."""
    count, axes = 25, [(0, 0, 1), (0, 1, 0), (1, 1, 0)]
    frames = [
        make_frame(f"f{k}", f"f{k - 1}" if k else "world", (0.01 * (k % 3), 0, 0.05), joint=f"j{k}", axis=axes[k % 3])
        for k in range(count)
    ]
    kinds = {f"j{k}": "prismatic" if k % 6 == 5 else "revolute" for k in range(count)}
    robot = make_robot(kinds, [*frames, make_frame("tool", f"f{count - 1}", (0, 0, 0.1))])
    take_step = make_take_step(robot, kind)
    for q in random_q(robot, rng, 3):
        assert_like_twin(robot, take_step, make_target(robot, random_q(robot, rng), kind), q)


@each_kind
def test_a_robot_that_only_slides_steps_like_the_twin(kind, rng):
    frames = [
        make_frame("f0", "world", joint="j0", axis=(1, 0, 0)),
        make_frame("f1", "f0", (0.1, 0.2, 0.3), rpy=(0.3, -0.2, 0.5), joint="j1", axis=(0, 1, 1)),
        make_frame("tool", "f1", (0.1, 0, 0), rpy=(0.1, 0, 0)),
    ]
    robot = make_robot({"j0": "prismatic", "j1": "prismatic"}, frames)
    take_step = make_take_step(robot, kind)
    extra = {"position": {}, "axis": {"axis_world_tool": [0, 0.6, 0.8]}, "pose": {"R_world_tool": np.eye(3)}}[kind]
    for q in random_q(robot, rng, 3):
        assert_like_twin(robot, take_step, Target(rng.normal(size=3), **extra), q)


@each_kind
def test_a_written_step_is_what_the_function_takes(qiao, kind, rng):
    """`write_step` by itself: errors and next values from names alone."""
    writer, q = Writer(), random_q(qiao, rng)
    step = write_step(writer, pack_robot(qiao), kind)
    target, descent = make_target(qiao, random_q(qiao, rng), kind), DescentArrays(least_damping=1e-3)
    T = pack_targets([target]).T_world_tool[0]
    known = joint_names(q) | {name: getattr(descent, name) for name in SETTINGS}
    known |= {f"m{i}{j}": T[i, j] for i in range(3) for j in range(3)} | dict(
        zip(("t_x", "t_y", "t_z"), T[:, 3], strict=True)
    )
    known |= {f"lower{k}": value for k, value in enumerate(qiao.lower)}
    known |= {f"upper{k}": value for k, value in enumerate(qiao.upper)}
    position, orientation, *after = evaluate(writer, [step.position, step.orientation, *step.next_q], **known)
    expected, errors = twin_step(qiao, target, np.array([qiao.lower, qiao.upper]), descent, q)
    np.testing.assert_allclose((position, orientation), errors, rtol=0, atol=1e-12)
    np.testing.assert_allclose(after, expected, rtol=0, atol=2e-12)


def test_a_position_needs_no_orientation(qiao):
    text = {kind: format_step(pack_robot(qiao), kind) for kind in KINDS}
    assert "rotation_length" not in text["position"]
    assert "m00" not in text["position"] + text["axis"]
    assert "A33" not in text["position"]
    assert "m00" in text["pose"]

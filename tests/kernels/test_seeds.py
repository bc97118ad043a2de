"""Seeds: chosen by the stream alone, near the target; the base brings the tool over it and turns it to its heading."""

from itertools import combinations

import numba
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from ikde.kernels import seeds
from ikde.kernels.rng import seed_stream
from ikde.kernels.seeds import draw_seed
from ikde.model.pack import pack_targets
from ikde.model.target import Target
from ikde.solver.plain import compute_frames
from tests.conftest import random_q
from tests.kernels.seeding import cell_of, no_seeds, pack_seeds
from tests.random_robots import random_robot
from tests.targets import target_at
from tests.uncompiled import plain, plain_module, quietly

PLAIN = plain_module(seeds)
needs_compiler = pytest.mark.skipif(bool(numba.config.DISABLE_JIT), reason="needs compiled kernels")
BASE = np.array([0, 1, 2])
KINDS = ("position", "axis", "pose")
each_kind = pytest.mark.parametrize("kind", KINDS)


def tool(robot, q):
    return compute_frames(robot, q)[robot.tool]


def make_ranges(robot, near=None):
    return np.array([robot.lower, robot.upper, 0.5 * (robot.lower + robot.upper) if near is None else near])


def draw(robot, pool, target, attempt=0, *, seed=5, stream=0, near=None):
    """The start of an attempt, as a descent gets it."""
    state, out_q = np.empty(1, dtype=np.uint64), np.full(len(robot.joints), np.nan)
    with quietly():
        plain(seed_stream)(seed, stream, attempt, state)
        PLAIN.draw_seed(pool, pack_targets([target]), 0, make_ranges(robot, near), state, attempt, out_q)
    return out_q


@pytest.fixture(scope="module")
def pool(qiao):
    """Two thousand configurations of the arm with its base at zero, free of collision or not."""
    Q = random_q(qiao, np.random.default_rng(1), 2000)
    Q[:, BASE] = 0.0
    return pack_seeds(qiao, Q, BASE)


def spread(robot, rng, count, kind, *, inside=0.6):
    """Targets that the base can drive to."""
    Q = random_q(robot, rng, count)
    Q[:, :2] *= inside
    return [target_at(T, kind) for T in tool(robot, Q)]


def poses(pool):
    """Where the tool is in each configuration of a pool for poses [K, 3, 4]: the pool keeps position, then z, x, y."""
    position, z, x, y = np.moveaxis(pool.T_world_tool.reshape(-1, 4, 3), 1, 0)
    return np.stack([x, y, z, position], axis=2)


@each_kind
def test_a_choice_hangs_on_the_stream_alone(qiao, pool, kind, rng):
    target, *others = spread(qiao, rng, 3, kind)
    for attempt in (0, 1, 7):
        first = draw(qiao, pool, target, attempt)
        draw(qiao, pool, others[0], attempt, seed=6)
        assert draw(qiao, pool, target, attempt).tobytes() == first.tobytes()
        drawn = {draw(qiao, pool, target, attempt, stream=stream).tobytes() for stream in range(12)}
        assert len(drawn) > 1


@each_kind
def test_the_tool_is_over_the_target_and_heads_as_it_does(qiao, pool, kind, rng):
    for attempt, target in enumerate(spread(qiao, rng, 12, kind)):
        q = draw(qiao, pool, target, attempt % 6)
        T = tool(qiao, q)
        np.testing.assert_allclose(T[:2, 3], target.p_world_tool[:2], rtol=0, atol=1e-12)
        if kind == "axis":
            a, b = T[:2, 2], target.R_world_tool[:2, 2]
            assert a @ b == pytest.approx(np.linalg.norm(a) * np.linalg.norm(b), abs=1e-12)
        if kind == "pose":
            # No turn about the vertical brings it nearer to the target.
            away = target.R_world_tool @ T[:3, :3].T
            for angle in (-0.01, 0.01):
                turned = Rotation.from_euler("z", angle).as_matrix().T @ away
                assert np.trace(turned) < np.trace(away) + 1e-12


@each_kind
def test_a_start_is_inside_the_ranges(qiao, pool, kind, rng):
    """Also for targets that the base cannot drive to."""
    for attempt in range(9):
        T = np.eye(4)
        T[:3, :3], T[:3, 3] = Rotation.random(rng=rng).as_matrix(), rng.uniform(-9.0, 9.0, 3)
        q = draw(qiao, pool, target_at(T, kind), attempt)
        assert np.all((qiao.lower <= q) & (q <= qiao.upper))


def test_the_arm_is_one_of_the_pool_and_from_around_the_targets_cell(qiao, pool, rng):
    for target in spread(qiao, rng, 20, "pose"):
        q = draw(qiao, pool, target)
        (row,) = np.flatnonzero((pool.q[:, 3:] == q[3:]).all(axis=1))
        T = np.column_stack([target.R_world_tool, target.p_world_tool]).ravel()
        first, last = pool.cell_start[cell_of(T, pool.grid_scale) + np.arange(2)]
        assert first - seeds.WINDOW // 2 - seeds.COMPARED <= row < last + seeds.WINDOW // 2 + seeds.COMPARED


def test_the_cell_of_a_target_is_the_one_that_its_pose_lies_in(qiao, pool, rng):
    assert pool.cell_start[-1] == len(pool.q)
    for target in spread(qiao, rng, 20, "pose"):
        T = np.column_stack([target.R_world_tool, target.p_world_tool]).ravel()
        with quietly():
            assert PLAIN.find_cell(pool, pack_targets([target]), 0) == cell_of(T, pool.grid_scale)
    T_world_tool = poses(pool).reshape(-1, 12)
    for row in range(0, len(pool.q), 97):
        cell = cell_of(T_world_tool[row], pool.grid_scale)
        assert pool.cell_start[cell] <= row < pool.cell_start[cell + 1]


@each_kind
def test_height_and_tilt_chosen_are_the_nearest_of_those_compared(qiao, pool, kind, rng):
    for target in spread(qiao, rng, 15, kind):
        with quietly():
            best = PLAIN.find_height_and_tilt(pool, pack_targets([target]), 0, 100, 50)
        T = np.moveaxis(poses(pool)[100:150], 0, 2)
        compared = {"position": [], "axis": [2], "pose": [0, 1, 2]}[kind]
        tilt = np.sum((T[2, compared].T - target.R_world_tool[2, compared]) ** 2, axis=1)
        distance = (T[2, 3] - target.p_world_tool[2]) ** 2 + pool.rotation_length**2 * tilt
        assert best == 100 + int(np.argmin(distance))


@each_kind
def test_the_pose_chosen_is_the_nearest_of_those_compared(kind, rng):
    """By squared distance and squared chord of the axes asked for, a radian counting as the rotation length."""
    robot = random_robot(4)
    pool = pack_seeds(robot, random_q(robot, rng, 200))
    for T in tool(robot, random_q(robot, rng, 10)):
        target = target_at(T, kind)
        best = PLAIN.find_pose(pool, pack_targets([target]), 0, 20, 150)
        Ts = poses(pool)[20:170]
        distance = np.sum((Ts[:, :, 3] - target.p_world_tool) ** 2, axis=1)
        columns = {"position": [], "axis": [2], "pose": [0, 1, 2]}[kind]
        for j in columns:
            chord = np.sum((Ts[:, :, j] - target.R_world_tool[:, j]) ** 2, axis=1)
            distance = distance + pool.rotation_length**2 * chord
        assert best == 20 + int(np.argmin(distance))


def test_without_a_base_a_start_is_near_the_target_and_of_the_pool(rng):
    robot = random_robot(4)
    pool = pack_seeds(robot, random_q(robot, rng, 300))
    chosen, any_one = [], []
    for stream, T in enumerate(tool(robot, random_q(robot, rng, 40))):
        q = draw(robot, pool, target_at(T, "position"), stream=stream)
        assert (pool.q == q).all(axis=1).any()
        chosen.append(np.linalg.norm(tool(robot, q)[:3, 3] - T[:3, 3]))
        any_one.append(np.linalg.norm(tool(robot, random_q(robot, rng))[:3, 3] - T[:3, 3]))
    assert np.mean(chosen) < 0.5 * np.mean(any_one)


def test_late_attempts_take_any_configuration(qiao, pool, rng):
    """The whole pool, not only what has the target's height."""
    (target,) = spread(qiao, rng, 1, "pose")
    arms = np.array([draw(qiao, pool, target, seeds.LUCKY_ATTEMPTS, stream=stream)[3:] for stream in range(60)])
    rows = np.array([np.flatnonzero((pool.q[:, 3:] == arm).all(axis=1))[0] for arm in arms])
    counts = np.histogram(rows, bins=4, range=(0, len(pool.q)))[0]
    assert counts.min() >= 5


def test_windows_double_and_stay_inside_the_pool(qiao, pool, rng):
    state = np.array([3], dtype=np.uint64)
    targets = pack_targets(spread(qiao, rng, 30, "pose"))
    reached = []
    with quietly():
        for attempt in range(seeds.LUCKY_ATTEMPTS):
            firsts = []
            for index in range(30):
                first, count = PLAIN.draw_window(pool, targets, index, state, attempt, seeds.COMPARED)
                assert count == seeds.COMPARED
                assert 0 <= first <= len(pool.q) - count
                firsts.append(first)
            reached.append(firsts)
    assert np.std(np.diff(reached, axis=0)[-1]) > np.std(np.diff(reached, axis=0)[0])


def test_the_first_start_is_near_itself_and_the_boxes_double(qiao, rng):
    target, near, share = Target([0.8, 0.5, 1.0]), random_q(qiao, rng), 1.0 / 64.0
    pool = no_seeds(qiao, share)
    assert draw(qiao, pool, target, 0, near=near).tobytes() == near.tobytes()
    width = qiao.upper - qiao.lower
    for attempt in range(1, 10):
        half = min(1.0, share * 2.0 ** (attempt - 1))
        drawn = np.array([draw(qiao, pool, target, attempt, stream=s, near=near) for s in range(40)])
        away = np.abs(drawn - near) / width
        assert away.max() <= half + 1e-12
        assert np.all((qiao.lower <= drawn) & (drawn <= qiao.upper))
        assert away.max() > 0.8 * min(half, 0.5)


def test_without_a_pool_starts_are_uniform(qiao):
    pool = no_seeds(qiao)
    drawn = np.array([draw(qiao, pool, Target([0.8, 0.5, 1.0]), 0, stream=s) for s in range(300)])
    share = (drawn - qiao.lower) / (qiao.upper - qiao.lower)
    assert share.min() >= 0.0
    assert share.max() <= 1.0
    np.testing.assert_allclose(share.mean(axis=0), 0.5, atol=0.08)


# ---- a base of which joints are frozen

HELD = [held for size in (1, 2, 3) for held in combinations(range(3), size)]
each_held = pytest.mark.parametrize("held", HELD, ids=str)


@pytest.fixture(scope="module")
def few(qiao):
    """So few configurations that all are compared."""
    Q = random_q(qiao, np.random.default_rng(2), seeds.COMPARED_HELD)
    Q[:, BASE] = 0.0
    return pack_seeds(qiao, Q, BASE)


def hold(robot, held, q):
    """Ranges with joints of the base frozen where `q` has them."""
    ranges = make_ranges(robot)
    ranges[:2, held] = q[list(held)]
    return ranges


def draw_within(ranges, pool, target, attempt=0, stream=0):
    state, out_q = np.empty(1, dtype=np.uint64), np.full(ranges.shape[1], np.nan)
    with quietly():
        plain(seed_stream)(5, stream, attempt, state)
        PLAIN.draw_seed(pool, pack_targets([target]), 0, ranges, state, attempt, out_q)
    return out_q


def far_from(target, T, length):
    """Squared distance and squared chord of the axes asked for [K], a radian counting as the length."""
    distance = np.sum((T[:, :3, 3] - target.p_world_tool) ** 2, axis=1)
    for j in {"position": [], "axis": [2], "pose": [0, 1, 2]}[target.kind]:
        distance += length**2 * np.sum((T[:, :3, j] - target.R_world_tool[:, j]) ** 2, axis=1)
    return distance


@each_kind
@each_held
def test_frozen_joints_of_a_base_stay_and_the_others_do_what_they_can(qiao, few, kind, held, rng):
    """No other row, and no other place of the base, comes nearer to the target."""
    for q in random_q(qiao, rng, 6):
        q[:2] *= 0.5
        target, ranges = target_at(tool(qiao, q), kind), hold(qiao, held, q)
        start = draw_within(ranges, few, target)
        assert start[list(held)].tobytes() == q[list(held)].tobytes()
        assert np.all((ranges[0] <= start) & (start <= ranges[1]))
        assert (few.q[:, 3:] == start[3:]).all(axis=1).any()
        Q = few.q[rng.integers(len(few.q), size=3000)].copy()
        Q[:, :3] = rng.uniform(ranges[0, :3], ranges[1, :3], (3000, 3))
        (ours,) = far_from(target, tool(qiao, start[None]), few.rotation_length)
        theirs = far_from(target, tool(qiao, Q), few.rotation_length)
        assert ours <= np.percentile(theirs, 1.0)
        if held == (0, 1):  # all rows, all headings
            Q = np.repeat(few.q, 40, axis=0)
            Q[:, :3] = np.column_stack([np.tile(q[:2], (len(Q), 1)), rng.uniform(-np.pi, np.pi, len(Q))])
            assert ours <= far_from(target, tool(qiao, Q), few.rotation_length).min() + 1e-12
        if 2 in held:  # x and y follow from the row: all of them are tried
            Q = few.q.copy()
            Q[:, 2] = q[2]
            gap = target.p_world_tool[:2] - tool(qiao, Q)[:, :2, 3]
            Q[:, :2] = np.clip(gap, ranges[0, :2], ranges[1, :2])
            assert ours <= far_from(target, tool(qiao, Q), few.rotation_length).min() + 1e-12


@pytest.mark.parametrize("held", [(0,), (1,)], ids=str)
def test_a_base_with_one_way_to_go_turns_the_tool_over_a_point_from_either_side(qiao, few, held, rng):
    sides = 0
    for q in random_q(qiao, rng, 6):
        q[:2] *= 0.5
        target = target_at(tool(qiao, q), "position")
        starts = [draw_within(hold(qiao, held, q), few, target, stream=stream) for stream in range(8)]
        away = [np.linalg.norm(tool(qiao, start)[:2, 3] - target.p_world_tool[:2]) for start in starts]
        assert max(away) < 1e-9
        sides += len({start[2] for start in starts}) > 1
    assert sides > 3


@each_held
def test_a_frozen_base_tries_others_when_one_fails(qiao, pool, held, rng):
    q = random_q(qiao, rng)
    target = target_at(tool(qiao, q), "pose")
    starts = [draw_within(hold(qiao, held, q), pool, target, attempt) for attempt in range(9)]
    assert len({start[3:].tobytes() for start in starts}) > 4


def test_frozen_joints_of_the_arm_leave_the_base_alone(qiao, pool, rng):
    target, ranges = target_at(tool(qiao, random_q(qiao, rng)), "pose"), make_ranges(qiao)
    free = draw_within(ranges, pool, target)
    ranges[:2, 5] = 0.25
    assert draw_within(ranges, pool, target).tobytes() == free.tobytes()


@needs_compiler
def test_compiled_starts_have_the_same_bits(qiao, few, rng):
    """Those of a free base, too: one piece of machine code serves all."""
    for kind in KINDS:
        for held in ((), *HELD):
            q = random_q(qiao, rng)
            target, ranges = target_at(tool(qiao, q), kind), hold(qiao, held, q)
            for attempt in (0, 7):
                out_q = np.full(9, np.nan)
                draw_compiled(few, pack_targets([target]), ranges, attempt, out_q)
                assert out_q.tobytes() == draw_within(ranges, few, target, attempt, stream=2).tobytes()


@numba.njit(error_model="numpy")
def draw_compiled(pool, target, ranges, attempt, out_q):
    state = np.empty(1, dtype=np.uint64)
    seed_stream(5, 2, attempt, state)
    draw_seed(pool, target, 0, ranges, state, attempt, out_q)

"""Seeds: free, the same for everybody, drawn where the joints may be."""

import numpy as np

import ikde
from ikde.kernels.seeds import Z
from ikde.model.robot import Robot
from ikde.solver.engines.pool import POOL_SIZE, find_base, load_kernels, make_seeds, rotation_length_m
from ikde.solver.problem import make_problem


def pool(robot: Robot, **options):
    told = {"detector": None, "near": None, "freeze": None} | options
    return make_seeds(make_problem(robot, ikde.SolveSettings(), **told), "pose")


def test_the_pool_is_free_and_sorted_by_height(qiao):
    seeds = pool(qiao)
    assert seeds.q.shape == (POOL_SIZE, 9)
    assert (seeds.q[:, :3] == 0.0).all()  # the base is set for each target
    assert not any(ikde.check(qiao, q).collision for q in seeds.q[::256])
    T_world_tool = ikde.forward(qiao, seeds.q)[qiao.tool]
    assert np.abs(T_world_tool[:, :3].reshape(POOL_SIZE, 12).T - seeds.T_world_tool).max() < 1e-12
    assert (np.diff(seeds.T_world_tool[Z]) >= 0.0).all()


def test_heights_are_found_by_their_bin(qiao):
    seeds = pool(qiao)
    heights = seeds.T_world_tool[Z]
    for height in np.linspace(heights[0], heights[-1], 50)[:-1]:
        start = seeds.height_start[int((height - seeds.lowest) * seeds.bins_per_metre)]
        assert abs(heights[min(start, POOL_SIZE - 1)] - height) <= 2.0 / seeds.bins_per_metre


def test_frozen_joints_stay_and_the_base_then_helps_no_more(qiao):
    seeds = pool(qiao, freeze={"d_x": 0.3, "q2": 0.1})
    assert (seeds.q[:, 0] == 0.3).all()
    assert (seeds.q[:, 4] == 0.1).all()
    assert seeds.base.tolist() == [-1, -1, -1]


def test_near_needs_no_pool(qiao):
    seeds = pool(qiao, near=qiao.home)
    assert len(seeds.q) == 0
    assert seeds.first_box < 1.0


def test_a_base_is_one_that_drives_turns_has_room_and_carries_all(qiao):
    lower, upper = qiao.lower, qiao.upper
    assert find_base(qiao, lower, upper).tolist() == [0, 1, 2]
    narrow = upper.copy()
    narrow[0] = lower[0] + 0.1
    assert find_base(qiao, lower, narrow).tolist() == [-1, -1, -1]
    half = upper.copy()
    half[2] = 0.0
    assert find_base(qiao, lower, half).tolist() == [-1, -1, -1]
    ur5 = ikde.load_robot("ur5")
    assert find_base(ur5, ur5.lower, ur5.upper).tolist() == [-1, -1, -1]


def test_a_radian_counts_as_a_part_of_the_arm(any_robot):
    assert 0.05 < rotation_length_m(any_robot) < 1.0


def test_tables_take_the_place_of_modules_if_asked(qiao, monkeypatch):
    monkeypatch.setenv("IKDE_KERNELS", "tables")
    _, robot, detector = load_kernels(qiao, qiao.detector(None), "pose")
    assert len(robot.bodies) == 10
    assert detector.safe_distance > 0.0

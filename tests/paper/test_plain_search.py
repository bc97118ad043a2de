"""The paper's plain search: what a setup changes, and that a sample is the beginning of a larger one."""

from pathlib import Path

import numpy as np
import pytest

import ikde
from ikde.paper.inputs import FULL, load_inputs
from ikde.paper.plain_search import (
    SEED,
    Setup,
    apply_setup,
    collides,
    make_setup_problem,
    solve_plainly,
)
from ikde.paper.section import make_collision

ROOT = Path(__file__).parents[2]
TARGETS = load_inputs(FULL).targets


def test_the_targets_are_those_of_section_5_3_3():
    assert TARGETS["1"].p_world_tool.tolist() == [0.8, 0.5, 1.0]
    assert TARGETS["2"].p_world_tool == pytest.approx([0.54, -0.131, 0.974])


def test_the_base_keeps_within_its_range(qiao):
    robot = apply_setup(qiao, Setup(base_half_width_m=0.2))
    assert robot.lower[:2].tolist() == [-0.2, -0.2]
    assert robot.upper[:2].tolist() == [0.2, 0.2]


def test_classical_limits_are_the_printed_ones_counted_classically(qiao):
    robot = apply_setup(qiao, Setup(limits="classical"))
    offset = np.where(np.array(robot.joint_names) == "q5", np.pi, 0.0)
    assert robot.lower[2:] + offset[2:] == pytest.approx(qiao.lower[2:])
    assert robot.upper[2:] + offset[2:] == pytest.approx(qiao.upper[2:])


@pytest.mark.parametrize(("limits", "turn"), [("half_turn", np.pi), ("full_turn", 2 * np.pi)])
def test_limits_may_be_a_turn(qiao, limits, turn):
    robot = apply_setup(qiao, Setup(limits=limits))
    assert robot.lower[2:].tolist() == [-turn] * 7
    assert robot.upper[2:].tolist() == [turn] * 7


def test_key_point_limits_are_the_robots_own(qiao):
    robot = apply_setup(qiao, Setup(limits="key_point"))
    assert robot.lower[2:].tolist() == qiao.lower[2:].tolist()


def test_every_solution_meets_its_target_within_its_ranges(qiao, inputs):
    setup = Setup()
    robot = apply_setup(qiao, setup)
    solutions = solve_plainly(inputs, setup, TARGETS["1"], 20)
    assert len(solutions.Q) == 20
    for q in solutions.Q:
        graded = ikde.verify(robot, TARGETS["1"], q, settings=setup.settings, collision="none")
        assert graded.accepted


def test_a_sample_is_the_beginning_of_a_larger_one(inputs):
    large = solve_plainly(inputs, Setup(), TARGETS["2"], 12, first_stream=100)
    small = solve_plainly(inputs, Setup(), TARGETS["2"], 5, first_stream=100)
    assert large.first(5).tobytes() == small.Q.tobytes()


def test_verdicts_are_those_of_check(qiao, inputs):
    Q = solve_plainly(inputs, Setup(), TARGETS["2"], 12).Q
    collision = make_collision(qiao, "typical", "non_adjacent")
    assert collides(collision, Q).tolist() == [ikde.check(qiao, q, collision).collision for q in Q]
    assert collides(collision, Q[:0]).tolist() == []


def test_the_shipped_run_file_is_the_stated_setting(qiao):
    batch = ikde.load_batch(ROOT / "configs" / "runs" / "qiao2021_table4.yaml")
    (arm,) = batch.arms
    problem = make_setup_problem(qiao, Setup())
    assert arm.problem.settings == problem.settings
    assert arm.problem.lower == pytest.approx(problem.lower, abs=1e-15)
    assert arm.problem.upper == pytest.approx(problem.upper, abs=1e-15)
    assert (batch.seed, batch.repeats, arm.problem.collision.detector) == (SEED, FULL.solves, None)
    for target, asked in zip(TARGETS.values(), batch.source.read(0, 2), strict=True):
        assert target.p_world_tool.tolist() == asked.p_world_tool.tolist()

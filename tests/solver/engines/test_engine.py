"""What engines share: rows that are open, ranges, and settings of damped least squares."""

import numpy as np
import pytest

import ikde
from ikde.kernels.damped import compute_rotation
from ikde.model.pack import pack_targets
from ikde.model.rotation import rotation_from_rpy
from ikde.solver.engines.engine import SearchInputs, make_descent, make_ranges, measure_rotation
from tests.problems import problem_of
from tests.solver.engines.questions import make_question


def test_attempts_go_to_open_rows_of_the_kind_only(qiao, rng):
    question, _ = make_question(qiao, rng, ("pose", "position", "position", "position"))
    question.found.counts[2, 0] = 1  # reached
    question.found.excess_m[3] = 0.5  # proved out of reach
    attempts = question.attempts(range(4), 2, np.array([9, 8, 7, 6]), kind=0)
    assert attempts.tolist() == [[2, 2], [2, 8], [2, 2], [2, 2]]
    assert question.attempts(range(0, 2), 2, np.array([9, 8, 7, 6])).tolist() == [[2, 9], [2, 8]]


def test_the_last_streams_are_whole_numbers(qiao, rng):
    question, targets = make_question(qiao, rng, ("pose", "pose"))
    last = range(2**63 - 2, 2**63)
    streams = SearchInputs(question.problem, targets, question.found, seed=1, streams=last).streams
    assert (streams.dtype, streams.tolist()) == (np.int64, [*last])


def test_ranges_hold_limits_and_the_middle_or_near(qiao):
    settings = ikde.SolveSettings()
    plain = make_ranges(problem_of(qiao, settings))
    assert (plain == [qiao.lower, qiao.upper, 0.5 * (qiao.lower + qiao.upper)]).all()
    near = make_ranges(problem_of(qiao, settings, near=qiao.home, freeze={"d_x": 0.25}))
    assert near[:2, 0].tolist() == [0.25, 0.25]
    assert (near[2, 1:] == qiao.home[1:]).all()


def test_tolerances_are_a_hair_smaller_than_asked(qiao):
    asked = ikde.SolveSettings(position_tolerance_m=1e-9, orientation_tolerance_rad=1e-3)
    descent = make_descent(problem_of(qiao, asked), "pose")
    assert 0.99e-9 < descent.position_tolerance < 1e-9
    assert descent.orientation_tolerance == pytest.approx(2.0 * np.sin(0.5e-3) - 1e-12, rel=1e-15)


@pytest.mark.parametrize("kind", ["axis", "pose"])
def test_a_turn_is_measured_as_the_kernel_measures_it(kind, rng):
    angles = [*rng.uniform(0.0, np.pi, 50), 1e-12, 1e-9, 1e-4, 0.5 * np.pi, 0.5 * np.pi + 1e-9, 3.12]
    for angle in angles:
        T = np.eye(4)
        T[:3, :3] = rotation_from_rpy(np.array([angle, 0.0, 0.0]))
        extra = {"axis_world_tool": T[:3, 2]} if kind == "axis" else {"R_world_tool": T[:3, :3]}
        target = pack_targets([ikde.Target(np.zeros(3), **extra)])
        measured = compute_rotation(target, 0, np.eye(4)[:3].copy(), np.empty(3))
        assert measured == pytest.approx(measure_rotation(angle, kind), abs=1e-15, rel=1e-9)


@pytest.mark.parametrize("kind", ["axis", "pose"])
def test_the_measure_of_a_turn_grows_with_its_angle(kind):
    sizes = [measure_rotation(angle, kind) for angle in np.linspace(0.0, np.pi, 10_001)]
    assert (np.diff(sizes) > 0.0).all()
    assert sizes[0] == 0.0
    assert sizes[-1] == pytest.approx(2.0)

"""Measures are functions of singular values; gradients are derivatives of every robot that ships, with each base."""

from dataclasses import replace

import numpy as np
import pytest

import ikde
from ikde.errors import InputError
from ikde.kernels.nullspace import differentiate_column
from ikde.model.actuators import speed_limits, speeds_by
from ikde.model.base_motion import find_planar_base
from ikde.solver.jacobian import arm_jacobian, find_chain, frame_jacobian
from ikde.solver.measures import MeasureChoice, chosen_jacobian, leave_out, measure, measure_gradient
from tests.conftest import random_q

STEP = 1e-5
WHAT = ("manipulability", "determinant", "condition", "smallest")
BASES = {name: ikde.load_robot(name) for name in ikde.robot_names()}
BASES |= {
    f"{name}, omnidirectional": replace(BASES[name], drive="omnidirectional") for name in ("qiao2021", "qiao2021_dh")
}


def choices(robot):
    parts = ("whole", "arm", "base") if find_planar_base(robot)[0] >= 0 else ("whole",)
    ways = ("joints", "twist", "actuators") if len(parts) > 1 else ("joints",)
    for part in parts:
        for rows in ("pose", "translation", "rotation"):
            for by in ways:
                yield MeasureChoice(part=part, rows=rows, by=by, length_m=0.3, scaled=rows != "translation")


@pytest.mark.parametrize("name", BASES)
def test_gradients_are_those_of_central_differences(name, rng):
    robot = BASES[name]
    q, steps = random_q(robot, rng), STEP * np.eye(len(robot.joints))
    for choice in choices(robot):
        around = {k: measure(robot, q + k * steps, choice) for k in (-2, -1, 1, 2)}
        for what in WHAT:
            here = float(getattr(measure(robot, q, choice), what))
            gradient = measure_gradient(robot, q, choice, what)
            if not np.isfinite(here):  # too few columns, or some that never move the tool otherwise
                assert np.isnan(gradient).any()
                continue
            f = {k: getattr(of, what) for k, of in around.items()}
            expected = (8.0 * (f[1] - f[-1]) - (f[2] - f[-2])) / (12.0 * STEP)
            scale = max(here, np.abs(expected).max())
            np.testing.assert_allclose(
                gradient, expected, rtol=0, atol=1e-6 * scale + 1e-12, err_msg=f"{choice} {what}"
            )


def test_yoshikawa_s_and_the_determinant_stand_under_their_own_names(qiao, rng):
    q = random_q(qiao, rng, 20)
    choice = MeasureChoice(rows="translation", by="actuators", scaled=False)
    found, J = measure(qiao, q, choice), ikde.jacobian(qiao, q, by="actuators")[:, :3]
    np.testing.assert_allclose(found.determinant, np.linalg.det(J @ J.mT), rtol=1e-9)
    np.testing.assert_allclose(found.manipulability, np.sqrt(found.determinant), rtol=1e-12)
    values = np.linalg.eigvalsh(J @ J.mT)
    np.testing.assert_allclose(found.axis_ratio, np.sqrt(values[:, -1] / values[:, 0]), rtol=1e-6)
    np.testing.assert_array_equal(found.condition, found.axis_ratio)
    np.testing.assert_allclose(found.smallest, np.sqrt(values[:, 0]), rtol=1e-6)


def test_the_base_s_determinant_is_the_distance_from_the_axle_by_the_track(qiao, rng):
    """[DongZhao, eq. 13] with the square: w1 = (distance of the tool from the axle's line / b)^2, by rim speeds."""
    q, b = random_q(qiao, rng, 50), 2.0 * qiao.wheels.half_track_m
    base = MeasureChoice(part="base", rows="translation", by="actuators", scaled=False)
    w1 = measure(qiao, q, base).determinant / qiao.wheels.radius_m**4
    frames = ikde.forward(qiao, q)
    own = np.linalg.inv(frames["Od"]) @ frames["tool"]
    np.testing.assert_allclose(w1, (own[:, 0, 3] / b) ** 2, rtol=1e-9)


def test_they_do_not_depend_on_where_the_base_stands(qiao, rng):
    q = random_q(qiao, rng, 10)
    there = q.copy()
    there[:, :3] = rng.uniform(-2, 2, (10, 3))
    for rows in ("pose", "translation"):
        for part in ("whole", "arm", "base"):
            choice = MeasureChoice(part=part, rows=rows)
            here, moved = (measure(qiao, values, choice).singular_values for values in (q, there))
            np.testing.assert_allclose(here, moved, rtol=0, atol=1e-12)


def test_a_determinant_of_base_and_arm_depends_on_the_unit_of_length_unless_it_is_scaled(qiao):
    """Where it is largest: a base's speed counts m a m, a joint's m a rad, so millimetres favour joints."""
    grid = np.deg2rad(np.arange(-150.0, 151.0, 3.0))
    q = np.tile(qiao.home, (len(grid) ** 2, 1))
    q[:, 3], q[:, 7] = 0.0, np.deg2rad(30.0)
    q[:, 4:6] = np.stack(np.meshgrid(grid, grid, indexing="ij"), axis=-1).reshape(-1, 2)
    J, speeds = ikde.jacobian(qiao, q, by="twist")[:, :3], speed_limits(qiao, "twist")
    best = {"raw": set(), "scaled": set()}
    for unit in (1.0, 10.0, 1000.0):  # so many a metre
        own = J * unit
        own[:, :, 0] /= unit
        limits = speeds * np.where(np.arange(8) == 0, unit, 1.0)
        for kind, columns in (("raw", own), ("scaled", own * limits)):
            best[kind].add(int(np.linalg.det(columns @ columns.mT).argmax()))
    assert (len(best["raw"]), len(best["scaled"])) == (3, 1)


def test_an_arm_measured_alone_is_that_of_tracks(qiao, rng):
    q = random_q(qiao, rng, 10)
    own = chosen_jacobian(qiao, q, MeasureChoice(part="arm", scaled=False))
    theirs = np.linalg.svd(arm_jacobian(qiao, q, ("d_x", "d_y", "q_z")), compute_uv=False)
    np.testing.assert_allclose(np.linalg.svd(own, compute_uv=False), theirs, rtol=0, atol=1e-12)


def test_tracks_follow_the_same_derivative(qiao, rng):
    """What `raise_manipulability` of the null space adds up is what gradients are made of."""
    q, slope = random_q(qiao, rng), rng.uniform(-1, 1, (6, 9))
    J, chain = frame_jacobian(qiao, q, qiao.tool), find_chain(qiao, qiao.tool)
    for k in (3, 6):
        moved = q.copy()
        moved[k] += 1e-7
        expected = np.sum(slope * (frame_jacobian(qiao, moved, qiao.tool) - J)) / 1e-7
        found = sum(differentiate_column.plain(J[:, chain], slope, k, i) for i in range(9))
        assert found == pytest.approx(expected, abs=1e-5)


def test_a_determinant_has_a_gradient_in_a_singularity():
    robot = ikde.load_robot("ur5")
    stretched = np.array([0.0, -1.2, 0.0, -1.0, 1.0, 0.0])
    choice = MeasureChoice()
    assert measure(robot, stretched, choice).smallest < 1e-9
    beside = stretched + np.array([0, 0, 1e-4, 0, 0, 0])
    slope = measure_gradient(robot, stretched, choice, "manipulability")[2]
    assert abs(slope) == pytest.approx(measure(robot, beside, choice).manipulability / 1e-4, rel=1e-3)


def test_what_is_left_without_a_column(qiao, rng):
    J = chosen_jacobian(qiao, random_q(qiao, rng, 3), MeasureChoice())
    without = leave_out(J)
    rest = J[1][:, 1:]
    assert without.shape == (3, 8)
    assert without[1, 0] == pytest.approx(np.sqrt(np.linalg.det(rest @ rest.T)), rel=1e-9)


def test_wrong_words_are_refused(qiao):
    for words, message in (
        ({"part": "leg"}, "part: expected one of whole, arm, base, got 'leg'"),
        ({"rows": "axis"}, "rows: expected one of pose, translation, rotation, got 'axis'"),
        ({"by": "wheels"}, "by: expected one of joints, twist, actuators, got 'wheels'"),
        ({"length_m": 0.0}, "length_m: expected a number above 0"),
    ):
        with pytest.raises(InputError, match=message):
            MeasureChoice(**words)
    with pytest.raises(InputError, match="part: ur5 has no planar base to measure"):
        measure(ikde.load_robot("ur5"), np.zeros(6), MeasureChoice(part="base"))
    with pytest.raises(InputError, match="measure: expected one of manipulability"):
        measure_gradient(qiao, qiao.home, MeasureChoice(), "dexterity")


def test_speeds_are_those_of_the_base_or_what_its_wheels_need(qiao):
    limits = speed_limits(qiao, "actuators")
    v, omega = speed_limits(qiao, "twist")[:2]
    assert limits[:2] == pytest.approx([(v + 0.259 * omega) / 0.1] * 2)
    assert speed_limits(qiao, "joints").shape == (9,)
    assert speeds_by(qiao, qiao.home, "actuators").shape == (9, len(limits))


def test_what_rounding_leaves_of_a_singular_value_is_none(qiao):
    """At home the arm of qiao2021 is folded into a plane: numpy gives 3e-33 and a condition of 1e33."""
    found = measure(qiao, qiao.home, MeasureChoice())
    assert (found.singular_values > 1e-3).sum() == 4
    assert (found.manipulability, found.smallest, found.condition) == (0.0, 0.0, np.inf)

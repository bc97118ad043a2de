"""Steps of a base with wheels against an integration, their derivatives against differences, and the box of a step."""

import numpy as np
import pytest

from ikde.kernels import drive as kernels
from tests.kernels.driving import make_drive, make_track
from tests.uncompiled import plain

take_drive_step, fold_row, set_step_box = map(plain, (kernels.take_drive_step, kernels.fold_row, kernels.set_step_box))
NAMES = ("differential", "omnidirectional")


def step_from(drive, q, step):
    out = np.full(len(q), np.nan)
    take_drive_step(drive, q, step, out)
    return out


@pytest.mark.parametrize("turn", [0.0, 1e-5, 0.03, -0.8, 1.0])
def test_a_base_with_wheels_drives_an_arc(qiao, rng, turn):
    drive = make_drive(qiao)
    q, step = rng.uniform(-1, 1, 9), rng.uniform(-1, 1, 8)
    step[1] = turn
    x, y, heading = q[:3]
    parts = 20_000
    distance, angle = drive.largest[0] * step[0] / parts, drive.largest[1] * turn / parts
    headings = heading + angle * (np.arange(parts) + 0.5)
    expected = [x + distance * np.cos(headings).sum(), y + distance * np.sin(headings).sum(), heading + angle * parts]
    np.testing.assert_allclose(step_from(drive, q, step)[:3], expected, atol=1e-12)


def test_joints_move_by_their_share(qiao, rng):
    for name in NAMES:
        drive = make_drive(qiao, name)
        q, step = rng.uniform(-1, 1, 9), rng.uniform(-1, 1, len(drive.largest))
        expected = q[drive.others] + (drive.largest * step)[-len(drive.others) :]
        np.testing.assert_allclose(step_from(drive, q, step)[drive.others], expected, rtol=1e-15)


def test_the_arc_and_its_series_meet():
    share = plain(kernels.chord_share)
    for x in (1e-9, 0.5 * kernels.SMALL, 0.999999 * kernels.SMALL, 1.000001 * kernels.SMALL, 0.3):
        value, slope = share(x)
        assert value == pytest.approx(np.sinc(x / np.pi), rel=1e-15)
        assert slope == pytest.approx(np.cos(x) / x - np.sin(x) / x**2 if x > 0.1 else -x / 3 + x**3 / 30, rel=1e-7)


def test_an_arc_leaves_a_range_where_a_fine_walk_along_it_does(qiao, rng):
    drive = make_drive(qiao, speed=np.full(9, 20.0))
    is_inside, found = plain(kernels.arc_is_inside), []
    for _ in range(1500):
        q, step = np.zeros(9), rng.uniform(-1, 1, 8)
        q[2] = 0.5 * np.pi * rng.integers(-3, 4) + rng.uniform(-0.4, 0.4)
        step[1] *= rng.choice([0.0, 1e-9, 1.0], p=[0.1, 0.1, 0.8])
        walk = np.array([step_from(drive, q, share * step)[:2] for share in np.linspace(0.0, 1.0, 80)])
        ends = walk[[0, -1]]
        room = rng.choice([1e-4, 1e-3, 1e-2])
        ranges, side, axis = np.full((2, 9), [[-9.0], [9.0]]), rng.integers(2), rng.integers(2)
        ranges[side, axis] = ends[:, axis].max() + room if side else ends[:, axis].min() - room
        beyond = np.maximum(ranges[0, :2] - walk, walk - ranges[1, :2]).max()
        if abs(beyond) > 5e-5:  # the walk's own coarseness
            found.append(bool(beyond > 0.0))
            assert is_inside(drive, ranges, q, step) is not found[-1]
    assert 10 < sum(found) < len(found) - 10


@pytest.mark.parametrize("name", NAMES)
def test_rows_follow_the_step(qiao, rng, name):
    drive = make_drive(qiao, name)
    for _ in range(10):
        q, step, row = rng.uniform(-1, 1, 9), rng.uniform(-1, 1, len(drive.largest)), rng.uniform(-1, 1, 9)
        out = np.full(len(step), np.nan)
        fold_row(drive, q, step, row, out)
        moves = 1e-6 * np.eye(len(step))
        expected = [row @ (step_from(drive, q, step + d) - step_from(drive, q, step - d)) / 2e-6 for d in moves]
        np.testing.assert_allclose(out, expected, atol=1e-9)


def test_a_step_stays_in_the_ranges(qiao):
    drive, track = make_drive(qiao), make_track(qiao)
    q = qiao.upper.copy()
    q[8] = qiao.lower[8] + 0.001
    lower, upper = np.empty(8), np.empty(8)
    assert set_step_box(drive, track.ranges, q, np.zeros(8), False, lower, upper)
    np.testing.assert_allclose(upper, [1, 0, 0, 0, 0, 0, 0, 1])
    np.testing.assert_allclose(lower, [-1] * 7 + [-0.001 / drive.largest[7]])


@pytest.mark.parametrize("change", [0.013, 0.1, 0.37])
def test_what_brakes_in_time_can_always_stop(qiao, rng, change):
    acceleration = change * make_drive(qiao, "omnidirectional").largest / 0.02**2
    drive, track = make_drive(qiao, acceleration=acceleration), make_track(qiao)
    out, lower, upper = np.empty(9), np.empty(8), np.empty(8)
    for share in (0.0, 0.3):
        q, step = qiao.home.copy(), np.zeros(8)
        for k in range(400):
            assert set_step_box(drive, track.ranges, q, step, k == 0, lower, upper)
            wanted = np.where(rng.random(8) < share, lower, upper)
            if k:
                assert np.abs(wanted - step).max() <= change + 1e-12
            step = wanted
            step[0] = np.clip(0.0, lower[0], upper[0])
            take_drive_step(drive, q, step, out)
            q = out.copy()
            assert (q >= qiao.lower - 1e-12).all()
            assert (q <= qiao.upper + 1e-12).all()


def test_what_cannot_stop_is_recognised(qiao):
    drive, track = make_drive(qiao, acceleration=np.full(9, 0.1)), make_track(qiao)
    q, last = qiao.home.copy(), np.zeros(8)
    q[8], last[7] = qiao.upper[8] - 1e-4, 1.0
    lower, upper = np.empty(8), np.empty(8)
    assert not set_step_box(drive, track.ranges, q, last, False, lower, upper)
    assert (lower <= upper).all()


def test_what_is_frozen_has_no_bounds_to_keep(qiao):
    speed = np.full(9, 0.5)
    speed[8] = 0.0
    drive, track = make_drive(qiao, speed=speed), make_track(qiao)
    q, lower, upper = qiao.home.copy(), np.empty(8), np.empty(8)
    q[8] = qiao.upper[8] + 1.0
    assert set_step_box(drive, track.ranges, q, np.zeros(8), False, lower, upper)
    assert (lower[7], upper[7], drive.largest[7]) == (-1.0, 1.0, 0.0)

"""What is proved of a way to a stop is so at a hundred places of it, for arms and for bases on arcs."""

import numpy as np
import pytest

import ikde
from ikde.kernels import stopping as kernels
from ikde.kernels.drive import take_drive_step
from ikde.kernels.flat_arguments import unpack_world
from ikde.model.collision_model import CollisionModel
from ikde.model.pack import pack_robot
from ikde.solver.plain import compute_gaps
from ikde.track.drive import pack_drive
from ikde.track.limits import MotionLimits
from ikde.track.servo_plan import ServoModels
from tests.track.servo_walks import draw_world
from tests.uncompiled import plain, plain_module

PLAIN = plain_module(kernels)
PLACES = 100


class Stand:
    """A robot in a world, with a drive, for uncompiled kernels."""

    def __init__(self, name, drive, seed=5, acceleration=2.0):
        robot, rng = ikde.load_robot(name), np.random.default_rng(seed)
        self.robot = robot
        self.model = CollisionModel.of(robot).in_world(draw_world(robot, robot.home, rng, 12))
        limits = MotionLimits.of(robot, acceleration=np.full(len(robot.joints), acceleration))
        self.drive, self.arrays, self.spheres = (
            pack_drive(robot, drive, limits, 0.1),
            pack_robot(robot),
            self.model.arrays,
        )
        self.world, self.radii = plain(unpack_world)(self.spheres.world), ServoModels.of(self.model).radii
        self.size, self.rng = len(self.drive.largest), rng
        self.way = PLAIN.make_way(self.arrays, self.spheres, len(robot.joints), self.size, 4)

    def prove(self, q, step):
        rotation = PLAIN.measure_way(self.arrays, self.drive, self.radii, step, 1.0, self.way)
        packed = (self.arrays, self.spheres, self.world, True, self.drive)
        return PLAIN.prove_way(*packed, q, step, rotation, 0, self.way)

    def least_room(self, q, step):
        rows = np.tile(q, (PLACES + 1, 1))
        for row, share in zip(rows, np.linspace(0.0, 1.0, PLACES + 1), strict=True):
            plain(take_drive_step)(self.drive, q, share * step, row)
        return compute_gaps(self.model, rows).min() - self.model.limit_m


@pytest.mark.parametrize(("name", "drive"), [("ur5", "omnidirectional"), ("qiao2021", "differential")])
def test_what_is_proved_is_free_and_what_is_free_by_far_is_proved(name, drive):
    stand, proved, refused = Stand(name, drive), 0, 0
    for _ in range(60):
        q = stand.robot.home + (0.9 if name == "ur5" else 0.4) * stand.rng.standard_normal(len(stand.robot.joints))
        step = stand.rng.uniform(-1.0, 1.0, stand.size) * stand.rng.uniform(0.1, 6.0)
        room = stand.least_room(q, step)
        is_proved = stand.prove(q, step) == kernels.PROVED
        assert not is_proved or room > 0.0
        assert is_proved or room < 0.005
        proved, refused = proved + is_proved, refused + (not is_proved)
    assert min(proved, refused) > 5


def test_travel_bounds_how_far_everything_moves():
    stand = Stand("qiao2021", "differential")
    step, q, end = stand.rng.uniform(-1.0, 1.0, stand.size), stand.robot.home, stand.robot.home.copy()
    PLAIN.measure_way(stand.arrays, stand.drive, stand.radii, step, 1.0, stand.way)
    plain(take_drive_step)(stand.drive, q, step, end)
    gaps = compute_gaps(stand.model, np.array([q, end]))
    pairs = len(stand.model.pairs)
    change, moved = np.abs(gaps[1] - gaps[0]), stand.way.moved
    assert (change[:pairs] <= moved[:pairs] + 1e-12).all()
    of_world = change[pairs:].reshape(len(stand.model.components), -1)
    assert (
        of_world[np.isfinite(of_world).all(axis=1)] <= moved[pairs:][np.isfinite(of_world).all(axis=1), None] + 1e-12
    ).all()


def test_braking_shrinks_all_speeds_together_and_its_way_is_as_long_as_said():
    stand = Stand("ur5", "omnidirectional")
    last = np.array([0.9, -0.3, 0.0, 0.5, 0.1, -0.7])
    factor, entry = PLAIN.stop_factor(stand.drive, last)
    longest = np.abs(last) / stand.drive.change
    assert entry == longest.argmax()
    assert factor == pytest.approx(1.0 + 0.5 * longest.max())
    total, step = last.copy(), last.copy()
    for _ in range(1000):
        after = np.empty(6)
        PLAIN.brake_step(stand.drive, step, after)
        assert (np.abs(after - step) <= stand.drive.change * (1.0 + 1e-12)).all()
        np.testing.assert_allclose(np.outer(after, last), np.outer(last, after), atol=1e-12)
        total, step = total + after, after
    assert not step.any()
    assert (np.abs(total) <= factor * np.abs(last) + 1e-12).all()


def test_the_distance_of_a_chord_is_that_of_its_nearest_point(rng):
    for _ in range(50):
        a, b = rng.standard_normal(3), rng.standard_normal(3)
        points = a + np.linspace(0.0, 1.0, 2001)[:, None] * (b - a)
        assert PLAIN.chord_distance(*a, *b) == pytest.approx(np.linalg.norm(points, axis=1).min(), abs=1e-4)
    assert PLAIN.chord_distance(1.0, 2.0, 2.0, 1.0, 2.0, 2.0) == 3.0

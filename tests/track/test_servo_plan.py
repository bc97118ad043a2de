"""What stays of a servo's call: entries of a step, limits by entry, and how far joints move things."""

import numpy as np

import ikde
from ikde.model.collision_model import CollisionModel
from ikde.track.servo_plan import NO_WORLD, ServoModels, ServoPlan, list_entries, world_of
from tests.track.servo_walks import draw_world, limits_of


def test_entries_are_joints_or_speeds_of_a_base(qiao):
    model = CollisionModel.of(qiao)
    arcs = ServoPlan.of(model, limits_of(qiao), "differential")
    free = ServoPlan.of(model, limits_of(qiao), "omnidirectional")
    assert list_entries(qiao, arcs.base)[:2] == ("v", qiao.joint_names[2])
    assert list_entries(qiao, free.base) == qiao.joint_names
    assert (arcs.rates.shape, free.rates.shape) == ((3, 8), (3, 9))
    np.testing.assert_array_equal(free.rates[0], limits_of(qiao).speed)


def test_another_world_changes_nothing_that_is_laid_out(rng):
    robot = ikde.load_robot("ur5")
    own = CollisionModel.of(robot)
    one, other = (own.in_world(draw_world(robot, robot.home, rng, 2)) for _ in range(2))
    assert world_of(own) is NO_WORLD
    first, second = ServoModels.of(one), ServoModels.of(other)
    for a, b in zip(
        (first.numbers, first.whole, first.radii), (second.numbers, second.whole, second.radii), strict=True
    ):
        np.testing.assert_array_equal(a, b)
    assert first.radii.shape == (len(own.pairs) + len(one.components), 6)

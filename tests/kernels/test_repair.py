"""What is pulled clear meets its target still; what is not stays as it was."""

import numpy as np

import ikde
from ikde.kernels.arrays import POSE, POSITION, DescentArrays, TargetArrays
from ikde.kernels.flat_arguments import flatten_search
from ikde.kernels.repair import repair_at
from ikde.kernels.world import find_obstacle_at
from ikde.model.collision_model import CollisionModel
from ikde.model.pack import pack_robot
from ikde.solver.engines.pool import no_pool
from tests.solids import random_world

DESCENT = DescentArrays(position_tolerance=1e-5, orientation_tolerance=1e-4)


def test_arms_with_joints_to_spare_are_pulled_clear_and_others_stay(rng):
    robot = ikde.load_robot("ur5")
    ranges = np.array([robot.lower, robot.upper, robot.home])
    model = CollisionModel.of(robot).in_world(random_world(rng, 4, kinds=("box", "sphere"), far=0.9))
    numbers, whole = flatten_search(pack_robot(robot), model.arrays, ranges, DESCENT, no_pool(robot, 1.0))[:2]
    found = []
    for q in rng.uniform(-2.0, 2.0, (40, 6)):
        with np.errstate(all="ignore"):
            if len(found) == 4 or find_obstacle_at.plain(numbers, whole, q) < 0:
                continue
            T, start = ikde.forward(robot, q)[robot.tool][None, :3], q.copy()
            asked = TargetArrays(np.array([POSE]), T)
            assert repair_at.plain(numbers, whole, asked, 0, ranges, DESCENT, q) == 0
            assert np.array_equal(q, start)
            asked = TargetArrays(np.array([POSITION]), T)
            steps = repair_at.plain(numbers, whole, asked, 0, ranges, DESCENT, q)
            free = find_obstacle_at.plain(numbers, whole, q) < 0
        found.append(steps > 0)
        assert free if steps > 0 else np.array_equal(q, start)
    assert any(found)

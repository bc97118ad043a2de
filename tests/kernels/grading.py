"""The grader in lanes as a call, and the robots that it is tested on."""

import numpy as np

import ikde
from ikde.kernels.flat_arguments import Terms, flatten_grader
from ikde.kernels.grade_many import grade_many
from ikde.model.collision_model import CollisionModel
from ikde.model.pack import pack_robot, pack_targets
from tests.conftest import ROBOTS as HAND_WRITTEN
from tests.kernels.arrays import freeze
from tests.random_robots import random_robot
from tests.three_joints import CROWDED

ROBOTS = [*map(ikde.load_robot, HAND_WRITTEN), *map(random_robot, range(12)), CROWDED]


def terms_of(robot, position=np.inf, orientation=np.inf):
    return Terms(freeze([robot.lower, robot.upper]), position, orientation)


def grade(robot, detector, targets, Q, terms=None, grader=grade_many):
    """Figures [T, 3], pairs [T] and verdicts [T] by the grader."""
    figures, pairs = np.full((len(Q), 3), np.nan), np.full(len(Q), -9, dtype=np.int64)
    accepted = np.zeros(len(Q), dtype=np.bool_)
    block = flatten_grader(
        pack_robot(robot), CollisionModel(robot=robot, detector=detector).arrays, terms or terms_of(robot)
    )
    grader(*block, *pack_targets(targets), np.ascontiguousarray(Q), figures, pairs, accepted)
    return figures, pairs, accepted

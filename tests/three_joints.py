"""A robot of three joints that can touch itself, whose kernels are compiled in seconds; and the tests' own judge."""

from functools import cache
from pathlib import Path

import numpy as np

import ikde
from ikde.model.collision_model import CollisionModel
from tests import reference
from tests.targets import target_at

FILE = Path(__file__).parent / "three_joints.yaml"
ROBOT = ikde.load_robot(FILE)
KINDS = ("position", "axis", "pose")


def is_met(robot, target, q, settings):
    """Whether `q` meets the target inside all limits and free of collision, by the naive twins."""
    q, detector = np.asarray(q, dtype=float), CollisionModel.of(robot).detector
    if not (np.isfinite(q).all() and (robot.lower <= q).all() and (q <= robot.upper).all()):
        return False
    T_world_tool = reference.compute_frames(robot, q)[robot.tool]
    near = reference.compute_position_error(T_world_tool, target) <= settings.position_tolerance_m
    turned = reference.compute_orientation_error(T_world_tool, target) <= settings.orientation_tolerance_rad
    return bool(near and turned and reference.compute_clearance(robot, detector, q)[0] > detector.safe_distance_m)


def meet(robot, q, kind, shift=(0.0, 0.0, 0.0)):
    """The target of a kind that the tool meets at `q`, moved by `shift` m."""
    T = np.array(reference.compute_frames(robot, np.asarray(q, dtype=float))[robot.tool])
    T[:3, 3] += shift
    return target_at(T, kind)


@cache
def free_q(count):
    """Configurations [count, 3] inside the limits and well apart from contact."""
    rng, found = np.random.default_rng(12), []
    while len(found) < count:
        q = rng.uniform(ROBOT.lower + 0.05, ROBOT.upper - 0.05)
        if reference.compute_clearance(ROBOT, CollisionModel.of(ROBOT).detector, q)[0] > 0.03:
            found.append(q)
    return np.array(found)

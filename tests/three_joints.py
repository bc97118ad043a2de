"""A robot of three joints that can touch itself, whose kernels are compiled in seconds; and the tests' own judge."""

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np

import ikde
from ikde.model.collision_model import CollisionModel
from ikde.model.robot import SphereRow
from tests import reference
from tests.targets import target_at

FILE = Path(__file__).parent / "three_joints.yaml"
ROBOT = ikde.load_robot(FILE)
KINDS = ("position", "axis", "pose")


def crowd(rows):
    """The robot with rows of 2, 3, .. spheres, no two of one radius, along its post and its hand."""
    lines = {"floor": ("world", "world"), "post": ("column", "top"), "arm": ("sleeve", "mouth"), "hand": ("rod", "tip")}
    spheres = [
        SphereRow(component=name, start=a, end=b, radius_m=0.05 - 0.001 * k, count=k + 2, spacing="even")
        for name, (a, b) in lines.items()
        for k in range(rows if a != b and name != "arm" else 1)
    ]
    return replace(ROBOT, name=f"crowded_{rows}", approximations={"balls": tuple(spheres)})


CROWDED = crowd(8)  # more tests than are written one by one: its check is written as tables


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

"""Robots and detectors whose collision checks are compared with brute force, and what brute force says."""

from dataclasses import replace
from itertools import combinations

import numpy as np

import ikde
from ikde.model.collision_model import CollisionModel
from ikde.model.robot import Detector, SphereRow
from ikde.solver.plain import compute_gaps
from tests.conftest import ROBOTS
from tests.random_robots import make_frame, make_robot, random_robot

MIN_FREE = 0.3  # of the configurations of a random robot


def loosen(robot):
    """The robot with other pairs: as many as leave a share of its configurations free, those seldom hit first."""
    detector = CollisionModel.of(robot).detector
    every = tuple(combinations(robot.components(detector.spheres), 2))
    Q = np.random.default_rng(0).uniform(robot.lower, robot.upper, (200, len(robot.joints)))
    hits = compute_gaps(CollisionModel(robot=robot, detector=detector), Q, every) <= detector.safe_distance_m
    kept, hit = [], np.zeros(len(Q), dtype=bool)
    for k in np.argsort(hits.mean(axis=0), kind="stable"):
        if (hit | hits[:, k]).mean() <= 1.0 - MIN_FREE:
            kept.append(int(k))
            hit |= hits[:, k]
    return replace(robot, pair_lists={"some": tuple(every[k] for k in sorted(kept))})


SHIPPED = [(robot, detector) for robot in map(ikde.load_robot, ROBOTS) for detector in robot.detectors.values()]
RANDOM = [(robot, CollisionModel.of(robot).detector) for robot in map(loosen, map(random_robot, range(20)))]
CASES = [*SHIPPED, *RANDOM]
CONTACT = 1e-9  # m: what is nearer to contact than this is left out


def name_case(case):
    """Robot and detector."""
    return f"{case[0].name}-{case[1].name}"


def find_gaps(robot, detector, Q):
    """Clearance [T, P] of every pair by plain numpy."""
    return compute_gaps(CollisionModel(robot=robot, detector=detector), Q)


def away_from_contact(gaps, safe_distance):
    """Rows none of whose pairs is at contact, where rounding decides."""
    return np.all(np.abs(gaps - safe_distance) > CONTACT, axis=1)


def make_row(component, start, end, radius, count=1, spacing="even"):
    """A row of spheres between two frames."""
    return SphereRow(component=component, start=start, end=end, radius_m=radius, count=count, spacing=spacing)


def two_arms(rows, pairs, points, **limits):
    """Two joints on the world, side by side, with key points {name: (frame, xyz)} on any of them, and a tool."""
    frames = [
        make_frame("f0", "world", (0, 0, 0.2), joint="j0", axis=(0, 0, 1)),
        make_frame("f1", "world", (0.3, 0, 0), joint="j1", axis=(0, 1, 0)),
        make_frame("tool", "f1", (0.3, 0, 0)),
        *(make_frame(name, parent, xyz) for name, (parent, xyz) in points.items()),
    ]
    return make_robot(
        {"j0": "revolute", "j1": "revolute"},
        frames,
        approximations={"spheres": tuple(rows)},
        pair_lists={"some": tuple(pairs)},
        detectors={"some": Detector(name="some", spheres="spheres", pairs="some")},
        default_detector="some",
        **limits,
    )

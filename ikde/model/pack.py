"""From a `Robot` to the arrays that the kernels take (`kernels/arrays.py`): read-only, C-ordered, one dtype each."""

from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike

from ikde.kernels.arrays import DetectorArrays, Floats, Ints, RobotArrays, TargetArrays
from ikde.model.robot import WORLD, Detector, Robot
from ikde.model.rotation import rotation_with_z
from ikde.model.spheres import Sphere, bounding_sphere, expand_rows
from ikde.model.target import Target
from ikde.model.tree import Body, build_tree, transform

KINDS = {"position": 0, "axis": 1, "pose": 2}


@lru_cache(maxsize=64)
def pack_robot(robot: Robot) -> RobotArrays:
    """Pack the kinematic tree; every joint axis becomes the z axis of its body."""
    tree = build_tree(robot)
    T_body_aligned = [_align(body) for body in tree.bodies]
    T_parent_body = [
        T_body_aligned[body.parent].T @ body.T_parent_body @ T
        for body, T in zip(tree.bodies, T_body_aligned, strict=True)
    ]
    frames = frame_names(robot)
    T_body_frame = [T_body_aligned[tree.frame_body[f]].T @ tree.T_body_frame[f] for f in frames]
    kinds = [None if body.joint is None else robot.joints[body.joint].kind for body in tree.bodies]
    return RobotArrays(
        body_parent=_ints([body.parent for body in tree.bodies]),
        body_coordinate=_ints([-1 if body.joint is None else body.joint for body in tree.bodies]),
        body_slides=_ints([kind == "prismatic" for kind in kinds]),
        body_moves_tool=_ints(_ancestors(tree.bodies, tree.frame_body[robot.tool])),
        R_parent_body=_floats([T[:3, :3] for T in T_parent_body]),
        p_parent_body=_floats([T[:3, 3] for T in T_parent_body]),
        frame_body=_ints([tree.frame_body[f] for f in frames]),
        R_body_frame=_floats([T[:3, :3] for T in T_body_frame]),
        p_body_frame=_floats([T[:3, 3] for T in T_body_frame]),
        tool_frame=_ints([frames.index(robot.tool)]),
        lower=_floats(robot.lower),
        upper=_floats(robot.upper),
    )


@lru_cache(maxsize=64)
def pack_detector(robot: Robot, detector: Detector | None) -> DetectorArrays:
    """Pack a detector's spheres and pairs; None packs the detector that never sees anything."""
    tree = build_tree(robot)
    pairs = robot.pair_lists[detector.pairs] if detector else ()
    looked_at = {component for pair in pairs for component in pair}
    every = expand_rows(robot, tree, detector.spheres) if detector else ()
    spheres = [sphere for sphere in every if sphere.component in looked_at]
    components = list(dict.fromkeys(sphere.component for sphere in spheres))
    groups = [[s for s in spheres if s.component == c] for c in components]
    bounds = [bounding_sphere(group) for group in groups]
    rows = robot.approximations[detector.spheres] if detector else ()
    used_rows = list(dict.fromkeys(sphere.row for sphere in spheres))
    frames = frame_names(robot)
    aligned = [_align(body).T for body in tree.bodies]
    return DetectorArrays(
        safe_distance=_floats([detector.safe_distance_m if detector else 0.0]),
        sphere_body=_ints([s.body for s in spheres]),
        p_body_sphere=_points([_map(aligned[s.body], s.p_body_sphere) for s in spheres]),
        sphere_radius=_floats([s.radius_m for s in spheres]),
        component_start=_ints(np.cumsum([0, *map(len, groups)])),
        component_body=_ints([group[0].body for group in groups]),
        p_body_bound=_points([_map(aligned[g[0].body], p) for g, (p, _) in zip(groups, bounds, strict=True)]),
        bound_radius=_floats([radius for _, radius in bounds]),
        pair_a=_ints([components.index(a) for a, _ in pairs]),
        pair_b=_ints([components.index(b) for _, b in pairs]),
        row_start=_ints(np.cumsum([0, *(_count(spheres, row) for row in used_rows)])),
        row_from=_ints([frames.index(rows[row].start) for row in used_rows]),
        row_to=_ints([frames.index(rows[row].end) for row in used_rows]),
        sphere_offset=_floats([s.offset_m for s in spheres]),
    )


def frame_names(robot: Robot) -> list[str]:
    """Names of the packed frames: the world, then the robot's."""
    return [WORLD, *(frame.name for frame in robot.frames)]


def pack_targets(targets: list[Target]) -> TargetArrays:
    """Pack targets, one row each."""
    return TargetArrays(
        kind=_ints([KINDS[target.kind] for target in targets]),
        p_world_tool=_points([target.p_world_tool for target in targets]),
        R_world_tool=_floats([target.R_world_tool for target in targets]),
    )


def _align(body: Body) -> Floats:
    """T_body_aligned: the body's frame, turned so that its joint axis is z; a pure rotation, so .T is its inverse."""
    return transform(rotation_with_z(body.axis), np.zeros(3))


def _map(T: Floats, p: Floats) -> Floats:
    return T[:3, :3] @ p + T[:3, 3]


def _count(spheres: list[Sphere], row: int) -> int:
    return sum(sphere.row == row for sphere in spheres)


def _ancestors(bodies: tuple[Body, ...], last: int) -> list[bool]:
    """For every body: does it carry body `last`, or is it that body?"""
    carries = [False] * len(bodies)
    while last != 0:
        carries[last] = True
        last = bodies[last].parent
    return carries


def _floats(values: ArrayLike) -> Floats:
    array = np.ascontiguousarray(values, dtype=np.float64)
    array.setflags(write=False)
    return array


def _points(values: list[Floats]) -> Floats:
    return _floats(np.reshape(values, (-1, 3)))


def _ints(values: ArrayLike) -> Ints:
    array = np.ascontiguousarray(values, dtype=np.int64)
    array.setflags(write=False)
    return array

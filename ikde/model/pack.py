"""From a `Robot` to the arrays that the kernels take (`kernels/arrays.py`): read-only, C-ordered, one dtype each."""

from collections.abc import Sequence
from functools import lru_cache
from itertools import groupby

import numpy as np
from numpy.typing import ArrayLike

from ikde.kernels.arrays import CollisionArrays, Floats, Indices, Ints, RobotArrays, TargetArrays, read_only
from ikde.model.robot import WORLD, Detector, FreeSpheres, Robot
from ikde.model.rotation import rotation_with_z
from ikde.model.spheres import Sphere, bounding_sphere, expand_rows
from ikde.model.target import Target, Targets
from ikde.model.tree import Body, build_tree, transform


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
    carries_tool = _ancestors(tree.bodies, tree.frame_body[robot.tool])
    return RobotArrays(
        bodies=pack_ints([_body_row(robot, body, c) for body, c in zip(tree.bodies, carries_tool, strict=True)]),
        T_parent_body=pack_floats([T[:3] for T in T_parent_body]),
        frame_body=pack_indices([tree.frame_body[f] for f in frames]),
        T_body_frame=pack_floats([T[:3] for T in T_body_frame]),
    )


@lru_cache(maxsize=64)
def pack_collision(robot: Robot, detector: Detector | None, *, every: bool = False) -> CollisionArrays:
    """Pack a detector's spheres and pairs; None packs no pairs at all. `every`: components without a pair, too."""
    tree = build_tree(robot)
    pairs = robot.pair_lists[detector.pairs] if detector else ()
    compared = {component for pair in pairs for component in pair}
    known = expand_rows(robot, tree, detector.spheres) if detector else ()
    spheres = [sphere for sphere in known if every or sphere.component in compared]
    components = list(dict.fromkeys(sphere.component for sphere in spheres))
    groups = [[s for s in spheres if s.component == c] for c in components]
    ends = np.cumsum([0, *map(len, groups)])
    aligned = [_align(body).T for body in tree.bodies]
    centres = [_map(aligned[s.body], s.p_body_sphere) for s in spheres]
    bounds = [(g[0].body, *bounding_sphere(g)) for g in groups]
    indices = [sorted((components.index(a), components.index(b)), key=lambda c: -len(groups[c])) for a, b in pairs]
    return CollisionArrays(
        safe_distance=float(detector.safe_distance_m if detector else 0.0),
        p_body_sphere=pack_floats(np.reshape(centres, (-1, 3)).T),
        radius=pack_floats([s.radius_m for s in spheres]),
        components=_table([(g[0].body, ends[i], ends[i + 1]) for i, g in enumerate(groups)], 3),
        bounds=pack_floats(np.reshape([[*_map(aligned[body], p), r] for body, p, r in bounds], (-1, 4))),
        pairs=_table(indices, 2),
        rows=_table(_list_rows(robot, detector.spheres, spheres) if detector else (), 4),
        offset=pack_floats([s.offset_m for s in spheres]),
        world=pack_floats([]),
    )


def _list_rows(robot: Robot, approximation: str, spheres: list[Sphere]) -> list[tuple[int, int, int, int]]:
    """Key points and spheres of each row; a free sphere is one of its own, about its frame."""
    frames, entries = frame_names(robot), robot.approximations[approximation]
    rows: list[tuple[int, int, int, int]] = []
    for entry, group in groupby(range(len(spheres)), key=lambda k: spheres[k].row):
        numbers, row = list(group), entries[entry]
        ends = frames.index(row.start), frames.index(row.end)
        if isinstance(row, FreeSpheres):
            rows += [(*ends, k, k + 1) for k in numbers]
        else:
            rows.append((*ends, numbers[0], numbers[-1] + 1))
    return rows


def frame_names(robot: Robot) -> list[str]:
    """Names of the packed frames: the world first, the tool last."""
    return [WORLD, *(frame.name for frame in robot.frames if frame.name != robot.tool), robot.tool]


def pack_targets(targets: Targets | Sequence[Target]) -> TargetArrays:
    """The targets' own poses; a sequence of `Target` is converted first.

    Kinds are a copy, which is writable as those in `flatten_answer` are: kernels are compiled for one type of them.
    """
    targets = Targets.of(targets)
    return TargetArrays(kind=targets.kind.copy(), T_world_tool=targets.T_world_tool)


def _body_row(robot: Robot, body: Body, carries_tool: bool) -> tuple[int, int, bool, bool]:
    if body.joint is None:
        return body.parent, -1, False, carries_tool
    return body.parent, body.joint, robot.joints[body.joint].kind == "prismatic", carries_tool


def _align(body: Body) -> Floats:
    """T_body_aligned: the body's frame, rotated so that its joint axis is z; a pure rotation, so .T is its inverse."""
    return transform(rotation_with_z(body.axis), np.zeros(3))


def _map(T: Floats, p: Floats) -> Floats:
    return T[:3, :3] @ p + T[:3, 3]


def _ancestors(bodies: tuple[Body, ...], last: int) -> list[bool]:
    """Whether each body carries body `last` or is that body."""
    carries = [False] * len(bodies)
    while last != 0:
        carries[last] = True
        last = bodies[last].parent
    return carries


def pack_floats(values: ArrayLike) -> Floats:
    """A copy as kernels take numbers."""
    return read_only(np.array(values, dtype=np.float64, order="C"))


def pack_ints(values: ArrayLike) -> Ints:
    """A copy as kernels take whole numbers."""
    return read_only(np.array(values, dtype=np.int64, order="C"))


def pack_indices(values: ArrayLike) -> Indices:
    """A copy as kernels take indices."""
    return read_only(np.array(values, dtype=np.uint64, order="C"))


def _table(rows: Sequence[Sequence[int]], columns: int) -> Indices:
    return pack_indices(np.reshape(rows, (-1, columns)))

"""The robot's geometry in plain numpy, straight from the `Robot`: no packing, no numba, nothing shared with kernels.

It answers `forward` and `check`, and it is what `verify` grades with. It is written to be read: frames by products of
4 x 4 matrices, sphere centres on the lines between key points, all distances of all pairs. Leading axes `...` are
configurations: one, or as many as there are.
"""

from collections.abc import Mapping, Sequence
from functools import lru_cache

import numpy as np

from ikde.kernels.arrays import Floats, Ints
from ikde.model.collision_model import CollisionModel
from ikde.model.robot import WORLD, FreeSpheres, Pairs, Robot, SphereRow
from ikde.solver.plain_world import measure_obstacle


def joint_motion(kind: str, axis: Floats, value: Floats) -> Floats:
    """T of a joint [..., 4, 4]: a rotation about `axis` [3] by `value` [...] rad, or a shift along it by `value` m."""
    T = np.zeros((*value.shape, 4, 4))
    T[...] = np.eye(4)
    if kind == "prismatic":
        T[..., :3, 3] = value[..., None] * axis
        return T
    x, y, z = axis
    K = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    outer = np.outer(axis, axis)
    s, c = np.sin(value)[..., None, None], np.cos(value)[..., None, None]
    T[..., :3, :3] = c * np.eye(3) + s * K + (1.0 - c) * outer
    return T


def compute_frames(robot: Robot, q: Floats) -> dict[str, Floats]:
    """T_world_frame [..., 4, 4] of every frame, for `q` [..., N] in the robot's own convention."""
    places = {name: place for place, name in enumerate(robot.joint_names)}
    Ts_world: dict[str, Floats] = {WORLD: np.broadcast_to(np.eye(4), (*q.shape[:-1], 4, 4))}
    for frame in robot.frames:
        T = np.eye(4)
        T[:3, :3], T[:3, 3] = frame.R_parent_frame, frame.p_parent_frame
        Ts_world[frame.name] = Ts_world[frame.parent] @ T
        if frame.joint is not None and frame.axis is not None:
            place = places[frame.joint]
            motion = joint_motion(robot.joints[place].kind, frame.axis, q[..., place])
            Ts_world[frame.name] = Ts_world[frame.name] @ motion
    return Ts_world


Spheres = tuple[Floats, Floats]
"""Centres [..., n, 3] in the world and radii [n], m."""


def compute_row_centres(row: SphereRow, start: Floats, end: Floats) -> Floats:
    """Centres [..., count, 3] of a row of spheres between key points [..., 3] [Qiao2021, eq. 12, 13, 16]."""
    middle, line = 0.5 * (start + end)[..., None, :], (end - start)[..., None, :]
    if row.count == 1:
        return middle
    steps = np.arange(row.count)[:, None] - 0.5 * (row.count - 1)
    if row.spacing == "even":
        return middle + steps * line / (row.count - 1)
    return middle + steps * 2.0 * row.radius_m * line / np.linalg.norm(line, axis=-1, keepdims=True)


def compute_components(
    collision: CollisionModel, q: Floats, Ts_world: Mapping[str, Floats] | None = None
) -> dict[str, Spheres]:
    """Spheres of every component, in the world, for `q` [..., N] or the frames there; none without a detector."""
    Ts_world = compute_frames(collision.robot, q) if Ts_world is None else Ts_world
    centres: dict[str, list[Floats]] = {}
    radii: dict[str, list[float]] = {}
    for row in collision.rows:
        if isinstance(row, FreeSpheres):
            own, T = np.array(row.spheres), Ts_world[row.frame]
            points = np.einsum("...ij,nj->...ni", T[..., :3, :3], own[:, :3]) + T[..., None, :3, 3]
            centres.setdefault(row.component, []).append(points)
            radii.setdefault(row.component, []).extend(own[:, 3])
            continue
        points = compute_row_centres(row, Ts_world[row.start][..., :3, 3], Ts_world[row.end][..., :3, 3])
        centres.setdefault(row.component, []).append(points)
        radii.setdefault(row.component, []).extend([row.radius_m] * row.count)
    return {name: (np.concatenate(centres[name], axis=-2), np.array(radii[name])) for name in centres}


def compute_sphere_gaps(a: Spheres, b: Spheres) -> Floats:
    """Distance - R_i - R_j between all spheres of two components [..., n, m] in m."""
    x, y, z = (a[0][..., :, None, k] - b[0][..., None, :, k] for k in range(3))  # thrice as fast as a norm over an axis
    return np.sqrt(x * x + y * y + z * z) - a[1][:, None] - b[1]


def compute_gaps(
    collision: CollisionModel, q: Floats, pairs: Pairs | None = None, Ts_world: Mapping[str, Floats] | None = None
) -> Floats:
    """Smallest distance - R_i - R_j [..., P] in m of every pair of components, or of some, for `q` [..., N].

    Without `pairs` those of components and obstacles follow (`compute_world_gaps`). `Ts_world`: the frames at `q`, if
    they are known.
    """
    if pairs is not None:
        return _compute_own_gaps(collision, q, pairs, Ts_world)
    Ts_world = compute_frames(collision.robot, q) if Ts_world is None else Ts_world
    own = _compute_own_gaps(collision, q, collision.pairs, Ts_world)
    if not collision.obstacles:
        return own
    return np.concatenate([own, compute_world_gaps(collision, q, Ts_world)], axis=-1)


def _compute_own_gaps(
    collision: CollisionModel, q: Floats, pairs: Pairs, Ts_world: Mapping[str, Floats] | None
) -> Floats:
    """Of pairs of components [..., P]."""
    if not pairs:
        return np.empty((*q.shape[:-1], 0))
    components = compute_components(collision, q, Ts_world)
    radii = np.concatenate([own for _, own in components.values()])[:, None]
    centres = np.concatenate([own for own, _ in components.values()], axis=-2)
    x, y, z = np.ascontiguousarray(
        centres.reshape(-1, *centres.shape[-2:]).transpose(2, 1, 0)
    )  # of each sphere, each q
    gaps = np.empty((len(pairs), x.shape[1]))
    sizes = tuple((name, len(own)) for name, (_, own) in components.items())
    for some, i, j, starts in list_sphere_pairs(sizes, pairs, AT_ONCE // max(1, x.shape[1])):
        dx, dy, dz = x[i] - x[j], y[i] - y[j], z[i] - z[j]
        distance = np.sqrt(dx * dx + dy * dy + dz * dz)
        gaps[some] = np.minimum.reduceat(distance - radii[i] - radii[j], starts, axis=0)
    return np.ascontiguousarray(gaps.T).reshape(*q.shape[:-1], len(pairs))


def compute_world_gaps(
    collision: CollisionModel,
    q: Floats,
    Ts_world: Mapping[str, Floats] | None = None,
    *,
    some: Sequence[str] | None = None,
) -> Floats:
    """Smallest distance - R of every component and obstacle [..., C O] in m, less what is asked for beyond the safe
    distance: so all are compared with that. inf where they are not compared. `some`: of these components only, also
    of those that no joint moves.
    """
    Ts_world = compute_frames(collision.robot, q) if Ts_world is None else Ts_world
    placed, obstacles = compute_components(collision, q, Ts_world), collision.obstacles
    components = {name: placed[name] for name in (placed if some is None else some)}
    if not (components and q.size):
        return np.empty((*q.shape[:-1], len(components) * len(obstacles)))
    centres = np.concatenate([own for own, _ in components.values()], axis=-2)
    radii = np.concatenate([own for _, own in components.values()])
    firsts = np.cumsum([0, *(len(own) for _, own in components.values())])[:-1]
    extras_m = collision.extras_m[len(collision.pairs) :].reshape(-1, len(obstacles))
    extras_m = extras_m[[collision.components.index(name) for name in components]]
    is_fixed = np.array([some is None and name in collision.fixed_components for name in components])
    gaps = np.empty((*q.shape[:-1], len(components), len(obstacles)))
    for other, obstacle in enumerate(obstacles):
        T = Ts_world[obstacle.frame].reshape(-1, 4, 4)[0]  # frames of obstacles stay in their place
        distance = measure_obstacle(obstacle, (centres - T[:3, 3]) @ T[:3, :3]) - radii
        is_left_out = is_fixed | np.array([name in obstacle.ignore for name in components])
        nearest = np.minimum.reduceat(distance, firsts, axis=-1) - extras_m[:, other]
        gaps[..., other] = np.where(is_left_out, np.inf, nearest)
    return gaps.reshape(*q.shape[:-1], len(components) * len(obstacles))


AT_ONCE = 5_000  # distances: from 128 kB on what is freed goes back to the system, and comes again page by page


@lru_cache(maxsize=64)
def list_sphere_pairs(
    sizes: tuple[tuple[str, int], ...], pairs: Pairs, most: int
) -> tuple[tuple[slice, Ints, Ints, Ints], ...]:
    """Pairs of components in groups of at most `most` pairs of spheres, or of one pair.

    Which pairs, their spheres on either side, and where each pair begins. `sizes`: all components with their spheres,
    which are counted through.
    """
    names, counts = zip(*sizes, strict=True)
    first, size = dict(zip(names, (np.cumsum(counts) - counts).tolist(), strict=True)), dict(sizes)
    groups, begin, tests = [], 0, [size[a] * size[b] for a, b in pairs]
    while begin < len(pairs):
        end, count = begin + 1, tests[begin]
        while end < len(pairs) and count + tests[end] <= most:
            end, count = end + 1, count + tests[end]
        some = pairs[begin:end]
        i = np.concatenate([np.repeat(first[a] + np.arange(size[a]), size[b]) for a, b in some])
        j = np.concatenate([np.tile(first[b] + np.arange(size[b]), size[a]) for a, b in some])
        groups.append((slice(begin, end), i, j, np.cumsum([0, *tests[begin : end - 1]])))
        begin = end
    return tuple(groups)

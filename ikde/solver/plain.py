"""The robot's geometry in plain numpy, straight from the `Robot`: no packing, no numba, nothing shared with kernels.

It answers `forward` and `check`, and it is what `verify` grades with. It is written to be read: frames by products of
4 x 4 matrices, sphere centres on the lines between key points, all distances of all pairs. Leading axes `...` are
configurations: one, or as many as there are.
"""

from collections.abc import Mapping
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ikde.kernels.arrays import Floats, Ints, read_only
from ikde.model.collision_model import CollisionModel
from ikde.model.large_worlds import KEPT
from ikde.model.robot import WORLD, Frame, FreeSpheres, Pairs, Robot, SphereRow
from ikde.solver.plain_cloud import find_cloud_gaps
from ikde.solver.plain_world import Alike, list_alike


def joint_motion(kind: str, axis: Floats, value: Floats) -> Floats:
    """T of joints [..., 4, 4]: rotations about `axis` [..., 3] by `value` [...] rad, or shifts along it, in m."""
    T = np.zeros((*value.shape, 4, 4))
    T[...] = np.eye(4)
    if kind == "prismatic":
        T[..., :3, 3] = value[..., None] * axis
        return T
    x, y, z = axis.T
    K = np.zeros((*axis.shape[:-1], 3, 3))
    K[..., 0, 1], K[..., 0, 2], K[..., 1, 2], K[..., 1, 0], K[..., 2, 0], K[..., 2, 1] = -z, y, -x, z, -y, x
    outer = axis[..., :, None] * axis[..., None, :]
    s, c = np.sin(value)[..., None, None], np.cos(value)[..., None, None]
    T[..., :3, :3] = c * np.eye(3) + s * K + (1.0 - c) * outer
    return T


class Placing(NamedTuple):
    """What of a robot's frames stays, parents first."""

    frames: tuple[tuple[str, str, Floats, tuple[str, int] | None], ...]
    """Name, parent, T_parent_frame [4, 4] at q = 0, and which joint of a kind moves it."""
    moved: dict[str, tuple[list[int], Floats]]
    """By kind of joint: places in q [M], and axes [M, 3]."""


@lru_cache(maxsize=128)
def _list_frames(robot: Robot, ends: tuple[str, ...] | None) -> Placing:
    places = {name: place for place, name in enumerate(robot.joint_names)}
    frames, moved = [], {}
    for frame in _list_ancestors(robot, ends):
        T, motion = np.eye(4), None
        T[:3, :3], T[:3, 3] = frame.R_parent_frame, frame.p_parent_frame
        if frame.joint is not None and frame.axis is not None:
            place = places[frame.joint]
            of_kind = moved.setdefault(robot.joints[place].kind, ([], []))
            motion = robot.joints[place].kind, len(of_kind[0])
            of_kind[0].append(place)
            of_kind[1].append(frame.axis)
        frames.append((frame.name, frame.parent, T, motion))
    return Placing(tuple(frames), {kind: (places, np.array(axes)) for kind, (places, axes) in moved.items()})


def _list_ancestors(robot: Robot, ends: tuple[str, ...] | None) -> list[Frame]:
    """The frames from the world to these, parents first; None: all frames."""
    if ends is None:
        return list(robot.frames)
    found, wanted = [], set(ends)
    for frame in reversed(robot.frames):
        if frame.name in wanted:
            found.append(frame)
            wanted.add(frame.parent)
    return found[::-1]


def compute_frames(robot: Robot, q: Floats, ends: tuple[str, ...] | None = None) -> dict[str, Floats]:
    """T_world_frame [..., 4, 4] of every frame, for `q` [..., N] in the robot's own convention.

    `ends`: of these frames alone, and of those between the world and them.
    """
    frames, moved = _list_frames(robot, ends)
    Ts_world: dict[str, Floats] = {WORLD: np.broadcast_to(np.eye(4), (*q.shape[:-1], 4, 4))}
    motions = {kind: joint_motion(kind, axes, q[..., places]) for kind, (places, axes) in moved.items()}
    for name, parent, T, motion in frames:
        Ts_world[name] = Ts_world[parent] @ T
        if motion is not None:
            Ts_world[name] = Ts_world[name] @ motions[motion[0]][..., motion[1], :, :]
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
    found = {}
    for name, (parts, radii) in _list_parts(collision.laden).items():
        points = []
        for part in parts:
            if isinstance(part, SphereRow):
                points.append(
                    compute_row_centres(part, Ts_world[part.start][..., :3, 3], Ts_world[part.end][..., :3, 3])
                )
            else:
                frame, own = part
                T = Ts_world[frame]
                points.append(np.einsum("...ij,nj->...ni", T[..., :3, :3], own) + T[..., None, :3, 3])
        found[name] = points[0] if len(points) == 1 else np.concatenate(points, axis=-2), radii
    return found


@lru_cache(maxsize=64)
def _list_parts(collision: CollisionModel) -> dict[str, tuple[list[SphereRow | tuple[str, Floats]], Floats]]:
    """Of each component its rows, or a frame and centres [n, 3] in it, and the radii of all spheres, m."""
    parts: dict[str, list[SphereRow | tuple[str, Floats]]] = {}
    radii: dict[str, list[float]] = {}
    for row in collision.rows:
        parts.setdefault(row.component, []).append(
            (row.frame, np.array(row.spheres)[:, :3]) if isinstance(row, FreeSpheres) else row
        )
        own = [sphere[3] for sphere in row.spheres] if isinstance(row, FreeSpheres) else [row.radius_m] * row.count
        radii.setdefault(row.component, []).extend(own)
    return {name: (parts[name], read_only(np.array(radii[name]))) for name in parts}


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
    Ts_world = compute_frames(collision.robot, q) if Ts_world is None else Ts_world
    components = compute_components(collision, q, Ts_world) if collision.detector else {}
    if pairs is not None:
        return _compute_own_gaps(components, q, pairs)
    own = _compute_own_gaps(components, q, collision.pairs)
    if not collision.obstacles:
        return own
    return np.concatenate([own, _compute_world_gaps(collision, q, components)], axis=-1)


def _compute_own_gaps(components: Mapping[str, Spheres], q: Floats, pairs: Pairs) -> Floats:
    """Of pairs of components [..., P]."""
    if not pairs:
        return np.empty((*q.shape[:-1], 0))
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


def compute_world_gaps(collision: CollisionModel, q: Floats, Ts_world: Mapping[str, Floats] | None = None) -> Floats:
    """Smallest distance - R of every component and obstacle [..., C O] in m, less what is asked for beyond the safe
    distance: so all are compared with that. inf where they are not compared.
    """
    return _compute_world_gaps(collision, q, compute_components(collision, q, Ts_world))


def _compute_world_gaps(collision: CollisionModel, q: Floats, components: Mapping[str, Spheres]) -> Floats:
    groups, less_m = list_world(collision)
    several, count = q.shape[:-1], len(collision.obstacles)
    if not (components and q.size):
        return np.empty((*several, len(components) * count))
    centres = np.concatenate([own for own, _ in components.values()], axis=-2)
    radii = np.concatenate([own for _, own in components.values()])
    firsts = np.cumsum([0, *(len(own) for _, own in components.values())])[:-1]
    P, nearest = centres.reshape(-1, 3), np.full((count, centres.size // (3 * len(radii)), len(components)), np.inf)
    for group in groups:
        if group.solid is not None and group.solid.kind == "cloud":
            for place, owner in enumerate(group.owners):
                gaps = _measure_cloud(group, place, P, radii, firsts, less_m[:, owner] > -np.inf)
                nearest[owner] = np.minimum(nearest[owner], gaps)
            continue
        for owners, distances in group.measure(P):
            gaps = distances.reshape(len(owners), -1, len(radii)) - radii
            gaps = np.minimum.reduceat(gaps, firsts, axis=-1)
            starts = np.flatnonzero(np.diff(owners, prepend=-1))
            each, gaps = owners[starts], np.minimum.reduceat(gaps, starts, axis=0)
            nearest[each] = np.minimum(nearest[each], gaps)
    return (nearest.transpose(1, 2, 0) - less_m).reshape(*several, len(components) * count)


def _measure_cloud(
    group: Alike, place: int, P: Floats, radii: Floats, firsts: Ints, compared: NDArray[np.bool_]
) -> Floats:
    """Gaps of components [K, C] to a cloud, of spheres at `P` [K S, 3] in the world, m; inf of those not compared."""
    counts, configurations = np.diff(np.append(firsts, len(radii))), len(P) // len(radii)
    component = np.repeat(np.arange(len(firsts)), counts)
    groups = (np.arange(configurations)[:, None] * len(firsts) + component).ravel()
    wanted = np.tile(compared[component], configurations)
    own = ((P - group.p[place]) @ group.R[place])[wanted]
    less = np.tile(radii, configurations)[wanted] + group.sizes[place, 0, 0]
    assert group.solid is not None
    assert group.solid.points is not None
    gaps = find_cloud_gaps(group.solid.points, own, less, groups[wanted], configurations * len(firsts))
    return gaps.reshape(configurations, len(firsts))


@KEPT.add
@lru_cache(maxsize=64)
def list_world(collision: CollisionModel) -> tuple[tuple[Alike, ...], Floats]:
    """Solids in their groups; and what each component and obstacle [C, O] are asked for beyond the safe distance, m:
    -inf where they are not compared.
    """
    frames, obstacles = compute_frames(collision.robot, collision.robot.home), collision.obstacles
    less_m = collision.extras_m[len(collision.pairs) :].reshape(-1, len(obstacles)).copy()
    for component, name in enumerate(collision.components):
        if name in collision.fixed_components:
            less_m[component] = -np.inf
        less_m[component, [name in obstacle.ignore for obstacle in obstacles]] = -np.inf
    for thing in collision.world.attached:
        allowed = [obstacle.name in thing.may_touch for obstacle in obstacles]
        less_m[collision.components.index(thing.name), allowed] = -np.inf
    return list_alike(obstacles, frames), less_m


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

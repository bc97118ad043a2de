"""Obstacles that move along a track: where each is at any moment, and how far its points have moved."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple, Self

import numpy as np
from numpy.typing import ArrayLike

from ikde.errors import InputError, nearest, quoted
from ikde.kernels.arrays import CollisionArrays, Floats, read_only
from ikde.kernels.flat_arguments import HEADER, SOLID_COLUMNS
from ikde.model.arguments import Pose, find_matrix
from ikde.model.collision_model import CollisionModel
from ikde.model.numbers import read_numbers
from ikde.model.robot import WORLD
from ikde.model.solids import Solid, read_pose
from ikde.model.world import Obstacle
from ikde.solver.plain import compute_components, compute_world_gaps
from ikde.solver.plain_cloud import find_cloud_gaps
from ikde.solver.plain_world import measure_solid
from ikde.track.slerp import slerp

ROUNDING_S = 1e-9
POSES = "T_world_object"
POSE = slice(1, 13)  # columns of a packed solid: its axes and its place


@dataclass(frozen=True, eq=False, repr=False, init=False)
class ObjectMotion:
    """Poses of an obstacle at moments; between them it moves straight and turns at constant speed on the shortest way.

    For `follow_path(..., moving={"cart": ObjectMotion(times_s, T_world_object)})`.

    Args:
        times_s: [K] ascending, s, two at least: from the path's start to its end.
        T_world_object: poses in the world at these times [K, 4, 4] or [K, 3, 4], those of another library, or places
            [K, 3] of what keeps the axes of the world; m.

    Raises:
        InputError: for times that do not increase, poses that are none, fewer than two, and half a turn between two.
    """

    times_s: Floats
    """[K] ascending."""
    T_world_object: Floats
    """[K, 3, 4] rotation and m."""

    def __init__(self, times_s: ArrayLike, T_world_object: ArrayLike | Iterable[ArrayLike | Pose]) -> None:
        times = read_numbers(times_s, ("times_s",))
        if times.ndim != 1:
            raise InputError(f"expected times [K] in s, got shape {times.shape}", ("times_s",))
        poses = _read_poses(T_world_object)
        if len(times) != len(poses) or len(times) < 2:
            raise InputError(f"expected a pose a time, two at least, got {len(times)} and {len(poses)}", ("times_s",))
        for (k,) in np.argwhere(~(np.diff(times) > 0.0) | ~np.isfinite(times[1:]))[:1]:
            raise InputError(
                f"expected a later time than {times[k]:g} s, got {times[k + 1]:g}", ("times_s", int(k) + 1)
            )
        object.__setattr__(self, "times_s", read_only(times))
        object.__setattr__(self, "T_world_object", read_only(poses))
        try:
            slerp("pose", poses[:, :, :3], np.arange(len(poses), dtype=float))
        except InputError as error:
            raise InputError(error.message, (POSES, *error.where)) from None

    def __repr__(self) -> str:
        """In a line."""
        first, last = self.times_s[[0, -1]].tolist()
        return f"<ObjectMotion: {len(self.times_s)} poses from {first:g} to {last:g} s>"

    def place(self, times_s: Floats) -> tuple[Floats, Floats]:
        """Rotations [M, 3, 3] and places [M, 3] in m at `times_s` [M]; before and after its times it rests."""
        at = np.interp(times_s, self.times_s, np.arange(len(self.times_s), dtype=float))
        p = np.column_stack([np.interp(times_s, self.times_s, row) for row in self.T_world_object[:, :, 3].T])
        return slerp("pose", self.T_world_object[:, :, :3], at), p

    def measure_travel(self, times_s: Floats, radius_m: float) -> Floats:
        """How far any point within `radius_m` of its origin has moved since the first time, at most [M], m."""
        R, p = self.T_world_object[:, :, :3], self.T_world_object[:, :, 3]
        turns = R[:-1].transpose(0, 2, 1) @ R[1:]
        axis = np.stack(
            [turns[:, 2, 1] - turns[:, 1, 2], turns[:, 0, 2] - turns[:, 2, 0], turns[:, 1, 0] - turns[:, 0, 1]]
        )
        angle = np.arctan2(np.linalg.norm(axis, axis=0), np.trace(turns, axis1=1, axis2=2) - 1.0)
        lengths = np.linalg.norm(np.diff(p, axis=0), axis=1) + radius_m * angle
        return np.interp(times_s, self.times_s, np.concatenate([[0.0], np.cumsum(lengths)]))


def _read_poses(given: Any) -> Floats:
    """[K, 3, 4] from a sequence of poses, or of places."""
    if isinstance(given, str) or not isinstance(given, Iterable):
        raise InputError(f"expected poses [K, 4, 4] or places [K, 3] in m, got {quoted(given)}", (POSES,))
    poses = []
    for k, value in enumerate(given):
        found = find_matrix(value, (POSES, k))
        T = read_numbers(value if found is None else found, (POSES, k))
        poses.append(read_pose(np.column_stack([np.eye(3), T]) if T.shape == (3,) else T, (POSES, k)))
    return np.array(poses).reshape(-1, 3, 4)


Moving = Mapping[str, ObjectMotion]
"""Obstacles of a world by name, and how they move."""


def check_moving(collision: CollisionModel, moving: Moving, duration_s: float) -> None:
    """Raise `InputError` for what is no obstacle that may move, and for a motion that ends before the path does."""
    if not isinstance(moving, Mapping):
        raise InputError(f"expected motions of obstacles by name, got {quoted(moving)}", ("moving",))
    names = [obstacle.name for obstacle in collision.obstacles]
    for name, motion in moving.items():
        if not isinstance(motion, ObjectMotion):
            raise InputError(f"expected an ObjectMotion, got {quoted(motion)}", ("moving", str(name)))
        if name not in names:
            raise InputError(f"no obstacle that counts is called {name!r}{nearest(name, names)}", ("moving", name))
        obstacle = collision.world[name]
        if obstacle.frame != WORLD:
            message = f"what moves stands in the world's frame, but {name} in that of {obstacle.frame}"
            raise InputError(message, ("moving", name))
        if any(solid.kind == "half_space" for solid in obstacle.solids):
            raise InputError(f"{name} has a half-space, which has no end: it can't move", ("moving", name))
        first, last = float(motion.times_s[0]), float(motion.times_s[-1])
        if first > ROUNDING_S or last < duration_s - ROUNDING_S:
            message = f"{name} is known from {first:g} to {last:g} s, the path lasts from 0 to {duration_s:g} s"
            raise InputError(message, ("moving", name, "times_s"))


def place_at(collision: CollisionModel, moving: Moving, time_s: float) -> CollisionModel:
    """The same with obstacles where they are at a moment."""
    world = collision.world
    for name, motion in moving.items():
        R, p = motion.place(np.array([time_s]))
        world = world.move(name, np.column_stack([R[0], p[0]]))
    return collision.own.in_world(world, collision.margin_m, dict(collision.margins_m)) if moving else collision


class Mover(NamedTuple):
    """An obstacle that moves."""

    place: int
    """Which obstacle it is."""
    solids: slice
    """Its rows in the packed world."""
    obstacle: Obstacle
    motion: ObjectMotion
    radius_m: float
    """All of it is within this of its origin."""
    packed: Floats
    """[samples, solids, 12] its axes and places in the world at each sample."""


@dataclass(frozen=True, kw_only=True, eq=False)
class MovingWorld:
    """A collision model whose obstacles move; it holds room of its own for the packed world of a moment."""

    collision: CollisionModel
    moving: Moving
    movers: tuple[Mover, ...]
    arrays: CollisionArrays
    """Whose world is that of the moment that `set_sample` was called with."""
    whole: Floats
    """The packed world, writable."""

    @classmethod
    def of(cls, collision: CollisionModel, moving: Moving, times_s: Floats) -> Self | None:
        """None where nothing moves; `times_s` are those of samples."""
        if not moving:
            return None
        movers, first = list[Mover](), 0
        for place, obstacle in enumerate(collision.obstacles):
            end = first + len(obstacle.solids)
            if obstacle.name in moving:
                radius_m = max(map(_measure_radius, obstacle.solids))
                packed = _pack(obstacle, *moving[obstacle.name].place(times_s))
                movers.append(Mover(place, slice(first, end), obstacle, moving[obstacle.name], radius_m, packed))
            first = end
        whole = collision.arrays.world.copy()
        world = whole.view()
        world.setflags(write=False)  # kernels are compiled for arrays that are not written
        arrays = collision.arrays._replace(world=world)
        known = {"collision": collision, "moving": moving, "movers": tuple(movers)}
        return cls(arrays=arrays, whole=whole, **known)

    def set_sample(self, sample: int) -> CollisionArrays:
        """Arrays for kernels in which obstacles are where they are at a sample; the next call changes them."""
        count = int(self.whole[0])
        rows = self.whole[HEADER : HEADER + SOLID_COLUMNS * count].reshape(count, SOLID_COLUMNS)
        places = self.whole[HEADER + SOLID_COLUMNS * count :][: 3 * count].reshape(3, count)
        for mover in self.movers:
            rows[mover.solids, POSE] = mover.packed[sample]
            places[:, mover.solids] = mover.packed[sample][:, 9:].T
        return self.arrays

    def compute_gaps(self, q: Floats, times_s: Floats) -> Floats:
        """As `compute_world_gaps` [M, C O], for `q` [M, N] at `times_s` [M].

        What no joint moves is compared with what moves, too.
        """
        model = self.collision
        gaps = compute_world_gaps(model, q).reshape(len(q), len(model.components), len(model.obstacles)).copy()
        extras = model.extras_m[len(model.pairs) :].reshape(len(model.components), len(model.obstacles))
        components = compute_components(model, q)
        for mover in self.movers:
            R, p = mover.motion.place(times_s)
            held = [thing.name for thing in model.world.attached if mover.obstacle.name in thing.may_touch]
            for row, name in enumerate(model.components):
                centres, radii = components[name]
                if name in mover.obstacle.ignore or name in held:
                    gaps[:, row, mover.place] = np.inf
                    continue
                own = np.einsum("mji,msj->msi", R, np.broadcast_to(centres, (len(q), *centres.shape[-2:])) - p[:, None])
                away = np.min([_measure(solid, own) for solid in mover.obstacle.solids], axis=0)
                gaps[:, row, mover.place] = (away - radii).min(axis=1) - extras[row, mover.place]
        return gaps.reshape(len(q), -1)

    def measure_travel(self, start_s: Floats, end_s: Floats) -> Floats:
        """How far any point of each obstacle moves from one time [M] to another, at most [M, O], m."""
        travel = np.zeros((len(start_s), len(self.collision.obstacles)))
        for mover in self.movers:
            way = mover.motion.measure_travel(np.stack([start_s, end_s]).ravel(), mover.radius_m).reshape(2, -1)
            travel[:, mover.place] = way[1] - way[0]
        return travel


class Around(NamedTuple):
    """What moves about a motion, and when the motion is at its samples."""

    world: MovingWorld
    times_s: Floats
    """[M + 1]"""


def _pack(obstacle: Obstacle, R: Floats, p: Floats) -> Floats:
    """Axes and places of its solids [M, solids, 12] for an obstacle at rotations [M, 3, 3] and places [M, 3]."""
    rows = []
    for solid in obstacle.solids:
        T = solid.T_obstacle_solid
        rows.append(np.concatenate([(R @ T[:, :3]).reshape(-1, 9), R @ T[:, 3] + p], axis=1))
    return np.stack(rows, axis=1)


def _measure(solid: Solid, P: Floats) -> Floats:
    """Distances [...] of points [..., 3] in an obstacle's frame from one of its solids, m."""
    if solid.kind != "cloud":
        return measure_solid(solid, P)
    assert solid.points is not None
    T, flat = solid.T_obstacle_solid, P.reshape(-1, 3)
    less = np.full(len(flat), solid.size_m[0])
    own = (flat - T[:, 3]) @ T[:, :3]
    return find_cloud_gaps(solid.points, own, less, np.arange(len(flat)), len(flat)).reshape(P.shape[:-1])


def _measure_radius(solid: Solid) -> float:
    """Of a ball about the obstacle's origin that holds a solid, m."""
    away = float(np.linalg.norm(solid.T_obstacle_solid[:, 3]))
    if solid.points is not None:
        return away + float(np.linalg.norm(solid.points, axis=1).max()) + sum(solid.size_m)
    if solid.kind == "box":
        return away + 0.5 * float(np.linalg.norm(solid.size_m))
    return away + solid.size_m[0] + 0.5 * sum(solid.size_m[1:])

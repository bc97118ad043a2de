"""Sources that make their targets from a rule: a grid, random points, and poses that the robot can reach."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from ikde.batch.sources import Orientation, PointSource
from ikde.errors import InputError
from ikde.kernels.arrays import Floats
from ikde.kernels.draws import MAX_DRAWS
from ikde.kernels.sampling import place_tools, sample_ball, sample_box
from ikde.model.collision_model import CollisionModel
from ikde.model.pack import pack_robot
from ikde.model.target import POSE, TargetKind, Targets
from ikde.solver.engines.pool import load_kernels


def make_grid(start: Floats, to: Floats, counts: tuple[int, int, int], orientation: Orientation) -> PointSource:
    """Points of the grid between two corners [3] in m; z runs fastest."""
    axes = [np.linspace(a, b, n) for a, b, n in zip(start, to, counts, strict=True)]
    count = counts[0] * counts[1] * counts[2]
    return PointSource(count=count, make_points=partial(_cut_grid, axes), orientation=orientation)


def make_box(start: Floats, to: Floats, count: int, seed: int, orientation: Orientation) -> PointSource:
    """Points uniform in the box between two corners [3] in m."""
    corners = np.minimum(start, to), np.maximum(start, to)
    return PointSource(count=count, make_points=partial(_sample, sample_box, corners, seed), orientation=orientation)


def make_ball(
    center: Floats, radius: float, filled: bool, count: int, seed: int, orientation: Orientation
) -> PointSource:
    """Points uniform in a ball about `center` [3], or on its surface; m."""
    ball = center, radius, filled
    return PointSource(count=count, make_points=partial(_sample, sample_ball, ball, seed), orientation=orientation)


def _cut_grid(axes: list[Floats], first: int, last: int) -> Floats:
    indices = np.unravel_index(np.arange(first, last), [len(axis) for axis in axes])
    return np.column_stack([axis[index] for axis, index in zip(axes, indices, strict=True)])


def _sample(sample: Callable[..., None], shape: tuple[Any, ...], seed: int, first: int, last: int) -> Floats:
    """Points [last - first, 3] of a sampling kernel."""
    out_p = np.empty((last - first, 3))
    with np.errstate(over="ignore"):  # the random stream wraps around; without the JIT numpy would warn
        sample(*shape, np.uint64(seed), np.int64(first), out_p)
    return out_p


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ReachableSource:
    """Where the tool is in random configurations that are free of collision."""

    collision: CollisionModel
    lower: Floats
    upper: Floats
    """[N] joint ranges, m or rad."""
    goal: TargetKind
    count: int
    seed: int
    names: None = None

    def read(self, first: int, last: int) -> Targets:
        """Targets first .. last - 1; raises `InputError` if the robot is never free."""
        T = self.sample(first, min(last, self.count))
        if self.goal == "position":
            return Targets(T[:, :, 3])
        if self.goal == "axis":
            return Targets(T[:, :, 3], axis_world_tool=T[:, :, 2])
        return Targets.packed(np.full(len(T), POSE, dtype=np.int64), T)

    def sample(self, first: int, last: int) -> Floats:
        """Poses T_world_tool [last - first, 3, 4]."""
        robot, q = self.collision.robot, np.empty((last - first, len(self.lower)))
        inside = bool((self.lower >= robot.lower).all() and (self.upper <= robot.upper).all())
        module, packed = load_kernels(self.collision, self.goal, inside=inside), pack_robot(robot)
        models = module.use_models(packed, self.collision.arrays)
        with np.errstate(over="ignore"):
            found = module.draw_free(*models, self.lower, self.upper, np.uint64(self.seed), np.int64(first), q)
        if found < len(q):
            judge = f"for {self.collision.name!r} " if self.collision.pairs else ""
            raise InputError(f"no configuration {judge}is free of self-collision in {MAX_DRAWS:,} draws")
        out_T = np.empty((len(q), 3, 4))
        place_tools(packed, q, out_T)
        return out_T

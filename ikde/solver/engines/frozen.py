"""Seeds for frozen joints of an arm, at whatever values: rows of the pool of the joint limits, moved.

Taken are the rows whose own value of the first frozen joint is nearest to the wanted one: free of collision as they
were, or nearly so. Every frozen joint is then set, and the tool rotated about its axis as it stands with the frozen
joints at zero, from the tool's end of the chain on: 0.1 ms, where drawing a pool takes 50.
"""

from typing import NamedTuple

import numpy as np

from ikde.kernels.arrays import COORDINATE, MOVES_TOOL, PRISMATIC, Floats, Ints, RobotArrays, SeedArrays, read_only
from ikde.solver.engines.draws import place_bodies, place_tools, sin_cos
from ikde.solver.engines.grids import find_cells, sort_cells

MAX_ROWS = 2**14  # rows of the pool that are moved
ROWS = 1024  # of them, for one value


class Axis(NamedTuple):
    """Where the axis of a frozen joint lies in each of K configurations with all frozen joints at zero."""

    number: int  # of the joint among the frozen ones
    is_prismatic: bool
    direction: Floats  # [3, K]
    point: Floats  # [3, K] m


class Rotated(NamedTuple):
    """Columns [3, C, K] of transforms, the last one the place, moved about an axis: still + c * across + s * aside."""

    still: Floats
    across: Floats
    aside: Floats


class FrozenPools(NamedTuple):
    """The pools of one choice of frozen joints."""

    joints: Ints  # [F] coordinates of q
    q: Floats  # [K, N] configurations, sorted by the first frozen joint
    value: Floats  # [K] of that joint
    tools: Floats  # [3, C, K] columns of T_world_tool that a kind of target asks for, with the frozen joints at zero
    axes: tuple[Axis, ...]  # of those that move the tool, the last one first
    rotated: Rotated | None  # `tools` about the first of `axes`
    asked: Ints  # which entries of the columns the seeds keep, and which [G] their grid divides
    divided: Ints
    seeds: SeedArrays  # all else


def freeze_pool(
    robot: RobotArrays, q: Floats, joints: tuple[int, ...], seeds: SeedArrays, asked: tuple[int, ...]
) -> FrozenPools:
    """What stays from value to value: of configurations `q` [K, N], and of a pool whose grid is made half as fine.

    `asked` are the entries of the transform [3, 4], row by row, that the pool keeps.
    """
    q = q[:: 1 + len(q) // MAX_ROWS]
    order = np.argsort(q[:, joints[0]], kind="stable")
    q = q[order]
    zeroed = q.copy()
    zeroed[:, list(joints)] = 0.0
    columns = sorted({entry % 4 for entry in asked})
    place_of = {4 * i + j: len(columns) * i + k for i in range(3) for k, j in enumerate(columns)}
    tools = place_tools(robot, zeroed).reshape(3, 4, -1)[:, columns]
    axes = tuple(_find_axes(robot, zeroed, joints))[::-1]
    return FrozenPools(
        joints=np.array(joints),
        q=q,
        value=q[:, joints[0]].copy(),
        tools=tools,
        axes=axes,
        rotated=rotate(tools, axes[0]) if axes else None,
        asked=np.array([place_of[entry] for entry in asked]),
        divided=np.array([place_of[entry] for entry in seeds.grid[:, 0].tolist()]),
        seeds=_coarsen(seeds),
    )


def set_frozen(pools: FrozenPools, values: Floats) -> SeedArrays:
    """Seeds with the frozen joints at `values` [F], m or rad."""
    rows = min(ROWS, len(pools.q))
    middle = int(np.searchsorted(pools.value, values[0]))
    first = min(max(middle - rows // 2, 0), len(pools.q) - rows)
    taken = slice(first, first + rows)
    tools, grid = _move_tools(pools, values, taken).reshape(-1, rows), pools.seeds.grid
    order, starts = sort_cells(grid, find_cells(grid, pools.seeds.grid_scale, tools[pools.divided]))
    q = np.take(pools.q[taken], order, axis=0)
    q[:, pools.joints] = values
    asked = np.take(tools[pools.asked], order, axis=1).T.copy()
    for array in (q, asked, starts):
        read_only(array)
    return pools.seeds._replace(q=q, T_world_tool=asked, cell_start=starts)


def _move_tools(pools: FrozenPools, values: Floats, taken: slice) -> Floats:
    """The columns [3, C, rows] of some rows with the frozen joints at `values` [F]."""
    tools, (sines, cosines) = pools.tools[:, :, taken], sin_cos(values)
    for axis in pools.axes:
        if axis is pools.axes[0] and pools.rotated:
            still, across, aside = (part[:, :, taken] for part in pools.rotated)
        else:
            moved = axis._replace(direction=axis.direction[:, taken], point=axis.point[:, taken])
            still, across, aside = rotate(tools, moved)
        k = axis.number
        tools = still + values[k] * aside if axis.is_prismatic else still + cosines[k] * across + sines[k] * aside
    return tools


def rotate(tools: Floats, axis: Axis) -> Rotated:
    """Columns [3, C, K] apart, by how they move about an axis, or along it."""
    if axis.is_prismatic:
        aside = np.zeros(tools.shape)
        aside[:, -1] = axis.direction
        return Rotated(tools, aside, aside)
    u, v = axis.direction[:, None], tools.copy()
    v[:, -1] -= axis.point
    still = u * (u[0] * v[0] + u[1] * v[1] + u[2] * v[2])
    aside = np.stack([u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]])
    across = v - still
    still[:, -1] += axis.point
    return Rotated(still, across, aside)


def _find_axes(robot: RobotArrays, q: Floats, joints: tuple[int, ...]) -> list[Axis]:
    """Axes of those of some joints that move the tool, parents first."""
    T_world_body = place_bodies(robot, q)
    moving = [(body, row) for body, row in enumerate(robot.bodies.tolist()) if body and row[MOVES_TOOL]]
    return [
        Axis(
            number=joints.index(row[COORDINATE]),
            is_prismatic=bool(row[PRISMATIC]),
            direction=T_world_body[body, :, 2],
            point=T_world_body[body, :, 3],
        )
        for body, row in moving
        if row[COORDINATE] in joints
    ]


def _coarsen(seeds: SeedArrays) -> SeedArrays:
    """A grid half as fine, for fewer rows."""
    grid = seeds.grid.copy()
    grid[:, 1] = (grid[:, 1] + 1) // 2
    scale = seeds.grid_scale * np.stack([np.ones(len(grid)), grid[:, 1] / seeds.grid[:, 1]], axis=1)
    for array in (grid, scale):
        read_only(array)
    return seeds._replace(grid=grid, grid_scale=scale)

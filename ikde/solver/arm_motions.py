"""How far components move while a UR-type arm's joints, and one that carries it, move within their slack."""

from functools import lru_cache

import numpy as np

from ikde.kernels.arrays import Floats
from ikde.model.collision_model import CollisionModel
from ikde.model.robot import WORLD, FreeSpheres, Robot, Spheres


class Motions:
    """How far components can move, against each other and in the world, while some joints move within their slack."""

    def __init__(self, collision: CollisionModel, joints: tuple[int, ...]) -> None:
        robot, pairs = collision.robot, collision.pairs
        names, are_prismatic = [robot.joint_names[k] for k in joints], robot.is_prismatic[list(joints)]
        axes = [next(frame.name for frame in robot.frames if frame.joint == name) for name in names]
        ways = {name: _list_ways_up(robot, name) for name in (WORLD, *(frame.name for frame in robot.frames))}
        parts = {name: ([False] * len(axes), np.zeros(len(axes)), 0.0) for pair in pairs for name in pair}
        for row in collision.rows:
            beyond = _reach_beyond(row)
            for point in (row.start, row.end):
                levers = np.array([_join(ways[axis], ways[point]) for axis in axes])
                _, old, old_tool = parts.get(row.component, (None, 0.0, 0.0))
                tool = max(old_tool, _join(ways[robot.tool], ways[point]) + beyond)
                moved = [axis in ways[point] for axis in axes]
                parts[row.component] = moved, np.maximum(old, np.where(are_prismatic, 1.0, levers + beyond)), tool
        self._parts = parts
        self._moved, self._levers, self._tool = (
            [np.array([parts[pair[side]][k] for pair in pairs]) for side in (0, 1)] for k in range(3)
        )

    def bound_in_world_m(
        self, slack: Floats, position_m: float | Floats, orientation_rad: float, collision: CollisionModel
    ) -> Floats:
        """By how much each component can move in the world, at most, [K, C O] in m for slacks [K, J].

        `position_m` and `orientation_rad`: how far the tool may be from where it is.
        """
        parts = [self._parts[name] for name in collision.components]
        moved, levers, tool = (np.array(column) for column in zip(*parts, strict=True))
        by_tool = slack @ (~moved * levers).T + position_m + orientation_rad * tool
        return np.repeat(np.minimum(slack @ (moved * levers).T, by_tool), len(collision.obstacles), axis=-1)

    def bound_m(self, slack: Floats, position_m: float | Floats, orientation_rad: float) -> Floats:
        """By how much, at most, [K, P] in m for slacks [K, J]: seen from either component, and from base and tool."""
        apart = (self._moved[0] != self._moved[1]) * np.maximum(*self._levers)  # what moves both moves neither
        own = [
            np.minimum(slack @ (moved * levers).T, slack @ (~moved * levers).T + position_m + orientation_rad * tool)
            for moved, levers, tool in zip(self._moved, self._levers, self._tool, strict=True)
        ]
        return np.minimum(slack @ apart.T, own[0] + own[1])


@lru_cache(maxsize=64)
def find_motions(collision: CollisionModel, joints: tuple[int, ...]) -> Motions:
    """Those of the joints of these indices, m per rad or per m."""
    return Motions(collision, joints)


def _list_ways_up(robot: Robot, frame: str) -> dict[str, float]:
    """Frames from one up to the world, and how far their origins can be from its own, m."""
    frames, length, ways = {frame.name: frame for frame in robot.frames}, 0.0, {}
    while frame in frames:
        ways[frame] = length
        length += float(np.linalg.norm(frames[frame].p_parent_frame))
        joint = frames[frame].joint
        index = None if joint is None else robot.joint_names.index(joint)
        if index is not None and robot.is_prismatic[index]:
            length += max(abs(robot.lower[index]), abs(robot.upper[index]))
        frame = frames[frame].parent
    return {**ways, frame: length}


def _join(one: dict[str, float], other: dict[str, float]) -> float:
    """How far two frames can be apart, m: along the tree, over the first one that is above both."""
    return min((one[name] + other[name] for name in one if name in other), default=0.0)


def _reach_beyond(row: Spheres) -> float:
    """How far a row's centres may be beyond its key points, m."""
    if isinstance(row, FreeSpheres):
        return float(np.linalg.norm(np.array(row.spheres)[:, :3], axis=1).max())
    return 2.0 * row.radius_m * row.count if row.spacing == "touching" else 0.0

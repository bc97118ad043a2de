"""What of a world is drawn beside a robot: the parts of obstacles that are near it, cut where the picture ends."""

from collections.abc import Mapping, Set

import numpy as np

from ikde.kernels.arrays import Floats
from ikde.model.robot import WORLD
from ikde.model.world import Obstacle, World
from ikde.scene.drawn_world import MAX_OBSTACLES, DrawnObstacle, DrawnSolid, draw_solid
from ikde.solver.plain_world import measure_obstacle

AROUND = 0.3  # of the robot's size, to each side
STEP_M = 1e-6  # of a difference


def draw_near(
    world: World, Ts_world: Mapping[str, Floats], robot_m: Floats, touched: Set[str], around: float = AROUND
) -> tuple[DrawnObstacle, ...]:
    """What of obstacles that count lies about the robot, whose box is `robot_m` [2, 3], in its frames `Ts_world`.

    `around`: how far beyond that box, as a share of its size.
    """
    room_m = around * float(np.ptp(robot_m, axis=0).max())
    box_m = robot_m + np.array([[-room_m], [room_m]])
    found = []
    for obstacle in world.active[:MAX_OBSTACLES]:
        T = _place(obstacle, Ts_world)
        solids = tuple(filter(None, (_cut(draw_solid(solid, T, box_m), box_m) for solid in obstacle.solids)))
        if solids:
            is_touched = obstacle.name in touched
            found.append(DrawnObstacle(name=obstacle.name, solids=solids, is_on=True, is_touched=is_touched))
    return tuple(found)


def reach_obstacle(obstacle: Obstacle, spheres: tuple[Floats, Floats], Ts_world: Mapping[str, Floats]) -> Floats:
    """Centre of the sphere that is nearest to an obstacle, or deepest in it, and the point next to it there, [2, 3].

    `spheres`: centres [S, 3] and radii [S] in m, in the world.
    """
    T = np.eye(4) if obstacle.frame == WORLD else Ts_world[obstacle.frame]
    centres = (spheres[0] - T[:3, 3]) @ T[:3, :3]
    distances = measure_obstacle(obstacle, centres)
    nearest = int(np.argmin(distances - spheres[1]))
    centre = centres[nearest]
    steps = STEP_M * np.eye(3)
    slope = measure_obstacle(obstacle, centre + steps) - measure_obstacle(obstacle, centre - steps)
    length = float(np.linalg.norm(slope))
    point = centre - distances[nearest] * slope / length if length > 0.0 else centre
    return np.array([centre, point]) @ T[:3, :3].T + T[:3, 3]


def _place(obstacle: Obstacle, Ts_world: Mapping[str, Floats]) -> Floats:
    """T_world_obstacle [3, 4], in whatever frame of the robot it stands."""
    if obstacle.frame == WORLD:
        return obstacle.T_world_obstacle
    return Ts_world[obstacle.frame][:3] @ np.vstack([obstacle.T_world_obstacle, [0.0, 0.0, 0.0, 1.0]])


def _cut(solid: DrawnSolid, box_m: Floats) -> DrawnSolid | None:
    """What of it is inside a box [2, 3]; None if nothing is."""
    inside = np.all((box_m[0] <= solid.points_m) & (solid.points_m <= box_m[1]), axis=-1)
    polygons = [cut_polygon(polygon, box_m) for polygon in solid.polygons_m]
    kept = tuple(polygon for polygon in polygons if len(polygon) > 2)
    if not kept and not inside.any():
        return None
    return DrawnSolid(polygons_m=kept, points_m=solid.points_m[inside], is_endless=solid.is_endless)


def cut_polygon(P: Floats, box_m: Floats) -> Floats:
    """What of a convex polygon [k, 3] lies in a box [2, 3]: a polygon [n, 3], by the six sides one after the other."""
    for axis in range(3):
        for bound, sign in zip(box_m[:, axis], (1.0, -1.0), strict=True):
            if len(P) == 0:
                return P
            room = sign * (P[:, axis] - bound)
            corners: list[Floats] = []
            for k in range(len(P)):
                if room[k - 1] * room[k] < 0.0:
                    corners.append(P[k - 1] + (P[k] - P[k - 1]) * room[k - 1] / (room[k - 1] - room[k]))
                if room[k] >= 0.0:
                    corners.append(P[k])
            P = np.array(corners).reshape(-1, 3)
    return P

"""The numbers of qiao2021 that the paper does not force, as functions that set one of them on a robot.

Each takes the robot and a value in mm (x and y from the drive-axis midpoint, z above the ground, as in
docs/calibration.md) and returns the changed robot; `MOVES` lists them with the shipped values.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from ikde.kernels.arrays import Floats
from ikde.model.robot import Frame, Robot
from ikde.solver.plain import compute_frames

Move = Callable[[Robot, float], Robot]
PLATFORM = ("platform_rear", "platform_front")
SUPPORT = ("support_rear_left", "support_front_left", "support_rear_right", "support_front_right")


def move_points(robot: Robot, points: dict[str, Floats]) -> Robot:
    """Set key points of the platform to world positions [3] in mm, as they stand at home."""
    Ts_world = compute_frames(robot, robot.home)

    def moved(frame: Frame) -> Frame:
        if frame.name not in points:
            return frame
        T = Ts_world[frame.parent]
        return replace(frame, p_parent_frame=T[:3, :3].T @ (np.asarray(points[frame.name]) / 1e3 - T[:3, 3]))

    return replace(robot, frames=tuple(moved(frame) for frame in robot.frames))


def points_of(robot: Robot, *names: str) -> dict[str, Floats]:
    """World positions [3] in mm of frames at home."""
    Ts_world = compute_frames(robot, robot.home)
    return {name: 1e3 * Ts_world[name][:3, 3] for name in names}


def setter(axis: int, *names: str) -> Move:
    """Set one world coordinate of the named key points, keeping the side (sign of y) of each."""

    def move(robot: Robot, value: float) -> Robot:
        points = points_of(robot, *names)
        for point in points.values():
            point[axis] = np.sign(point[1]) * value if axis == 1 and point[1] else value
        return move_points(robot, points)

    return move


def set_half_extent(robot: Robot, value: float) -> Robot:
    """Half the distance between the first and the last of the platform's spheres."""
    points = points_of(robot, *PLATFORM)
    centre = 0.5 * (points["platform_rear"] + points["platform_front"])
    offset = np.array([value, 0.0, 0.0])
    return move_points(robot, {"platform_rear": centre - offset, "platform_front": centre + offset})


def set_platform_x(robot: Robot, value: float) -> Robot:
    """Shift the platform's row so that its middle stands at x."""
    points = points_of(robot, *PLATFORM)
    shift = value - 0.5 * (points["platform_rear"][0] + points["platform_front"][0])
    return move_points(robot, {name: p + np.array([shift, 0.0, 0.0]) for name, p in points.items()})


def set_load(robot: Robot, x: float, z: float) -> Robot:
    """Put the load's sphere at (x, 0, z)."""
    return move_points(robot, {"load_centre": np.array([x, 0.0, z])})


def set_platform(robot: Robot, z: float, half_extent: float) -> Robot:
    """Put the platform's row at a height, with a half extent."""
    return set_half_extent(setter(2, *PLATFORM)(robot, z), half_extent)


def set_support(robot: Robot, x: tuple[float, float], y: float, z: float) -> Robot:
    """Put the support frame's two rows from x[0] to x[1] at +-y and height z."""
    for move, value in (
        (setter(0, *SUPPORT[::2]), x[0]),
        (setter(0, *SUPPORT[1::2]), x[1]),
        (setter(1, *SUPPORT), y),
        (setter(2, *SUPPORT), z),
    ):
        robot = move(robot, value)
    return robot


def set_safe_distance(robot: Robot, value: float) -> Robot:
    """One safe distance for every detector."""
    detectors = {name: replace(d, safe_distance_m=value / 1e3) for name, d in robot.detectors.items()}
    return replace(robot, detectors=detectors)


def set_motor5(robot: Robot, value: float) -> Robot:
    """Stand motor 5's sphere at a distance from O5 along O4 -> O5 (-94.65 is O4)."""
    frame = Frame(
        name="motor5", parent="O5", p_parent_frame=np.array([0.0, 0.0, value / 1e3]), R_parent_frame=np.eye(3)
    )
    rows = {
        name: tuple(replace(row, start="motor5", end="motor5") if row.component == "J5" else row for row in rows)
        for name, rows in robot.approximations.items()
    }
    frames = tuple(f for f in robot.frames if f.name != "motor5")
    return replace(robot, frames=(*frames, frame), approximations=rows)


def shift_links(robot: Robot, sign: int) -> Robot:
    """Stand the links' rows as Formula 13's range -i/2 : 1 : i/2 reads to the letter: it is not centred.

    Its last step falls short of i/2, so the row stands nearer to one end: the far one for `sign` +1.
    """
    Ts_world = compute_frames(robot, robot.home)
    frames, approximations = list(robot.frames), dict(robot.approximations)
    for name, rows in robot.approximations.items():
        for index, row in enumerate(rows):
            if row.component not in ("L1", "L2") or row.count == 1:
                continue
            line = Ts_world[row.end][:3, 3] - Ts_world[row.start][:3, 3]
            short = np.linalg.norm(line) - 2.0 * row.radius_m * (row.count - 1)
            ends = [f"{row.component}_{name}_{end}" for end in ("start", "end")]
            for end, z in zip(ends, (0.0, np.linalg.norm(line)), strict=True):
                p = np.array([0.0, 0.0, z + 0.5 * sign * short])
                frames.append(Frame(name=end, parent=row.start, p_parent_frame=p, R_parent_frame=np.eye(3)))
            moved = replace(row, start=ends[0], end=ends[1])
            approximations[name] = (*approximations[name][:index], moved, *rows[index + 1 :])
    return replace(robot, frames=tuple(frames), approximations=approximations)


def look_at_link_2_and_motor_5(robot: Robot) -> Robot:
    """Add (L2, J5), which Formula 22 prints, to the pairs."""
    lists = dict(robot.pair_lists)
    for name in ("arm_arm", "formula_22"):
        lists[name] = (*lists[name], ("L2", "J5"))
    return replace(robot, pair_lists=lists)


MOVES: dict[str, tuple[str, float, Move]] = {  # name -> provenance, shipped value in mm, setter
    "load x": ("calibrated", 271.0, setter(0, "load_centre")),
    "load y": ("derived", 0.0, setter(1, "load_centre")),
    "load z": ("calibrated", 433.0, setter(2, "load_centre")),
    "platform half extent": ("calibrated", 250.5, set_half_extent),
    "platform centre x": ("published", 340.0, set_platform_x),
    "platform y": ("published", 0.0, setter(1, *PLATFORM)),
    "platform z": ("published", 219.0, setter(2, *PLATFORM)),
    "support x rear": ("derived", 412.0, setter(0, *SUPPORT[::2])),
    "support x front": ("derived", 862.0, setter(0, *SUPPORT[1::2])),
    "support y": ("derived", 179.0, setter(1, *SUPPORT)),
    "support z": ("derived", 411.5, setter(2, *SUPPORT)),
    "safe distance R_sf": ("calibrated", 0.0, set_safe_distance),
    "motor 5 beyond O5": ("calibrated", 0.0, set_motor5),
}

"""Frames, the tool and its Jacobian as straight-line code, from the packed robot."""

from dataclasses import dataclass

import numpy as np

from ikde.kernels.arrays import COORDINATE, MOVES_TOOL, PARENT, PRISMATIC, Floats, RobotArrays
from ikde.model.generate.writer import Value, Writer

Vector = tuple[Value, Value, Value]
ROUNDING = 1e-15


@dataclass(frozen=True, slots=True, kw_only=True)
class Pose:
    """Rotation, row by row, and position of a frame."""

    R: tuple[Vector, Vector, Vector]
    p: Vector

    def column(self, k: int) -> Vector:
        """Direction of one axis."""
        return self.R[0][k], self.R[1][k], self.R[2][k]


ORIGIN = Pose(R=((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)), p=(0.0, 0.0, 0.0))


def write_bodies(writer: Writer, robot: RobotArrays, root: int = 0) -> dict[int, Pose]:
    """Poses of `root` and the bodies that it carries, seen from `root`.

    Takes `q<k>` of prismatic joints, `s<k>` and `c<k>` of revolute ones, k being the coordinate of q.
    """
    poses = {root: ORIGIN}
    for body in range(root + 1, len(robot.bodies)):
        parent = int(robot.bodies[body, PARENT])
        if parent in poses:
            fixed = write_fixed(writer, f"f{body}", poses[parent], robot.T_parent_body[body])
            poses[body] = _move(writer, body, fixed, robot.bodies[body])
    return poses


def write_fixed(writer: Writer, name: str, parent: Pose, T: Floats) -> Pose:
    """Pose of what is fixed to a frame by a constant transform [3, 4]."""
    T = snap(T)
    rows = [[writer.sum(f"{name}_{i}{j}", *_products(parent.R[i], T[:, j])) for j in range(3)] for i in range(3)]
    return Pose(R=_rotation(rows), p=write_point(writer, name, parent, T[:, 3]))


def write_point(writer: Writer, name: str, frame: Pose, p: Floats) -> Vector:
    """Where a point [3] fixed to a frame is."""
    p = snap(p)
    x, y, z = (writer.sum(f"{name}_{'xyz'[i]}", *_products(frame.R[i], p), (frame.p[i],)) for i in range(3))
    return x, y, z


def write_jacobian(writer: Writer, robot: RobotArrays, poses: dict[int, Pose], tool: Vector) -> dict[int, list[Value]]:
    """Columns of the tool's geometric Jacobian by coordinate: v, then omega; of the joints that move it."""
    columns = {}
    for body, pose in poses.items():
        if body == 0 or not robot.bodies[body, MOVES_TOOL]:
            continue
        k, axis = int(robot.bodies[body, COORDINATE]), pose.column(2)
        if robot.bodies[body, PRISMATIC]:
            columns[k] = [*axis, 0.0, 0.0, 0.0]
        else:
            arm = [writer.sum(f"a{k}_{'xyz'[i]}", (tool[i],), (-1.0, pose.p[i])) for i in range(3)]
            columns[k] = [*write_cross(writer, f"v{k}", axis, arm), *axis]
    return columns


def write_cross(writer: Writer, name: str, a: Vector | list[Value], b: Vector | list[Value]) -> list[Value]:
    """A x b."""
    cycles = ((0, 1, 2), (1, 2, 0), (2, 0, 1))
    return [writer.sum(f"{name}_{'xyz'[i]}", (a[j], b[k]), (-1.0, a[k], b[j])) for i, j, k in cycles]


def snap(values: Floats) -> Floats:
    """Numbers within rounding of 0 or +-1 are these: they fold."""
    nearest = np.rint(values)
    exact = (np.abs(values - nearest) <= ROUNDING) & (np.abs(nearest) <= 1.0)
    return np.where(exact, nearest, values) + 0.0


def _move(writer: Writer, body: int, fixed: Pose, row: np.ndarray) -> Pose:
    """A frame moved by its joint about or along its own z axis."""
    k = int(row[COORDINATE])
    if row[PRISMATIC]:
        axis = fixed.column(2)
        x, y, z = (writer.sum(f"p{body}_{'xyz'[i]}", (axis[i], f"q{k}"), (fixed.p[i],)) for i in range(3))
        return Pose(R=fixed.R, p=(x, y, z))
    s, c = f"s{k}", f"c{k}"
    rows = []
    for i, (x, y, z) in enumerate(fixed.R):
        rows.append(
            [
                writer.sum(f"r{body}_{i}0", (x, c), (y, s)),
                writer.sum(f"r{body}_{i}1", (y, c), (-1.0, x, s)),
                z,
            ]
        )
    return Pose(R=_rotation(rows), p=fixed.p)


def _products(row: Vector, column: Floats) -> list[tuple[Value, ...]]:
    return [(row[k], float(column[k])) for k in range(3)]


def _rotation(rows: list[list[Value]]) -> tuple[Vector, Vector, Vector]:
    a, b, c = ((row[0], row[1], row[2]) for row in rows)
    return a, b, c

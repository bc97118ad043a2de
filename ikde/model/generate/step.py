"""One damped least-squares step as straight-line code: the twin of `kernels/damped.py`, written for one robot.

Takes `q<k>`, `s<k>`, `c<k>`; the target `t_x` .. `t_z` and, row by row, `m00` .. `m22`; `lower<k>`, `upper<k>`; and the
numbers of `DescentArrays` by their names.
"""

from dataclasses import dataclass

from ikde.kernels.arrays import RobotArrays
from ikde.kernels.damped import AT_BOUND, MIN_SQUARE, OPPOSITE
from ikde.model.generate.kinematics import Pose, write_bodies, write_cross, write_fixed, write_jacobian
from ikde.model.generate.writer import Value, Writer, text


@dataclass(frozen=True, slots=True, kw_only=True)
class Step:
    """What a step gives: both errors before it in m and rad, and the next value of each coordinate."""

    position: Value
    orientation: Value
    next_q: list[str]


def write_step(writer: Writer, robot: RobotArrays, kind: str) -> Step:
    """Write the step for targets of one kind: `position`, `axis` or `pose`."""
    poses = write_bodies(writer, robot)
    tool = write_fixed(writer, "tool", poses[int(robot.frame_body[-1])], robot.T_body_frame[-1])
    columns = write_jacobian(writer, robot, poses, tool.p)
    error = [writer.sum(f"e_{'xyz'[i]}", (f"t_{'xyz'[i]}",), (-1.0, tool.p[i])) for i in range(3)]
    position = writer.let("position", f"math.sqrt({text(writer.sum('square', *((e, e) for e in error)))})")
    orientation: Value = 0.0
    if kind == "position":
        columns = {k: column[:3] for k, column in columns.items()}
    else:
        orientation, rotation = (_write_rotation if kind == "pose" else _write_tilt)(writer, tool)
        error += [writer.sum(f"w_{'xyz'[i]}", ("rotation_length", rotation[i])) for i in range(3)]
        columns = {k: _weigh(writer, k, column, tool, kind) for k, column in columns.items()}
    columns = {k: _write_active(writer, k, column, error) for k, column in columns.items()}
    size = writer.sum("size", *((e, e) for e in error))
    damping = writer.sum("lamda", ("damping", size), ("least_damping",))
    x = _write_solution(writer, list(columns.values()), error, damping)
    moves = {k: writer.sum(f"d{k}", *zip(column, x, strict=True)) for k, column in columns.items()}
    return Step(position=position, orientation=orientation, next_q=_write_next(writer, moves, robot))


def _write_rotation(writer: Writer, tool: Pose) -> tuple[Value, list[Value]]:
    """Axis * 2 sin(angle / 2) of S = R_target R_tool^T, as in `damped.compute_rotation`, and its size."""
    columns = [(tool.column(j), (f"m0{j}", f"m1{j}", f"m2{j}")) for j in range(3)]
    products = [product for a, b in columns for product in zip((0.25,) * 3, a, b, strict=True)]
    quarter = text(writer.sum("quarter", *products, (0.25,)))
    half = writer.let("half", f"0.5 / math.sqrt(max({quarter}, {MIN_SQUARE!r}))")
    cycles = ((1, 2), (2, 0), (0, 1))
    twice = [
        writer.sum(f"twice_{'xyz'[i]}", *(p for a, b in columns for p in ((a[j], b[k]), (-1.0, a[k], b[j]))))
        for i, (j, k) in enumerate(cycles)
    ]
    rotation = [writer.sum(f"u_{'xyz'[i]}", (twice[i], half)) for i in range(3)]
    size = text(writer.sum("rotation", *((u, u) for u in rotation)))
    orientation = writer.let("orientation", f"{OPPOSITE!r} if {quarter} < {MIN_SQUARE!r} else math.sqrt({size})")
    return orientation, rotation


def _write_tilt(writer: Writer, tool: Pose) -> tuple[Value, list[Value]]:
    """Axis * sin(angle) from the tool's z axis to the target's, and its size."""
    z, wanted = tool.column(2), ("m02", "m12", "m22")
    rotation = write_cross(writer, "u", z, wanted)
    size = writer.let("rotation", f"math.sqrt({text(writer.sum('sine', *((u, u) for u in rotation)))})")
    cosine = text(writer.sum("cosine", *zip(z, wanted, strict=True)))
    return writer.let("orientation", f"{OPPOSITE!r} - {size} if {cosine} < 0.0 else {size}"), rotation


def _weigh(writer: Writer, k: int, column: list[Value], tool: Pose, kind: str) -> list[Value]:
    """The rotation rows in metres; for an axis target without the part about the tool's own axis."""
    rotation = column[3:]
    if kind == "axis":
        z = tool.column(2)
        along = writer.sum(f"z{k}", *zip(rotation, z, strict=True))
        rotation = [writer.sum(f"t{k}_{'xyz'[i]}", (rotation[i],), (-1.0, along, z[i])) for i in range(3)]
    weighted = [writer.sum(f"w{k}_{'xyz'[i]}", ("rotation_length", rotation[i])) for i in range(3)]
    return [*column[:3], *weighted]


def _write_active(writer: Writer, k: int, column: list[Value], error: list[Value]) -> list[Value]:
    """A joint that would leave its range does not move: its column becomes 0."""
    gradient = text(writer.sum(f"g{k}", *zip(column, error, strict=True)))
    above = f"(q{k} >= upper{k} - {AT_BOUND!r} and {gradient} >= 0.0)"
    below = f"(q{k} <= lower{k} + {AT_BOUND!r} and {gradient} <= 0.0)"
    free = writer.let(f"free{k}", f"0.0 if {above} or {below} else 1.0")
    return [writer.sum(f"j{k}_{i}", (free, value)) for i, value in enumerate(column)]


def _write_solution(writer: Writer, columns: list[list[Value]], error: list[Value], damping: Value) -> list[Value]:
    """X of (J J^T + damping) x = error, by L D L^T."""
    n = len(error)
    L: dict[tuple[int, int], Value] = {}
    B: dict[tuple[int, int], Value] = {}  # L D
    inverse: list[Value] = []
    for j in range(n):
        for i in range(j, n):
            product = [(column[i], column[j]) for column in columns] + [(damping,)] * (i == j)
            A = writer.sum(f"A{i}{j}", *product)
            B[i, j] = writer.sum(f"B{i}{j}", (A,), *((-1.0, L[i, k], B[j, k]) for k in range(j)))
            if i == j:
                inverse.append(writer.let(f"inverse{j}", f"1.0 / {text(B[j, j])}"))
            else:
                L[i, j] = writer.sum(f"L{i}{j}", (B[i, j], inverse[j]))
    y: list[Value] = []
    for i in range(n):
        y.append(writer.sum(f"y{i}", (error[i],), *((-1.0, L[i, k], y[k]) for k in range(i))))
    x: list[Value] = [0.0] * n
    for i in reversed(range(n)):
        x[i] = writer.sum(f"x{i}", (y[i], inverse[i]), *((-1.0, L[k, i], x[k]) for k in range(i + 1, n)))
    return x


def _write_next(writer: Writer, moves: dict[int, Value], robot: RobotArrays) -> list[str]:
    """Q after the step: shortened to the largest step, clipped to the ranges."""
    longest = "0.0"
    for k, move in moves.items():
        longest = writer.let(f"longest{k}", f"max({longest}, abs({text(move)}))")
    share = writer.let("share", f"largest_step / max({longest}, largest_step)")
    joints = max(int(c) for c in robot.bodies[:, 1]) + 1
    return [
        writer.let(
            f"n{k}",
            f"min(max({text(writer.sum(f'to{k}', (f'q{k}',), (share, moves.get(k, 0.0))))}, lower{k}), upper{k})",
        )
        for k in range(joints)
    ]

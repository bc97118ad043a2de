"""How well the tool can be moved: manipulability, condition and distance to a singularity, and their gradients.

All are functions of the singular values of a Jacobian. Which one is said by a `MeasureChoice`: of the whole robot, its
arm or its base, of the tool's velocity, its rotation or both, and how its rows and columns are scaled. Gradients come
from the same derivative of a Jacobian that tracks follow (`kernels.nullspace.differentiate_column`).
"""

from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from ikde.errors import InputError, quoted
from ikde.kernels.arrays import Floats, Ints
from ikde.kernels.nullspace import differentiate_column
from ikde.model.actuators import By, actuator_names, speed_limits, speeds_by
from ikde.model.base_motion import find_planar_base
from ikde.model.numbers import is_number
from ikde.model.robot import MAX_MAGNITUDE, Robot
from ikde.solver.jacobian import find_chain, frame_jacobian

Part = Literal["whole", "arm", "base"]
Rows = Literal["pose", "translation", "rotation"]
Measure = Literal["manipulability", "determinant", "condition", "smallest"]
LENGTH_M = 1.0
ROUNDING = 1e-14  # of the largest singular value: what is smaller is none
ROWS = {"pose": range(6), "translation": range(3), "rotation": range(3, 6)}
BASE_ROWS = {"pose": (0, 1, 5), "translation": (0, 1), "rotation": (5,)}  # what a base in the plane can move at all


@dataclass(frozen=True, slots=True, kw_only=True)
class MeasureChoice:
    """Which Jacobian is measured; raises `InputError` for what is none."""

    part: Part = "whole"
    """`whole`: all that moves the tool. `arm`: without a planar base. `base`: that alone; its rows are x, y and yaw."""
    rows: Rows = "pose"
    """`translation`: of the tool's velocity. `rotation`: of its angular velocity. `pose`: both."""
    by: By = "twist"
    """What the columns are of, as for `jacobian`."""
    scaled: bool = True
    """Whether each column counts at the speed limit of what it is of (`speed_limits`): it is the tool's speed then, m/s
    and rad/s. Else it is by a m or a rad of that."""
    length_m: float = LENGTH_M
    """What a radian of the tool's rotation counts as."""

    def __post_init__(self) -> None:
        for key, kind in (("part", Part), ("rows", Rows), ("by", By)):
            if getattr(self, key) not in get_args(kind):
                words = ", ".join(get_args(kind))
                raise InputError(f"expected one of {words}, got {quoted(getattr(self, key))}", (key,))
        if not (is_number(self.length_m) and 0.0 < self.length_m <= MAX_MAGNITUDE):
            raise InputError(f"expected a number above 0, up to {MAX_MAGNITUDE:g} m", ("length_m",))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Measures:
    """What the singular values of a Jacobian say, of one configuration or of several [...]."""

    singular_values: Floats
    """[..., rows], the largest first: semi-axes of the ellipsoid of velocities; 0 where there are fewer columns."""

    @property
    def manipulability(self) -> Floats:
        """Yoshikawa's sqrt det(J J^T): the product of the singular values."""
        return self.singular_values.prod(axis=-1)

    @property
    def determinant(self) -> Floats:
        """det(J J^T), the square of that [DongZhao, eq. 13, 15]."""
        return self.manipulability**2

    @property
    def condition(self) -> Floats:
        """The largest by the smallest singular value; inf in a singularity."""
        largest, smallest = self.singular_values[..., 0], self.singular_values[..., -1]
        return np.divide(largest, smallest, out=np.full_like(largest, np.inf), where=smallest > 0.0)

    @property
    def axis_ratio(self) -> Floats:
        """The ellipsoid's longest by its shortest axis [Zhang2022, eq. 28]: the same number as the condition."""
        return self.condition

    @property
    def smallest(self) -> Floats:
        """The smallest singular value: how far, by its norm, the nearest singular Jacobian is."""
        return self.singular_values[..., -1]


def measure(robot: Robot, q: Floats, choice: MeasureChoice) -> Measures:
    """The measures at `q` [..., N]; raises `InputError` for the base of a robot that has none."""
    return Measures(singular_values=_find_values(chosen_jacobian(robot, q, choice)))


def chosen_jacobian(robot: Robot, q: Floats, choice: MeasureChoice) -> Floats:
    """The Jacobian that is measured [..., rows, columns], scaled."""
    rows, columns = _choose(robot, choice)
    whole = frame_jacobian(robot, q, robot.tool) @ speeds_by(robot, q, choice.by)
    scale = _row_scale(choice)[:, None] * _column_scale(robot, choice)
    return (whole * scale)[..., rows, :][..., columns]


def measure_gradient(robot: Robot, q: Floats, choice: MeasureChoice, what: Measure) -> Floats:
    """The gradient [..., N] of a measure at `q` [..., N], by the joints, a m and a rad.

    Of the determinant and the manipulability it holds in a singularity as well; the smallest singular value and the
    condition have none where singular values are equal, or 0.
    """
    if what not in get_args(Measure):
        raise InputError(f"expected one of {', '.join(get_args(Measure))}, got {quoted(what)}", ("measure",))
    rows, columns = _choose(robot, choice)
    by = speeds_by(robot, q, choice.by)
    scale = _row_scale(choice)[:, None] * _column_scale(robot, choice)
    jacobian = frame_jacobian(robot, q, robot.tool)
    U, S, Vt = np.linalg.svd(((jacobian @ by) * scale)[..., rows, :][..., columns], full_matrices=False)
    S = np.where(ROUNDING * S[..., :1] > S, 0.0, S)
    slope = np.zeros((*q.shape[:-1], 6, by.shape[-1]))
    slope[..., np.ix_(rows, columns)[0], np.ix_(rows, columns)[1]] = U @ (
        _by_values(S, len(rows), what)[..., None] * Vt
    )
    return differentiate(robot, jacobian, (slope * scale) @ by.mT, choice.by)


def differentiate(robot: Robot, jacobian: Floats, slope: Floats, by: By) -> Floats:
    """The gradient [..., N] of what has this `slope` [..., 6, N] by the entries of the tool's `jacobian` [..., 6, N].

    By the twist or the wheels of a base it must be the same wherever the base stands, as all measures are.
    """
    chain = find_chain(robot, robot.tool)
    J, G = (np.ascontiguousarray(np.moveaxis(of[..., chain], (-2, -1), (0, 1))) for of in (jacobian, slope))
    out, still = np.zeros((jacobian.shape[-1], *jacobian.shape[:-2])), find_planar_base(robot) if by != "joints" else ()
    for k, joint in enumerate(chain):
        if joint not in still:
            out[joint] = sum(differentiate_column.plain(J, G, k, i) for i in range(len(chain)))
    return np.moveaxis(out, 0, -1)


def leave_out(jacobian: Floats) -> Floats:
    """What the manipulability [..., columns] is without each column of a `jacobian` [..., rows, columns]."""
    count = jacobian.shape[-1]
    others = [jacobian[..., [k for k in range(count) if k != column]] for column in range(count)]
    return np.stack([_find_values(other).prod(axis=-1) for other in others], axis=-1)


def _find_values(jacobian: Floats) -> Floats:
    """Singular values [..., rows], 0 for what rounding leaves of one and those that too few columns have not."""
    rows, columns = jacobian.shape[-2:]
    values = np.zeros((*jacobian.shape[:-2], rows))
    if columns:
        values[..., : min(rows, columns)] = np.linalg.svd(jacobian, compute_uv=False)
    values[values < ROUNDING * values[..., :1]] = 0.0
    return values


def _by_values(S: Floats, rows: int, what: Measure) -> Floats:
    """The derivative [..., r] of a measure by each singular value, of which there are r."""
    out = np.zeros_like(S)
    if what in ("manipulability", "determinant"):
        if S.shape[-1] == rows:
            for k in range(rows):
                out[..., k] = np.delete(S, k, axis=-1).prod(axis=-1)
        return out if what == "manipulability" else 2.0 * S.prod(axis=-1)[..., None] * out
    if S.shape[-1] < rows:
        return out if what == "smallest" else np.full_like(S, np.nan)
    if what == "smallest":
        out[..., -1] = 1.0
        return out
    smallest = np.where(S[..., -1] > 0.0, S[..., -1], np.nan)
    out[..., 0] += 1.0 / smallest
    out[..., -1] -= S[..., 0] / smallest**2
    return out


def _choose(robot: Robot, choice: MeasureChoice) -> tuple[list[int], list[int]]:
    """Rows and columns of what is measured."""
    names, base = actuator_names(robot, choice.by), find_planar_base(robot)
    others = {name for place, name in enumerate(robot.joint_names) if place not in base}
    if choice.part == "base" and base[0] < 0:
        raise InputError(f"{robot.name} has no planar base to measure", ("part",))
    kept = {"whole": (True, True), "arm": (False, True), "base": (True, False)}[choice.part]
    rows = BASE_ROWS[choice.rows] if choice.part == "base" else ROWS[choice.rows]
    return list(rows), [k for k, name in enumerate(names) if kept[name in others]]


def _row_scale(choice: MeasureChoice) -> Floats:
    return np.array([1.0] * 3 + [choice.length_m] * 3)


def _column_scale(robot: Robot, choice: MeasureChoice) -> Floats | Ints:
    return speed_limits(robot, choice.by) if choice.scaled else np.ones(1)

"""Whether configurations are free of the robot itself and of a world: a yes or no alone, for planners."""

from collections.abc import Callable
from functools import lru_cache
from typing import overload

import numpy as np

from ikde.errors import InputError
from ikde.kernels.arrays import Floats
from ikde.kernels.cache_folder import is_kept
from ikde.kernels.flat_arguments import flatten_models
from ikde.kernels.free_rows import judge_rows
from ikde.model.arguments import RobotLike, read_robot
from ikde.model.collision_model import CollisionChoice, CollisionModel
from ikde.model.pack import pack_robot
from ikde.model.robot import Robot
from ikde.solver.background import Question, answers_plainly
from ikde.solver.check import AT_ONCE, Many, One
from ikde.solver.compile_note import name_work, note_compile
from ikde.solver.joints import JointValues, read_joints
from ikde.solver.plain import compute_gaps
from ikde.solver.standing import find_model
from ikde.solver.verify import Bools

CALL, ENGINE, KIND = "a yes or no of", "check", "configurations"
"""How machine code is asked for: the name of its stage in `solver/warmup.py`."""


@overload
def is_free(robot: RobotLike, q: One, collision: CollisionChoice = None, convention: str | None = None) -> bool: ...


@overload
def is_free(robot: RobotLike, q: Many, collision: CollisionChoice = None, convention: str | None = None) -> Bools: ...


@overload
def is_free(
    robot: RobotLike, q: JointValues, collision: CollisionChoice = None, convention: str | None = None
) -> bool | Bools: ...


def is_free(
    robot: RobotLike, q: JointValues, collision: CollisionChoice = None, convention: str | None = None
) -> bool | Bools:
    """Whether a configuration is free of self-collision and, in a world, of every obstacle, margins kept.

    That is `not check(...).collision` without the distances: by machine code, and until there is some by the plain
    numpy of `check`. Limits of joints are not part of the question.

    Args:
        robot: the robot, its name or the path of its file.
        q: joint values [N], or a mapping by joint name; m and rad. Of many, [K, N], the answer is an array [K].
        collision: as for `check`; a `CollisionModel` that is handed over again costs nothing.
        convention: how `q` is counted; None for the robot's own.

    Raises:
        InputError: without a detector that compares anything, since nothing would be checked; for a wrong count, an
            unknown joint, detector or convention, NaN or infinity.
    """
    robot = read_robot(robot)
    values = read_joints(robot, q, convention)
    if values.ndim not in (1, 2):
        count = len(robot.joints)
        raise InputError(f"expected a configuration [{count}] or many [K, {count}], got shape {values.shape}", ("q",))
    asked = _find_asked(robot, collision)
    found = asked.judge(np.array(values.reshape(-1, len(robot.joints))))  # one that may not be written is another type
    return found if values.ndim == 2 else bool(found[0])


class Asked:
    """One robot in one world, as it is asked again and again."""

    def __init__(self, model: CollisionModel) -> None:
        self._model = model
        self._question = Question(model.own, KIND, CALL, ENGINE)
        self._models = flatten_models(pack_robot(model.robot), model.arrays)

    def judge(self, rows: Floats) -> Bools:
        """Whether each of `rows` [K, N] is free [K]."""
        machine = find_machine_code(self._question)
        if machine is None:
            parts = range(0, len(rows) or 1, AT_ONCE)
            return np.concatenate([self._judge_plainly(rows[k : k + AT_ONCE]) for k in parts])
        found = np.empty(len(rows), dtype=bool)
        with note_compile(self._describe):
            machine(*self._models, rows, found)
        return found

    def _describe(self) -> str:
        return name_work("checks", self._model)

    def _judge_plainly(self, rows: Floats) -> Bools:
        return compute_gaps(self._model, rows).min(axis=1) > self._model.limit_m


class Rows:
    """`judge_rows` as what answers a question, and its machine code once that has been there."""

    machine: Callable[..., None] | None = None

    @property
    def is_kept(self) -> bool:
        """True if its machine code lies in the cache."""
        return is_kept(judge_rows.py_func)


ROWS = Rows()


def find_machine_code(question: Question) -> Callable[..., None] | None:
    """Machine code, or what waits for it; None while there is none: then a child begins to compile it."""
    if ROWS.machine is None:
        if answers_plainly(ROWS, question):
            return None
        ROWS.machine = judge_rows.compiled
    return ROWS.machine


@lru_cache(maxsize=64)
def _find_asked(robot: Robot, collision: CollisionChoice) -> Asked:
    model = find_model(robot, collision)
    if not model.pairs:
        raise InputError("nothing is compared without a detector, so nothing can be called free", ("collision",))
    return Asked(model)

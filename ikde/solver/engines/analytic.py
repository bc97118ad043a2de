"""`analytic`: every branch of a UR-type arm in closed form, the base drawn from the seeds."""

import numpy as np

from ikde.errors import InputError
from ikde.kernels.arrays import POSE, Ints
from ikde.model.closed_form import find_ur_arm, pack_ur_arm
from ikde.model.robot import Robot
from ikde.solver.engines.engine import SearchInputs, make_ranges
from ikde.solver.engines.pool import load_kernels, make_seeds
from ikde.solver.problem import pack_searched


class Analytic:
    """Poses only; an arm on a base that cannot move is done with one attempt: it has no other branches."""

    name = "analytic"
    is_ready = False
    rows_per_call = 1024
    attempts_per_call = 256

    def __init__(self, inputs: SearchInputs) -> None:
        self._inputs, problem = inputs, inputs.problem
        check_closed_form(problem.robot)
        if (inputs.targets.kind != POSE).any():
            raise InputError("the closed form needs a whole pose: a position and an orientation", ("method",))
        self._arm = find_ur_arm(problem.robot)
        self._kernels, models = load_kernels(problem.collision, "pose"), pack_searched(problem.collision)
        self._models = models[0], self._kernels.use_models(*models)[1]
        self._seeds = make_seeds(problem, "pose")

    def call(self, rows: range, first: int, last: Ints) -> None:
        """Make attempts first .. last - 1 on the rows that are not reached yet."""
        asked, arm = self._inputs, self._arm
        if arm is None:
            return
        attempts = asked.attempts(rows, first, np.minimum(last, first + self.attempts_per_call))
        where = (asked.targets, np.array([rows.start, rows.stop]), make_ranges(asked.problem), self._seeds)
        with np.errstate(over="ignore"):  # the random stream wraps around; without the JIT numpy would warn
            self._kernels.solve_branches(
                *(*self._models, pack_ur_arm(arm), arm.carrier, *where),
                *(asked.seed, asked.streams, attempts, *asked.outputs),
            )


def check_closed_form(robot: Robot) -> None:
    """Raise `InputError` for a robot without a closed form."""
    if find_ur_arm(robot) is None:
        raise InputError(f"{robot.name} has no closed form: its last six joints are no UR-type arm", ("method",))

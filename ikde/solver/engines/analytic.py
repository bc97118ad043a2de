"""`analytic`: every branch of a UR-type arm in closed form; a base that may move is drawn from the seeds."""

from collections.abc import Callable
from functools import partial

import numpy as np

from ikde.errors import InputError
from ikde.kernels.arrays import POSE, Floats, Ints
from ikde.kernels.flat_arguments import flatten_answer, flatten_closed_form
from ikde.model.closed_form import URArm, find_still_arm, find_ur_arm, pack_ur_arm
from ikde.model.robot import Robot
from ikde.solver.engines.engine import SearchInputs, make_ranges
from ikde.solver.engines.pool import load_kernels, make_seeds
from ikde.solver.joined import append_world, cut_world, join_answer, without_world
from ikde.solver.metrics import pack_grader
from ikde.solver.problem import Problem, pack_searched


def make_still_ranges(problem: Problem) -> Floats:
    """Lower, upper, and what motions begin at [3, N]."""
    return np.array(
        [problem.lower, problem.upper, np.minimum(np.maximum(problem.centre, problem.lower), problem.upper)]
    )


def pack_still(problem: Problem, arm: URArm) -> tuple[Floats, Ints]:
    """All that stays from target to target, as `solve_poses` takes it, of an arm that alone may move."""
    numbers, whole = _pack_head(problem, arm)
    return append_world(numbers, whole, int(whole[3]), problem.collision.arrays.world)


def _pack_head(problem: Problem, arm: URArm) -> tuple[Floats, Ints]:
    """The same without the world."""
    (robot, collision), packed = pack_searched(problem.collision), pack_ur_arm(arm, problem.weights)
    ranges = make_still_ranges(problem)
    return flatten_closed_form(robot, without_world(collision), ranges, packed, arm.carrier)


def pack_answer(problem: Problem) -> tuple[Floats, Ints]:
    """The same as `answer_pose` takes it."""
    search = _pack_head(problem, check_closed_form(problem.robot))
    grader = cut_world(*pack_grader(problem.collision, problem.settings))
    block = flatten_answer(search, grader, POSE, problem.turns, is_graded=problem.near is None)
    return join_answer(*block, problem.collision.arrays.world)


class Analytic:
    """Poses only; of an arm that alone may move one attempt shows all branches."""

    name = "analytic"
    is_ready = False
    rows_per_call = 1024
    attempts_per_call = 256

    def __init__(self, inputs: SearchInputs) -> None:
        self._inputs, problem = inputs, inputs.problem
        arm = check_closed_form(problem.robot)
        if (inputs.targets.kind != POSE).any():
            raise InputError("the closed form needs a whole pose: a position and an orientation", ("method",))
        stands_still = find_still_arm(problem.robot, problem.lower, problem.upper) is not None
        self._search = self._prepare_still(arm) if stands_still else self._prepare_driving(arm)

    def call(self, rows: range, first: int, last: Ints) -> None:
        """Make attempts first .. last - 1 on the rows that are not reached yet."""
        attempts = self._inputs.attempts(rows, first, np.minimum(last, first + self.attempts_per_call))
        with np.errstate(over="ignore"):  # the random stream wraps around; without the JIT numpy would warn
            self._search(np.array([rows.start, rows.stop]), attempts)

    def _prepare_still(self, arm: URArm) -> Callable[[Ints, Ints], None]:
        asked, problem = self._inputs, self._inputs.problem
        solve = partial(load_kernels(problem.collision, "pose").solve_poses, *pack_still(problem, arm))
        T_world_tool = asked.targets.T_world_tool
        return lambda rows, attempts: solve(T_world_tool, rows, asked.seed, asked.streams, attempts, *asked.outputs)

    def _prepare_driving(self, arm: URArm) -> Callable[[Ints, Ints], None]:
        asked, problem = self._inputs, self._inputs.problem
        kernels, (robot, collision) = load_kernels(problem.collision, "pose"), pack_searched(problem.collision)
        models = robot, kernels.use_models(robot, collision)[1]
        solve = partial(kernels.solve_branches, *models, collision, pack_ur_arm(arm), arm.carrier, asked.targets)
        own = make_ranges(problem), make_seeds(problem, "pose"), asked.seed, asked.streams
        return lambda rows, attempts: solve(rows, *own, attempts, *asked.outputs)


def check_closed_form(robot: Robot) -> URArm:
    """The robot's arm; raises `InputError` for a robot without a closed form."""
    arm = find_ur_arm(robot)
    if arm is None:
        raise InputError(f"{robot.name} has no closed form: its last six joints are no UR-type arm", ("method",))
    return arm

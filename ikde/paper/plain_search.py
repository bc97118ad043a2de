"""The paper's plain search, which ignores collision: the setting that Table 4 is recomputed at, and its variations."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from ikde.kernels.arrays import Floats, Ints
from ikde.model.collision_model import CollisionModel
from ikde.model.convention import convention_offsets
from ikde.model.robot import Detector, Robot
from ikde.model.target import Target
from ikde.paper.inputs import Inputs
from ikde.solver.distinct import UNEXPLAINED
from ikde.solver.metrics import compute_clearances
from ikde.solver.problem import Problem, make_problem
from ikde.solver.results import SolveResults, solve_rows
from ikde.solver.settings import DeSettings, SolveSettings

SEED = 2021
CHUNK = 1000  # solves at a time: a progress bar moves, Ctrl-C is heard
Limits = Literal["classical", "key_point", "half_turn", "full_turn"]
"""Those of [Qiao2022], counted as Table 5 counts its joints or as the key-point model; or a turn to either side."""

STATED = SolveSettings(
    method="de",
    position_tolerance_m=5e-5,
    restarts=1,
    de=DeSettings(strategy="best/1", bounds="redraw", update="in_place", collision="reject"),
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Setup:
    """What Table 4 leaves open. The defaults are the setting at which all four printed rates are met."""

    settings: SolveSettings = STATED
    base_half_width_m: float = 0.06  # Table 5's d_x and d_y lie within +-61 mm
    limits: Limits = "classical"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Solutions:
    """Solves of one target from random streams of their own, and those that met it."""

    Q: Floats  # [S, N] the S that met the target, in the robot's own convention
    order: Ints  # [S] which solve each was
    seconds: Floats  # [solves]
    evaluations: Ints  # [solves]
    attempts: Ints  # [solves]

    def first(self, solves: int) -> Floats:
        """Solutions among the first so many solves."""
        return self.Q[self.order < solves]


def apply_setup(robot: Robot, setup: Setup) -> Robot:
    """The robot with a setup's joint ranges."""
    offsets = convention_offsets(robot, "classical") if setup.limits == "classical" else np.zeros(len(robot.joints))
    reach = {"half_turn": np.pi, "full_turn": 2.0 * np.pi}.get(setup.limits)
    joints = []
    for joint, offset in zip(robot.joints, offsets, strict=True):
        lower, upper = (joint.lower - offset, joint.upper - offset) if reach is None else (-reach, reach)
        joints.append(replace(joint, lower=lower, upper=upper))
    return limit_base(replace(robot, joints=tuple(joints)), setup.base_half_width_m)


def limit_base(robot: Robot, reach_m: float) -> Robot:
    """The robot with its prismatic joints within +-`reach_m`: no range is printed, the solutions lie within 61 mm."""
    kept = [replace(j, lower=-reach_m, upper=reach_m) if j.kind == "prismatic" else j for j in robot.joints]
    return replace(robot, joints=tuple(kept))


def make_setup_problem(robot: Robot, setup: Setup, detector: Detector | str | None = "none") -> Problem:
    """The search of a setup; with a detector it starts again until a solution is free."""
    return make_problem(apply_setup(robot, setup), setup.settings, collision=detector, near=None, freeze=None)


def solve_plainly(inputs: Inputs, setup: Setup, target: Target, solves: int, *, first_stream: int = 0) -> Solutions:
    """Solve one target many times without checking for collision."""
    problem = make_setup_problem(inputs.robot, setup)
    parts = []
    for begin in range(0, solves, CHUNK):
        count = min(CHUNK, solves - begin)
        parts.append(solve_rows(problem, [target] * count, UNEXPLAINED, seed=SEED, first_stream=first_stream + begin))
        inputs.progress.advance(count)
    return gather(parts)


def gather(parts: Sequence[SolveResults]) -> Solutions:
    """Solves one after the other as one sample."""
    reached = np.concatenate([rows.reached for rows in parts])
    return Solutions(
        Q=np.concatenate([rows.q for rows in parts])[reached],
        order=np.flatnonzero(reached),
        seconds=np.concatenate([rows.found.seconds for rows in parts]),
        evaluations=np.concatenate([rows.evaluations for rows in parts]),
        attempts=np.concatenate([rows.attempts for rows in parts]),
    )


def collides(collision: CollisionModel, Q: Floats) -> np.ndarray:
    """Which configurations [K, N] a collision model rejects [K]."""
    if not len(Q):
        return np.zeros(0, dtype=bool)
    return np.concatenate([compute_clearances(collision, Q[k : k + CHUNK]).collides for k in range(0, len(Q), CHUNK)])

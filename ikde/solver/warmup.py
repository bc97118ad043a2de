"""Compile ahead: everything that a robot's solves are going to need, one small solve after the other."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

from ikde.kernels.jit import compile_clock
from ikde.model.closed_form import find_ur_arm
from ikde.model.collision_model import CollisionChoice, CollisionModel
from ikde.model.robot import Robot
from ikde.model.target import Target
from ikde.solver.background import WAIT, compile_way
from ikde.solver.engine_table import ENGINES, SEVERAL
from ikde.solver.plain import compute_frames
from ikde.solver.settings import BulkOptions, SolveSettings
from ikde.solver.solve import solve, solve_many


@dataclass(frozen=True, slots=True, kw_only=True)
class Stage:
    """One part of the warm-up."""

    name: str
    run: Callable[[], object]


@dataclass(frozen=True, slots=True, kw_only=True)
class Compiled:
    """What a stage took; 0 s if its machine code was in the cache."""

    name: str
    seconds: float


def list_stages(robot: Robot, collision: CollisionChoice = None) -> list[Stage]:
    """What there is to compile: a robot's own kernels for each kind of target, and the engines that serve all."""
    T = compute_frames(robot, robot.home)[robot.tool]
    targets = {
        "position": Target(T[:3, 3]),
        "axis": Target(T[:3, 3], axis_world_tool=T[:3, 2]),
        "pose": Target(T[:3, 3], R_world_tool=T[:3, :3]),
    }
    collision = CollisionModel.of(robot, collision)  # a wrong name is found before anything is compiled
    one, many = partial(solve, robot, collision=collision), partial(_solve_many, robot, collision)
    stages = {}
    for name, row in ENGINES.items():
        if row.is_closed_form and find_ur_arm(robot) is None:
            continue
        settings = SolveSettings.for_method(name).with_changes(restarts=1)
        settings = settings.with_changes(de=settings.de and {"generations": 1})
        for kind in row.compiled_kinds:
            if row.one_by_one or row.is_closed_form:
                stages[f"{name}, one {kind}"] = partial(one, targets[kind], settings)
                stages[f"{name}, near {kind}"] = partial(one, targets[kind], settings, near=robot.home)
            if row.one_by_one:
                stages[f"{name}, many of {kind}"] = partial(many, [targets[kind]] * SEVERAL, settings)
            else:
                stages[name] = partial(many, [targets[kind]] * SEVERAL, settings)
    return [Stage(name=name, run=run) for name, run in stages.items()]


def warm_up(stages: list[Stage], progress: Callable[[int, Stage], None] | None = None) -> list[Compiled]:
    """Run stages in order; `progress` is called with the number of each before it begins."""
    done = []
    for number, stage in enumerate(stages):
        if progress is not None:
            progress(number, stage)
        with compile_clock(_stay_silent) as clock, compile_way(WAIT):
            stage.run()
        done.append(Compiled(name=stage.name, seconds=clock.seconds))
    return done


def _stay_silent() -> None:
    """`progress` has said what is compiled."""


def _solve_many(robot: Robot, collision: CollisionChoice, targets: list[Target], settings: SolveSettings) -> object:
    """Solves whose answers are not read: no search for reasons."""
    return solve_many(robot, targets, settings, collision=collision, bulk=BulkOptions(explain=False))

"""From a run file to a batch: every name resolved, every number in m and rad, everything wrong found before it runs."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ikde.batch.arms import describe_arm, make_arm, make_arms
from ikde.batch.columns import place_grader
from ikde.batch.parts import MAX_PARTS, PLAIN_NAME
from ikde.batch.plan import Arm, Batch
from ikde.batch.recipe import as_plain, ikde_version, robot_digest
from ikde.batch.sources import FreedomSource, GoalSource
from ikde.batch.spec import COLUMN_GROUPS, BatchSpec
from ikde.batch.targets import make_source
from ikde.batch.worlds import Read, RunWorld, make_worlds, pick_up_all
from ikde.errors import InputError
from ikde.formats.attached import list_held, read_attached
from ikde.formats.error_path import prefix_errors
from ikde.formats.robot_entries import read_collision, to_si
from ikde.model.generate.module import describe_kernels
from ikde.model.robot import Detector, Robot

MAX_SOLVES = 10**9  # of an arm
MIN_CHUNK, MAX_CHUNK = 1000, 10_000
MIN_GOALS, MAX_GOALS = 20, 1000  # of goals with freedom, each of which takes milliseconds, and a thread has them alone


def make_batch(
    spec: BatchSpec,
    robot: Robot,
    *,
    folder: Path,
    file: str | None = None,
    read_world: Read | None = None,
    attach: str | None = None,
) -> Batch:
    """Resolve a run file whose paths start at `folder`; its own name is for the record.

    `read_world` reads the world files that it names; `attach` is typed, for what is picked up beside its `attached`.

    Raises:
        InputError: with the path of the key inside the run file.
        FileError: for what is wrong inside a table, or a world file.
    """
    worlds = () if read_world is None else make_worlds(spec, read_world)
    worlds = _pick_up(spec, robot, worlds, attach)
    arms, graders = make_arms(spec, robot, worlds), _make_graders(spec, robot)
    for arm in arms:
        _check_graders(arm, graders)
    with prefix_errors("solve"):
        shared = make_arm("solve", robot, spec.solve.model_copy(update={"margin": None}), spec.units)
    source, targets = make_source(spec, shared.problem, folder)
    if source.count * spec.repeats > MAX_SOLVES:
        raise InputError(f"{source.count:,} targets make more than {MAX_SOLVES:,} solves an arm", ("repeats",))
    is_free = isinstance(source, FreedomSource | GoalSource)
    chunk = spec.chunk or choose_chunk(source.count * spec.repeats, has_freedom=is_free)
    parts = len(arms) * -(-source.count * spec.repeats // chunk)
    if parts > MAX_PARTS:
        raise InputError(f"this makes {parts:,} files; expected at most {MAX_PARTS:,}", ("chunk",))
    asked: dict[str, Any] = {
        "repeats": spec.repeats,
        "seed": spec.seed,
        "chunk": chunk,
        "explain": spec.explain,
        "columns": tuple(group for group in COLUMN_GROUPS if group in spec.output.columns),
    }
    recipe = {
        "ikde": ikde_version(),
        "kernels": describe_kernels(),
        "robot": {"name": robot.name, "digest": robot_digest(robot)},
        "targets": targets,
        "arms": {arm.name: describe_arm(arm) for arm in arms},
        "grade": graders,
        **asked,
    }
    name = spec.name or (Path(file).stem if file else "batch")
    return Batch(
        name=name,
        robot=robot,
        arms=arms,
        source=source,
        graders=graders,
        recipe=as_plain(recipe),
        file=file,
        attach=attach,
        **asked,
    )


def _pick_up(spec: BatchSpec, robot: Robot, worlds: Sequence[RunWorld], attach: str | None) -> tuple[RunWorld, ...]:
    """The worlds in which the robot holds what it is to hold, picked up at `near` of `solve`, else at home."""
    typed = [] if attach is None else read_attached(attach)
    if not (spec.attached or typed):
        return tuple(worlds)
    with prefix_errors("solve"):
        near = to_si(robot, "near", spec.solve.near or {}, spec.units)
        with prefix_errors("detector"):
            model = read_collision(robot, spec.solve.detector, spec.units)
    q = np.array([near.get(joint.name, joint.home) for joint in robot.joints])
    worlds = pick_up_all(worlds, list_held(spec.attached), model, q, "attached")
    return pick_up_all(worlds, typed, model, q, "attach")


def choose_chunk(solves: int, *, has_freedom: bool = False) -> int:
    """Solves a part: a hundredth of an arm's; a part costs 10 ms beside its solves, and a kill costs some parts."""
    least, most = (MIN_GOALS, MAX_GOALS) if has_freedom else (MIN_CHUNK, MAX_CHUNK)
    return min(max(solves // 100, least), most)


def _check_graders(arm: Arm, graders: tuple[Detector, ...]) -> None:
    """Raise `InputError` for a grader that an arm's world does not fit: it has other components."""
    for index, grader in enumerate(graders):
        with prefix_errors("grade", index):
            place_grader(arm.problem.collision, grader)


def _make_graders(spec: BatchSpec, robot: Robot) -> tuple[Detector, ...]:
    graders: dict[str, Detector] = {}
    for index, choice in enumerate(spec.grade):
        with prefix_errors("grade", index):
            detector = read_collision(robot, choice, spec.units).detector
            if detector is None:
                raise InputError("expected a detector; 'none' grades nothing")
            if not PLAIN_NAME.fullmatch(detector.name):
                raise InputError("expected a name of up to 100 letters, digits and . _ -, since it names columns")
            if detector.name in graders:
                raise InputError(f"two detectors are called {detector.name!r}")
            graders[detector.name] = detector
    return tuple(graders.values())

"""Planning problems asked as inverse kinematics: the pose that the tool has at a problem's goal, in its scene."""

import time
from collections import Counter
from collections.abc import Callable, Container, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ikde.batch.arm_summary import name_blocker
from ikde.errors import InputError, nearest
from ikde.kernels.arrays import Floats
from ikde.model.collision_model import CollisionModel
from ikde.model.pack_world import find_fixed_frames
from ikde.model.robot import Robot
from ikde.model.target import Target
from ikde.model.tools import list_chain
from ikde.model.world import World
from ikde.solver.forward import forward
from ikde.solver.grade import confirm
from ikde.solver.result import NO_SOLUTION, SolveResult
from ikde.solver.solve import solve

Row = Mapping[str, Any]
"""What came of a problem."""

REFUSED = "refused"  # beside the stop reasons: what could not be asked
REPEATED = 3  # further calls that are timed
KEPT_BLOCKERS = 8  # of a problem
KINDS = {"reached": bool, "stop_reason": str, "proved": bool, "blockers": dict, "q": list, "T_world_tool": list} | {
    "again_s": float,
    "new_s": float,
    "held": dict,
    "tool": str,
}


@dataclass(frozen=True, slots=True)
class Margins:
    """Distances to keep from the world, m."""

    all_m: float = 0.0
    of_m: Mapping[str, float] = field(default_factory=dict)
    """Components that keep another one."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LinkPose:
    """Where a link should be."""

    link: str
    frame: str
    """That its pose is in: `world`, which is the robot's root, or a frame that no joint moves."""
    p_frame_link: Floats
    """[3] m."""
    R_frame_link: Floats | None
    """[3, 3]; None: any orientation."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Question:
    """A problem as it is asked: of a robot whose joints may all move but for those that are held."""

    robot: Robot
    target: Target
    held: Mapping[str, float]


def make_question(
    robot: Robot, start: Mapping[str, float], goal: Mapping[str, float], *, has_tool: bool = True
) -> Question:
    """What a request asks of the tool; joints are by name, m and rad.

    Joints that do not move the tool, or that the goal does not name, are held at the request's values. Joints that the
    robot does not have are left out: they stand where its file has them. Unless `has_tool`, it is that of the robot's
    tools of which the goal names most joints; the one that the robot has, of equals.

    Raises:
        InputError: for a joint of the robot that the request says nothing of, a goal that names no joint of the tool,
            and for a value outside the limits of a joint that is held.
    """
    whole = (robot if has_tool else choose_tool(robot, goal)).whole
    values = {**start, **goal}
    moving = list_chain(whole, whole.tool)
    if not any(name in goal for name in moving):
        raise InputError(f"names no joint that moves {whole.tool}", ("goal_constraints",))
    _refuse_missing(whole, values)
    T = forward(whole, np.array([values[name] for name in whole.joint_names]))[whole.tool]
    held = {name: values[name] for name in whole.joint_names if name not in moving or name not in goal}
    return _ask_of(whole, Target(T[:3, 3], R_world_tool=T[:3, :3]), held)


def make_pose_question(robot: Robot, start: Mapping[str, float], pose: LinkPose) -> Question:
    """What a request asks of a link, whose frame is the tool; joints that do not move it are held at their values.

    Raises:
        InputError: for a link or a frame that the robot does not have, and as `make_question`.
    """
    frames = find_fixed_frames(robot)
    if pose.frame not in frames:
        known = nearest(pose.frame, frames)
        raise InputError(f"no frame that stays in its place is called {pose.frame!r}{known}", ("goal_constraints",))
    whole = robot.with_tool(pose.link).whole
    moving, T = list_chain(whole, whole.tool), frames[pose.frame]
    _refuse_missing(whole, {**dict.fromkeys(moving, 0.0), **start})
    R = None if pose.R_frame_link is None else T[:3, :3] @ pose.R_frame_link
    held = {name: start[name] for name in whole.joint_names if name not in moving}
    return _ask_of(whole, Target(T[:3, :3] @ pose.p_frame_link + T[:3, 3], R_world_tool=R), held)


def _refuse_missing(robot: Robot, values: Mapping[str, float]) -> None:
    missing = [name for name in robot.joint_names if name not in values]
    if missing:
        raise InputError(f"the request has no value of joint {', '.join(missing)}", ("start_state",))


def _ask_of(robot: Robot, target: Target, held: Mapping[str, float]) -> Question:
    for joint in robot.joints:
        if joint.name in held and not joint.lower <= held[joint.name] <= joint.upper:
            limits = f"outside its limits, {joint.lower:g} to {joint.upper:g}"
            raise InputError(f"{joint.name} is held at {held[joint.name]:g}, {limits}", ("start_state",))
    return Question(robot=robot, target=target, held=held)


def choose_tool(robot: Robot, named: Container[str]) -> Robot:
    """The robot with the tool of which most joints are named; the one that it has, of equals."""
    frames = dict.fromkeys((robot.tool, *robot.tools.values()))
    counts = {frame: sum(name in named for name in list_chain(robot.whole, frame)) for frame in frames}
    return robot.with_tool(max(counts, key=lambda frame: counts[frame]))


def use_tool(own: CollisionModel, tool: str) -> CollisionModel:
    """The robot of a model with another tool, and the same detector."""
    robot = own.robot
    return own if robot.tool == tool else CollisionModel.of(robot.with_tool(tool).whole, own.name)


def ask(question: Question, own: CollisionModel, world: World, margins: Margins) -> dict[str, Any]:
    """The answer as plain data, lengths in m and times in s, and graded by plain numpy.

    `new_s` is the first call in a world that was not seen before, with placing the robot in it; `again_s` the median
    of further calls, which give the same bits.
    """
    robot, held = question.robot, question.held or None
    own = use_tool(own, robot.tool)
    started = time.perf_counter()
    model = own.in_world(world, margins.all_m, margins.of_m)
    result = solve(robot, question.target, collision=model, freeze=held)
    new_s = time.perf_counter() - started - result.compile_seconds
    again_s = []
    for _ in range(REPEATED):
        started = time.perf_counter()
        solve(robot, question.target, collision=model, freeze=held)
        again_s.append(time.perf_counter() - started)
    result = confirm(robot, result)
    return {
        **_describe(result, robot.name),
        "tool": robot.tool,
        "held": dict(question.held),
        "new_s": new_s,
        "again_s": float(np.median(again_s)),
    }


def refuse(error: InputError) -> dict[str, Any]:
    """The row of a problem that could not be asked."""
    return {"reached": False, "stop_reason": REFUSED, "reason": str(error), "proved": False, "blockers": {}}


def _describe(result: SolveResult, robot: str) -> dict[str, Any]:
    target, clearance_m = result.target, result.clearance_m
    blockers = Counter[str]()
    for pair, count in result.blocking_pairs.items():
        blockers[name_blocker(pair, robot)] += count
    return {
        "reached": result.reached,
        "stop_reason": str(result.stop_reason),
        "reason": None if result.reached else result.reason,
        "hint": result.hint,
        "proved": result.reason.startswith(NO_SOLUTION),
        "blockers": dict(blockers.most_common(KEPT_BLOCKERS)),
        "clearance_m": clearance_m if result.reached and clearance_m is not None and np.isfinite(clearance_m) else None,
        "closest_pair": list(result.closest_pair) if result.reached and result.closest_pair else None,
        "q": result.q.tolist(),
        "T_world_tool": np.column_stack([target.R_world_tool, target.p_world_tool]).tolist(),
    }


def read_known(data: Any, asked: Mapping[str, Any]) -> dict[str, Row]:
    """Rows of earlier data that answer the same question; none where it is another, or no such data."""
    if not isinstance(data, dict) or data.get("asked") != asked or not isinstance(data.get("problems"), dict):
        return {}
    return {name: row for name, row in data["problems"].items() if _is_row(row)}


def _is_row(row: Any) -> bool:
    """Whether something is a row that was answered; others are asked again."""
    return isinstance(row, dict) and all(isinstance(row.get(key), kind) for key, kind in KINDS.items())


def run_scenes(
    names: Iterable[tuple[str, str]],
    known: Mapping[str, Row],
    ask_one: Callable[[str], Row],
    keep: Callable[[Mapping[str, Row]], None],
) -> dict[str, Row]:
    """Rows by name, in order: those that are `known`, by name and digest, and the others asked.

    `names` has the digest of each; `keep` is called with what there is so far after each that was asked.
    """
    rows: dict[str, Row] = {}
    for name, digest in names:
        there = known.get(name)
        if there is not None and there.get("digest") == digest:
            rows[name] = there
            continue
        rows[name] = {**ask_one(name), "digest": digest}
        keep(rows)
    return rows


@dataclass(frozen=True, slots=True, kw_only=True)
class FamilySummary:
    """What came of one family of problems."""

    name: str
    problems: int
    reached: int
    proved: int
    """Problems of which it is proved that they have no answer."""
    again_ms: tuple[float, float, float] | None
    """Median, 99th percentile and maximum of the time of a call that was asked before."""
    new_ms: tuple[float, float, float] | None
    """Of the first call in a world."""
    least_clearance_m: float | None
    blockers: Mapping[str, int]
    """Problems without an answer, by what blocked most often."""


def summarise_rows(name: str, rows: Sequence[Row]) -> FamilySummary:
    """Counts and times of some rows."""
    clearances = [row["clearance_m"] for row in rows if row.get("clearance_m") is not None]
    missed = Counter(next(iter(row["blockers"])) for row in rows if not row["reached"] and row["blockers"])
    return FamilySummary(
        name=name,
        problems=len(rows),
        reached=sum(row["reached"] for row in rows),
        proved=sum(row["proved"] and not row["reached"] for row in rows),
        again_ms=_spread([row["again_s"] for row in rows if "again_s" in row]),
        new_ms=_spread([row["new_s"] for row in rows if "new_s" in row]),
        least_clearance_m=min(clearances, default=None),
        blockers=dict(missed.most_common()),
    )


def _spread(seconds: Sequence[float]) -> tuple[float, float, float] | None:
    if not seconds:
        return None
    median, p99, most = (1e3 * np.quantile(seconds, (0.5, 0.99, 1.0))).tolist()
    return median, p99, most

"""What would help among obstacles: each remedy is tried by short searches, and what these may cost is limited."""

import math
from collections.abc import Iterable, Iterator
from dataclasses import replace

import numpy as np

from ikde.kernels.arrays import EVALUATIONS, Floats
from ikde.model.base_motion import base_joints
from ikde.model.closed_form import find_still_arm
from ikde.model.collision_model import CollisionModel
from ikde.model.robot import MAX_MAGNITUDE
from ikde.model.target import Target, Targets
from ikde.solver.branches import judge_branches
from ikde.solver.engines.search_state import SearchState
from ikde.solver.hints import WIDER, Probe, meets
from ikde.solver.plain import compute_gaps
from ikde.solver.problem import ROUNDING, Problem

REMOVED = 3  # obstacles that are left out, one at a time
HALVINGS = 5  # of what is not known of a margin
FINEST_M = 1e-4  # to which a margin is found
MIN_COST = 500  # of a search, in evaluations: what it takes to begin one
MAX_COST = 30_000  # in evaluations: 20 to 40 ms of machine code; not a time, so that reasons are the same everywhere
STOPPED = "further remedies were not tried: they would take more than 50 ms"


class Tries:
    """Short searches for one target, until they have cost enough."""

    def __init__(self, probe: Probe) -> None:
        self._probe, self._cost = probe, 0

    @property
    def is_spent(self) -> bool:
        """Whether no further search is begun."""
        return self._cost >= MAX_COST

    def find(self, problem: Problem, **settings: int) -> Floats | None:
        """A configuration [N] that answers a question that was changed, in the eyes of plain numpy, too."""
        found: SearchState = self._probe.run(problem.with_settings(**settings) if settings else problem)
        self._cost += max(MIN_COST, int(found.counts[0, EVALUATIONS]))
        return found.q[0] if self._probe.confirms(problem, found) else None


def try_in_world(problem: Problem, probe: Probe, blocking: Iterable[tuple[str, str]]) -> str | None:
    """All that was found to help against obstacles: one left out, less margin, a base that may leave its range; and
    against what the robot holds, if that may touch something.

    None where neither blocked, or nothing helped.
    """
    names, blocking = {obstacle.name for obstacle in problem.collision.obstacles}, list(blocking)
    blockers = [name for _, name in blocking if name in names][:REMOVED]
    touches = list_touches(problem.collision, blocking)[:REMOVED]
    if not (blockers or touches):
        return None
    is_pose = probe.target.kind == "pose"
    if is_pose and find_still_arm(problem.robot, problem.lower, problem.upper) is not None:
        return "; ".join(_try_branches(problem, probe.target, blockers, touches)) or None
    tries, hints = Tries(probe), list[str | None]()
    if blockers:
        hints.append(_try_removing(problem, tries, blockers[:1]))
        hints.append(_try_less_margin(problem, tries))
        hints.append(_try_base(problem, tries))
    hints.append(_try_touching(problem, tries, touches))
    if not any(hints):
        hints.append(_try_removing(problem, tries, blockers[1:]))
    helpful = [hint for hint in hints if hint]
    return "; ".join([*helpful, *([STOPPED] if tries.is_spent else [])]) if helpful else None


def list_touches(model: CollisionModel, blocking: Iterable[tuple[str, str]]) -> list[tuple[str, str]]:
    """Pairs of an attached object and something it may not touch, of those that blocked, most often first."""
    held, found = {thing.name: thing.may_touch for thing in model.world.attached}, list[tuple[str, str]]()
    own = set(model.pairs)
    for pair in blocking:
        if pair in own:
            found += [(a, b) for a, b in (pair, pair[::-1]) if a in held][:1]
        else:
            found += [(name, pair[1]) for name, allowed in held.items() if pair[1] not in allowed]
    return found


def let_touch(model: CollisionModel, name: str, other: str) -> CollisionModel:
    """The same where something that is held may touch something else."""
    held = tuple(
        replace(thing, may_touch=(*thing.may_touch, other)) if thing.name == name else thing
        for thing in model.world.attached
    )
    return model.own.in_world(replace(model.world, attached=held), model.margin_m, dict(model.margins_m))


def _try_touching(problem: Problem, tries: Tries, touches: Iterable[tuple[str, str]]) -> str | None:
    """The first thing that is held, and what it touches, with which a short search finds a solution."""
    for name, other in touches:
        if not tries.is_spent and tries.find(_let_touch(problem, name, other)) is not None:
            return _tell_touching(name, other)
    return None


def _let_touch(problem: Problem, name: str, other: str) -> Problem:
    return replace(problem, collision=let_touch(problem.collision, name, other))


def _tell_touching(name: str, other: str) -> str:
    return f"if {name} may touch {other}: a solution was found"


def _try_branches(
    problem: Problem, target: Target, blockers: Iterable[str], touches: Iterable[tuple[str, str]]
) -> Iterator[str]:
    """The same where the closed form has all configurations: no search."""
    model, q = problem.collision, judge_branches(problem, Targets.of([target])).q[0]
    q = q[(np.isfinite(q) & (problem.lower <= q) & (q <= problem.upper)).all(axis=-1)]
    every = q
    gaps_m, own = compute_gaps(model, q) - model.limit_m, len(model.pairs)
    is_free = (gaps_m[:, :own] > 0.0).all(axis=-1)
    q, shape = q[is_free], (int(is_free.sum()), len(model.components), len(model.obstacles))
    of_world = gaps_m[is_free, own:].reshape(shape).min(axis=1)
    names = [obstacle.name for obstacle in model.obstacles]
    for name in blockers:
        others = np.delete(of_world, names.index(name), axis=1)
        without = q[(others > 0.0).all(axis=-1)]
        if len(without) and meets(problem.without_obstacle(name), target, without[0]):
            yield _tell_without(name)
            break
    if len(q) and (most_m := find_largest_margin(problem.collision)) > 0.0:
        need_m = -of_world.min(axis=-1)
        less_m = _round_up(float(need_m.min()), most_m)
        if meets(_lower_margins(problem, less_m), target, q[need_m.argmin()]):
            yield _tell_less(less_m)
    for name, other in touches:
        if any(meets(_let_touch(problem, name, other), target, row) for row in every):
            yield _tell_touching(name, other)
            break


def _tell_without(name: str) -> str:
    return f"without {name}: a solution was found that touches nothing else"


def _tell_less(less_m: float) -> str:
    return f"with {1e3 * less_m:.4g} mm less margin: a solution was found"


def _round_up(need_m: float, most_m: float) -> float:
    """To the next tenth of a millimetre, and a little above what is just not enough."""
    return min(most_m, FINEST_M * math.ceil((need_m + ROUNDING) / FINEST_M))


def _try_removing(problem: Problem, tries: Tries, blockers: Iterable[str]) -> str | None:
    """The first of some obstacles without which a short search finds a solution."""
    for name in blockers:
        if not tries.is_spent and tries.find(problem.without_obstacle(name)) is not None:
            return _tell_without(name)
    return None


def _try_less_margin(problem: Problem, tries: Tries) -> str | None:
    """By how much less margin a short search finds a solution: the least that was found."""
    most_m = find_largest_margin(problem.collision)
    q = None if tries.is_spent or most_m == 0.0 else tries.find(_lower_margins(problem, most_m))
    if q is None:
        return None
    low_m, less_m = 0.0, min(most_m, _measure_need(problem, q))
    for _ in range(HALVINGS):
        if tries.is_spent or less_m - low_m <= FINEST_M:
            break
        middle_m = 0.5 * (low_m + less_m)
        q = tries.find(_lower_margins(problem, middle_m), restarts=1)
        low_m = low_m if q is not None else middle_m
        less_m = less_m if q is None else min(middle_m, _measure_need(problem, q))
    return _tell_less(_round_up(less_m, most_m))


def find_largest_margin(model: CollisionModel) -> float:
    """The largest of what the caller keeps from obstacles, m; else of their own."""
    kept = max([model.margin_m, *(margin_m for _, margin_m in model.margins_m)])
    return kept or max((obstacle.margin_m for obstacle in model.obstacles), default=0.0)


def lower_margins(model: CollisionModel, less_m: float) -> CollisionModel:
    """The same among obstacles with all margins of the caller lower, if there are any; else with those of obstacles."""
    world = model.world
    own = {name: max(margin_m - less_m, 0.0) for name, margin_m in model.margins_m}
    if not (model.margin_m or any(margin_m for _, margin_m in model.margins_m)):
        lower = tuple(replace(one, margin_m=max(one.margin_m - less_m, 0.0)) for one in world.obstacles)
        world = replace(world, obstacles=lower)
    return model.own.in_world(world, max(model.margin_m - less_m, 0.0), own)


def _lower_margins(problem: Problem, less_m: float) -> Problem:
    """The same question with lower margins."""
    return replace(problem, collision=lower_margins(problem.collision, less_m))


def _measure_need(problem: Problem, q: Floats) -> float:
    """By how much margins must be lower for `q` [N], m."""
    model = problem.collision
    return float((model.limit_m - compute_gaps(model, q)[len(model.pairs) :]).max(initial=0.0))


def _try_base(problem: Problem, tries: Tries) -> str | None:
    """Whether a short search finds a solution beyond the range of a base that may move."""
    robot = problem.robot
    base = np.isin(robot.joint_names, base_joints(robot)) & robot.is_prismatic & (problem.lower < problem.upper)
    if tries.is_spent or not base.any():
        return None
    grow = np.where(base, 0.5 * (WIDER - 1.0) * (problem.upper - problem.lower), 0.0)
    lower = np.maximum(problem.lower - grow, np.minimum(problem.lower, -MAX_MAGNITUDE))
    upper = np.minimum(problem.upper + grow, np.maximum(problem.upper, MAX_MAGNITUDE))
    q = tries.find(replace(problem, lower=lower, upper=upper))
    if q is None:
        return None
    place = ", ".join(f"{name}={q[k]:.3g} m" for k, name in enumerate(robot.joint_names) if base[k])
    return f"if the base may leave its range: a solution was found at {place}"

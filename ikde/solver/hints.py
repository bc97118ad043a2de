"""What would help where a target was not reached. Each hint is proved by a bound, or was found by trying it."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from ikde.kernels.arrays import REACHED, Floats
from ikde.model.bounds import find_bounds
from ikde.model.robot import MAX_MAGNITUDE, Joint
from ikde.model.target import Target
from ikde.solver.branches import find_beyond
from ikde.solver.digits import round_up
from ikde.solver.engine_table import ENGINES
from ikde.solver.engines.search_state import SearchState
from ikde.solver.problem import Problem
from ikde.solver.proof import prove
from ikde.solver.search import search
from ikde.solver.settings import SolveSettings
from ikde.solver.verify import Bools, Grade, verify_many

WIDER = (
    4.0  # how much wider the ranges of prismatic joints get when a probe asks whether limits are what stands in the way
)
GENEROUS = 100.0  # a best error within this many tolerances is worth a word about the tolerance

TOOL_AXES = {(1.0, 0.0, 0.0): "x axis", (0.0, 1.0, 0.0): "y axis", (0.0, 0.0, 1.0): "z axis"}

Names = Sequence[str]
"""Of joints."""


@dataclass(slots=True)
class Probe:
    """Short searches for one target, within what is left of its time."""

    target: Target
    seed: int
    stream: int
    spent_s: float

    def run(self, problem: Problem, **attempts: int) -> SearchState:
        """A few attempts at a question that may have been changed, at most as many as were asked for."""
        few = ENGINES[problem.settings.engines[-1]].attempts_of_probe
        brief = problem.with_settings(restarts=min(few, problem.settings.restarts or few))
        found = search(brief, [self.target], seed=self.seed, streams=[self.stream], spent_s=self.spent_s, **attempts)
        self.spent_s += float(found.seconds[0])
        return found

    def confirms(self, problem: Problem, found: SearchState) -> bool:
        """Whether the question was answered, in the eyes of plain numpy, too."""
        return bool(found.counts[0, REACHED]) and meets(problem, self.target, found.q[0])


def meets(problem: Problem, target: Target, q: Floats) -> bool:
    """Whether plain numpy accepts `q` [N] as an answer inside the question's own ranges."""
    graded = verify_many(problem.collision, [target], q[None], problem.settings).row(0)
    is_inside = bool(np.all((problem.lower <= q) & (q <= problem.upper)))
    return is_inside and graded.within_tolerance and not graded.colliding_pairs


def hint_at_bounds(problem: Problem, target: Target) -> str:
    """What opens the bounds that exclude a target, or that nothing does."""
    frozen, limiting = problem.frozen, [joint.name for joint in problem.robot.joints if _limits_bounds(joint)]

    def is_open(freed: Names, widened: Names) -> bool:
        return prove(problem.with_ranges(*_open_ranges(problem, freed, widened)), target) == (0.0, 0.0)

    ways = [f"free {_name(freed)}" for freed in _find_fewest(frozen, lambda names: is_open(names, ()))]
    if not ways:
        ways = [
            f"a larger range for {_name(wide)}" for wide in _find_fewest(limiting, lambda names: is_open((), names))
        ]
    if not ways:
        for wide in _find_fewest(limiting, lambda names: is_open(frozen, names)):
            freed = _find_fewest(frozen, lambda names, wide=wide: is_open(names, wide))[0]
            ways.append(f"free {_name(freed)} and a larger range for {_name(wide)}")
    if ways:
        return f"{', or '.join(ways)}: then the bound no longer excludes the target"
    widest = problem.with_ranges(*_open_ranges(problem, frozen, limiting))
    far_m, off_rad = prove(widest, target)
    asked = ["a target closer to the robot"] if far_m > 0.0 else []
    asked += [f"another orientation ({_name_cone(widest, target)})"] if off_rad > 0.0 else []
    return f"{' and '.join(asked)}; no joint range brings the tool there"


def hint_at_branches(problem: Problem, target: Target) -> str | None:
    """The joints that stand in the way of a branch of the closed form that is free of collision."""
    q = find_beyond(problem, target)
    if q is None:
        return None
    wide = problem.with_ranges(np.minimum(problem.lower, q), np.maximum(problem.upper, q))
    if not meets(wide, target, q):
        return None
    outside = (q < problem.lower) | (q > problem.upper)
    names = [joint.name for joint, is_out in zip(problem.robot.joints, outside, strict=True) if is_out]
    return f"a wider range for {', '.join(names)}: a solution was found beyond the limits" if names else None


def hint_at_tolerance(problem: Problem, target: Target, q: Floats, graded: Grade) -> str | None:
    """The tolerances that would accept the best `q` [N], where they are not much larger than those asked for."""
    asked = problem.settings
    position_m = max(asked.position_tolerance_m, _rounded(graded.position_error_m))
    orientation_rad = max(asked.orientation_tolerance_rad, _rounded(graded.orientation_error_rad))
    is_near = position_m <= GENEROUS * asked.position_tolerance_m
    if not is_near or orientation_rad > min(np.pi, GENEROUS * asked.orientation_tolerance_rad):
        return None
    wider = asked.with_changes(position_tolerance_m=position_m, orientation_tolerance_rad=orientation_rad)
    wanted = _name_tolerances(asked, wider)
    if not wanted or not verify_many(problem.collision, [target], q[None], wider).accepted[0]:
        return None
    return f"a tolerance of {wanted} would accept the best"


def hint_at_stream(problem: Problem, target: Target, found: SearchState) -> str | None:
    """The first of the streams 0, 1 .. that were `found` to lead to a solution, if one does."""
    for stream in np.flatnonzero(found.counts[:, REACHED]).tolist():
        if meets(problem, target, found.q[stream]):
            return f"other random numbers: with this seed and stream {stream} a solution was found"
    return None


def try_longer(problem: Problem, probe: Probe) -> str | None:
    """Whether more attempts find a solution."""
    last = problem.settings.engines[-1]
    attempts = {"first_attempt": problem.settings.budget(last), "attempts": ENGINES[last].attempts_of_probe}
    found = probe.run(problem, **attempts)
    return "more restarts: a solution was found by going on" if probe.confirms(problem, found) else None


def try_freeing(problem: Problem, probe: Probe) -> str | None:
    """Whether a short search finds a solution if frozen joints are free."""
    if not problem.frozen:
        return None
    free = problem.with_ranges(*problem.free_ranges)
    if not probe.confirms(free, probe.run(free)):
        return None
    return f"free {', '.join(problem.frozen)}: a solution was found without freezing"


def try_widening(problem: Problem, probe: Probe) -> str | None:
    """Whether a short search finds a solution beyond the limits of the joints that may move."""
    wide = problem.with_ranges(*_widen(problem))
    found = probe.run(wide)
    outside = _leave_ranges(problem, found.q[0])
    if not (outside.any() and probe.confirms(wide, found)):
        return None
    names = [joint.name for joint, is_out in zip(problem.robot.joints, outside, strict=True) if is_out]
    return f"a wider range for {', '.join(names)}: a solution was found beyond the limits"


def _limits_bounds(joint: Joint) -> bool:
    """Whether a wider range may open a bound: the range of a revolute joint does not count, unless it is a point."""
    return joint.kind == "prismatic" or joint.lower == joint.upper


def _open_ranges(problem: Problem, freed: Names, widened: Names) -> tuple[Floats, Floats]:
    """The ranges with some frozen joints free, and some of the joints that may move as wide as can be."""
    robot, is_free = problem.robot, np.isin(problem.robot.joint_names, freed)
    is_wide = np.isin(robot.joint_names, widened) & (is_free | ~np.isin(robot.joint_names, problem.frozen))
    lower, upper = np.where(is_free, [robot.lower, robot.upper], [problem.lower, problem.upper])
    return np.where(is_wide, -MAX_MAGNITUDE, lower), np.where(is_wide, MAX_MAGNITUDE, upper)


def _widen(problem: Problem) -> tuple[Floats, Floats]:
    """Prismatic joints with ranges four times as wide, revolute ones free to rotate once; what is frozen stays."""
    prismatic, is_frozen = problem.robot.is_prismatic, np.isin(problem.robot.joint_names, problem.frozen)
    grow = 0.5 * (WIDER - 1.0) * (problem.upper - problem.lower)
    lower = np.where(prismatic, np.maximum(problem.lower - grow, -MAX_MAGNITUDE), np.minimum(problem.lower, -np.pi))
    upper = np.where(prismatic, np.minimum(problem.upper + grow, MAX_MAGNITUDE), np.maximum(problem.upper, np.pi))
    return np.where(is_frozen, problem.lower, lower), np.where(is_frozen, problem.upper, upper)


def _name_cone(problem: Problem, target: Target) -> str:
    """What the joints keep, however they rotate, and the target asks for otherwise."""
    cone = find_bounds(problem.robot, problem.lower, problem.upper).orientation.find_worst(target)
    direction = TOOL_AXES.get(cone.tool, f"direction {_numbers(cone.tool)}")
    angles = " to ".join(dict.fromkeys(f"{angle:.3f}" for angle in (cone.low, cone.high)))
    return f"the tool's {direction} stays {angles} rad from {_numbers(cone.world)} of the world"


def _numbers(vector: Sequence[float]) -> str:
    return " ".join(f"{value + 0.0:.3g}" for value in np.round(vector, 6).tolist())  # no -0


def _leave_ranges(problem: Problem, q: Floats) -> Bools:
    """Which joints of `q` [N] stand outside their ranges, whatever whole turns are taken [N]."""
    lower, upper, period = problem.lower, problem.upper, np.where(problem.robot.is_prismatic, 0.0, 2.0 * np.pi)
    shifted = q + period * np.ceil((lower - q) / (2.0 * np.pi))
    return ~((lower <= q) & (q <= upper)) & ~((lower <= shifted) & (shifted <= upper))


def _find_fewest(names: Names, helps: Callable[[Names], bool]) -> list[Names]:
    """Each of `names` that is enough alone; else one set that is and could spare none; none if not even all are."""
    alone: list[Names] = [(name,) for name in names if helps((name,))]
    if alone or not helps(names):
        return alone
    together = tuple(names)
    for name in names:
        fewer = tuple(other for other in together if other != name)
        together = fewer if helps(fewer) else together
    return [together]


def _name(names: Names) -> str:
    return " and ".join(names)


def _rounded(error: float) -> float:
    return round_up(error) if error > 0.0 else 0.0


def _name_tolerances(asked: SolveSettings, wider: SolveSettings) -> str:
    """Those that are wider than what was asked for."""
    words = []
    if wider.position_tolerance_m > asked.position_tolerance_m:
        words.append(f"{wider.position_tolerance_m:.2g} m")
    if wider.orientation_tolerance_rad > asked.orientation_tolerance_rad:
        words.append(f"{wider.orientation_tolerance_rad:.2g} rad")
    return " and ".join(words)

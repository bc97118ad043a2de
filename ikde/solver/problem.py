"""One kind of question, ready to be searched: robot, collision model, settings, and the ranges that hold."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ikde.errors import InputError, quoted
from ikde.kernels.arrays import FEASIBILITY, IGNORE, REJECT, CollisionArrays, Floats, RobotArrays, SearchArrays
from ikde.kernels.mutation import REPAIRS, STRATEGIES
from ikde.model.collision_model import CollisionChoice, CollisionModel
from ikde.model.numbers import is_number
from ikde.model.pack import pack_robot
from ikde.model.robot import MAX_MAGNITUDE, Robot
from ikde.solver.joints import JointValues, read_joints
from ikde.solver.motion import Weights, read_weights
from ikde.solver.settings import SolveSettings
from ikde.solver.standing import find_model

Freeze = Mapping[str, float | None] | Iterable[str]

NEAR_FIRST_BOX = 1.0 / 64.0  # half-width of the first box around `near`, as a share of each joint range
SEARCHED_TURNS = 2.0  # either way, of a joint without limits: half to a seed, and 12 steps of `lm` are one and a half
ROUNDING = 1e-12  # m, rad: the search keeps this far from every bound, so that rounding cannot turn `verify`'s verdict


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Problem:
    """Everything about a search but the target and the seed."""

    collision: CollisionModel
    settings: SolveSettings
    lower: Floats
    upper: Floats
    """[N] joint ranges, all finite; a frozen joint's are equal."""
    near: Floats | None
    frozen: tuple[str, ...]
    weights: Floats
    """[N] of the joints in the motion from `centre`, per m or rad."""
    descends: bool = True
    """Whether what is found is moved to a local minimum of the motion from `near`."""

    def __repr__(self) -> str:
        """In a line: what may move, and near what."""
        held = f", {len(self.frozen)} frozen" if self.frozen else ""
        return f"<Problem {self.robot.name}, detector {self.collision.name}{held}{', near' * (self.near is not None)}>"

    @property
    def robot(self) -> Robot:
        """The robot of the collision model."""
        return self.collision.robot

    @property
    def centre(self) -> Floats:
        """[N] what joints are unwound towards, by whole turns, and motions begin at: `near`, else home."""
        return self.robot.home if self.near is None else self.near

    @property
    def drawn(self) -> tuple[Floats, Floats]:
        """Ranges [N] that seeds are drawn from: of a continuous joint one turn about home, wherever it may search."""
        if not self.robot.has_continuous:
            return self.lower, self.upper
        turns_freely = np.isinf(self.robot.lower) & (self.lower < self.upper)
        lower, upper = self.robot.drawn
        return np.where(turns_freely, lower, self.lower), np.where(turns_freely, upper, self.upper)

    @property
    def free_ranges(self) -> tuple[Floats, Floats]:
        """The ranges [N] with nothing frozen."""
        return self.robot.finite_limits(self.centre, SEARCHED_TURNS)

    @property
    def turns(self) -> tuple[Floats, Floats, NDArray[np.bool_], Floats]:
        """What `kernels.turns.unwind` takes beside q: lower, upper, is_revolute and centre, each [N].

        Inside the ranges of the problem and the robot's limits: no turn leads beyond them where a probe asks what
        wider ranges would bring.
        """
        robot = self.robot
        lower, upper = np.maximum(self.lower, robot.lower), np.minimum(self.upper, robot.upper)
        return lower, upper, ~robot.is_prismatic, self.centre

    @property
    def is_fixed(self) -> bool:
        """Whether no joint may move."""
        return bool((self.lower == self.upper).all())

    def with_ranges(self, lower: Floats, upper: Floats) -> "Problem":
        """The same question with other joint ranges and nothing frozen."""
        return replace(self, lower=lower, upper=upper, frozen=())

    def without_obstacle(self, name: str) -> "Problem":
        """The same question in a world without one obstacle."""
        model = self.collision
        kept = model.own.in_world(model.world.remove(name), model.margin_m, dict(model.margins_m))
        return replace(self, collision=kept)

    def with_settings(self, **changes: object) -> "Problem":
        """The same question with some settings changed."""
        return replace(self, settings=self.settings.with_changes(**changes))


def make_problem(
    robot: Robot,
    settings: SolveSettings,
    *,
    collision: CollisionChoice,
    near: JointValues | None,
    freeze: Freeze | None,
    weights: Weights | None = None,
) -> Problem:
    """Resolve names and ranges; raises `InputError` for what does not fit the robot."""
    start = None if near is None else read_joints(robot, near, default=robot.home, argument="near")
    if start is not None and start.ndim != 1:
        raise InputError(f"expected one configuration, got shape {start.shape}", ("near",))
    centre = robot.home if start is None else start
    lower, upper = robot.finite_limits(centre, SEARCHED_TURNS)
    fixed = _read_freeze(robot, freeze, centre)
    for name, value in fixed.items():
        index = robot.joint_names.index(name)
        joint = robot.joints[index]
        if not joint.lower <= value <= joint.upper:
            limits = f"[{joint.lower:g}, {joint.upper:g}]"
            raise InputError(f"{value:g} is outside the limits {limits}", ("freeze", name))
        lower[index] = upper[index] = value
    model = find_model(robot, collision)
    return Problem(
        collision=model,
        settings=settings,
        lower=lower,
        upper=upper,
        near=None if start is None else np.minimum(np.maximum(start, lower), upper),
        frozen=tuple(fixed),
        weights=read_weights(robot, weights),
    )


def _read_freeze(robot: Robot, freeze: Freeze | None, default: Floats) -> dict[str, float]:
    if freeze is None:
        return {}
    names = [freeze] if isinstance(freeze, str) else freeze
    names = names if isinstance(names, Mapping) or not isinstance(names, Iterable) else list(names)
    if not isinstance(names, Mapping | list) or not all(isinstance(name, str) for name in names):
        raise InputError(f"expected names of joints, or values by name, got {quoted(freeze)}", ("freeze",))
    given = dict(names) if isinstance(names, Mapping) else dict.fromkeys(names)
    start = dict(zip(robot.joint_names, default, strict=True))
    values = {name: start.get(name, 0.0) if value is None else value for name, value in given.items()}
    if all(name in start and is_number(value) and abs(value) <= MAX_MAGNITUDE for name, value in values.items()):
        return {name: float(value) for name, value in values.items()}
    resolved = read_joints(robot, values, default=default, argument="freeze")
    return {name: float(resolved[robot.joint_names.index(name)]) for name in values}


def shrink(tolerance: float) -> float:
    """A tolerance a hair smaller, so that rounding cannot turn `verify`'s verdict."""
    return tolerance - min(ROUNDING, 0.5 * tolerance)


def pack_searched(collision: CollisionModel) -> tuple[RobotArrays, CollisionArrays]:
    """Robot and collision model as all searches take them: with the safe distance that leaves room for rounding."""
    arrays = collision.arrays
    return pack_robot(collision.robot), arrays._replace(safe_distance=arrays.safe_distance + ROUNDING)


def pack_search(problem: Problem) -> SearchArrays:
    """The search's arrays for the kernels."""
    settings, de = problem.settings, problem.settings.evolution
    rules = {"reject": REJECT, "feasibility": FEASIBILITY}
    near = 0.5 * (problem.lower + problem.upper) if problem.near is None else problem.near
    return SearchArrays(
        ranges=np.array([problem.lower, problem.upper, near]),
        first_box=1.0 if problem.near is None else NEAR_FIRST_BOX,
        start_share=float(de.start_share),
        position_tolerance=shrink(settings.position_tolerance_m),
        orientation_tolerance=shrink(settings.orientation_tolerance_rad),
        population=int(de.population),
        generations=int(de.generations),
        strategy=STRATEGIES.index(de.strategy),
        weight=float(de.weight),
        crossover=float(de.crossover),
        repair=REPAIRS.index(de.bounds),
        in_place=de.update == "in_place",
        collision_rule=rules[de.collision] if problem.collision.pairs else IGNORE,
    )

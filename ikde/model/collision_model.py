"""What may collide with what: the pairs of components that are compared, and the distance that is still safe."""

from collections import Counter
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations
from typing import Union

from ikde.errors import InputError, nearest, quoted
from ikde.kernels.arrays import CollisionArrays
from ikde.model.arguments import RobotLike, read_robot
from ikde.model.names import check_printable
from ikde.model.numbers import is_number
from ikde.model.pack import pack_collision
from ikde.model.robot import MAX_MAGNITUDE, NO_DETECTOR, Detector, LeftOutPair, Pairs, Robot, Spheres
from ikde.model.spheres import Sphere, expand_rows
from ikde.model.tree import build_tree

NAMED = 3  # pairs in a message that is about many
MAX_PAIRS, MAX_SPHERE_PAIRS = 50_000, 2_000_000  # of components in a list, and of spheres that a detector compares

CollisionChoice = Union[str, Detector, "CollisionModel", None]
"""How a caller names a collision model: a detector's name, `"none"`, a `Detector`, a model, or None for the default."""


@dataclass(frozen=True, kw_only=True, repr=False)
class CollisionModel:
    """A robot and what is compared on it. Without a detector no pair is: nothing is checked, nothing is called free."""

    robot: Robot
    detector: Detector | None

    def __repr__(self) -> str:
        """In a line, whatever the robot."""
        return f"<CollisionModel {self.robot.name}: detector {self.name}, {len(self.pairs)} pairs>"

    @classmethod
    def of(cls, robot: RobotLike, choice: CollisionChoice = None) -> "CollisionModel":
        """Resolve a choice; raises `InputError` for an unknown name, or for what does not fit the robot."""
        robot = read_robot(robot)
        if isinstance(choice, CollisionModel):
            if choice.robot != robot:
                other = f"this is a model of another Robot object ({choice.robot.name}), not of this {robot.name}"
                raise InputError(other, ("collision",))
            _ = choice.is_checked
            return choice
        if isinstance(choice, Detector):
            check_detector(robot, choice, ("detector",))
            return cls(robot=robot, detector=choice)
        name = robot.default_detector if choice is None else choice
        if not isinstance(name, str):
            raise InputError(f"expected a name, a Detector or a CollisionModel, got {quoted(name)}", ("collision",))
        if name == NO_DETECTOR:
            return cls(robot=robot, detector=None)
        if name not in robot.detectors:
            known = ", ".join([*robot.detectors, NO_DETECTOR])
            raise InputError(f"{robot.name} has no detector {name!r}; it has {known}")
        return cls(robot=robot, detector=robot.detectors[name])

    @cached_property
    def is_checked(self) -> bool:
        """True, found out once: checking walks all pairs; raises `InputError` for what does not fit the robot."""
        if self.detector is not None:
            check_detector(self.robot, self.detector, ("collision", "detector"))
        return True

    def __getstate__(self) -> dict[str, object]:
        """Without the packed arrays: pickled ones come back writable, which numba takes for another type."""
        return {"robot": self.robot, "detector": self.detector}

    @property
    def name(self) -> str:
        """The detector's, or `"none"`."""
        return self.detector.name if self.detector else NO_DETECTOR

    @property
    def limit_m(self) -> float:
        """The safe distance: a clearance at or below it is a collision; 0 without a detector."""
        return self.detector.safe_distance_m if self.detector else 0.0

    @property
    def rows(self) -> tuple[Spheres, ...]:
        """Rows of spheres of all components, compared or not; none without a detector."""
        return self.robot.approximations[self.detector.spheres] if self.detector else ()

    @cached_property
    def pairs(self) -> Pairs:
        """Pairs of components that are compared; none without a detector."""
        return self.robot.pair_lists[self.detector.pairs] if self.detector else ()

    @property
    def left_out_pairs(self) -> tuple[LeftOutPair, ...]:
        """All other pairs of components, and why they are left out; none without a detector."""
        if self.detector is None:
            return ()
        compared = {frozenset(pair) for pair in self.pairs}
        reasons = {frozenset((pair.a, pair.b)): pair.reason for pair in self.robot.neighbours}
        unlisted = f"not in the pair list {self.detector.pairs}"
        return tuple(
            LeftOutPair(a=a, b=b, reason=reasons.get(frozenset((a, b)), unlisted))
            for a, b in combinations(self.robot.components(self.detector.spheres), 2)
            if frozenset((a, b)) not in compared
        )

    @cached_property
    def spheres(self) -> tuple[Sphere, ...]:
        """All spheres of its components, compared or not, each on its body; none without a detector."""
        if self.detector is None:
            return ()
        return tuple(expand_rows(self.robot, build_tree(self.robot), self.detector.spheres))

    @cached_property
    def arrays(self) -> CollisionArrays:
        """Packed for the kernels."""
        return pack_collision(self.robot, self.detector)


def check_detector(robot: Robot, detector: Detector, where: tuple[str | int, ...]) -> None:
    """Raise `InputError` unless the detector's names exist, and it compares pairs that its approximation describes."""
    if not isinstance(detector, Detector):
        raise InputError(f"expected a Detector, got {quoted(detector)}", where)
    for key, what, name, known in (
        ("spheres", "approximation", detector.spheres, robot.approximations),
        ("pairs", "pair list", detector.pairs, robot.pair_lists),
    ):
        if name not in known:
            raise InputError(f"no {what} is called {name!r}{nearest(name, known)}", (*where, key))
    check_printable(detector.name, (*where, "name"))
    if detector.name == NO_DETECTOR:
        raise InputError(f"{NO_DETECTOR!r} is taken: it stands for no detector at all", where or ("name",))
    distance = detector.safe_distance_m
    if not (is_number(distance) and 0.0 <= distance <= MAX_MAGNITUDE):
        raise InputError(f"expected a distance of at least 0, up to {MAX_MAGNITUDE:g} m", (*where, "safe_distance"))
    described = robot.components(detector.spheres)
    if not described:
        raise InputError(f"this detector compares nothing: {detector.spheres!r} has no spheres", (*where, "spheres"))
    collision = CollisionModel(robot=robot, detector=detector)
    if not collision.pairs:
        raise InputError(f"this detector compares nothing: {_explain_no_pairs(collision)}", (*where, "pairs"))
    for component in {c for pair in collision.pairs for c in pair}:
        if component not in described:
            raise InputError(
                f"the approximation {detector.spheres!r} has no component {component!r}", (*where, "pairs")
            )
    _check_size(collision, where)


def _check_size(collision: CollisionModel, where: tuple[str | int, ...]) -> None:
    """Comparing takes time with every pair, also where a file is only shown."""
    pairs = collision.pairs
    if len(pairs) > MAX_PAIRS:
        raise InputError(f"expected at most {MAX_PAIRS:,} pairs of components, got {len(pairs):,}", (*where, "pairs"))
    spheres: Counter[str] = Counter()
    for row in collision.rows:
        spheres[row.component] += row.count
    compared = sum(spheres[a] * spheres[b] for a, b in pairs)
    if compared > MAX_SPHERE_PAIRS:
        message = f"expected at most {MAX_SPHERE_PAIRS:,} pairs of spheres to compare, got {compared:,}"
        raise InputError(message, (*where, "spheres"))


def _explain_no_pairs(collision: CollisionModel) -> str:
    left_out = collision.left_out_pairs
    if not left_out:
        return f"{collision.rows[0].component!r} is the only component"
    named = ", ".join(f"{pair.a} - {pair.b} ({pair.reason})" for pair in left_out[:NAMED])
    more = f" and {len(left_out) - NAMED} more" if len(left_out) > NAMED else ""
    return f"{'the only pair is' if len(left_out) == 1 else f'all {len(left_out)} pairs are'} left out: {named}{more}"

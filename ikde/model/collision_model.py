"""What may collide with what: the pairs of components that are compared, and the distance that is still safe."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Any, Union

import numpy as np
from numpy.typing import NDArray

from ikde.errors import InputError, nearest, quoted
from ikde.kernels.arrays import CollisionArrays, Floats, Ints, read_only
from ikde.model.arguments import RobotLike, read_robot
from ikde.model.carried import carry
from ikde.model.detectors import check_detector, list_left_out
from ikde.model.numbers import is_number
from ikde.model.pack import pack_collision
from ikde.model.pack_world import WorldPacker, find_fixed_frames
from ikde.model.robot import MAX_MAGNITUDE, NO_DETECTOR, Detector, LeftOutPair, Pairs, Robot, Spheres
from ikde.model.spheres import Sphere, expand_rows
from ikde.model.tree import build_tree
from ikde.model.world import NOTHING, Attached, Obstacle, World

FIELDS = ("robot", "detector", "world", "margin_m", "margins_m")
CollisionChoice = Union[str, Detector, World, "CollisionModel", None]
"""How a caller names a collision model: a detector's name, `"none"`, a `Detector`, a `World` (beside the default
detector), a model, or None for the default."""


@dataclass(frozen=True, kw_only=True, repr=False)
class CollisionModel:
    """A robot and what is compared: on it, and with a world.

    Without a detector no pair is: nothing is checked, nothing is called free.
    """

    robot: Robot
    detector: Detector | None
    world: World = NOTHING
    """What stands around."""
    margin_m: float = 0.0
    """The distance that is kept from all of it, beside each obstacle's own margin; the safe distance is for the robot's
    own pairs."""
    margins_m: tuple[tuple[str, float], ...] = ()
    """Components that keep another distance in its place."""

    def __repr__(self) -> str:
        """In a line, whatever the robot."""
        return f"<CollisionModel {self.robot.name}: detector {self.name}, {len(self.pairs)} pairs>"

    def __hash__(self) -> int:
        """Computed once: it is a key of all that is prepared for a model."""
        return self._hash

    @cached_property
    def _hash(self) -> int:
        return hash((self.robot, self.detector, self.world, self.margin_m, self.margins_m))

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
        if isinstance(choice, World):
            return cls.of(robot).in_world(choice)
        if isinstance(choice, Detector):
            check_detector(robot, choice, ("detector",))
            return cls(robot=robot, detector=choice)
        name = robot.default_detector if choice is None else choice
        if not isinstance(name, str):
            raise InputError(
                f"expected a name, a Detector, a World or a CollisionModel, got {quoted(name)}", ("collision",)
            )
        if name == NO_DETECTOR:
            return cls(robot=robot, detector=None)
        if name not in robot.detectors:
            known = ", ".join([*robot.detectors, NO_DETECTOR])
            raise InputError(f"{robot.name} has no detector {name!r}; it has {known}")
        return _with_detector(robot, name)

    @cached_property
    def is_checked(self) -> bool:
        """True, found out once: checking walks all pairs; raises `InputError` for what does not fit the robot."""
        if self.own is not self:
            return self.own.is_checked
        if self.detector is not None:
            check_detector(self.robot, self.detector, ("collision", "detector"))
        return True

    def __getstate__(self) -> dict[str, object]:
        """Without the packed arrays: pickled ones come back writable, which numba takes for another type."""
        known = ("robot", "detector") if self.world is NOTHING else FIELDS
        return {name: getattr(self, name) for name in known}

    @cached_property
    def own(self) -> "CollisionModel":
        """The same without a world: what is prepared for a robot depends on no world."""
        return self if self.world is NOTHING else CollisionModel(robot=self.robot, detector=self.detector)

    @cached_property
    def laden(self) -> "CollisionModel":
        """That of the robot with what is attached to it as parts of its own, without a world; `own` if nothing is.

        Nothing is written or compiled for it: its pairs stand behind the robot's own.
        """
        return _lade(self.own, self.world.attached) if self.world.attached else self.own

    @property
    def is_in_world(self) -> bool:
        """Whether more is compared than the robot with itself: something stands around, or is attached."""
        return bool(self.obstacles or self.world.attached)

    def in_world(
        self, world: World, margin_m: float = 0.0, margins_m: Mapping[str, float] | None = None
    ) -> "CollisionModel":
        """The same robot among obstacles.

        Args:
            world: what stands around.
            margin_m: the distance that is kept from all of it, beside each obstacle's own margin, m.
            margins_m: components that keep another distance in its place, by name, m.

        Raises:
            InputError: for what does not fit the robot. What touches it in every configuration is refused by `solve`,
                `check` and all others that are asked in this world.
        """
        if not isinstance(world, World):
            raise InputError(f"expected a World, got {quoted(world)}", ("world",))
        if not self.pairs:
            raise InputError("a world needs a detector: without spheres nothing can be compared with it", ("world",))
        own, given = self.own, {} if margins_m is None else margins_m
        known = _lade(own, world.attached).components if world.attached else own.components
        if not isinstance(given, Mapping):
            raise InputError(f"expected distances by component, got {quoted(given)}", ("margins_m",))
        for name, value in (("", margin_m), *given.items()):
            if name and name not in known:
                raise InputError(f"no component is called {name!r}{nearest(name, known)}", ("margin", name))
            if not (is_number(value) and 0.0 <= value <= MAX_MAGNITUDE):
                where = ("margin", name) if name else ("margin",)
                most = f", up to {MAX_MAGNITUDE:g} m" if is_number(value) and value > 0.0 else " m"
                raise InputError(f"expected a distance of at least 0{most}, got {quoted(value)}", where)
        _check_touching(world, own.components)
        kept = tuple((name, float(value)) for name, value in given.items())
        model = CollisionModel(
            robot=own.robot, detector=own.detector, world=world, margin_m=float(margin_m), margins_m=kept
        )
        vars(model)["own"] = own  # what is known of it is found once for all worlds
        _ = model.arrays
        return model

    def kept_m(self, component: str) -> float:
        """The distance that a component keeps from an obstacle, beside the obstacle's own margin, m."""
        own_m = next((thing.obstacle.margin_m for thing in self.world.attached if thing.name == component), 0.0)
        return dict(self.margins_m).get(component, self.margin_m) + own_m

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
        if self.laden is not self:
            return self.laden.rows
        return self.robot.approximations[self.detector.spheres] if self.detector else ()

    @cached_property
    def pairs(self) -> Pairs:
        """Pairs of components that are compared; none without a detector."""
        if self.laden is not self:
            return self.laden.pairs
        return self.robot.pair_lists[self.detector.pairs] if self.detector else ()

    @property
    def left_out_pairs(self) -> tuple[LeftOutPair, ...]:
        """All other pairs of components, and why they are left out; none without a detector."""
        return () if self.detector is None else list_left_out(self.laden.robot, self.detector)

    @cached_property
    def spheres(self) -> tuple[Sphere, ...]:
        """All spheres of its components, compared or not, each on its body; none without a detector."""
        if self.laden is not self:
            return self.laden.spheres
        if self.detector is None:
            return ()
        return tuple(expand_rows(self.robot, build_tree(self.robot), self.detector.spheres))

    @cached_property
    def components(self) -> tuple[str, ...]:
        """Of the spheres, in their order; with a world they are all packed, else those that have a pair."""
        if self.laden is not self:
            return self.laden.components
        return tuple(dict.fromkeys(sphere.component for sphere in self.spheres))

    @cached_property
    def fixed_components(self) -> tuple[str, ...]:
        """Those that no joint moves: they are not compared with a world, which does not move either."""
        if self.laden is not self:
            return self.laden.fixed_components
        bodies = {sphere.component: sphere.body for sphere in self.spheres}
        return tuple(name for name, body in bodies.items() if body == 0)

    @cached_property
    def obstacles(self) -> tuple[Obstacle, ...]:
        """What counts of the world."""
        return self.world.active

    @cached_property
    def counted(self) -> Pairs:
        """What may be to blame for a collision: the pairs, then the robot and each obstacle."""
        return (*self.pairs, *((self.robot.name, obstacle.name) for obstacle in self.obstacles))

    @cached_property
    def all_pairs(self) -> Pairs:
        """Of the table of clearances: the pairs of components, then each component and obstacle."""
        return (*self.pairs, *((name, obstacle.name) for name in self.components for obstacle in self.obstacles))

    def name_pair(self, place: int) -> tuple[str, str]:
        """The pair of a place in the table of clearances."""
        if place < len(self.pairs):
            return self.pairs[place]
        component, obstacle = divmod(place - len(self.pairs), len(self.obstacles))
        return self.components[component], self.obstacles[obstacle].name

    def fold(self, table: NDArray[Any]) -> NDArray[Any]:
        """Flags of pairs, and of components and obstacles [..., P + C O], as those of `counted` [..., P + O]."""
        pairs, obstacles = len(self.pairs), len(self.obstacles)
        if not obstacles:
            return table
        blocks = table[..., pairs:].reshape(*table.shape[:-1], len(self.components), obstacles)
        return np.concatenate([table[..., :pairs], blocks.any(axis=-2)], axis=-1)

    def clearances_m(self, least: Floats, places: Ints) -> Floats:
        """Distances [T] of graders, which are less what is asked for beyond the safe distance, as what they are, m."""
        if not self.obstacles:
            return least
        return least + self.extras_m[places]

    @cached_property
    def extras_m(self) -> Floats:
        """What each of `all_pairs` is asked for beyond the safe distance, m: distances of graders are less by it."""
        margins_m = np.array([obstacle.margin_m for obstacle in self.obstacles], dtype=float)
        of_world = self._list_kept_m()[:, None] + margins_m - self.limit_m
        return read_only(np.concatenate([np.zeros(len(self.pairs)), of_world.ravel()]))

    def extra_m(self, place: int) -> float:
        """What one of them is asked for, m."""
        return self.extras_m.item(place)

    @cached_property
    def arrays(self) -> CollisionArrays:
        """Packed for the kernels."""
        if not self.is_in_world:
            return pack_collision(self.robot, self.detector)
        arrays, packer, is_fixed = self.laden._whole
        kept_m = self._list_kept_m()
        kept_m[is_fixed] = -np.inf
        return arrays._replace(world=packer.pack(self.world, kept_m))

    @cached_property
    def _whole(self) -> tuple[CollisionArrays, WorldPacker, NDArray[np.bool_]]:
        """All components packed; what packs worlds for them; and which no joint moves [C]."""
        arrays = pack_collision(self.robot, self.detector, every=True)
        is_fixed = np.array([name in self.fixed_components for name in self.components], dtype=bool)
        reach_m = float(arrays.bounds[:, 3].max())
        packer = WorldPacker(self.components, find_fixed_frames(self.robot), reach_m, self._attached_pairs)
        return arrays, packer, is_fixed

    @cached_property
    def _attached_pairs(self) -> int:
        """How many of the pairs, the last ones, no written kernel knows; only of what `_lade` makes are there some."""
        return 0

    def _list_kept_m(self) -> Floats:
        """The distance that each component keeps [C], m."""
        if not (self.margins_m or self.world.attached):
            return np.full(len(self.components), self.margin_m)
        others, own_m = dict(self.margins_m), {thing.name: thing.obstacle.margin_m for thing in self.world.attached}
        return np.array([others.get(c, self.margin_m) + own_m.get(c, 0.0) for c in self.components], dtype=float)


@lru_cache(maxsize=64)
def _with_detector(robot: Robot, name: str) -> CollisionModel:
    """The same object whenever it is asked for: what is known of it is found once."""
    return CollisionModel(robot=robot, detector=robot.detectors[name])


@lru_cache(maxsize=16)
def _lade(own: CollisionModel, attached: tuple[Attached, ...]) -> CollisionModel:
    """The same object for the same things at the same places: what is known of it is found once."""
    assert own.detector is not None
    laden = CollisionModel(robot=carry(own.robot, own.detector, attached), detector=own.detector)
    vars(laden)["_attached_pairs"] = len(laden.pairs) - len(own.pairs)
    return laden


def _check_touching(world: World, components: tuple[str, ...]) -> None:
    """Raise `InputError` for what may be touched and is nothing, or two things."""
    known = (*components, *world.names, *(thing.name for thing in world.attached))
    for thing in world.attached:
        for name in thing.may_touch:
            if name not in known:
                message = f"no component and no obstacle is called {name!r}{nearest(name, known)}"
                raise InputError(message, ("attached", thing.name, "may_touch"))
            if name in components and name in world.names:
                message = f"{name!r} is a component and an obstacle: give one of them another name"
                raise InputError(message, ("attached", thing.name, "may_touch"))

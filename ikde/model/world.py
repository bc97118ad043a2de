"""A world of obstacles, as values: named, posed, each with a margin of its own. Worlds never become types or text."""

import hashlib
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from importlib import import_module
from typing import cast

import numpy as np
from numpy.typing import ArrayLike

from ikde.errors import InputError, nearest, quoted
from ikde.kernels.arrays import Floats
from ikde.model.arguments import HasDetector, Pose, RobotLike, find_matrix
from ikde.model.names import check_printable
from ikde.model.numbers import is_number
from ikde.model.robot import MAX_MAGNITUDE, WORLD
from ikde.model.solids import Solid, read_pose
from ikde.model.value import ByFields

MAX_OBSTACLES = MAX_SOLIDS = 100_000


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Obstacle(ByFields):
    """Solids that stand together under one name."""

    name: str
    solids: tuple[Solid, ...]
    T_world_obstacle: Floats
    """[3, 4]; rotation and m, read-only. In the world, or in `frame`."""
    frame: str = WORLD
    """A frame of the robot that no joint moves, if it does not stand in the world's."""
    margin_m: float = 0.0
    """Added to the distance that is asked for from everything else."""
    ignore: tuple[str, ...] = ()
    """Components of the robot that may touch it."""
    group: str | None = None
    """What it is switched with."""

    def __repr__(self) -> str:
        kinds = list(dict.fromkeys(solid.kind for solid in self.solids))
        place = ", ".join(f"{value:g}" for value in self.T_world_obstacle[:, 3])
        return f"<Obstacle {self.name}: {len(self.solids)} solids ({', '.join(kinds)}) at {place} m in {self.frame}>"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Attached(ByFields):
    """An object that a frame of the robot holds: spheres that are compared as one more component of the robot."""

    obstacle: Obstacle
    """What it is, and where it stood when it was picked up."""
    frame: str
    """The frame of the robot that holds it."""
    T_frame_object: Floats
    """[3, 4]; rotation and m, read-only."""
    spheres: Floats
    """[n, 4] centre in the object's frame and radius, m; read-only."""
    protrusion_m: float | None
    """How far the spheres stand out of the object at most, m; None of spheres that were given."""
    may_touch: tuple[str, ...] = ()
    """Components of the robot, obstacles and other attached objects that it may touch."""
    place: int | None = field(default=None, compare=False)
    """Which obstacle it was, with all that is attached where it stood before: there it is put back; None: the last."""

    @property
    def name(self) -> str:
        """The object's."""
        return self.obstacle.name

    def __repr__(self) -> str:
        fat = "given" if self.protrusion_m is None else f"{1e3 * self.protrusion_m:.3g} mm beyond it at most"
        touch = f", may touch {', '.join(self.may_touch)}" if self.may_touch else ""
        return f"<Attached {self.name} to {self.frame}: {len(self.spheres)} spheres, {fat}{touch}>"


@dataclass(frozen=True, kw_only=True, eq=False)
class World(ByFields):
    """Obstacles by name, in their order, and what the robot holds. It stays as it is: `add`, `move`, `remove`,
    `switch`, `attach` and `detach` give another one.

    Equal are two of the same numbers and names, to the bit, also after pickling or copying.

    Raises:
        InputError: for what is no obstacle, for two of one name, and for a group that is switched off but none's.
    """

    obstacles: tuple[Obstacle, ...] = ()
    switched_off: frozenset[str] = field(default_factory=frozenset)
    """Groups that do not count."""
    attached: tuple[Attached, ...] = ()
    """What frames of the robot hold, in the order in which it was picked up: no obstacles any more."""

    def __post_init__(self) -> None:
        found: dict[str, Obstacle] = {}
        for name, given in (("obstacles", self.obstacles), ("switched_off", self.switched_off)):
            if isinstance(given, str) or not isinstance(given, Iterable):
                what = "obstacles" if name == "obstacles" else "names of groups"
                raise InputError(f"expected {what} in a sequence, got {quoted(given)}", (name,))
            object.__setattr__(self, name, tuple(given))
        for place, obstacle in enumerate(self.obstacles):
            if not isinstance(obstacle, Obstacle):
                raise InputError(f"expected an obstacle of a World, got {quoted(obstacle)}", ("obstacles", place))
            if found.setdefault(obstacle.name, obstacle) is not obstacle or len(found) <= place:
                raise InputError(f"two obstacles are called {obstacle.name!r}", ("obstacles", obstacle.name))
        object.__setattr__(self, "attached", tuple(self.attached))
        for thing in self.attached:
            if not isinstance(thing, Attached):
                raise InputError(f"expected what World.attach makes, got {quoted(thing)}", ("attached",))
            if found.setdefault(thing.name, thing.obstacle) is not thing.obstacle or thing.name in self.names:
                message = f"{thing.name!r} is attached to {thing.frame}, and another object has its name"
                raise InputError(message, ("attached", thing.name))
        known = dict.fromkeys(self.groups)
        for group in self.switched_off:
            if not isinstance(group, str) or group not in known:
                raise InputError(f"no group is called {quoted(group)}{nearest(str(group), known)}", ("switched_off",))
        object.__setattr__(self, "switched_off", frozenset(self.switched_off))

    @cached_property
    def active(self) -> tuple[Obstacle, ...]:
        """Those that count, in their order."""
        return tuple(o for o in self.obstacles if o.group is None or o.group not in self.switched_off)

    @property
    def names(self) -> tuple[str, ...]:
        """Of all obstacles."""
        return tuple(self._places)

    @property
    def groups(self) -> tuple[str, ...]:
        """Of all obstacles, each once, in the order of their first."""
        return tuple(dict.fromkeys(o.group for o in self.obstacles if o.group is not None))

    @cached_property
    def digest(self) -> str:
        """Of all numbers and names that a verdict depends on."""
        sha = hashlib.sha256()
        for obstacle in self.active:
            sha.update(
                repr((obstacle.name, obstacle.frame, obstacle.margin_m, obstacle.ignore, len(obstacle.solids))).encode()
            )
            sha.update(obstacle.T_world_obstacle.tobytes())
            for solid in obstacle.solids:
                sha.update(repr((solid.kind, solid.size_m)).encode() + solid.T_obstacle_solid.tobytes())
                sha.update(b"" if solid.points is None else solid.points.tobytes())
        for thing in self.attached:
            margin_m, touch = thing.obstacle.margin_m, thing.may_touch
            sha.update(repr(("attached", thing.name, thing.frame, margin_m, touch, len(thing.spheres))).encode())
            sha.update(thing.T_frame_object.tobytes() + thing.spheres.tobytes())
        return sha.hexdigest()

    def __getitem__(self, name: str) -> Obstacle:
        return self.obstacles[self._place(name)]

    def __contains__(self, name: object) -> bool:
        return name in self.names

    def __iter__(self) -> Iterator[Obstacle]:
        return iter(self.obstacles)

    def __len__(self) -> int:
        return len(self.obstacles)

    def __repr__(self) -> str:
        off = f", off: {', '.join(sorted(self.switched_off))}" if self.switched_off else ""
        held = ", ".join(f"{thing.name} to {thing.frame}" for thing in self.attached)
        count = f"{len(self)} obstacle{'s' * (len(self) != 1)}"
        return f"<World of {count}{off}{f', attached: {held}' if held else ''}>"

    def add(self, *obstacles: Obstacle) -> "World":
        """The world with further obstacles."""
        return make_world((*self.obstacles, *obstacles), self.switched_off, self.attached)

    def remove(self, *names: str) -> "World":
        """The world without some obstacles; a group of which none is left is forgotten: what is added to it counts."""
        gone = {self._place(name) for name in names}
        left = tuple(o for place, o in enumerate(self.obstacles) if place not in gone)
        off = self.switched_off & {o.group for o in left if o.group is not None}
        held = tuple(self._forget(thing, gone, names) for thing in self.attached)
        return World(obstacles=left, switched_off=off, attached=held)

    def move(self, name: str, T_world_obstacle: "ArrayLike | Pose") -> "World":
        """The world with an obstacle at another pose [4, 4] or [3, 4], m, or at that of another library."""
        place, T = self._place(name), _read_place(T_world_obstacle)
        moved = replace(self.obstacles[place], T_world_obstacle=T)
        known = {"obstacles": (*self.obstacles[:place], moved, *self.obstacles[place + 1 :]), "_places": self._places}
        world = object.__new__(World)  # of the same names and groups, which are known to be right
        vars(world).update(known, switched_off=self.switched_off, attached=self.attached)
        return world

    def switch(self, /, **groups: bool) -> "World":
        """The world with groups of obstacles on or off."""
        known = dict.fromkeys(self.groups)
        for group, on in groups.items():
            if not isinstance(on, bool | np.bool):
                raise InputError(f"expected True or False, got {quoted(on)}", ("groups", group))
            if group not in known:
                raise InputError(f"no group is called {group!r}{nearest(group, known)}", ("groups", group))
        off = (self.switched_off - groups.keys()) | {group for group, on in groups.items() if not on}
        return replace(self, switched_off=frozenset(off))

    def attach(
        self,
        name: str,
        to: str | None = None,
        *,
        robot: RobotLike | HasDetector | None = None,
        q: ArrayLike | Mapping[str, float] | None = None,
        T_frame_object: "ArrayLike | Pose | None" = None,
        may_touch: Iterable[str] = (),
        spheres: ArrayLike | None = None,
        protrusion_m: float | None = None,
    ) -> "World":
        """The world in which a frame of the robot holds an obstacle, from now on one of the robot's components.

        Its solids become spheres that hold all of it; by how much these stand out of it is said (`attached`). They are
        compared with all components of the robot but those of the body that holds them, at the safe distance, and
        with the obstacles that are left, at the obstacle's own margin beside the others. Nothing is compiled for it.

        Args:
            name: of an obstacle that counts.
            to: a frame of the robot that a joint moves; None: the tool, by `robot`.
            robot: the robot, its name or the path of its file, or a `CollisionModel`: its detector sees what touches.
            q: the joint values [N], m and rad, or by name, at which it is picked up from where it stands; None: home.
                What it touches of the robot there is refused unless it may be touched.
            T_frame_object: its pose [4, 4] in the frame, m, in place of that.
            may_touch: names of components, obstacles and attached objects that it may touch; what the obstacle is
                allowed to touch (`ignore`) is added.
            spheres: [n, 4] centre in the object's frame and radius, m, in place of ikde's own.
            protrusion_m: how far ikde's own may stand out of it, m; None: 5 mm, or as much more as up to 128 take.

        Raises:
            InputError: for what is attached already, an unknown obstacle or frame, a frame that no joint moves, clouds
                and half-spaces, and for what would touch the robot where it is picked up.
        """
        where = {"robot": robot, "q": q, "T_frame_object": T_frame_object}
        how = {"may_touch": may_touch, "spheres": spheres, "protrusion_m": protrusion_m}
        return import_module("ikde.solver.attach").attach(self, name, to, **where, **how)  # on a floor above this one

    def detach(
        self,
        name: str,
        T_world_object: "ArrayLike | Pose | None" = None,
        *,
        robot: RobotLike | None = None,
        q: ArrayLike | Mapping[str, float] | None = None,
    ) -> "World":
        """The world in which an attached object is an obstacle again, at its old place in their order.

        Args:
            name: of what is attached.
            T_world_object: where it is put [4, 4], m; None: where the robot holds it, or where it was picked up.
            robot: the robot that holds it.
            q: the joint values [N], m and rad, or by name, at which it is let go; None: where it was picked up.

        Raises:
            InputError: for what is not attached, or joint values without a robot.
        """
        return import_module("ikde.solver.attach").detach(self, name, T_world_object, robot=robot, q=q)

    def _forget(self, thing: Attached, gone: set[int], names: tuple[str, ...]) -> Attached:
        """What is attached when obstacles are no more: it touches none of them, and stood that much farther ahead."""
        touch, place = tuple(name for name in thing.may_touch if name not in names), thing.place
        if place is not None:
            before = place - sum(other.place is not None and other.place < place for other in self.attached)
            place -= sum(number < before for number in gone)
        return replace(thing, may_touch=touch, place=place)

    @cached_property
    def _places(self) -> dict[str, int]:
        """Where each name stands."""
        return {obstacle.name: place for place, obstacle in enumerate(self.obstacles)}

    def _place(self, name: str) -> int:
        place = self._places.get(name) if isinstance(name, str) else None
        if place is None:
            held = [thing.frame for thing in self.attached if thing.name == name]
            if held:
                raise InputError(f"{name!r} is no obstacle now: it is attached to {held[0]}", ("obstacle",))
            raise InputError(f"no obstacle is called {name!r}{nearest(str(name), self.names)}", ("obstacle",))
        return place


def make_world(
    obstacles: Iterable[Obstacle], switched_off: Iterable[str] = (), attached: Iterable[Attached] = ()
) -> World:
    """A world whose names are known to be right; raises `InputError`."""
    world = World(obstacles=tuple(obstacles), switched_off=frozenset(switched_off), attached=tuple(attached))
    if len(world) > MAX_OBSTACLES:
        raise InputError(f"expected at most {MAX_OBSTACLES:,} obstacles, got {len(world):,}", ("obstacles",))
    count = sum(len(obstacle.solids) for obstacle in world)
    if count > MAX_SOLIDS:
        raise InputError(f"expected at most {MAX_SOLIDS:,} solids in all, got {count:,}", ("obstacles",))
    return world


def make_obstacle(
    name: str,
    solids: Iterable[Solid],
    T_world_obstacle: ArrayLike | None = None,
    *,
    frame: str = WORLD,
    margin_m: float = 0.0,
    ignore: Iterable[str] = (),
    group: str | None = None,
) -> Obstacle:
    """An obstacle that is known to be right; raises `InputError` that names what is wrong."""
    check_printable(name, ("name",))
    check_printable(frame, ("frame",))
    if group is not None:
        check_printable(group, ("group",))
    if isinstance(ignore, str):
        raise InputError(f"expected a list of components, got {ignore!r}", ("ignore",))
    ignored = tuple(ignore)
    for place, component in enumerate(ignored):
        check_printable(component, ("ignore", place))
    if not (is_number(margin_m) and 0.0 <= margin_m <= MAX_MAGNITUDE):
        raise InputError(f"expected a margin of at least 0 m, got {margin_m!r}", ("margin",))
    parts = tuple(solids)
    if not parts:
        raise InputError(f"{name!r} has no solid", ("solids",))
    T = np.eye(4)[:3] if T_world_obstacle is None else T_world_obstacle
    known = {"frame": frame, "margin_m": float(margin_m), "ignore": ignored, "group": group}
    return Obstacle(name=name, solids=parts, T_world_obstacle=read_pose(T, ("T_world_obstacle",)), **known)


def _read_place(given: "ArrayLike | Pose") -> Floats:
    where = ("T_world_obstacle",)
    found = find_matrix(given, where)
    return read_pose(cast(ArrayLike, given) if found is None else found, where)


NOTHING = World()

"""Objects that a robot picks up and lets go of: from an obstacle to a component of the robot, and back."""

from collections.abc import Iterable
from dataclasses import replace
from typing import Any, cast

import numpy as np
from numpy.typing import ArrayLike

from ikde.errors import InputError, nearest, quoted
from ikde.kernels.arrays import Floats
from ikde.model.arguments import HasDetector, Pose, RobotLike, find_matrix, read_robot
from ikde.model.carried import find_carrier
from ikde.model.collision_model import CollisionModel
from ikde.model.names import check_printable
from ikde.model.numbers import is_number, read_numbers
from ikde.model.pack import pack_floats
from ikde.model.robot import MAX_MAGNITUDE, WORLD, Robot
from ikde.model.solids import MIN_SIZE_M, read_pose
from ikde.model.world import Attached, World
from ikde.solver.cover_solid import cover_solids, refuse_endless
from ikde.solver.joints import JointValues, read_configuration
from ikde.solver.plain import compute_frames, compute_gaps
from ikde.spheres.primitives import MAX_SPHERES

FINEST_M = 1e-4  # by which spheres are asked to stand out at most


def attach(
    world: World,
    name: str,
    to: str | None = None,
    *,
    robot: RobotLike | HasDetector | None = None,
    q: JointValues | None = None,
    T_frame_object: ArrayLike | Pose | None = None,
    may_touch: Iterable[str] = (),
    spheres: ArrayLike | None = None,
    protrusion_m: float | None = None,
) -> World:
    """As `World.attach`, which says what all this is."""
    is_model = isinstance(robot, CollisionModel | None)
    model = robot if is_model else CollisionModel.of(read_robot(cast(RobotLike, robot)))
    own = None if model is None else model.robot
    _check_free(world, name)
    obstacle = world[name]
    frame = _choose_frame(own, to)
    values = None if own is None else read_configuration(own, own.home if q is None else q)
    if own is None and q is not None:
        raise InputError("joint values are those of a robot: give `robot`, too", ("robot",))
    if T_frame_object is not None:
        T = _read_place(T_frame_object, "T_frame_object")
    elif own is None or values is None:
        raise InputError(
            "expected `robot` and `q`, where it is picked up, or its pose `T_frame_object`", ("attach", name)
        )
    else:
        Ts_world = compute_frames(own, values)
        T = _find_pose(Ts_world, frame, obstacle.frame, _whole(obstacle.T_world_obstacle), name)
    touch = _read_touch(world, name, may_touch, None if model is None else model.own.components)
    given = None if spheres is None else read_spheres(spheres)
    least_m = FINEST_M if given is None else 0.0
    out_m = None if protrusion_m is None else read_protrusion(protrusion_m, least_m=least_m)
    refuse_endless(obstacle.solids)
    cover = (given, out_m) if given is not None else cover_solids(obstacle.solids, out_m)
    touch = tuple(dict.fromkeys((*touch, *obstacle.ignore)))
    known_of = {"spheres": pack_floats(cover[0]), "protrusion_m": cover[1], "may_touch": touch}
    place = _list_whole(world).index(name)
    thing = Attached(obstacle=obstacle, frame=frame, T_frame_object=T, place=place, **known_of)
    if model is not None and values is not None and (T_frame_object is None or q is not None):
        _refuse_touching(model.own, values, world.attached, thing)
    left = tuple(other for other in world.obstacles if other is not obstacle)
    off = world.switched_off & {other.group for other in left if other.group is not None}
    return World(obstacles=left, switched_off=off, attached=(*world.attached, thing))


def detach(
    world: World,
    name: str,
    T_world_object: ArrayLike | Pose | None = None,
    *,
    robot: RobotLike | None = None,
    q: JointValues | None = None,
) -> World:
    """As `World.detach`, which says what all this is."""
    names = [thing.name for thing in world.attached]
    if name not in names:
        held = f"; attached: {', '.join(names)}" if names else ""
        raise InputError(
            f"nothing that is attached is called {quoted(name)}{nearest(str(name), names) or held}", ("detach",)
        )
    thing = world.attached[names.index(name)]
    obstacle = thing.obstacle
    if T_world_object is not None:
        place = _read_place(T_world_object, "T_world_object")
        obstacle = replace(obstacle, frame=WORLD, T_world_obstacle=place)
    elif (robot is None) != (q is None):
        raise InputError("where it is let go is said by `robot` and `q` together", ("detach", name))
    elif robot is not None and q is not None:
        own = read_robot(robot)
        find_carrier(own, thing.frame, ("attached", name, "frame"))
        T = compute_frames(own, read_configuration(own, q))[thing.frame] @ _whole(thing.T_frame_object)
        obstacle = replace(obstacle, frame=WORLD, T_world_obstacle=read_pose(T, ("q",)))
    left = tuple(other for other in world.attached if other is not thing)
    place = len(world) if thing.place is None else sum(n in world for n in _list_whole(world)[: thing.place])
    others = world.obstacles[:place], world.obstacles[place:]
    return World(obstacles=(*others[0], obstacle, *others[1]), switched_off=world.switched_off, attached=left)


def _list_whole(world: World) -> list[str]:
    """Names of obstacles, with those of what is attached where it stood among them."""
    names = [*world.names]
    for thing in sorted((one for one in world.attached if one.place is not None), key=lambda one: one.place or 0):
        names.insert(thing.place or 0, thing.name)
    return names


def _check_free(world: World, name: Any) -> None:
    for thing in world.attached:
        if thing.name == name:
            raise InputError(f"{name!r} is attached to {thing.frame} already: detach it first", ("attach", name))
    if name in world and world[name].group in world.switched_off:
        raise InputError(f"{name!r} is switched off with its group {world[name].group}", ("attach", name))


def _choose_frame(robot: Robot | None, to: Any) -> str:
    """The frame that holds it; the robot's tool if none is named."""
    if to is None:
        if robot is None:
            raise InputError("expected the frame that holds it, or a robot, whose tool does", ("to",))
        return robot.tool
    check_printable(to, ("to",))
    if robot is not None:
        find_carrier(robot, to, ("to",))
    return cast(str, to)


def _find_pose(Ts_world: dict[str, Floats], frame: str, stands_in: str, T_stand: Floats, name: str) -> Floats:
    """T_frame_object [3, 4] of what stands in a frame that no joint moves."""
    if stands_in not in Ts_world:
        message = f"no frame that stays in its place is called {stands_in!r}{nearest(stands_in, Ts_world)}"
        raise InputError(message, ("obstacles", name, "frame"))
    T = np.linalg.inv(Ts_world[frame]) @ Ts_world[stands_in] @ T_stand
    return read_pose(T[:3], ("q",))


def _read_place(given: ArrayLike | Pose, word: str) -> Floats:
    found = find_matrix(given, (word,))
    return read_pose(cast(ArrayLike, given) if found is None else found, (word,))


def _read_touch(world: World, name: str, given: Any, components: tuple[str, ...] | None) -> tuple[str, ...]:
    """Names of what may be touched; unknown ones are refused where the robot is known, too."""
    if isinstance(given, str) or not isinstance(given, Iterable):
        raise InputError(f"expected a list of names, got {quoted(given)}", ("may_touch",))
    touch = tuple(given)
    for place, one in enumerate(touch):
        check_printable(one, ("may_touch", place))
        if components is not None:
            known = [*components, *(n for n in world.names if n != name), *(thing.name for thing in world.attached)]
            if one not in known:
                message = f"no component and no obstacle is called {one!r}{nearest(one, known)}"
                raise InputError(message, ("may_touch", place))
    return touch


def read_spheres(given: ArrayLike) -> Floats:
    """Centres and radii [n, 4] in m; raises `InputError` for what is none."""
    spheres = read_numbers(given, ("spheres",))
    if spheres.ndim != 2 or spheres.shape[1] != 4 or not 1 <= len(spheres) <= MAX_SPHERES:
        message = f"expected up to {MAX_SPHERES:,} spheres [n, 4], centre and radius in m, got shape {spheres.shape}"
        raise InputError(message, ("spheres",))
    good = (np.abs(spheres) <= MAX_MAGNITUDE).all(axis=1) & (spheres[:, 3] >= MIN_SIZE_M)
    if not good.all():
        row = int(np.argmin(good))
        message = f"expected finite numbers and a radius of at least {MIN_SIZE_M:g} m, got {spheres[row].tolist()}"
        raise InputError(message, ("spheres", row))
    return spheres + 0.0


def read_protrusion(given: Any, where: tuple[str | int, ...] = ("protrusion_m",), least_m: float = FINEST_M) -> float:
    """A length in m; raises `InputError` for what is none, or less than `least_m`."""
    if not (is_number(given) and least_m <= given <= MAX_MAGNITUDE):
        raise InputError(f"expected a length of at least {least_m:g} m, got {quoted(given)}", where)
    return float(given)


def _refuse_touching(own: CollisionModel, q: Floats, others: tuple[Attached, ...], thing: Attached) -> None:
    """Raise `InputError` for what it touches of the robot where it is picked up, unless it may."""
    if not own.pairs:
        return
    known = {*own.components, *(other.name for other in others), thing.name}
    held = (replace(one, may_touch=tuple(n for n in one.may_touch if n in known)) for one in (*others, thing))
    model = own.in_world(World(attached=tuple(held)))
    pairs = tuple(pair for pair in model.pairs if thing.name in pair)
    if not pairs:
        return
    gaps_m = compute_gaps(model, q, pairs)
    touched = {a if b == thing.name else b: gap for (a, b), gap in zip(pairs, gaps_m.tolist(), strict=True)}
    touched = {name: gap for name, gap in touched.items() if gap <= model.limit_m}
    if not touched:
        return
    nearest_m = [f"{1e3 * gap:.3g} mm from {name}" for name, gap in sorted(touched.items(), key=lambda one: one[1])]
    fat = f", its spheres stand out by up to {1e3 * thing.protrusion_m:.3g} mm" if thing.protrusion_m else ""
    raise InputError(
        f"{thing.name} is {', '.join(nearest_m)} where it is picked up{fat}; if that is meant, "
        f"write may_touch: [{', '.join((*thing.may_touch, *touched))}]",
        ("attach", thing.name),
    )


def _whole(T: Floats) -> Floats:
    return np.vstack([T, [0.0, 0.0, 0.0, 1.0]])

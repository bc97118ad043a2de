"""Everything that can be wrong with a robot, found in one place and named by the path of the offending value."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from ikde.errors import ErrorList, InputError, nearest
from ikde.model.base_motion import check_wheels, find_planar_base, usual_drive
from ikde.model.detectors import check_detector
from ikde.model.names import check_printable
from ikde.model.pairs import component_bodies, find_neighbours, non_adjacent_pairs
from ikde.model.robot import (
    DRIVES,
    MAX_MAGNITUDE,
    NO_DETECTOR,
    TOOL,
    WORLD,
    Frame,
    FreeSpheres,
    Joint,
    Pairs,
    Robot,
    SphereRow,
    Spheres,
)
from ikde.model.rotation import check_rotation
from ikde.model.tree import Tree, build_tree

NON_ADJACENT = "non_adjacent"


def check_robot(draft: Robot) -> Robot:
    """Return the robot with its frames in the tree's order and its list of non-adjacent pairs added.

    Raises:
        InputError: with the path of the first value that makes no sense; `others` holds those of entries beside it.
    """
    _check_names(draft)
    _check_joints(draft)
    robot = replace(draft, frames=_sort_frames(draft))
    _check_tool(robot)
    tree = build_tree(robot)
    bodies: dict[str, int] = {}
    for name, rows in robot.approximations.items():
        _check_rows(rows, tree, ("spheres", name))
        for component, body in component_bodies(rows, tree).items():
            same = bodies.setdefault(component, body) == body
            _require(same, f"{component!r} lies on another body than in the other approximations", "spheres", name)
    _check_pairs(robot, bodies)
    for name in robot.approximations:
        missing = [component for component in bodies if component not in robot.components(name)]
        _require(not missing, f"the other approximations also describe {', '.join(missing)}", "spheres", name)
    neighbours = find_neighbours(robot, tree, bodies)
    every = non_adjacent_pairs(bodies, neighbours)
    robot = replace(robot, neighbours=neighbours, pair_lists={**robot.pair_lists, NON_ADJACENT: every})
    _check_detectors(robot)
    _check_conventions(robot)
    _check_wheels(robot)
    _check_inertias(robot)
    return robot


def _check_names(robot: Robot) -> None:
    """Everything that a robot names; what only refers to something must be the name of it anyway."""
    check_printable(robot.name, ("name",))
    check_printable(robot.convention, ("convention",))
    named = {
        "joints": robot.joint_names,
        "frames": [frame.name for frame in robot.frames],
        "spheres": robot.approximations,
        "pairs": robot.pair_lists,
        "detectors": robot.detectors,
        "conventions": robot.conventions,
    }
    for section, names in named.items():
        for name in names:
            check_printable(name, (section, name))
    for name, rows in robot.approximations.items():
        for index, row in enumerate(rows):
            check_printable(row.component, ("spheres", name, index, "component"))


def _check_name(name: str, known: Iterable[str], where: tuple[str | int, ...], what: str) -> None:
    names = list(known)
    if name not in names:
        raise InputError(f"no {what} is called {name!r}{nearest(name, names)}", where)


def _require(condition: bool, message: str, *where: str | int) -> None:
    if not condition:
        raise InputError(message, where)


def _check_unique(names: Sequence[str], section: str) -> None:
    for name in names:
        _require(names.count(name) == 1, "this name is given twice", section, name)


def _check_joints(robot: Robot) -> None:
    _require(bool(robot.joints), "expected at least one joint", "joints")
    _check_unique(robot.joint_names, "joints")
    errors = ErrorList()
    for joint in robot.joints:
        with errors:
            _check_joint(joint)
    errors.raise_all()


def _check_joint(joint: Joint) -> None:
    where = ("joints", joint.name)
    for key, none in (("lower", -np.inf), ("upper", np.inf)):
        endless = getattr(joint, key) == none or joint.kind != "continuous"
        _require(endless, "a continuous joint has no limits; one with limits is revolute", *where, key)
    for key in ("home",) if joint.kind == "continuous" else ("lower", "upper", "home"):
        _require(bool(abs(getattr(joint, key)) <= MAX_MAGNITUDE), _too_far(joint, getattr(joint, key)), *where, key)
    _require(joint.lower <= joint.upper, "the upper limit is below the lower one", *where, "upper")
    inside = joint.lower <= joint.home <= joint.upper
    _require(inside, "home is outside the limits", *where, "home")
    for key in ("max_speed", "max_acceleration", "max_effort"):
        value = getattr(joint, key)
        is_good = value is None or bool(0.0 < value < np.inf)
        _require(is_good, f"expected a finite number above 0, got {value}", *where, key)


def _too_far(joint: Joint, value: float) -> str:
    unit = "m" if joint.kind == "prismatic" else "rad"
    return f"expected a finite number, at most {MAX_MAGNITUDE:g} {unit} from 0, got {float(value)}"


def _sort_frames(robot: Robot) -> tuple[Frame, ...]:
    """Parents before children; otherwise in the order they were written."""
    frames = {frame.name: frame for frame in robot.frames}
    _check_unique([frame.name for frame in robot.frames], "frames")
    errors = ErrorList()
    for frame in robot.frames:
        with errors:
            _check_frame(robot, frame, frames)
    errors.raise_all()
    moved = [frame.joint for frame in robot.frames if frame.joint is not None]
    for joint in robot.joint_names:
        with errors:
            found = f"expected one frame that this joint moves, found {moved.count(joint)}"
            _require(moved.count(joint) == 1, found, "joints", joint)
    errors.raise_all()
    placed: dict[str, Frame] = {}
    while len(placed) < len(frames):
        ready = {n: f for n, f in frames.items() if n not in placed and (f.parent == WORLD or f.parent in placed)}
        if not ready:
            loop = next(name for name in frames if name not in placed)
            raise InputError("a cycle: following the parents never reaches the world", ("frames", loop, "parent"))
        placed |= ready
    order = _depth_first(placed)
    return tuple(placed[name] for name in order)


def _depth_first(frames: Mapping[str, Frame]) -> list[str]:
    """Names along each branch, so that a chain reads from its base to its tool."""
    order: list[str] = []
    waiting = [name for name, frame in frames.items() if frame.parent == WORLD][::-1]
    while waiting:
        name = waiting.pop()
        order.append(name)
        waiting += [child for child, frame in frames.items() if frame.parent == name][::-1]
    return order


def _check_frame(robot: Robot, frame: Frame, frames: Mapping[str, Frame]) -> None:
    where = ("frames", frame.name)
    _require(frame.name != WORLD, f"{WORLD!r} is the root and cannot be defined", *where)
    _check_name(frame.parent, [WORLD, *frames], (*where, "parent"), "frame")
    is_near = bool(np.all(np.abs(frame.p_parent_frame) <= MAX_MAGNITUDE))  # False for NaN
    _require(is_near, f"expected finite numbers, at most {MAX_MAGNITUDE:g} m from 0", *where, "xyz")
    check_rotation(frame.R_parent_frame)
    if frame.joint is None:
        _require(frame.axis is None, "an axis needs a joint", *where, "axis")
        return
    _check_name(frame.joint, robot.joint_names, (*where, "joint"), "joint")
    _require(frame.axis is not None, "a frame with a joint needs an axis", *where)
    unit = frame.axis is not None and abs(float(np.linalg.norm(frame.axis)) - 1.0) < 1e-12
    _require(unit, "expected an axis that is not zero", *where, "axis")


def _check_tool(robot: Robot) -> None:
    names = [frame.name for frame in robot.frames]
    _check_name(robot.tool, names, ("tool",), "frame")
    taken = f"this name stands for the tool, which is {robot.tool!r}; name this frame otherwise, or let it be the tool"
    _require(robot.tool == TOOL or TOOL not in names, taken, "frames", TOOL)
    for name, frame in robot.tools.items():
        check_printable(name, ("tools", name))
        _check_name(frame, names, ("tools", name), "frame")
        other = f"a frame is called so, and this tool is {frame!r}; expected another name"
        _require(name == frame or name not in (*names, TOOL), other, "tools", name)


def _check_rows(rows: tuple[Spheres, ...], tree: Tree, where: tuple[str | int, ...]) -> None:
    body_of: dict[str, int] = {}
    errors = ErrorList()
    for index, row in enumerate(rows):
        here = (*where, index)
        with errors:
            if isinstance(row, FreeSpheres):
                _check_free(row, tree, here)
            else:
                _check_row(row, tree, here)
            body = tree.frame_body[row.start]
            _require(
                body_of.setdefault(row.component, body) == body,
                f"the rows of {row.component!r} lie on different bodies; a component is rigid",
                *here,
                "component",
            )
    errors.raise_all()


def _check_free(free: FreeSpheres, tree: Tree, here: tuple[str | int, ...]) -> None:
    _check_name(free.frame, tree.frame_body, (*here, "frame"), "frame")
    _require(free.count >= 1, "expected at least one sphere [x, y, z, radius]", *here, "spheres")
    for number, (x, y, z, radius) in enumerate(free.spheres):
        place = (*here, "spheres", number)
        is_near = all(abs(v) <= MAX_MAGNITUDE for v in (x, y, z))  # False for NaN
        _require(is_near, f"expected a finite centre, at most {MAX_MAGNITUDE:g} m from 0", *place)
        _require(0.0 < radius <= MAX_MAGNITUDE, f"expected a radius above 0, up to {MAX_MAGNITUDE:g} m", *place, 3)


def _check_row(row: SphereRow, tree: Tree, here: tuple[str | int, ...]) -> None:
    _check_name(row.start, tree.frame_body, (*here, "from"), "frame")
    _check_name(row.end, tree.frame_body, (*here, "to"), "frame")
    _require(
        0.0 < row.radius_m <= MAX_MAGNITUDE,
        f"expected a radius above 0, up to {MAX_MAGNITUDE:g} m",
        *here,
        "radius",
    )
    _require(row.count >= 1, "expected a count of at least 1", *here, "count")
    body = tree.frame_body[row.start]
    _require(
        body == tree.frame_body[row.end],
        "these two frames are on different bodies; add a fixed frame on one of the two",
        *here,
        "to",
    )
    length = np.linalg.norm(tree.T_body_frame[row.start][:3, 3] - tree.T_body_frame[row.end][:3, 3])
    _require(row.count == 1 or bool(length > 0.0), "several spheres need two key points to stand between", *here, "to")


def _check_pairs(robot: Robot, components: Mapping[str, int]) -> None:
    _require(
        NON_ADJACENT not in robot.pair_lists, "this list is made by ikde and cannot be defined", "pairs", NON_ADJACENT
    )
    for name, pairs in robot.pair_lists.items():
        _check_list(pairs, components, ("pairs", name, "pairs"))
    _check_list(tuple((pair.a, pair.b) for pair in robot.adjacent), components, ("adjacent", "pairs"))
    _check_list(robot.compared, components, ("compare",))
    compared = {frozenset(pair): pair[0] for pair in robot.compared}
    for pair in robot.adjacent:
        both = f"{pair.a!r} and {pair.b!r} are declared adjacent as well"
        key = frozenset((pair.a, pair.b))
        _require(key not in compared, both, "compare", compared.get(key, ""))
        has_reason = bool(pair.reason.strip()) and pair.reason.isprintable()
        _require(has_reason, "expected a reason, in one line of printable text", "adjacent", "pairs", pair.a, pair.b)


def _check_list(pairs: Pairs, components: Mapping[str, int], where: tuple[str | int, ...]) -> None:
    seen: set[frozenset[str]] = set()
    errors = ErrorList()
    for a, b in pairs:
        with errors:
            _check_name(a, components, (*where, a), "component")
            _check_name(b, components, (*where, a), "component")
            _require(a != b, f"{a!r} is paired with itself", *where, a)
            _require(frozenset((a, b)) not in seen, f"{a!r} and {b!r} are paired twice", *where, a)
            seen.add(frozenset((a, b)))
    errors.raise_all()


def _check_detectors(robot: Robot) -> None:
    for name, detector in robot.detectors.items():
        where = ("detectors", name)
        check_detector(robot, detector, where)
    _check_name(robot.default_detector, [*robot.detectors, NO_DETECTOR], ("default_detector",), "detector")


def _check_conventions(robot: Robot) -> None:
    kinds = {joint.name: joint.kind for joint in robot.joints}
    for name, offsets in robot.conventions.items():
        _require(name != robot.convention, "this is the convention the file is written in", "conventions", name)
        for joint, offset in offsets.items():
            _check_name(joint, kinds, ("conventions", name, joint), "joint")
            _require(
                kinds[joint] != "prismatic", "only a revolute joint can have an offset", "conventions", name, joint
            )
            is_near = bool(abs(offset) <= MAX_MAGNITUDE)
            _require(is_near, f"expected at most {MAX_MAGNITUDE:g} rad either way", "conventions", name, joint)


def _check_wheels(robot: Robot) -> None:
    """Wheels with a size, and a drive, under a base that they can drive."""
    wheels = robot.wheels
    for key, what, value in (("wheels", "wheels need", wheels), ("drive", "a drive needs", robot.drive)):
        drives = value is None or bool(find_planar_base(robot)[0] >= 0)
        needed = (
            f"{what} a planar base, prismatic along x and y and revolute about z, that carries all that can collide"
        )
        _require(drives, needed, key)
    _require(robot.drive is None or robot.drive in DRIVES, f"expected one of {', '.join(DRIVES)}", "drive")
    if wheels is None:
        return
    sizes = {"radius": wheels.radius_m, "half_track": wheels.half_track_m, "half_wheelbase": wheels.half_wheelbase_m}
    for key, value in sizes.items():
        what = "radius" if key == "radius" else "distance"
        is_good = value is None or 0.0 < value <= MAX_MAGNITUDE
        _require(is_good, f"expected a {what} above 0, up to {MAX_MAGNITUDE:g} m", "wheels", key)
    check_wheels(robot, usual_drive(robot))


def _check_inertias(robot: Robot) -> None:
    names = [frame.name for frame in robot.frames]
    for name, inertia in robot.inertias.items():
        where = ("inertias", name)
        _check_name(name, names, where, "frame")
        _require(0.0 <= inertia.mass_kg < np.inf, "expected a finite mass of at least 0 kg", *where, "mass")
        is_near = bool(np.all(np.abs(inertia.p_frame_com) <= MAX_MAGNITUDE))
        _require(is_near, f"expected finite numbers, at most {MAX_MAGNITUDE:g} m from 0", *where, "com")
        is_finite = bool(np.all(np.isfinite(inertia.I_com_frame)))
        _require(is_finite, "expected finite numbers", *where, "inertia")

"""One robot out of several: an arm mounted on a platform, a tool at its end."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from ikde.kernels.arrays import Floats
from ikde.model.arguments import RobotLike, read_robot
from ikde.model.collision_model import CollisionModel
from ikde.model.names import MAX_NAME_LENGTH, find_free_name
from ikde.model.robot import (
    NO_DETECTOR,
    TOOL,
    WORLD,
    AdjacentPair,
    Detector,
    Frame,
    FreeSpheres,
    Inertia,
    Joint,
    Robot,
    Spheres,
)
from ikde.model.rotation import rotation_about
from ikde.model.solids import read_pose
from ikde.model.validate import NON_ADJACENT, check_robot

SPHERES = "spheres"
OF_THE_TREE = ("one body", "joined by joint")  # reasons that are found anew


@dataclass(slots=True, kw_only=True)
class _Assembly:
    """What has been put together so far; `end` is the frame that the next part is mounted on."""

    joints: list[Joint] = field(default_factory=list)
    frames: list[Frame] = field(default_factory=list)
    rows: list[Spheres] = field(default_factory=list)
    adjacent: list[AdjacentPair] = field(default_factory=list)
    compared: list[tuple[str, str]] = field(default_factory=list)
    inertias: dict[str, Inertia] = field(default_factory=dict)
    safe_distance_m: float = 0.0
    end: str = WORLD


def compose(base: RobotLike, arm: RobotLike, T_base_arm: Floats, tool: RobotLike | None = None) -> Robot:
    """An arm on a platform, and a tool at its end.

    Names that are taken get the word `arm_` or `tool_` before them. Spheres, and pairs that are left out, are those of
    each part's default detector; the new one compares all others, and keeps the largest safe distance. Conventions, and
    where numbers come from, are left behind.

    Args:
        base: the platform, its name or the path of its file; its tool is what the arm stands on.
        arm: the arm, likewise.
        T_base_arm: [4, 4] m, the arm's world in the platform's tool.
        tool: what the arm's tool carries, likewise: its joints are frozen at home, its tool is the new one.

    Raises:
        InputError: if what comes of it is no robot.
    """
    base, arm = read_robot(base, ("base",)).whole, read_robot(arm, ("arm",)).whole
    tool = None if tool is None else read_robot(tool, ("tool",))
    T_base_arm = read_pose(T_base_arm, ("T_base_arm",))
    assembly = _Assembly()
    _add(assembly, base, "base", np.eye(4), is_last=False)
    _add(assembly, arm, "arm", T_base_arm, is_last=tool is None)
    if tool is not None:
        _add(assembly, freeze_all(tool), "tool", np.eye(4), is_last=True)
    parts = [part.name for part in (base, arm, tool) if part]
    draft = Robot(
        name="_".join(parts)[:MAX_NAME_LENGTH],
        title=" with ".join(parts),
        joints=tuple(assembly.joints),
        frames=tuple(assembly.frames),
        tool=assembly.end,
        approximations={SPHERES: tuple(assembly.rows)} if assembly.rows else {},
        adjacent=tuple(assembly.adjacent),
        pair_lists={},
        detectors={},
        default_detector=NO_DETECTOR,
        convention="own",
        conventions={},
        provenance={},
        inertias=assembly.inertias,
    )
    return check_robot(replace(_with_detector(draft, assembly), wheels=base.wheels, drive=base.drive))


def _with_detector(draft: Robot, assembly: _Assembly) -> Robot:
    """The robot with a detector of all that is not left out, and of what a part compares although a joint joins it."""
    listed = check_robot(draft).pair_lists[NON_ADJACENT] if draft.approximations else ()
    known = {frozenset(pair) for pair in listed}
    joined = tuple(pair for pair in assembly.compared if frozenset(pair) not in known)
    if not (listed or joined):
        return draft
    pairs = SPHERES if joined else NON_ADJACENT
    detector = Detector(name=SPHERES, spheres=SPHERES, pairs=pairs, safe_distance_m=assembly.safe_distance_m)
    lists = {SPHERES: listed + joined} if joined else {}
    return replace(draft, pair_lists=lists, detectors={SPHERES: detector}, default_detector=SPHERES)


def freeze_all(robot: Robot) -> Robot:
    """The robot with every joint as a part of its frames, at home."""
    joints = {joint.name: joint for joint in robot.joints}
    return replace(robot, joints=(), frames=tuple(_freeze(frame, joints) for frame in robot.frames))


def _freeze(frame: Frame, joints: Mapping[str, Joint]) -> Frame:
    if frame.joint is None or frame.axis is None:
        return frame
    joint, R, p = joints[frame.joint], frame.R_parent_frame, frame.p_parent_frame
    if joint.kind == "prismatic":
        p = p + R @ (joint.home * frame.axis)
    else:
        R = R @ rotation_about(frame.axis, joint.home)
    return replace(frame, p_parent_frame=p, R_parent_frame=R, joint=None, axis=None)


def _add(assembly: _Assembly, part: Robot, word: str, T_end_part: Floats, *, is_last: bool) -> None:
    """Mount a part on the end, and let its tool be the new one."""
    taken = {WORLD, *(frame.name for frame in assembly.frames)}
    taken |= set() if is_last and part.tool == TOOL else {TOOL}
    frame_of = _rename([frame.name for frame in part.frames], word, taken)
    frame_of[WORLD] = WORLD
    if assembly.end != WORLD:
        frame_of[WORLD] = next(iter(_rename([f"{word}_mount"], word, taken | set(frame_of.values())).values()))
        mount = Frame(
            name=frame_of[WORLD],
            parent=assembly.end,
            p_parent_frame=T_end_part[:3, 3],
            R_parent_frame=T_end_part[:3, :3],
        )
        assembly.frames.append(mount)
    joint_of = _rename([joint.name for joint in part.joints], word, {joint.name for joint in assembly.joints})
    assembly.joints += [replace(joint, name=joint_of[joint.name]) for joint in part.joints]
    assembly.frames += [
        replace(
            frame,
            name=frame_of[frame.name],
            parent=frame_of[frame.parent],
            joint=None if frame.joint is None else joint_of[frame.joint],
        )
        for frame in part.frames
    ]
    assembly.inertias |= {frame_of[name]: inertia for name, inertia in part.inertias.items()}
    _add_spheres(assembly, part, word, frame_of)
    assembly.end = frame_of[part.tool]


def _add_spheres(assembly: _Assembly, part: Robot, word: str, frame_of: Mapping[str, str]) -> None:
    """Rows of the part's default detector, or of its only approximation, and the pairs that it leaves out."""
    detector = part.detectors.get(part.default_detector)
    names = [detector.spheres] if detector else list(part.approximations)
    rows = part.approximations[names[0]] if len(names) == 1 else ()
    component_of = _rename(dict.fromkeys(row.component for row in rows), word, {row.component for row in assembly.rows})
    assembly.rows += [
        replace(row, component=component_of[row.component], frame=frame_of[row.frame])
        if isinstance(row, FreeSpheres)
        else replace(row, component=component_of[row.component], start=frame_of[row.start], end=frame_of[row.end])
        for row in rows
    ]
    left_out = [(pair.a, pair.b, pair.reason) for pair in part.adjacent]
    if detector and part.joints:
        left_out = [(pair.a, pair.b, pair.reason) for pair in CollisionModel.of(part).left_out_pairs]
        assembly.compared += [(component_of[a], component_of[b]) for a, b in CollisionModel.of(part).pairs]
        assembly.safe_distance_m = max(assembly.safe_distance_m, detector.safe_distance_m)
    assembly.adjacent += [
        AdjacentPair(a=component_of[a], b=component_of[b], reason=reason.removeprefix("adjacent: "))
        for a, b, reason in left_out
        if a in component_of and b in component_of and not reason.startswith(OF_THE_TREE)
    ]


def _rename(names: Iterable[str], word: str, taken: set[str]) -> dict[str, str]:
    """New names: the old ones, but for those that are taken."""
    own = list(names)
    used, found = taken | set(own), {}
    for name in own:
        new = name
        if name in taken:
            new = find_free_name(f"{word}_{name}", used)
            used.add(new)
        found[name] = new
    return found

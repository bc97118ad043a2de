"""Sets of planning problems as MotionBenchMaker writes them: a scene file, and a request file beside it."""

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np

from ikde.batch.scenes import LinkPose
from ikde.errors import FileError, InputError
from ikde.formats.error_path import prefix_errors
from ikde.formats.reading import read_bytes
from ikde.io.moveit_scene import read_attached, read_frame, read_pose
from ikde.io.scene_values import Reading, as_list, as_mapping, as_name, as_number, as_numbers, get
from ikde.io.yaml_file import read_yaml
from ikde.model.solids import IDENTITY
from ikde.model.world import Attached

SCENE = re.compile(r"scene(.*\.(?:ya?ml|json))")
MAX_PAIRS = 100_000  # of a folder


@dataclass(frozen=True, slots=True, kw_only=True)
class ScenePair:
    """A scene and its request."""

    family: str
    """The folder, relative to that of the set."""
    name: str
    scene: Path
    request: Path

    @property
    def digest(self) -> str:
        """SHA-256 of both files' bytes, hex."""
        return sha256(b"\0".join(sha256(read_bytes(path)).digest() for path in (self.scene, self.request))).hexdigest()


@dataclass(frozen=True, slots=True, kw_only=True)
class Request:
    """What is asked: joint values by name, m and rad, in no order, or the pose of a link."""

    start: Mapping[str, float]
    goal: Mapping[str, float]
    """Empty where a pose is asked for."""
    pose: LinkPose | None = None
    attached: tuple[Attached, ...] = ()
    """What the robot holds at the start, beside what it holds in the scene."""


def find_pairs(folder: Path) -> dict[str, list[ScenePair]]:
    """Family -> its pairs, each in order of names: files `scene*.yaml` with `request*.yaml` beside them, at any depth.

    Raises:
        FileError: for a folder that cannot be read or holds none, and for a scene without its request.
    """
    families: dict[str, list[ScenePair]] = {}
    try:
        for scene, rest in _list_scenes(folder):
            request = scene.with_name(f"request{rest}")
            if not request.is_file():
                raise FileError(scene, f"has no {request.name} beside it, which would say what is asked in it")
            family = scene.parent.relative_to(folder).as_posix()
            family = folder.resolve().name if family == "." else family.removeprefix("problems/")
            pair = ScenePair(family=family, name=f"{family}/{scene.stem}", scene=scene, request=request)
            families.setdefault(family, []).append(pair)
    except OSError as error:
        raise FileError(folder, f"cannot be read: {error.strerror or error}") from None
    if not families:
        raise FileError(folder, "holds no scene*.yaml with a request*.yaml beside it")
    return families


def _list_scenes(folder: Path) -> Iterator[tuple[Path, str]]:
    """Scenes and what their names and those of their requests share."""
    if not folder.is_dir():
        raise FileError(folder, "expected a folder of scenes and requests")
    found = sorted(path for path in folder.rglob("scene*") if SCENE.fullmatch(path.name))
    if len(found) > MAX_PAIRS:
        raise FileError(folder, f"holds {len(found):,} scenes; expected at most {MAX_PAIRS:,}")
    for path in found:
        yield path, path.name.removeprefix("scene")


def read_request(path: Path) -> Request:
    """Where joints are at first, and where they, or a link, should go; raises `FileError` where that is not said."""
    document = read_yaml(path)
    try:
        data = as_mapping(document.data)
        with prefix_errors("start_state"):
            state = as_mapping(data.get("start_state"))
            start, attached = _read_state(state), read_attached(state, Reading(path.parent))
        goal, pose = _read_goal(data)
        return Request(start=start, goal=goal, pose=pose, attached=attached)
    except FileError:
        raise
    except InputError as error:
        raise document.error(error.message, error.where) from None


def read_scene_state(path: Path) -> dict[str, float]:
    """Where a scene's `robot_state` has joints, by name, m and rad; raises `FileError`."""
    document = read_yaml(path)
    try:
        with prefix_errors("robot_state"):
            return _read_state(as_mapping(as_mapping(document.data).get("robot_state")))
    except FileError:
        raise
    except InputError as error:
        raise document.error(error.message, error.where) from None


def _read_state(state: Mapping[str, Any]) -> dict[str, float]:
    with prefix_errors("multi_dof_joint_state"):
        several = as_mapping(state.get("multi_dof_joint_state"))
        for key in ("transforms", "poses"):
            for place, value in enumerate(as_list(several.get(key))):
                with prefix_errors(key, place):
                    _refuse_moved(as_mapping(value))
    with prefix_errors("joint_state"):
        joints = as_mapping(state.get("joint_state"))
        names, values = as_list(joints.get("name")), as_list(joints.get("position"))
        if len(names) != len(values):
            raise InputError(f"{len(names)} names, but {len(values)} positions")
        found: dict[str, float] = {}
        for place, (name, value) in enumerate(zip(map(as_name, names), values, strict=True)):
            if name in found:
                raise InputError(f"{name!r} is there twice", ("name", place))
            with prefix_errors("position", place):
                found[name] = as_number(value)
        return found


def _refuse_moved(transform: Mapping[str, Any]) -> None:
    """Raise `InputError` for a pose that is not the identity: the robot would stand elsewhere than in its file."""
    keys = ("position", "orientation") if "position" in transform else ("translation", "rotation")
    if not np.allclose(read_pose(transform, keys), IDENTITY, rtol=0.0, atol=1e-9):
        raise InputError("a robot that stands elsewhere is not read: give the robot's file that place")


def _read_goal(data: Mapping[str, Any]) -> tuple[dict[str, float], LinkPose | None]:
    with prefix_errors("goal_constraints"):
        goals = as_list(data.get("goal_constraints"))
        if len(goals) != 1:
            raise InputError(f"expected one goal, got {len(goals)}")
        with prefix_errors(0):
            goal, pose = as_mapping(goals[0]), None
            joints = _read_joints(as_list(goal.get("joint_constraints")))
            if as_list(goal.get("position_constraints")) or as_list(goal.get("orientation_constraints")):
                if joints:
                    raise InputError("joint values and a pose at once are not read", ("position_constraints",))
                pose = _read_pose_goal(goal)
            if as_list(goal.get("visibility_constraints")):
                raise InputError("what should be seen is not read", ("visibility_constraints",))
            if not joints and pose is None:
                raise InputError("expected the goal's joint values", ("joint_constraints",))
            return joints, pose


def _read_joints(entries: list[Any]) -> dict[str, float]:
    found: dict[str, float] = {}
    for place, entry in enumerate(entries):
        with prefix_errors("joint_constraints", place):
            name = as_name(get(as_mapping(entry), "joint_name"))
            if name in found:
                raise InputError(f"{name!r} is asked twice", ("joint_name",))
            with prefix_errors("position"):
                found[name] = as_number(get(as_mapping(entry), "position"))
    return found


def _read_pose_goal(goal: Mapping[str, Any]) -> LinkPose:
    """The middle of a link's region, and its orientation, without their tolerances."""
    found: dict[str, Mapping[str, Any]] = {}
    for key in ("position_constraints", "orientation_constraints"):
        entries = as_list(goal.get(key))
        if len(entries) > 1 or (not entries and key == "position_constraints"):
            raise InputError(f"expected one, got {len(entries)}", (key,))
        if entries:
            found[key] = as_mapping(entries[0])
    where, oriented = found["position_constraints"], found.get("orientation_constraints")
    with prefix_errors("position_constraints", 0):
        link, frame = as_name(get(where, "link_name")), read_frame(where)
        with prefix_errors("target_point_offset"):
            offset = where.get("target_point_offset")
            if offset is not None and as_numbers(offset, ("x", "y", "z")).any():
                raise InputError("another point than the link's origin is not read")
        region = as_mapping(get(where, "constraint_region"))
        with prefix_errors("constraint_region", "primitive_poses"):
            poses = as_list(region.get("primitive_poses"))
            if len(poses) != 1:
                raise InputError(f"expected one, got {len(poses)}")
            p = read_pose(poses[0])[:, 3]
    R = None
    if oriented is not None:
        with prefix_errors("orientation_constraints", 0):
            if (as_name(get(oriented, "link_name")), read_frame(oriented)) != (link, frame):
                raise InputError(f"expected the link and the frame of the position, {link} in {frame}")
            R = read_pose({"orientation": get(oriented, "orientation")})[:, :3]
    return LinkPose(link=link, frame=frame, p_frame_link=p, R_frame_link=R)

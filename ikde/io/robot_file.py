"""The robot file: its schema, and how it becomes a `Robot`."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Annotated, Any

import numpy as np
from pydantic import AfterValidator, BeforeValidator, ConfigDict, Field, ValidationError, ValidationInfo
from pydantic.config import JsonDict
from pydantic_core import PydanticCustomError

from ikde.errors import ErrorList, InputError, nearest
from ikde.formats.entries import DetectorPartsEntry, Entry, Number, UnitsEntry, Vector
from ikde.formats.names import MAX_TEXT_LENGTH, Name, Text
from ikde.formats.robot_entries import make_detector
from ikde.io.schema import as_file_error, place_errors
from ikde.io.sphere_entries import SourcedEntry, SphereRowEntry, to_spheres
from ikde.io.yaml_file import Document, Where
from ikde.model.detectors import MAX_PAIRS
from ikde.model.robot import (
    NO_DETECTOR,
    WORLD,
    AdjacentPair,
    Drive,
    Frame,
    Inertia,
    Joint,
    JointKind,
    Origin,
    Pairs,
    Provenance,
    Robot,
    Wheels,
)
from ikde.model.rotation import rotation_from_rpy
from ikde.model.validate import check_robot

MAX_JOINTS, MAX_ENTRIES, MAX_LISTS, MAX_TOOLS = (
    500,
    2000,
    100,
    100,
)  # of a robot: what it takes to load grows with their squares
MAX_SPHERES = 100_000  # of a robot's approximations together
OfLists = Field(max_length=MAX_LISTS)
LIMITS_BY_KIND: JsonDict = {
    "if": {"properties": {"kind": {"const": "continuous"}}},
    "then": {"properties": {"lower": False, "upper": False}},
    "else": {"required": ["lower", "upper"]},
}


class SourceEntry(Entry):
    """Where numbers come from."""

    kind: Origin
    text: Text


class JointEntry(SourcedEntry):
    """One coordinate of q."""

    model_config = ConfigDict(json_schema_extra=LIMITS_BY_KIND)

    kind: JointKind
    """What it does: a continuous joint rotates without end, and has no limits."""
    lower: Number | None = None
    upper: Number | None = None
    home: Number = 0.0
    max_speed: Number | None = None
    max_acceleration: Number | None = None
    max_effort: Number | None = None
    """N or N m; kept for other programs."""


class FrameEntry(SourcedEntry):
    """A frame: first `xyz`, then `rpy` about the fixed axes of the parent, then the joint about or along `axis`."""

    parent: Name
    xyz: Vector = [0.0, 0.0, 0.0]
    rpy: Vector = [0.0, 0.0, 0.0]
    joint: Name | None = None
    axis: Vector | None = None


class PairEntry(SourcedEntry):
    """A pair list: pairs of its own, other lists included, or both."""

    pairs: dict[Name, list[Name]] = {}
    include: list[Name] = []


def _with_reasons(value: Any) -> Any:
    """The pairs of a component, if each has its reason."""
    if isinstance(value, dict) and all(isinstance(reason, str) and reason.strip() for reason in value.values()):
        return value
    raise PydanticCustomError("no_reason", 'expected a reason for each pair: {A: {B: "why A and B may touch"}}')


class AdjacentEntry(SourcedEntry):
    """Pairs that are adjacent although the tree does not show it, each with the reason: {A: {B: "why"}}."""

    pairs: dict[Name, Annotated[dict[Name, str], BeforeValidator(_with_reasons)]]


class RobotDetectorEntry(DetectorPartsEntry, SourcedEntry):
    """An approximation, a pair list and a safe distance."""


class ConventionEntry(SourcedEntry):
    """Another way to count the joints: q_other = q + offset."""

    offsets: dict[Name, Number]


class WheelsEntry(SourcedEntry):
    """The driven wheels of a base: how large, and how far from its middle."""

    radius: Number
    half_track: Number
    half_wheelbase: Number | None = None
    """Of four mecanum wheels alone: from the middle to the front or the rear axle."""


class InertiaEntry(SourcedEntry):
    """The mass that moves with a frame, in kg and kg m^2 whatever the units; kept for other programs."""

    mass: Number
    com: Vector = [0.0, 0.0, 0.0]
    """The centre of mass in the frame."""
    inertia: Annotated[list[Number], Field(min_length=6, max_length=6)]
    """xx, yy, zz, xy, xz, yz about the centre of mass, along the axes of the frame."""


def _need_one(tool: str | None, info: ValidationInfo) -> str | None:
    if tool is None and not info.data.get("tools", True):
        raise PydanticCustomError("missing", "one tool at least")
    return tool


class RobotFile(Entry):
    """The whole file."""

    model_config = ConfigDict(json_schema_extra={"anyOf": [{"required": ["tool"]}, {"required": ["tools"]}]})

    name: Name
    title: Annotated[str, Field(max_length=MAX_TEXT_LENGTH)] = ""
    units: UnitsEntry = UnitsEntry()
    convention: Name = "own"
    sources: dict[Name, SourceEntry] = {}
    joints: Annotated[dict[Name, JointEntry], Field(max_length=MAX_JOINTS)]
    frames: Annotated[dict[Name, FrameEntry], Field(max_length=MAX_ENTRIES)]
    tools: Annotated[dict[Name, Name], Field(max_length=MAX_TOOLS)] = {}
    """Name -> frame, of a robot with several tools; `tool` names one of them, or a frame (default: the first)."""
    tool: Annotated[Name | None, AfterValidator(_need_one), Field(validate_default=True)] = None
    conventions: Annotated[dict[Name, ConventionEntry], OfLists] = {}
    spheres: Annotated[dict[Name, Annotated[list[SphereRowEntry], Field(max_length=MAX_ENTRIES)]], OfLists] = {}
    adjacent: AdjacentEntry | None = None
    compare: dict[Name, list[Name]] = {}
    """Pairs that `non_adjacent` has although one joint joins them: {A: [B]}."""
    pairs: Annotated[dict[Name, PairEntry], OfLists] = {}
    detectors: Annotated[dict[Name, RobotDetectorEntry], OfLists] = {}
    default_detector: Name | None = None
    wheels: WheelsEntry | None = None
    drive: Drive | None = None
    inertias: Annotated[dict[Name, InertiaEntry], Field(max_length=MAX_ENTRIES)] = {}


def parse_robot(document: Document) -> Robot:
    """Turn a YAML document into a checked `Robot`, SI inside; raises `FileError` with line and key."""
    robot = _parse(document, check_robot)
    return robot.with_tool() if robot.tools else robot


def parse_part(document: Document) -> Robot:
    """A robot that may have no joints; then nothing is known of its pairs."""
    return _parse(document, _check_part)


def _parse(document: Document, check: Callable[[Robot], Robot]) -> Robot:
    try:
        file = RobotFile.model_validate(document.data)
    except ValidationError as error:
        raise as_file_error(document, error, RobotFile) from None
    try:
        return check(_to_robot(file))
    except InputError as error:
        raise place_errors(document, error) from None


def _check_part(draft: Robot) -> Robot:
    """What can be wrong with a rigid part is found with a joint beside it."""
    if draft.joints:
        return check_robot(draft)
    joint = Joint(name="beside", kind="continuous", home=0.0)
    frame = _to_frame("beside the part", FrameEntry(parent=WORLD, joint=joint.name, axis=[0.0, 0.0, 1.0]), 1.0, 1.0)
    check_robot(replace(draft, joints=(joint,), frames=(*draft.frames, frame)))
    return draft


def _to_robot(file: RobotFile) -> Robot:
    length, angle = file.units.length_m, file.units.angle_rad
    unit = {"revolute": angle, "prismatic": length, "continuous": angle}
    if sum(len(entry.spheres or ()) or entry.count for rows in file.spheres.values() for entry in rows) > MAX_SPHERES:
        raise InputError(f"expected at most {MAX_SPHERES:,} spheres in all", ("spheres",))
    lists: dict[str, Pairs] = {}
    errors = ErrorList()
    joints = errors.collect(partial(_to_joint, name, entry, unit[entry.kind]) for name, entry in file.joints.items())
    frames = errors.collect(partial(_to_frame, name, entry, length, angle) for name, entry in file.frames.items())
    approximations = {
        name: errors.collect(partial(to_spheres, e, length, ("spheres", name, k)) for k, e in enumerate(rows))
        for name, rows in file.spheres.items()
    }
    errors.raise_all()
    return Robot(
        name=file.name,
        title=file.title,
        joints=joints,
        frames=frames,
        tool=_choose_tool(file),
        tools=file.tools,
        approximations=approximations,
        pair_lists={name: _to_pairs(file, name, (), lists) for name in file.pairs},
        adjacent=_to_adjacent(file.adjacent.pairs) if file.adjacent else (),
        compared=tuple((a, b) for a, others in file.compare.items() for b in others),
        detectors={name: make_detector(name, entry, file.units) for name, entry in file.detectors.items()},
        default_detector=_choose_default(file),
        convention=file.convention,
        conventions={n: {j: v * angle for j, v in e.offsets.items()} for n, e in file.conventions.items()},
        provenance=_provenance(file),
        wheels=_to_wheels(file.wheels, length) if file.wheels else None,
        drive=file.drive,
        inertias={name: _to_inertia(entry, length) for name, entry in file.inertias.items()},
    )


def _to_wheels(entry: WheelsEntry, length: float) -> Wheels:
    base = None if entry.half_wheelbase is None else entry.half_wheelbase * length
    return Wheels(radius_m=entry.radius * length, half_track_m=entry.half_track * length, half_wheelbase_m=base)


def _to_inertia(entry: InertiaEntry, length: float) -> Inertia:
    xx, yy, zz, xy, xz, yz = entry.inertia
    I_com_frame = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    return Inertia(mass_kg=entry.mass, p_frame_com=np.array(entry.com) * length, I_com_frame=I_com_frame)


def _to_joint(name: str, entry: JointEntry, unit: float) -> Joint:
    keys = ("lower", "upper", "home", "max_speed", "max_acceleration")
    given = {key: value * unit for key in keys if (value := getattr(entry, key)) is not None}
    given |= {} if entry.max_effort is None else {"max_effort": entry.max_effort}
    for key in keys[:2]:
        if key not in given and entry.kind != "continuous":
            raise InputError("this key is missing", ("joints", name, key))
    return Joint(name=name, kind=entry.kind, **given)


def _to_frame(name: str, entry: FrameEntry, length: float, angle: float) -> Frame:
    return Frame(
        name=name,
        parent=entry.parent,
        p_parent_frame=np.array(entry.xyz) * length,
        R_parent_frame=rotation_from_rpy(np.array(entry.rpy) * angle),
        joint=entry.joint,
        axis=None if entry.axis is None else _unit(name, np.array(entry.axis)),
    )


def _unit(name: str, axis: np.ndarray) -> np.ndarray:
    norm = np.linalg.norm(axis)
    if not 1e-9 < norm < np.inf:
        raise InputError("expected an axis that is not zero", ("frames", name, "axis"))
    return axis / norm


def _to_pairs(file: RobotFile, name: str, seen: tuple[str, ...], known: dict[str, Pairs]) -> Pairs:
    """Pairs of a list with those of the lists it includes, each once, whichever way round.

    Lists that are done are kept in `known`: each may be included again and again.
    """
    if name in known:
        return known[name]
    if name in seen:
        raise InputError("this list includes itself", ("pairs", seen[0], "include"))
    if name not in file.pairs:
        raise InputError(f"no pair list is called {name!r}{nearest(name, file.pairs)}", ("pairs", seen[-1], "include"))
    entry = file.pairs[name]
    unique: dict[frozenset[str], tuple[str, str]] = {}
    for other in dict.fromkeys(entry.include):
        for pair in _to_pairs(file, other, (*seen, name), known):
            unique.setdefault(frozenset(pair), pair)
    for a, others in entry.pairs.items():
        for b in others:
            unique.setdefault(frozenset((a, b)), (a, b))
    if len(unique) > MAX_PAIRS:
        raise InputError(f"expected at most {MAX_PAIRS:,} pairs", ("pairs", name))
    known[name] = tuple(unique.values())
    return known[name]


def _to_adjacent(pairs: dict[str, dict[str, str]]) -> tuple[AdjacentPair, ...]:
    return tuple(AdjacentPair(a=a, b=b, reason=reason) for a, others in pairs.items() for b, reason in others.items())


def _choose_tool(file: RobotFile) -> str:
    """The frame of the tool that the file names, or of its first one."""
    return next(iter(file.tools.values())) if file.tool is None else file.tools.get(file.tool, file.tool)


def _choose_default(file: RobotFile) -> str:
    """The detector that the file names, or its only one."""
    if file.default_detector is not None:
        return file.default_detector
    if len(file.detectors) > 1:
        known = ", ".join([*file.detectors, NO_DETECTOR])
        raise InputError(f"there are several detectors: name one of {known}", ("default_detector",))
    return next(iter(file.detectors), NO_DETECTOR)


def _provenance(file: RobotFile) -> dict[Where, Provenance]:
    """Path of every entry (or of every key of it) that names a source -> that source."""
    found: dict[Where, Provenance] = {}
    sections = ("joints", "frames", "conventions", "pairs", "detectors", "inertias")
    entries: list[tuple[Where, Any]] = [
        ((s, name), entry) for s in sections for name, entry in getattr(file, s).items()
    ]
    entries += [((key,), entry) for key in ("adjacent", "wheels") if (entry := getattr(file, key))]
    entries += [(("spheres", n, i), e) for n, rows in file.spheres.items() for i, e in enumerate(rows)]
    for where, entry in entries:
        named = entry.source if isinstance(entry.source, dict) else {None: entry.source}
        for key, source in named.items():
            if source is None:
                continue
            if source not in file.sources:
                message = f"no source is called {source!r}{nearest(source, file.sources)}"
                raise InputError(message, (*where, "source"))
            if key is not None and key not in entry.model_dump(by_alias=True):
                raise InputError(f"this entry has no key {key!r} to name a source for", (*where, "source", key))
            place = where if key is None else (*where, key)
            found[place] = Provenance(kind=file.sources[source].kind, text=file.sources[source].text)
    return found

"""A robot as its YAML file, m and rad: what `load_robot` reads back is equal, rotations to the last digits."""

from collections.abc import Iterable, Mapping
from os import PathLike
from typing import Any

import numpy as np

from ikde.errors import FileError, printable
from ikde.formats.reading import read_path
from ikde.io.urdf import rpy_from_rotation
from ikde.io.xml_file import write_xml
from ikde.io.yaml_text import format_flow
from ikde.model.robot import Frame, FreeSpheres, Inertia, Joint, Provenance, Robot, Spheres
from ikde.model.validate import NON_ADJACENT

Entry = dict[str, Any]
_AS_SPHERES = "spheres"
OF_OTHERS = (".urdf", ".xacro", ".srdf", ".xml", ".stl", ".obj", ".dae", ".html")
"""Endings of files that an import reads, or that stand beside a robot's."""


def write_robot(robot: Robot, path: str | PathLike[str], notes: Iterable[str] = ()) -> None:
    """Write a robot's file, whole or not at all.

    Raises:
        FileError: if it cannot be written, or its name is that of another kind of file, as which it would be read.
    """
    place = read_path(path, "path")
    if place.suffix.lower() in OF_OTHERS:
        raise FileError(place, "a robot file is YAML; expected a name that ends in .yaml")
    write_xml(place, format_robot_file(robot, notes))


def format_robot_file(robot: Robot, notes: Iterable[str] = ()) -> str:
    """The text of a robot's file, a line an entry, `notes` as comments on top."""
    robot = robot.whole
    sources = _Sources(robot.provenance)
    sections = {
        "joints": {joint.name: _joint_entry(joint) for joint in robot.joints},
        "frames": {frame.name: _frame_entry(frame) for frame in robot.frames},
        "conventions": {name: {"offsets": dict(offsets)} for name, offsets in robot.conventions.items()},
        "pairs": {
            name: {"pairs": _group((a, b, None) for a, b in listed)}
            for name, listed in robot.pair_lists.items()
            if name != NON_ADJACENT
        },
        "detectors": {
            name: {"spheres": d.spheres, "pairs": d.pairs, "safe_distance": d.safe_distance_m}
            for name, d in robot.detectors.items()
        },
        "inertias": {name: _inertia_entry(inertia) for name, inertia in robot.inertias.items()},
    }
    texts = {key: _section(key, {n: sources.add(e, key, n) for n, e in own.items()}) for key, own in sections.items()}
    head = {"name": robot.name, "title": robot.title, "convention": robot.convention}
    lines = [
        *(f"# {printable(note)}" for note in notes),
        *(f"{key}: {format_flow(value)}" for key, value in head.items()),
    ]
    below = [*texts["joints"], *texts["frames"], "", *_tool_lines(robot), *_base_lines(robot, sources)]
    below += [*texts["conventions"], *_sphere_lines(robot, sources), *_adjacent_lines(robot, sources)]
    below += [*_compare_lines(robot), *texts["pairs"]]
    below += [*texts["detectors"], "", f"default_detector: {format_flow(robot.default_detector)}", *texts["inertias"]]
    return "\n".join([*lines, *_section("sources", sources.entries), *below]) + "\n"


class _Sources:
    """Sources of a robot's numbers under names of their own, and which entries name them."""

    def __init__(self, provenance: Mapping[tuple[str | int, ...], Provenance]) -> None:
        every = dict.fromkeys(provenance.values())
        names = {source: f"source_{number}" for number, source in enumerate(every, 1)}
        self.entries: dict[str, Entry] = {names[s]: {"kind": s.kind, "text": s.text} for s in every}
        self._whole = {where: names[source] for where, source in provenance.items()}
        self._keys: dict[tuple[str | int, ...], dict[str, str]] = {}
        for where, source in provenance.items():
            self._keys.setdefault(where[:-1], {})[str(where[-1])] = names[source]

    def add(self, entry: Entry, *where: str | int) -> Entry:
        """The entry at a path with its source, or the sources of its keys."""
        source = self._whole.get(where) or self._keys.get(where)
        return entry | ({"source": source} if source else {})


def _joint_entry(joint: Joint) -> Entry:
    ends = {} if joint.kind == "continuous" else {"lower": joint.lower, "upper": joint.upper}
    more = {key: getattr(joint, key) for key in ("max_speed", "max_acceleration", "max_effort")}
    return {"kind": joint.kind, **ends, "home": joint.home} | {k: v for k, v in more.items() if v is not None}


def _frame_entry(frame: Frame) -> Entry:
    entry: Entry = {"parent": frame.parent}
    if frame.p_parent_frame.any():
        entry["xyz"] = frame.p_parent_frame.tolist()
    if not np.array_equal(frame.R_parent_frame, np.eye(3)):
        entry["rpy"] = rpy_from_rotation(frame.R_parent_frame).tolist()
    if frame.joint is not None and frame.axis is not None:
        entry |= {"joint": frame.joint, "axis": frame.axis.tolist()}
    return entry


def _row_entry(row: Spheres) -> Entry:
    if isinstance(row, FreeSpheres):
        return {"component": row.component, "frame": row.frame, "spheres": [list(sphere) for sphere in row.spheres]}
    line: Entry = {} if row.end == row.start else {"to": row.end}
    many: Entry = {"count": row.count} if row.count != 1 else {}
    many |= {"spacing": row.spacing} if row.spacing != "touching" else {}
    return {"component": row.component, "from": row.start, **line, "radius": row.radius_m, **many}


def _inertia_entry(inertia: Inertia) -> Entry:
    I_com = inertia.I_com_frame
    moments = [*np.diag(I_com).tolist(), I_com[0, 1], I_com[0, 2], I_com[1, 2]]
    return {"mass": inertia.mass_kg, "com": inertia.p_frame_com.tolist(), "inertia": list(map(float, moments))}


def _group(pairs: Iterable[tuple[str, str, str | None]]) -> Entry:
    """Pairs by their first component: lists, or the reasons of each."""
    grouped: dict[str, Any] = {}
    for a, b, reason in pairs:
        if reason is None:
            grouped.setdefault(a, []).append(b)
        else:
            grouped.setdefault(a, {})[b] = reason
    return grouped


def _sphere_lines(robot: Robot, sources: _Sources) -> list[str]:
    lines = ["", "spheres:"] if robot.approximations else []
    for name, rows in robot.approximations.items():
        lines.append(f"  {format_flow(name)}:{'' if rows else ' []'}")
        lines += [
            f"    - {format_flow(sources.add(_row_entry(row), _AS_SPHERES, name, k))}" for k, row in enumerate(rows)
        ]
    return lines


def _adjacent_lines(robot: Robot, sources: _Sources) -> list[str]:
    if not robot.adjacent:
        return []
    grouped = _group((pair.a, pair.b, pair.reason) for pair in robot.adjacent)
    source = sources.add({}, "adjacent")
    lines = ["", "adjacent:", *(f"  {key}: {format_flow(value)}" for key, value in source.items()), "  pairs:"]
    return [*lines, *(f"    {format_flow(a)}: {format_flow(others)}" for a, others in grouped.items())]


def _compare_lines(robot: Robot) -> list[str]:
    grouped = _group((a, b, None) for a, b in robot.compared)
    return (
        ["", "compare:", *(f"  {format_flow(a)}: {format_flow(others)}" for a, others in grouped.items())]
        if grouped
        else []
    )


def _tool_lines(robot: Robot) -> list[str]:
    named = next((name for name, frame in robot.tools.items() if frame == robot.tool), robot.tool)
    tools = [f"tools: {format_flow(dict(robot.tools))}"] if robot.tools else []
    return [*tools, f"tool: {format_flow(named)}"]


def _base_lines(robot: Robot, sources: _Sources) -> list[str]:
    lines = [f"drive: {robot.drive}"] if robot.drive else []
    if robot.wheels:
        entry = {"radius": robot.wheels.radius_m, "half_track": robot.wheels.half_track_m}
        if robot.wheels.half_wheelbase_m is not None:
            entry["half_wheelbase"] = robot.wheels.half_wheelbase_m
        lines.append(f"wheels: {format_flow(sources.add(entry, 'wheels'))}")
    return lines


def _section(key: str, entries: Mapping[str, Entry]) -> list[str]:
    """A key with its entries, a line each; nothing for none."""
    return (
        ["", f"{key}:", *(f"  {format_flow(name)}: {format_flow(entry)}" for name, entry in entries.items())]
        if entries
        else []
    )

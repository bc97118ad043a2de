"""A robot as text: what it is made of, and where its numbers come from."""

from collections import Counter
from collections.abc import Iterable
from dataclasses import asdict
from typing import Any

from ikde.formats.units import LENGTHS_M
from ikde.model.collision_model import CollisionModel
from ikde.model.robot import Joint, Robot, Wheels
from ikde.report.numbers import Units
from ikde.report.pairs import describe_pairs, pairs_json
from ikde.report.render import make_table, plain, render

WIDE = 80  # columns


def robots_json(robots: Iterable[Robot]) -> list[dict[str, Any]]:
    """A line a robot, as plain data."""
    return [
        {
            "name": robot.name,
            "title": robot.title,
            "joints": len(robot.joints),
            "detectors": list(robot.detectors),
            "source": _name_source(robot),
        }
        for robot in robots
    ]


def format_robots(robots: Iterable[Robot], *, color: bool = False, width: int = 100) -> str:
    """A line a robot; where there is little room, without its detectors."""
    wide = ["detectors"] if width >= WIDE else []
    table = make_table("robot", ">joints", *wide, "frames from", "title")
    for robot in robots:
        names = ", ".join(robot.detectors) or "none"
        cells = [names] * len(wide) + [_name_source(robot), robot.title]
        table.add_row(plain(robot.name), str(len(robot.joints)), *map(plain, cells))
    return render(table, color=color, width=width)


def _name_source(robot: Robot) -> str:
    """Who published most of its frames: the first words of their source; nothing if no source is named."""
    named = Counter(source.text for where, source in robot.provenance.items() if where[0] == "frames")
    published = {source.text for source in robot.provenance.values() if source.kind == "published"}
    text = next((text for text, _ in named.most_common() if text in published), "")
    return text.partition(",")[0].partition(":")[0].strip("[]")


def robot_json(collision: CollisionModel) -> dict[str, Any]:
    """A robot as plain data, m and rad, with the pairs that a detector compares and leaves out."""
    robot = collision.robot
    return {
        "name": robot.name,
        "title": robot.title,
        "convention": robot.convention,
        "conventions": [robot.convention, *robot.conventions],
        "tool": robot.tool,
        "tools": dict(robot.tools),
        "joints": [_joint_json(joint) for joint in robot.joints],
        "frames": [
            {"name": f.name, "parent": f.parent, "p_parent_frame": f.p_parent_frame.tolist(), "joint": f.joint}
            for f in robot.frames
        ],
        "approximations": {
            name: {"components": list(robot.components(name)), "spheres": sum(row.count for row in rows)}
            for name, rows in robot.approximations.items()
        },
        "pair_lists": {name: [list(pair) for pair in pairs] for name, pairs in robot.pair_lists.items()},
        "detectors": {
            name: {"spheres": d.spheres, "pairs": d.pairs, "safe_distance_m": d.safe_distance_m}
            for name, d in robot.detectors.items()
        },
        "default_detector": robot.default_detector,
        "adjacent": [asdict(pair) for pair in robot.adjacent],
        "collision": pairs_json(collision),
        "wheels": None if robot.wheels is None else asdict(robot.wheels),
        "drive": robot.drive,
        "provenance": dict(Counter(p.kind for p in robot.provenance.values())),
    }


def _joint_json(joint: Joint) -> dict[str, Any]:
    """A continuous joint's limits are null: JSON has no infinities."""
    ends = {"lower": None, "upper": None} if joint.kind == "continuous" else {}
    return asdict(joint) | ends


def format_robot(collision: CollisionModel, units: Units, *, color: bool = False, width: int = 100) -> str:
    """A robot for the terminal: joints, frames, detectors, how many pairs one compares, where its numbers come from."""
    robot = collision.robot
    head = f"[bold]{plain(robot.name)}[/]: {plain(robot.title)}"
    wheels = [_wheel_table(robot, robot.wheels, units)] if robot.wheels else []
    detectors = [_detector_table(robot, units)] if robot.detectors else []
    parts = [_joint_table(robot, units), _frame_table(robot, units), *wheels, *detectors]
    pairs = describe_pairs(collision)
    above, below = render(head, "", *parts, color=color, width=width), render(_sources(robot), color=color, width=width)
    return "\n\n".join([above, _describe_tools(robot), pairs, below])


def _describe_tools(robot: Robot) -> str:
    """The tool; of a robot with several all of them, by name."""
    others = ", ".join(f"{name} ({frame})" for name, frame in robot.tools.items())
    return f"tool: {robot.tool}{f'; tools by name: {others}' if others else ''}"


def _joint_table(robot: Robot, units: Units) -> Any:
    heads = ("joint", "?kind", ">lower", ">home", ">upper", "unit", "limits from")
    table = make_table(*heads, title=f"joints, {robot.convention} convention")
    for joint in robot.joints:
        values = [units.format_limit(joint, value, 6) for value in (joint.lower, joint.home, joint.upper)]
        source = _source_kind(robot, "joints", joint.name, "lower")
        table.add_row(plain(joint.name), joint.kind, *values, units.joint_unit(joint), source)
    return table


def _frame_table(robot: Robot, units: Units) -> Any:
    table = make_table("frame", "parent", f"offset [{units.length}]", "joint", "?from", title="frames")
    for frame in robot.frames:
        offset = " ".join(f"{v / LENGTHS_M[units.length]:.6g}" for v in frame.p_parent_frame)
        names = map(plain, (frame.name, frame.parent, offset, frame.joint or ""))
        table.add_row(*names, _source_kind(robot, "frames", frame.name))
    return table


def _wheel_table(robot: Robot, wheels: Wheels, units: Units) -> Any:
    table = make_table("wheels", f">[{units.length}]", "from", title="wheels")
    sizes = {"radius": wheels.radius_m, "half_track": wheels.half_track_m, "half_wheelbase": wheels.half_wheelbase_m}
    for key, value in [(key, value) for key, value in sizes.items() if value is not None]:
        table.add_row(key, f"{value / LENGTHS_M[units.length]:.6g}", _source_kind(robot, "wheels", key))
    return table


def _detector_table(robot: Robot, units: Units) -> Any:
    table = make_table("detector", "spheres", ">number", "pairs", ">number", ">safe distance", title="detectors")
    for name, detector in robot.detectors.items():
        spheres = sum(row.count for row in robot.approximations[detector.spheres])
        pairs = len(robot.pair_lists[detector.pairs])
        shown = f"{name} (default)" if name == robot.default_detector else name
        distance = units.format_length(detector.safe_distance_m)
        table.add_row(plain(shown), plain(detector.spheres), str(spheres), plain(detector.pairs), str(pairs), distance)
    return table


def _source_kind(robot: Robot, *where: str) -> str:
    """Where the numbers at a place, or else those of the whole entry, come from."""
    source = robot.provenance.get(where) or robot.provenance.get(where[:-1])
    return source.kind if source else ""


def _sources(robot: Robot) -> Any:
    table = make_table("provenance", ">entries", "source", title="where the numbers come from")
    counts = Counter((source.kind, source.text) for source in robot.provenance.values())
    for (kind, text), count in sorted(counts.items()):
        table.add_row(kind, str(count), plain(text))
    return table

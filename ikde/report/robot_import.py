"""What an import made of a URDF: joints, what is frozen, spheres, pairs, home and warnings, as text and as JSON."""

from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from ikde.formats.units import ANGLES_RAD, LENGTHS_M
from ikde.io.urdf_import.held import HeldJoint
from ikde.io.urdf_import.imported import OF_THE_TREE, CoveredLink, ImportedUrdf, describe_pairs
from ikde.model.collision_model import CollisionModel
from ikde.model.robot import WORLD, Joint, Robot
from ikde.report.numbers import Units, count_of
from ikde.report.pairs import pairs_json
from ikde.report.render import make_table, plain, render


def import_json(imported: ImportedUrdf) -> dict[str, Any]:
    """All that was decided, m and rad."""
    robot = imported.robot
    return {
        "file": imported.file,
        "name": robot.name,
        "root": imported.root,
        "tool": robot.tool,
        "tools": dict(robot.tools),
        "tool_was_chosen": imported.tool_was_chosen,
        "drive": robot.drive,
        "chain": [{"joint": joint, "link": link} for joint, link, _ in _list_chain(robot)],
        "joints": [_joint_json(joint, imported.joint_notes.get(joint.name, "")) for joint in robot.joints],
        "frames": len(robot.frames),
        "frozen": [asdict(held) for held in imported.held],
        "spheres": [asdict(link) for link in imported.links],
        "collision": pairs_json(CollisionModel.of(robot)),
        "never_touching": [list(pair) for pair in imported.never_touching],
        "home": imported.home,
        "home_is_free": imported.is_home_free,
        "warnings": list(imported.warnings),
    }


def _joint_json(joint: Joint, note: str) -> dict[str, Any]:
    """A continuous joint's limits are null: JSON has no infinities."""
    ends = {"lower": None, "upper": None} if joint.kind == "continuous" else {}
    return asdict(joint) | ends | {"note": note}


def format_import(imported: ImportedUrdf, units: Units, *, color: bool = False, width: int = 100) -> str:
    """All that was decided, for the terminal."""
    robot = imported.robot
    chosen = ", the only end that a joint moves" if imported.tool_was_chosen else ""
    head = f"[bold]{plain(robot.name)}[/] from {plain(imported.file)}: tool {plain(robot.tool)}{chosen}"
    tables = [_joint_table(imported, units)]
    tables += [_held_table(imported, units)] if imported.held else []
    tables += [sphere_table(imported.links, units)] if imported.links else []
    collision = CollisionModel.of(robot)
    tables += [_pair_table(collision)] if _list_told(collision) else []
    lines = [f"tools: {plain(', '.join(robot.tools))}; the first one unless another is chosen"] if robot.tools else []
    lines += map(plain, _describe_chain(imported))
    lines += [f"home: {plain(imported.home)}{_say_free(imported.is_home_free)}"]
    lines += [f"[bold]warning:[/] {plain(warning)}" for warning in imported.warnings]
    return render(head, "", *tables, "", f"pairs: {describe_pairs(imported)}", *lines, color=color, width=width)


def _list_chain(robot: Robot) -> list[tuple[str, str, str]]:
    """Joints from the root to the tool, the frame that each moves, and that frame's parent."""
    frames, chain, name = {frame.name: frame for frame in robot.frames}, [], robot.tool
    while name != WORLD:
        frame = frames[name]
        chain += [(frame.joint, name, frame.parent)] if frame.joint else []
        name = frame.parent
    return chain[::-1]


def _describe_chain(imported: ImportedUrdf) -> list[str]:
    """What moves the tool, link by link; and how the last joint is left out if the tool was not named."""
    robot, chain = imported.robot, _list_chain(imported.robot)
    steps = [f"{joint} moves {link}" for joint, link, _ in chain]
    end = [] if chain and chain[-1][1] == robot.tool else [f"the tool {robot.tool} is fixed to it"]
    lines = [f"chain: {', '.join([*steps, *end])}"]
    if imported.tool_was_chosen and len(chain) > 1:
        joint, _, parent = chain[-1]
        lines.append(f"tool: if {joint} opens a gripper, --tool {parent} names a link before it")
    return lines


def _say_free(is_free: bool | None) -> str:
    return {True: "; free", False: "", None: "; not checked"}[is_free]


def _joint_table(imported: ImportedUrdf, units: Units) -> Any:
    table = make_table(
        "joint", "?kind", ">lower", ">home", ">upper", "unit", "?speed", "?", title="joints that move the tool"
    )
    for joint in imported.robot.joints:
        values = [units.format_limit(joint, value, 6) for value in (joint.lower, joint.home, joint.upper)]
        speed = "" if joint.max_speed is None else f"{units.joint_value(joint, joint.max_speed):.4g}/s"
        note = imported.joint_notes.get(joint.name, "")
        table.add_row(plain(joint.name), joint.kind, *values, units.joint_unit(joint), speed, plain(note))
    return table


def _held_table(imported: ImportedUrdf, units: Units) -> Any:
    table = make_table("joint", "?kind", ">at", "why", title=f"frozen: {count_of(len(imported.held), 'joint')}")
    for held in imported.held:
        table.add_row(plain(held.name), held.kind, _format_held(held, units), plain(held.reason))
    return table


def _format_held(held: HeldJoint, units: Units) -> str:
    is_slide = held.kind == "prismatic"
    scale, unit = (LENGTHS_M[units.length], units.length) if is_slide else (ANGLES_RAD[units.angle], units.angle)
    return f"{held.value / scale:.5g} {unit}"


def sphere_table(links: Sequence[CoveredLink], units: Units) -> Any:
    """A line a link: what was covered, with how many spheres, and what is proved of them."""
    total = sum(link.spheres for link in links)
    is_made = any(link.covered is not None for link in links)  # all others are taken as they are
    heads = ("link", "?shapes", ">spheres", *((">covered", f">stand out [{units.length}]") if is_made else ()), "?how")
    table = make_table(*heads, title=f"spheres: {total:,} on {count_of(len(links), 'link')}")
    for link in links:
        covered = "" if link.covered is None else f"{100.0 * link.covered:.2f} %"
        out = "" if link.protrusion_m is None else f"{link.protrusion_m / LENGTHS_M[units.length]:.3g}"
        made = (covered, out) if is_made else ()
        table.add_row(plain(link.link), link.shapes, str(link.spheres), *made, plain(link.how))
    return table


def _list_told(collision: CollisionModel) -> list[Any]:
    """Pairs that are left out for a reason that the tree does not show."""
    return [pair for pair in collision.left_out_pairs if not pair.reason.startswith(OF_THE_TREE)]


def _pair_table(collision: CollisionModel) -> Any:
    table = make_table("pair", "why", title="left out beside neighbours")
    for pair in _list_told(collision):
        table.add_row(plain(f"{pair.a} - {pair.b}"), plain(pair.reason.removeprefix("adjacent: ")))
    return table

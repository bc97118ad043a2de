"""`ikde robots spheres`: spheres of links covered anew, or taken from a file, and a page that shows them."""

import shlex
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ikde.cli.options import JsonOption, LengthUnit, PrintedUnitOption, RobotArgument
from ikde.cli.output import page_width, print_json, print_note, print_result, print_written, use_color

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ikde.io.urdf_import.cover_links import LinkSpheres
    from ikde.io.urdf_import.imported import CoveredLink
    from ikde.io.urdf_import.options import ImportOptions
    from ikde.io.urdf_import.refit import UrdfShapes
    from ikde.model.robot import Robot
    from ikde.report.sphere_page import DrawnLink

PROTRUSION_MM = 20.0


def exchange_robot_spheres(
    file: RobotArgument,
    urdf: Annotated[
        str | None, typer.Option(metavar="FILE|NAME", help="Where the shapes are that spheres cover (default: FILE).")
    ] = None,
    link: Annotated[
        list[str] | None, typer.Option(metavar="NAME", help="A link to cover anew; as often as you like.")
    ] = None,
    protrusion: Annotated[
        float, typer.Option(metavar="MM", help="How far its spheres may stand out of its shapes, in mm.")
    ] = PROTRUSION_MM,
    spheres: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Take the links' spheres from cuRobo's robot file, an XRDF or an SRDF."),
    ] = None,
    package_path: Annotated[
        list[Path] | None, typer.Option(metavar="FOLDER", help="A further folder with meshes; as often as you like.")
    ] = None,
    mesh_scale: Annotated[float, typer.Option(metavar="X", help="What meshes are scaled by: 0.001 if in mm.")] = 1.0,
    report: Annotated[
        Path | None, typer.Option(metavar="FILE.html", help="A page with every link's shapes and spheres.")
    ] = None,
    out: Annotated[Path | None, typer.Option("--out", "-o", metavar="FILE", help="The robot file to write.")] = None,
    unit: PrintedUnitOption = LengthUnit.mm,
    as_json: JsonOption = False,
) -> None:
    """Cover links of a robot anew, or take their spheres from a file; show all of them on a page.

    A robot file holds spheres, not shapes: those are in the URDF that it comes from. Pairs that always touched are
    compared again unless they still do.

    Example: ikde robots spheres arm.yaml --urdf arm.urdf --link forearm --protrusion 10 -o arm.yaml --report arm.html
    """
    from ikde.errors import InputError
    from ikde.io.robots import check_kept, find_urdf, is_urdf, robot_path
    from ikde.io.urdf_import.options import ImportOptions
    from ikde.io.urdf_import.refit import exchange_spheres

    if not (link or spheres or report):
        raise InputError("expected --link NAME, --spheres FILE or --report FILE.html, got none")
    if report is not None and report.suffix.lower() not in (".html", ".htm"):
        raise InputError(f"expected a file with the ending .html, got {report.name!r}", ("report",))
    path = robot_path(file)
    shapes_in, folders = find_urdf(urdf) if urdf else (path, ())
    check_kept(out, spheres, *filter(is_urdf, (path, shapes_in)))  # a robot file may be written in its own place
    options = ImportOptions(
        package_paths=(*(package_path or []), *folders), mesh_scale=mesh_scale, protrusion_m=protrusion / 1000.0
    )
    robot, shapes = _read(path, shapes_in, options, needs_shapes=bool(report or (link and not spheres)))
    own, notes = _choose_spheres(robot, shapes, link or [], spheres, options.protrusion_m)
    robot, more = exchange_spheres(robot, own) if own else (robot, [])
    notes += [*(warning for spheres in own.values() for warning in spheres.warnings), *more]
    drawn = [] if report is None or shapes is None else _list_drawn(robot, shapes, own)
    if report is not None:
        again = ["ikde", "robots", "spheres", str(out or file), *(["--urdf", urdf] if urdf else [])]
        _write_page(report, robot.name, drawn, (shlex.join([*again, "--report", report.name]), notes))
    if out is not None:
        _write_robot(robot, out, path, own, notes)
    _show(
        robot.name, [spheres.report for spheres in own.values()] or [each.cover for each in drawn], notes, unit, as_json
    )
    print_written(*filter(None, (out, report)), as_json=as_json)
    if out is None and own:
        print_note("ikde: the robot is not written without -o FILE")


def _read(
    path: Path, shapes_in: Path, options: "ImportOptions", needs_shapes: bool
) -> "tuple[Robot, UrdfShapes | None]":
    """The robot, and the shapes of the URDF if there is one."""
    from ikde.errors import InputError
    from ikde.io.robots import is_urdf, load_robot
    from ikde.io.urdf_import.read_urdf import read_urdf
    from ikde.io.urdf_import.refit import UrdfShapes

    if needs_shapes and not is_urdf(shapes_in):
        raise InputError(
            "expected --urdf FILE: a robot file has spheres, and no shapes to compare them with", ("urdf",)
        )
    shapes = UrdfShapes.read(shapes_in, options) if is_urdf(shapes_in) else None
    return (read_urdf(path, options).robot if is_urdf(path) else load_robot(path)), shapes


def _choose_spheres(
    robot: "Robot", shapes: "UrdfShapes | None", links: list[str], file: Path | None, protrusion_m: float
) -> "tuple[dict[str, LinkSpheres], list[str]]":
    """Spheres of the links that change, and what is worth a warning."""
    from ikde.errors import InputError, nearest, quoted
    from ikde.io.sphere_files import read_spheres
    from ikde.io.urdf_import.given_spheres import give_spheres

    if file is None:
        return {name: shapes.cover(name, protrusion_m) for name in links if shapes}, []
    known = {frame.name: bool(shapes and shapes.shapes.get(frame.name)) for frame in robot.frames}
    given, notes = give_spheres(read_spheres(file), known)
    if unknown := [name for name in links if name not in given]:
        raise InputError(f"{file.name} has no spheres for {quoted(unknown[0])}{nearest(unknown[0], given)}", ("link",))
    return {name: own for name, own in given.items() if not links or name in links}, notes


def _list_drawn(robot: "Robot", shapes: "UrdfShapes", own: "Mapping[str, LinkSpheres]") -> "list[DrawnLink]":
    """Every link with spheres, as it is after the change; what others made is measured."""
    from ikde.io.urdf_import.refit import list_link_spheres
    from ikde.report.sphere_page import DrawnLink

    drawn = []
    for name, spheres in list_link_spheres(robot).items():
        made = own[name].report if name in own else None
        measured = made if made and made.covered is not None else shapes.describe(name, spheres, made)
        triangles = shapes.list_triangles(name)
        drawn.append(DrawnLink(cover=measured, triangles=triangles, centres=spheres[:, :3], radii=spheres[:, 3]))
    return drawn


def _write_page(path: Path, name: str, drawn: "list[DrawnLink]", texts: tuple[str, list[str]]) -> None:
    from ikde.io.xml_file import write_xml
    from ikde.report.html import render_html
    from ikde.report.sphere_page import make_sphere_page

    write_xml(path, render_html(make_sphere_page(name, drawn, *texts)))


def _write_robot(robot: "Robot", out: Path, old: Path, own: "Mapping[str, LinkSpheres]", notes: list[str]) -> None:
    """The robot's file, with the comments of the old one on top."""
    from ikde.io.robot_writer import write_robot
    from ikde.io.robots import is_urdf
    from ikde.io.urdf_import.imported import describe_cover
    from ikde.io.urdf_import.refit import read_comments

    stale = tuple(f"spheres of {name}: " for name in own)
    comments = [] if is_urdf(old) else [line for line in read_comments(old) if not line.startswith(stale)]
    made = [f"spheres of {describe_cover(spheres.report)}" for spheres in own.values()]
    write_robot(robot, out, [*comments, *made, *(f"warning: {note}" for note in notes)])


def _show(name: str, links: "list[CoveredLink]", notes: list[str], unit: LengthUnit, as_json: bool) -> None:
    from dataclasses import asdict

    from ikde.report.numbers import Units
    from ikde.report.render import plain, render
    from ikde.report.robot_import import sphere_table

    if as_json:
        print_json({"robot": name, "spheres": [asdict(link) for link in links], "warnings": notes})
        return
    lines = [f"[bold]warning:[/] {plain(note)}" for note in notes]
    print_result(
        render(f"robot {plain(name)}", sphere_table(links, Units(unit)), *lines, color=use_color(), width=page_width())
    )

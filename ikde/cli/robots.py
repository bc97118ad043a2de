"""`ikde robots`: list, show, validate, export; import and compose have files of their own."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ikde.cli.options import (
    AngleUnit,
    Command,
    DetectorOption,
    Group,
    JsonOption,
    LengthUnit,
    PrintedAnglesOption,
    PrintedUnitOption,
    RobotArgument,
    check_environment,
)
from ikde.cli.output import layout, print_json, print_line, print_note, print_result, print_written
from ikde.cli.robot_choice import read_whole
from ikde.cli.robots_compose import compose_robot
from ikde.cli.robots_import import import_robot
from ikde.cli.robots_spheres import exchange_robot_spheres

if TYPE_CHECKING:
    from ikde.model.collision_model import CollisionModel

robots = typer.Typer(cls=Group, help="The robots that ship with ikde, and files of your own.", no_args_is_help=False)
robots.command("import", cls=Command)(import_robot)
robots.command("compose", cls=Command)(compose_robot)
robots.command("spheres", cls=Command)(exchange_robot_spheres)


@robots.callback(invoke_without_command=True)
def default(context: typer.Context, as_json: JsonOption = False) -> None:
    """List the robots if nothing else is asked for."""
    if context.invoked_subcommand is None:
        check_environment()
        list_robots(as_json)


@robots.command("list", cls=Command)
def list_robots(as_json: JsonOption = False) -> None:
    """List the robots that ship with ikde.

    Example: ikde robots list
    """
    from ikde.io.robots import load_robot, robot_names
    from ikde.report.robot import format_robots, robots_json

    loaded = [load_robot(name) for name in robot_names()]
    if as_json:
        print_json(robots_json(loaded))
    else:
        print_result(format_robots(loaded, **layout()))


@robots.command("show", cls=Command)
def show(
    name: RobotArgument,
    kernels: Annotated[bool, typer.Option("--kernels", help="Print the kernels written for it instead.")] = False,
    pairs: Annotated[bool, typer.Option("--pairs", help="Print the pairs that are compared and left out.")] = False,
    kind: Annotated[str, typer.Option(help="Of which targets: position, axis or pose.")] = "pose",
    detector: DetectorOption = None,
    unit: PrintedUnitOption = LengthUnit.mm,
    angles: PrintedAnglesOption = AngleUnit.deg,
    as_json: JsonOption = False,
) -> None:
    """Show a robot: joints, frames, detectors, and where its numbers come from; or its pairs; or its kernels.

    --pairs lists every pair of components: those that the detector compares, with their clearance at home, and those
    that it leaves out, each with the reason.

    Example: ikde robots show qiao2021 --pairs
    """
    from ikde.errors import InputError
    from ikde.model.collision_model import CollisionModel
    from ikde.report.numbers import Units
    from ikde.report.pairs import format_pairs, pairs_json
    from ikde.report.robot import format_robot, robot_json

    if kernels and pairs:
        raise InputError("expected one of --kernels and --pairs, got both")
    model = read_whole(name)
    chosen = CollisionModel.of(model, detector)
    if kernels:
        source = _format_kernels(chosen, kind)
        if as_json:
            print_json({"robot": model.name, "kind": kind, "source": source})
        else:
            print_result(source)
    elif as_json:
        print_json({"robot": model.name, "collision": pairs_json(chosen)} if pairs else robot_json(chosen))
    elif pairs:
        print_line(f"robot {model.name}")
        print_result(format_pairs(chosen, Units(unit, angles), **layout()))
    else:
        print_result(format_robot(chosen, Units(unit, angles), **layout()))


def _format_kernels(collision: "CollisionModel", kind: str) -> str:
    from ikde.errors import InputError
    from ikde.model.generate.assemble import format_module
    from ikde.model.target import KINDS

    if kind not in KINDS:
        raise InputError(f"expected one of {', '.join(KINDS)}, got {kind!r}", ("kind",))
    return format_module(collision, kind)


@robots.command("validate", cls=Command)
def validate(
    file: Annotated[Path, typer.Argument(help="A robot file.")],
    detector: DetectorOption = None,
    unit: PrintedUnitOption = LengthUnit.mm,
    as_json: JsonOption = False,
) -> None:
    """Check a robot file, and list every pair that its detector compares and leaves out.

    What is wrong is one line with file, line and key (exit code 2). Pairs that touch in every configuration are no
    error, but nothing is ever free then: they are named, with the line to add to the file if they may touch.
    """
    from ikde.io.robots import load_robot
    from ikde.model.collision_model import CollisionModel
    from ikde.report.numbers import Units
    from ikde.report.pairs import format_pairs, pairs_json

    model = load_robot(file).whole
    chosen = CollisionModel.of(model, detector)
    if as_json:
        counts = {"joints": len(model.joints), "frames": len(model.frames)}
        print_json({"valid": True, "name": model.name, **counts, "collision": pairs_json(chosen)})
    else:
        print_line(f"{file}: valid, robot {model.name} with {len(model.joints)} joints and {len(model.frames)} frames")
        print_result(format_pairs(chosen, Units(unit), **layout()))


@robots.command("export", cls=Command)
def export(
    name: RobotArgument,
    urdf: Annotated[bool, typer.Option("--urdf", help="Write URDF.")] = False,
    srdf: Annotated[bool, typer.Option("--srdf", help="Write SRDF: pairs that are left out.")] = False,
    mjcf: Annotated[bool, typer.Option("--mjcf", help="Write MJCF, MuJoCo's format.")] = False,
    curobo: Annotated[
        bool, typer.Option("--curobo", help="Write cuRobo's robot file: spheres, ignored pairs.")
    ] = False,
    xrdf: Annotated[bool, typer.Option("--xrdf", help="Write XRDF: spheres, ignored pairs.")] = False,
    out: Annotated[Path | None, typer.Option("--out", metavar="FILE", help="Where it goes (default: printed).")] = None,
    urdf_path: Annotated[
        str | None,
        typer.Option(metavar="FILE", help="The URDF that --curobo and --xrdf go with (default: written beside --out)."),
    ] = None,
    detector: DetectorOption = None,
) -> None:
    """Write a robot for other programs: frames, joints, limits, and the detector's spheres as collision shapes.

    What the format cannot hold is listed, on the screen and in the file. A URDF goes beside cuRobo's file and XRDF
    unless one is named.

    Example: ikde robots export qiao2021 --urdf --out qiao2021.urdf
    """
    from functools import partial

    from ikde.errors import InputError
    from ikde.io.mjcf import format_mjcf
    from ikde.io.robots import check_kept, robot_path
    from ikde.io.sphere_writers import format_curobo, format_xrdf
    from ikde.io.srdf_writer import format_srdf
    from ikde.io.unheld import BESIDE, Format, list_unheld
    from ikde.io.urdf import format_urdf
    from ikde.io.xml_file import write_xml
    from ikde.model.collision_model import CollisionModel

    kinds: dict[Format, bool] = {"URDF": urdf, "SRDF": srdf, "MJCF": mjcf, "cuRobo": curobo, "XRDF": xrdf}
    wanted: list[Format] = [kind for kind, is_asked in kinds.items() if is_asked]
    if len(wanted) != 1:
        raise InputError(f"expected one of --urdf, --srdf, --mjcf, --curobo and --xrdf, got {len(wanted) or 'none'}")
    kind: Format = wanted[0]
    if urdf_path is not None and kind not in BESIDE:
        raise InputError("only --curobo and --xrdf go with a URDF", ("urdf-path",))
    check_kept(out, robot_path(name))
    robot = read_whole(name)
    is_alone = kind not in BESIDE or out is None or urdf_path is not None
    beside_text = "" if is_alone else format_urdf(robot, collision=detector)
    beside = None if is_alone or out is None else _find_beside(out, beside_text)
    named = urdf_path or (beside.name if beside else "")
    forms = {"URDF": format_urdf, "SRDF": format_srdf, "MJCF": format_mjcf, "XRDF": format_xrdf}
    text = {**forms, "cuRobo": partial(format_curobo, urdf_path=named)}[kind](robot, collision=detector)
    if out is None:
        print_result(text)
    else:
        write_xml(out, text, {beside.name: beside_text} if beside else None)
        print_written(out)
    if beside:
        print_written(beside)
    unheld = list_unheld(CollisionModel.of(robot, detector), kind)
    if kind in BESIDE and not named:
        unheld = (*unheld, "the URDF: name it (--urdf-path FILE), or write it beside (--out FILE)")
    if unheld:
        print_note(f"ikde: {kind} does not hold: {'; '.join(unheld)}")


def _find_beside(out: Path, text: str) -> Path:
    """Where the URDF goes; raises `InputError` if another one is there, which may be the user's own."""
    from ikde.errors import FileError, InputError
    from ikde.formats.reading import read_bytes
    from ikde.io.robots import is_there

    if not out.name:
        raise FileError(out, "cannot be written: expected the name of a file")
    path = out.with_suffix(".urdf")
    if path == out:
        message = f"{path} is where the URDF goes; expected another name, or the URDF that goes with it (--urdf-path)"
        raise InputError(message, ("out",))
    if is_there(path) and not (path.is_file() and read_bytes(path) == text.encode()):
        message = f"{path} is there already, and is not written over; name the URDF that goes with it (--urdf-path)"
        raise InputError(message, ("out",))
    return path

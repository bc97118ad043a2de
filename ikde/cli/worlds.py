"""`ikde worlds`: show, validate and convert files of obstacles."""

from dataclasses import asdict
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ikde.cli.candidates import offer_robots
from ikde.cli.options import Command, DetectorOption, Group, JsonOption, LengthUnit, PrintedUnitOption, check_drawable
from ikde.cli.output import layout, print_json, print_line, print_note, print_result, print_written

if TYPE_CHECKING:
    from ikde.io.world_file import ReadWorld
    from ikde.solver.standing import StandingObstacle

worlds = typer.Typer(cls=Group, help="Files of obstacles: ikde's, cuRobo's and MoveIt's.", no_args_is_help=True)

FileArgument = Annotated[Path, typer.Argument(help="A world file, a cuRobo scene or a MoveIt planning scene.")]


class WorldFormat(StrEnum):
    """What a world is written as."""

    ikde = "ikde"
    moveit = "moveit"
    curobo = "curobo"


@worlds.command("show", cls=Command)
def show(
    file: FileArgument,
    unit: PrintedUnitOption = LengthUnit.mm,
    plot: Annotated[Path | None, typer.Option(metavar="FILE", help="Draw it to a file, such as world.png.")] = None,
    as_json: JsonOption = False,
) -> None:
    """Show a world: every solid, where it stands, margins and groups; or a picture of it.

    Example: ikde worlds show configs/worlds/kitchen.yaml
    """
    from ikde.io.world_file import read_world
    from ikde.report.numbers import Units
    from ikde.report.world import format_world, world_json

    check_drawable(plot)
    found = read_world(file)
    if as_json:
        print_json({"format": found.format, **world_json(found.world), "notes": list(found.notes)})
    else:
        print_result(format_world(found.world, Units(unit), found.notes, **layout()))
    if plot is not None:
        from ikde.plot.pose import save_figure
        from ikde.plot.world import plot_world
        from ikde.scene.drawn_world import draw_world

        save_figure(plot_world(draw_world(found.world, file.stem)), plot)
        print_written(plot, as_json=as_json)


@worlds.command("validate", cls=Command)
def validate(
    file: FileArgument,
    robot: Annotated[
        str | None,
        typer.Option(metavar="NAME|FILE", help="Check that it fits.", autocompletion=offer_robots),
    ] = None,
    detector: DetectorOption = None,
    as_json: JsonOption = False,
) -> None:
    """Check a world file. What is wrong is one line with file, line and key (exit code 2).

    With a robot also: frames and components that it does not have, and what touches whatever its joints do.

    Example: ikde worlds validate scene.yaml --robot ur5
    """
    from ikde.io.world_file import read_world
    from ikde.report.world import describe_world

    found = read_world(file)
    near = [] if robot is None else _check_fit(found, robot, detector)
    if as_json:
        counts = {"obstacles": len(found.world), "digest": found.world.digest}
        fit = {} if robot is None else {"robot": robot, "standing": [asdict(pair) for pair in near]}
        print_json({"valid": True, "format": found.format, **counts, **fit, "notes": list(found.notes)})
        return
    fits = "" if robot is None else f"; fits {robot}: nothing touches in every configuration"
    print_line(f"{file}: valid, {found.format}, {describe_world(found.world)}{fits}")
    for pair in near:
        print_line(f"in every configuration: {pair.component} - {pair.obstacle} {1e3 * pair.clearance_m:.4g} mm")
    for note in found.notes:
        print_line(f"note: {note}")


def _check_fit(found: "ReadWorld", robot: str, detector: str | None) -> "tuple[StandingObstacle, ...]":
    from ikde.cli.robot_choice import read_robot
    from ikde.io.world_fit import check_fit
    from ikde.model.collision_model import CollisionModel

    return check_fit(found, CollisionModel.of(read_robot(robot), detector))


@worlds.command("convert", cls=Command)
def convert(
    file: FileArgument,
    to: Annotated[WorldFormat, typer.Option(help="What to write.")] = WorldFormat.ikde,
    out: Annotated[
        Path | None, typer.Option("--out", "-o", metavar="FILE", help="The file (default: printed).")
    ] = None,
) -> None:
    """Write a world as ikde's own file, which holds all of it, or as a scene; what a scene cannot hold is listed.

    Example: ikde worlds convert scene.yaml --out world.yaml
    """
    from ikde.errors import InputError
    from ikde.io.robots import check_kept
    from ikde.io.scene_writers import FORMATS
    from ikde.io.world_file import read_world
    from ikde.io.world_writer import save_text

    check_kept(out, file)
    found = read_world(file)
    written = FORMATS[to.value](found.world, out.stem if out else file.stem, found.notes)
    if out is None and written.files:
        raise InputError("expected --out FILE: clouds of many points are files beside it", ("out",))
    if out is None:
        print_result(written.text)
    else:
        print_written(*save_text(written, out))
    for note in found.notes:
        print_note(f"ikde: {note}")
    for lost in written.lost:
        print_note(f"ikde: not held by {to.value}: {lost}")

"""`ikde robots`: list, show, validate."""

from pathlib import Path
from typing import Annotated

import typer

from ikde.cli.options import AnglesOption, AngleUnit, JsonOption, LengthUnit, UnitOption
from ikde.cli.output import print_json, print_result, use_color

robots = typer.Typer(help="The robots that ship with ikde, and files of your own.", no_args_is_help=False)


@robots.callback(invoke_without_command=True)
def default(context: typer.Context, as_json: JsonOption = False) -> None:
    """List the robots if nothing else is asked for."""
    if context.invoked_subcommand is None:
        list_robots(as_json)


@robots.command("list")
def list_robots(as_json: JsonOption = False) -> None:
    """List the robots that ship with ikde."""
    from ikde.io.robots import load_robot, robot_names
    from ikde.report.robot import format_robots, robots_json

    loaded = [load_robot(name) for name in robot_names()]
    if as_json:
        print_json(robots_json(loaded))
    else:
        print_result(format_robots(loaded, color=use_color()))


@robots.command("show")
def show(
    name: Annotated[str, typer.Argument(metavar="NAME|FILE", help="A robot of `ikde robots list`, or its file.")],
    unit: UnitOption = LengthUnit.mm,
    angles: AnglesOption = AngleUnit.deg,
    as_json: JsonOption = False,
) -> None:
    """Show a robot: joints, frames, detectors, and where its numbers come from."""
    from ikde.io.robots import load_robot
    from ikde.report.robot import format_robot, robot_json
    from ikde.report.units import Units

    model = load_robot(name)
    if as_json:
        print_json(robot_json(model))
    else:
        print_result(format_robot(model, Units(unit, angles), color=use_color()))


@robots.command("validate")
def validate(
    file: Annotated[Path, typer.Argument(help="A robot file.")],
    as_json: JsonOption = False,
) -> None:
    """Check a robot file: one line if it is good, one line with file, line and key if it is not (exit code 2)."""
    from ikde.io.robots import load_robot

    model = load_robot(file)
    if as_json:
        print_json({"valid": True, "name": model.name, "joints": len(model.joints), "frames": len(model.frames)})
    else:
        print_result(
            f"{file}: valid, robot {model.name} with {len(model.joints)} joints and {len(model.frames)} frames"
        )

"""`ikde robots compose`: an arm on a platform, with a tool."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ikde.cli.options import AngleUnit, JsonOption, LengthUnit, PrintedAnglesOption, PrintedUnitOption
from ikde.cli.output import page_width, print_json, print_result, say_written, use_color

if TYPE_CHECKING:
    from ikde.kernels.arrays import Floats


def compose_robot(
    base: Annotated[str, typer.Option(metavar="NAME|FILE", help="The platform; the arm stands on its tool.")],
    arm: Annotated[str, typer.Option(metavar="NAME|FILE", help="The arm.")],
    mount: Annotated[
        str, typer.Option(metavar="'X Y Z [R P Y]'", help="Where the arm stands on the platform, in m and rad.")
    ] = "0 0 0",
    tool: Annotated[
        Path | None, typer.Option(metavar="FILE", help="A robot file of the tool; its joints are frozen at home.")
    ] = None,
    out: Annotated[Path | None, typer.Option("--out", "-o", metavar="FILE", help="The robot file to write.")] = None,
    unit: PrintedUnitOption = LengthUnit.mm,
    angles: PrintedAnglesOption = AngleUnit.deg,
    as_json: JsonOption = False,
) -> None:
    """Put an arm on a platform, and a tool at its end: all spheres, all joints, one robot file.

    Example: ikde robots compose --base platform.yaml --arm ur5 --mount "0.3 0 0.4" --tool tool.yaml -o robot.yaml
    """
    from ikde.io.robot_writer import write_robot
    from ikde.io.robots import check_kept, load_part, load_robot
    from ikde.model.collision_model import CollisionModel
    from ikde.model.compose import compose
    from ikde.report.numbers import Units
    from ikde.report.robot import format_robot, robot_json

    check_kept(out, Path(base), Path(arm), tool)
    robot = compose(load_robot(base), load_robot(arm), _read_mount(mount), None if tool is None else load_part(tool))
    if out is not None:
        notes = [f"Composed of {base}, {arm} at {mount}{'' if tool is None else f', {tool}'}; m and rad."]
        write_robot(robot, out, notes)
    collision = CollisionModel.of(robot)
    if as_json:
        print_json(robot_json(collision))
    else:
        print_result(format_robot(collision, Units(unit, angles), color=use_color(), width=page_width()))
    say_written(out, as_json=as_json)


def _read_mount(text: str) -> "Floats":
    """A place [4, 4] out of `X Y Z` or `X Y Z R P Y`, m and rad; raises `InputError` for anything else."""
    import numpy as np

    from ikde.errors import InputError, quoted
    from ikde.model.robot import MAX_MAGNITUDE
    from ikde.model.rotation import rotation_from_rpy
    from ikde.model.tree import transform

    try:
        numbers = np.array([float(word) for word in text.replace(",", " ").split()])
    except ValueError:
        numbers = np.empty(0)
    if len(numbers) not in (3, 6) or not np.all(np.abs(numbers) <= MAX_MAGNITUDE):
        raise InputError(f"expected 'X Y Z' or 'X Y Z R P Y', in m and rad, got {quoted(text)}", ("mount",))
    rpy = numbers[3:] if len(numbers) == 6 else np.zeros(3)
    return transform(rotation_from_rpy(rpy), numbers[:3])

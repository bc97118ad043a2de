"""`ikde check`: whether a configuration is free of itself and of a world."""

import typer

from ikde.cli import options
from ikde.cli.candidates import DEFAULT_ROBOT
from ikde.cli.exit_codes import ExitCode
from ikde.cli.output import layout, print_json, print_result
from ikde.cli.robot_choice import ToolOption, read_whole
from ikde.cli.world_options import AttachOption, MarginOption, Pick, WorldOption, place_in_world


def check(
    q: options.QOption = None,
    robot: options.RobotOption = DEFAULT_ROBOT,
    tool: ToolOption = None,
    detector: options.DetectorOption = None,
    pairs: options.PairsOption = None,
    safe_distance: options.SafeDistanceOption = None,
    world: WorldOption = None,
    margin: MarginOption = None,
    attach: AttachOption = None,
    unit: options.UnitOption = options.LengthUnit.m,
    angles: options.AnglesOption = options.AngleUnit.rad,
    convention: options.ConventionOption = None,
    plot: options.PlotOption = None,
    as_json: options.JsonOption = False,
) -> None:
    """Print the clearance of every pair of components, and of obstacles, worst first.

    Exits with 1 on collision, and with 0 where there is none or, as the output says, it was not checked.

    Example: ikde check --q 'q1=90 q2=80' --angles deg --unit mm --detector typical
    """
    from ikde.report.geometry import check_json, format_check
    from ikde.report.numbers import Units
    from ikde.solver.check import check as check_configuration

    model = read_whole(robot, tool)
    values = options.read_q(model, q, unit, angles, convention)
    collision = options.read_collision(model, detector, pairs, safe_distance, unit)
    collision = place_in_world(collision, world, margin, unit, Pick(attach, values))
    result = check_configuration(model, values, collision)
    options.check_drawable(plot)
    options.note_unchecked(model, detector)
    if as_json:
        print_json(check_json(model, result, convention))
    else:
        print_result(format_check(model, result, Units(unit, angles), **layout()))
    options.draw(plot, collision, values, as_json=as_json)
    raise typer.Exit(ExitCode.NOT_REACHED if result.collision else ExitCode.OK)

"""`ikde fk`: where every frame is."""

from ikde.cli import options
from ikde.cli.candidates import DEFAULT_ROBOT
from ikde.cli.output import layout, print_json, print_result
from ikde.cli.robot_choice import ToolOption, read_whole


def fk(
    q: options.QOption = None,
    robot: options.RobotOption = DEFAULT_ROBOT,
    tool: ToolOption = None,
    detector: options.DetectorOption = None,
    unit: options.UnitOption = options.LengthUnit.m,
    angles: options.AnglesOption = options.AngleUnit.rad,
    convention: options.ConventionOption = None,
    plot: options.PlotOption = None,
    as_json: options.JsonOption = False,
) -> None:
    """Print the pose of every frame in the world. Joint values outside the limits are accepted and named.

    Example: ikde fk --q '0 0 0 90 0 0 0 0 0' --angles deg --unit mm
    """
    from ikde.model.collision_model import CollisionModel
    from ikde.report.geometry import format_forward, forward_json
    from ikde.report.numbers import Units
    from ikde.solver.forward import forward
    from ikde.solver.joints import joints_outside

    model = read_whole(robot, tool)
    values = options.read_q(model, q, unit, angles, convention)
    frames, outside = forward(model, values), joints_outside(model, values)
    options.check_drawable(plot)
    collision = CollisionModel.of(model, detector)  # a wrong name is found before anything is printed
    if as_json:
        print_json(forward_json(model, values, frames, outside, convention))
    else:
        print_result(format_forward(model, frames, outside, Units(unit, angles), **layout()))
    options.draw(plot, collision, values, as_json=as_json)

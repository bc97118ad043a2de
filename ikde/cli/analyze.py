"""`ikde analyze`: how well a robot moves where it stands."""

from pathlib import Path
from typing import Annotated

import typer

from ikde.cli import options
from ikde.cli.candidates import DEFAULT_ROBOT
from ikde.cli.output import layout, print_json, print_result, print_written
from ikde.cli.robot_choice import ToolOption, read_whole

ByOption = Annotated[
    str, typer.Option("--by", metavar="joints|twist|actuators", help="What moves it; twist: that of its base.")
]
RotationOption = Annotated[
    float, typer.Option("--radian", metavar="M", help="What a radian of the tool counts as, in m.")
]
EllipsoidsOption = Annotated[
    Path | None, typer.Option("--plot", metavar="FILE", help="Draw the robot with its ellipsoids of velocity.")
]


def analyze(
    q: options.QOption = None,
    robot: options.RobotOption = DEFAULT_ROBOT,
    tool: ToolOption = None,
    by: ByOption = "twist",
    radian: RotationOption = 1.0,
    unit: options.UnitOption = options.LengthUnit.m,
    angles: options.AnglesOption = options.AngleUnit.rad,
    convention: options.ConventionOption = None,
    plot: EllipsoidsOption = None,
    as_json: options.JsonOption = False,
) -> None:
    """Print manipulability, condition and distance to a singularity, of the whole robot, its arm and its base.

    Beside them: what each joint adds, and the room to the joint limits.

    Example: ikde analyze --robot ur5e_mecanum --by actuators --plot ellipsoids.png
    """
    from typing import cast

    from ikde.errors import InputError
    from ikde.model.actuators import By
    from ikde.report.analysis import analysis_json, format_analysis
    from ikde.report.numbers import Units
    from ikde.solver.analysis import analyze as analyze_configuration

    model = read_whole(robot, tool)
    values = options.read_q(model, q, unit, angles, convention)
    try:
        analysis = analyze_configuration(model, values, by=cast(By, by), length_m=radian)
    except InputError as error:
        raise InputError(error.message, ("radian",) if error.where == ("length_m",) else error.where) from None
    options.check_drawable(plot)
    if as_json:
        print_json(analysis_json(analysis, convention))
    else:
        print_result(format_analysis(analysis, Units(unit, angles), **layout()))
    if plot is not None:
        from ikde.model.collision_model import CollisionModel
        from ikde.plot.ellipsoids import plot_ellipsoids
        from ikde.plot.pose import save_figure
        from ikde.scene.drawn_pose import draw_pose
        from ikde.solver.analysis import split_jacobian
        from ikde.solver.forward import forward

        pose = draw_pose(CollisionModel.of(model), values)
        figure = plot_ellipsoids(pose, forward(model, values)["tool"][:3, 3], split_jacobian(analysis))
        save_figure(figure, plot)
        print_written(plot, as_json=as_json)

"""`ikde solve`: a collision-free configuration for a tool target."""

from math import pi
from typing import Annotated

import typer

from ikde.cli.exit_codes import ExitCode
from ikde.cli.options import (
    AnglesOption,
    AngleUnit,
    ConventionOption,
    DetectorOption,
    JsonOption,
    LengthUnit,
    PairsOption,
    PlotOption,
    RobotOption,
    SafeDistanceOption,
    UnitOption,
    check_drawable,
    check_positive,
    draw,
    note_unchecked,
    read_collision,
    read_freeze,
    read_q,
)
from ikde.cli.output import announce_compile, print_json, print_note, print_result, use_color, working
from ikde.cli.startup import skip_blas_probe

Vector = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]
TARGET, SEARCH, ROBOT, OUTPUT = "Target", "Search", "Robot", "Output"


def solve(
    position: Annotated[
        Vector, typer.Option(metavar="X Y Z", help="Tool position in the world.", rich_help_panel=TARGET)
    ],
    quat_wxyz: Annotated[
        Quaternion | None,
        typer.Option(metavar="W X Y Z", help="Tool orientation as a quaternion, w first.", rich_help_panel=TARGET),
    ] = None,
    rpy: Annotated[
        Vector | None,
        typer.Option(
            metavar="R P Y",
            help="Tool orientation as turns about the fixed x, y, z axes, as in URDF.",
            rich_help_panel=TARGET,
        ),
    ] = None,
    axis: Annotated[
        Vector | None,
        typer.Option(metavar="X Y Z", help="Direction of the tool's z axis, nothing more.", rich_help_panel=TARGET),
    ] = None,
    tolerance: Annotated[
        float | None,
        typer.Option(
            help="Position tolerance, in --unit (default: 1e-5 m; 5e-5 m with --method de).", rich_help_panel=TARGET
        ),
    ] = None,
    orientation_tolerance: Annotated[
        float | None,
        typer.Option(help="Orientation tolerance, in --angles (default: 1e-4 rad).", rich_help_panel=TARGET),
    ] = None,
    robot: RobotOption = "qiao2021",
    detector: DetectorOption = None,
    pairs: PairsOption = None,
    safe_distance: SafeDistanceOption = None,
    unit: UnitOption = LengthUnit.m,
    angles: AnglesOption = AngleUnit.rad,
    convention: ConventionOption = None,
    near: Annotated[
        str | None, typer.Option(metavar="Q", help="Stay close to these joint values (as --q of check).")
    ] = None,
    freeze: Annotated[
        str | None,
        typer.Option(metavar="J=V,J", help="Joints that must not move; without a value: from --near, else home."),
    ] = None,
    seed: Annotated[int, typer.Option(help="Same seed, same answer.", rich_help_panel=SEARCH)] = 0,
    count: Annotated[int, typer.Option(metavar="K", help="Distinct solutions to find.", rich_help_panel=SEARCH)] = 1,
    rank: Annotated[
        str, typer.Option(help="Order of several: motion (least first), clearance, found.", rich_help_panel=SEARCH)
    ] = "motion",
    method: Annotated[
        str,
        typer.Option(
            help="auto (ikde's choice), lm (least squares), analytic (closed form), memetic, de (the paper's).",
            rich_help_panel=SEARCH,
        ),
    ] = "auto",
    collision: Annotated[
        str | None,
        typer.Option(help="reject: the paper's; feasibility: Deb's rules inside the search.", rich_help_panel=SEARCH),
    ] = None,
    strategy: Annotated[
        str | None, typer.Option(help="Mutation, e.g. rand/1 or current-to-best/1.", rich_help_panel=SEARCH)
    ] = None,
    population: Annotated[int | None, typer.Option(help="NP.", rich_help_panel=SEARCH)] = None,
    weight: Annotated[float | None, typer.Option(help="F, the differential weight.", rich_help_panel=SEARCH)] = None,
    crossover: Annotated[float | None, typer.Option(help="CR, the crossover rate.", rich_help_panel=SEARCH)] = None,
    generations: Annotated[int | None, typer.Option(help="Generations of one attempt.", rich_help_panel=SEARCH)] = None,
    restarts: Annotated[
        int | None, typer.Option(help="Attempts before the budget is spent.", rich_help_panel=SEARCH)
    ] = None,
    timeout: Annotated[
        float | None,
        typer.Option(
            metavar="SECONDS",
            help="Begin no further attempt after so long; the answer may then depend on the machine.",
            rich_help_panel=SEARCH,
        ),
    ] = None,
    bounds: Annotated[
        str | None,
        typer.Option(
            help="Repair of values out of range: redraw, clip, parent, midpoint, none.", rich_help_panel=SEARCH
        ),
    ] = None,
    update: Annotated[str | None, typer.Option(help="generation or in_place.", rich_help_panel=SEARCH)] = None,
    plot: PlotOption = None,
    as_json: JsonOption = False,
) -> None:
    """Find joint values that bring the tool to a target, inside the limits and free of self-collision.

    Example: ikde solve --position 800 500 1000 --unit mm --plot pose.png
    """
    skip_blas_probe()
    from ikde.files.entries import ANGLES_RAD, LENGTHS_M
    from ikde.io.robots import load_robot
    from ikde.io.target import make_target
    from ikde.model.convention import convention_offsets
    from ikde.report.numbers import Units
    from ikde.report.solve import format_solve, solve_json
    from ikde.solver.distinct import solve_distinct
    from ikde.solver.settings import SolveSettings

    model = load_robot(robot)
    target = make_target(position, quat_wxyz, rpy, axis, unit, angles)
    check_positive(tolerance, "--tolerance")
    check_positive(orientation_tolerance, "--orientation-tolerance", pi / ANGLES_RAD[angles])
    check_positive(timeout, "--timeout")
    settings = SolveSettings.for_method(method).with_changes(
        position_tolerance_m=None if tolerance is None else tolerance * LENGTHS_M[unit],
        orientation_tolerance_rad=None if orientation_tolerance is None else orientation_tolerance * ANGLES_RAD[angles],
        collision=collision,
        strategy=strategy,
        population=population,
        weight=weight,
        crossover=crossover,
        generations=generations,
        restarts=restarts,
        timeout_s=timeout,
        bounds=bounds,
        update=update,
    )
    checked = read_collision(model, detector, pairs, safe_distance, unit)
    start = None if near is None else read_q(model, near, unit, angles, convention, "near")
    convention_offsets(model, convention)  # a wrong name is found before the search
    frozen = read_freeze(model, freeze, unit, angles, convention)
    check_drawable(plot)
    note_unchecked(model, detector)
    with working("searching ..."):
        results = solve_distinct(
            model,
            target,
            count,
            settings,
            rank=rank,  # type: ignore[arg-type]
            seed=seed,
            collision=checked,
            near=start,
            freeze=frozen,
            announce_compile=announce_compile,
        )
    if as_json:
        objects = [solve_json(model, result, convention) for result in results]
        print_json(objects[0] if count == 1 else {**objects[0], "solutions": objects})
    else:
        pages = [format_solve(model, r, Units(unit, angles), convention=convention, color=use_color()) for r in results]
        if count > 1:
            pages = [f"solution {number} of {len(results)}\n{page}" for number, page in enumerate(pages, 1)]
        print_result("\n\n".join(pages))
    if results[0].reached and len(results) < count:
        print_note(f"found {len(results)} distinct solutions of {count}; more --restarts may find more")
    draw(plot, checked, results[0].q, target)
    raise typer.Exit(ExitCode.OK if len(results) == count and results[0].reached else ExitCode.NOT_REACHED)

"""`ikde solve`: a collision-free configuration for a tool target."""

from math import pi
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ikde.cli import goal_options, options
from ikde.cli.candidates import DEFAULT_ROBOT, offer, offer_joints
from ikde.cli.exit_codes import ExitCode
from ikde.cli.options import of_robot, of_search, of_target
from ikde.cli.output import layout, print_json, print_note, print_result, working
from ikde.cli.robot_choice import ToolOption, hold_at, read_robot
from ikde.cli.startup import skip_blas_probe
from ikde.cli.world_options import AttachOption, MarginOption, Pick, WorldOption, place_in_world
from ikde.solver.engine_table import ENGINES, NO_ENGINE

if TYPE_CHECKING:
    from ikde.model.region import Region
    from ikde.model.robot import Robot
    from ikde.model.target import Target
    from ikde.report.numbers import Units
    from ikde.solver.result import SolveResult
    from ikde.solver.settings import SolveSettings

Vector = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]

METHODS = ", ".join(["auto (ikde's choice)", *(f"{name} ({row.brief})" for name, row in ENGINES.items())])

PositionOption = Annotated[Vector | None, of_target(metavar="X Y Z", help="Tool position in the world.")]
QuatOption = Annotated[
    Quaternion | None, of_target(metavar="W X Y Z", help="Tool orientation as a quaternion, w first.")
]
RpyOption = Annotated[
    Vector | None,
    of_target(metavar="R P Y", help="Tool orientation as rotations about the fixed x, y, z axes, as in URDF."),
]
AxisOption = Annotated[Vector | None, of_target(metavar="X Y Z", help="Direction of the tool's z axis; free about it.")]
ToleranceOption = Annotated[
    float | None, of_target(help="Position tolerance, in --unit (default: 1e-5 m; 5e-5 m with --method de).")
]
OrientationToleranceOption = Annotated[
    float | None, of_target(help="Orientation tolerance, in --angles (default: 1e-4 rad).")
]
NearOption = Annotated[
    str | None,
    of_robot(
        metavar="Q",
        autocompletion=offer_joints("="),
        help="Stay near these joint values (as --q of check): no small change is nearer.",
    ),
]
FreezeOption = Annotated[
    str | None,
    of_robot(
        metavar="J=V,J",
        autocompletion=offer_joints(),
        help="Joints that must not move; without a value: from --near, else home.",
    ),
]
WeightsOption = Annotated[
    str | None,
    of_robot(
        metavar="J=W,..",
        autocompletion=offer_joints("="),
        help="Weights of joints in the motion, per m or rad (default: 1 / range; 1 / m of a base).",
    ),
]
SeedOption = Annotated[int, of_search(help="Same seed, same answer.")]
CountOption = Annotated[int, of_search(metavar="K", help="Distinct solutions to find.")]
RankOption = Annotated[
    str,
    of_search(
        metavar="ORDER",
        autocompletion=offer("motion", "clearance", "limits", "manipulability", "found"),
        help="Order of several: motion (least from --near, else home), clearance, limits, manipulability, found.",
    ),
]
PreferOption = Annotated[
    str | None,
    of_search(
        metavar="WHAT",
        autocompletion=offer("manipulability", "clearance", "limits", "motion"),
        help="Move the answer, on its target, for more manipulability, clearance, room to the limits, or less motion.",
    ),
]
MethodOption = Annotated[str, of_search(metavar="NAME", autocompletion=offer("auto", *ENGINES), help=f"{METHODS}.")]
RestartsOption = Annotated[int | None, of_search(metavar="N", help="Attempts before the budget is spent.")]
TimeoutOption = Annotated[
    float | None,
    of_search(
        metavar="SECONDS", help="Begin no further attempt after so long; the answer may then depend on the machine."
    ),
]
DeOption = Annotated[
    str | None,
    of_search(
        metavar="KEY=VALUE,..",
        help="Settings of --method de: strategy, population, start_share, weight, crossover, generations, bounds, "
        "update, collision.",
    ),
]


def solve(
    position: PositionOption = None,
    quat_wxyz: QuatOption = None,
    rpy: RpyOption = None,
    axis: AxisOption = None,
    tolerance: ToleranceOption = None,
    orientation_tolerance: OrientationToleranceOption = None,
    tolerance_box: goal_options.BoxOption = None,
    rotation_box: goal_options.RotationBoxOption = None,
    free_turn: goal_options.FreeTurnOption = False,
    cone: goal_options.ConeOption = None,
    look_at: goal_options.LookAtOption = None,
    distance: goal_options.DistanceOption = None,
    goal: goal_options.GoalOption = None,
    base_region: goal_options.BaseRegionOption = None,
    robot: options.RobotOption = DEFAULT_ROBOT,
    tool: ToolOption = None,
    near: NearOption = None,
    freeze: FreezeOption = None,
    weights: WeightsOption = None,
    detector: options.DetectorOption = None,
    pairs: options.PairsOption = None,
    safe_distance: options.SafeDistanceOption = None,
    world: WorldOption = None,
    margin: MarginOption = None,
    attach: AttachOption = None,
    seed: SeedOption = 0,
    count: CountOption = 1,
    rank: RankOption = "motion",
    prefer: PreferOption = None,
    method: MethodOption = "auto",
    restarts: RestartsOption = None,
    timeout: TimeoutOption = None,
    de: DeOption = None,
    unit: options.UnitOption = options.LengthUnit.m,
    angles: options.AnglesOption = options.AngleUnit.rad,
    convention: options.ConventionOption = None,
    plot: options.PlotOption = None,
    as_json: options.JsonOption = False,
) -> None:
    """Find joint values that bring the tool to a target, inside the limits and free of itself and of a world.

    Example: ikde solve --position 800 500 1000 --unit mm --plot pose.png
    """
    typed = locals()
    skip_blas_probe()
    from ikde.io.joint_text import parse_weights
    from ikde.model.convention import convention_offsets
    from ikde.report.numbers import Units
    from ikde.solver.distinct import check_rank
    from ikde.solver.objectives import check_prefer

    model, units = read_robot(robot, tool), Units(unit, angles)
    start = None if near is None else options.read_q(model.whole, near, unit, angles, convention, "near")
    model = hold_at(model, start)
    target = goal_options.read_goal(typed, unit, angles)
    settings = _read_settings(method, units, tolerance, orientation_tolerance, timeout, restarts, de)
    checked = options.read_collision(model, detector, pairs, safe_distance, unit)
    checked = place_in_world(checked, world, margin, unit, Pick(attach, start))
    convention_offsets(model, convention)  # a wrong name is found before the search
    frozen = options.read_freeze(model, freeze, unit, angles, convention)
    weighed = None if weights is None else parse_weights(model, weights)
    check_rank(rank)
    check_prefer(checked, prefer)
    if prefer is not None and count > 1:
        raise typer.BadParameter("--prefer moves one answer; of several, --rank chooses the first")
    options.check_drawable(plot)
    options.note_unchecked(model, detector)
    question = {"seed": seed, "collision": checked, "near": start, "freeze": frozen, "weights": weighed}
    results, spent = _search(target, count, settings, rank, question | ({"prefer": prefer} if prefer else {}))
    if count == 1:
        _print(model, results[0], units, convention, as_json)
    else:
        _print_several(model, results, units, convention, as_json, **spent)
        _note_fewer(results, count)
    best = results[0]
    shown = {"region": best.region, "alternative": best.alternative}
    options.draw(plot, checked, best.q, best.target, **shown, as_json=as_json)
    raise typer.Exit(ExitCode.OK if len(results) == count and results[0].reached else ExitCode.NOT_REACHED)


def _search(
    target: "Target | Region", count: int, settings: "SolveSettings", rank: str, question: dict[str, Any]
) -> "tuple[list[SolveResult], dict[str, float]]":
    """The solutions, and what they took."""
    from ikde.solver.background import LATER, compile_way
    from ikde.solver.compile_note import name_work, note_compile
    from ikde.solver.distinct import solve_distinct
    from ikde.solver.grade import confirm
    from ikde.solver.solve import solve as solve_one

    checked, kind = question["collision"], getattr(target, "kind", "region")
    note = note_compile(lambda: name_work(f"{kind} targets", checked))
    with compile_way(LATER), working("searching ..."), note as clock:
        if count == 1:
            results = [confirm(checked.robot, solve_one(checked.robot, target, settings, **question))]
        else:
            results = solve_distinct(checked.robot, target, count, settings, rank=rank, **question)  # type: ignore[arg-type]
        return results, {"solve_seconds": clock.run_seconds, "compile_seconds": clock.seconds}


def _read_settings(
    method: str,
    units: "Units",
    tolerance: float | None,
    orientation_tolerance: float | None,
    timeout: float | None,
    restarts: int | None,
    de: str | None,
) -> "SolveSettings":
    """The method's own settings, but for what is given, in m and rad."""
    from ikde.formats.units import ANGLES_RAD, LENGTHS_M
    from ikde.solver.settings import SolveSettings

    length_m, angle_rad = LENGTHS_M[units.length], ANGLES_RAD[units.angle]
    options.check_positive(tolerance, "--tolerance")
    options.check_positive(orientation_tolerance, "--orientation-tolerance", pi / angle_rad)
    options.check_positive(timeout, "--timeout")
    own, of_de = SolveSettings.for_method(method), options.read_de(de)
    with options.named_as_typed():
        return own.with_changes(
            position_tolerance_m=None if tolerance is None else tolerance * length_m,
            orientation_tolerance_rad=None if orientation_tolerance is None else orientation_tolerance * angle_rad,
            restarts=restarts,
            timeout_s=timeout,
            de=of_de,
        )


def _print(robot: "Robot", result: "SolveResult", units: "Units", convention: str | None, as_json: bool) -> None:
    from ikde.report.solve import format_solve, solve_json

    if as_json:
        print_json(solve_json(robot, result, convention))
    else:
        print_result(format_solve(robot, result, units, convention=convention, **layout()))


def _print_several(
    robot: "Robot",
    results: "list[SolveResult]",
    units: "Units",
    convention: str | None,
    as_json: bool,
    **spent: float,
) -> None:
    from ikde.report.solve import Spent, format_solutions, solutions_json

    if as_json:
        print_json(solutions_json(robot, results, Spent(**spent), convention))
    else:
        page = format_solutions(robot, results, units, Spent(**spent), convention=convention, **layout())
        print_result(page)


def _note_fewer(results: "list[SolveResult]", count: int) -> None:
    if results[0].reached and len(results) < count:
        more = "no joint may move" if results[0].method == NO_ENGINE else "more --restarts may find more"
        print_note(f"found {len(results)} distinct solutions of {count}; {more}")

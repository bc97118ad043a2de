"""Options of a goal with freedom, and how they become one."""

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from ikde.cli.options import AngleUnit, LengthUnit, of_freedom

if TYPE_CHECKING:
    from ikde.model.base_region import BaseRegion
    from ikde.model.region import Region
    from ikde.model.target import Target

Vector = tuple[float, float, float]

BoxOption = Annotated[
    str | None,
    of_freedom(metavar="X Y Z", help="How far off the position the tool may be, either way along the goal's own axes."),
]
RotationBoxOption = Annotated[
    str | None, of_freedom(metavar="X Y Z", help="How far off the orientation: the rotation vector's components.")
]
FreeTurnOption = Annotated[bool, of_freedom("--free-turn", help="Any rotation about the tool's z axis will do.")]
ConeOption = Annotated[
    float | None, of_freedom(metavar="ANGLE", help="How far the tool's z axis may be off; free about it.")
]
LookAtOption = Annotated[
    Vector | None,
    of_freedom(metavar="X Y Z", help="A point for the tool's z axis to point at; --axis and --cone: from where."),
]
DistanceOption = Annotated[
    tuple[float, float] | None, of_freedom(metavar="MIN MAX", help="How far from the point of --look-at.")
]
GoalOption = Annotated[
    Path | None, of_freedom(metavar="FILE", help="The goal from a file, with alternatives: see `ikde schema goal`.")
]
BaseRegionOption = Annotated[
    str | None,
    of_freedom(
        metavar="FILE|X,Y X,Y ..", help="Where a planar base may stand: corners of a polygon, or a file with holes."
    ),
]
NAMES = ("position", "quat_wxyz", "rpy", "axis", "tolerance_box", "rotation_box", "free_turn", "cone")
NAMES += ("look_at", "distance", "goal", "base_region")
WAYS = ("--position", "--look-at", "--goal")
ALONE = "a goal comes from {}; leave out {}"


def read_goal(options: Mapping[str, Any], unit: LengthUnit, angles: AngleUnit) -> "Target | Region":
    """The goal of the options of a command by name, of which those that were not given are None or False.

    Raises:
        InputError: for none, for options that do not go together, and for what makes no goal.
    """
    from ikde.errors import InputError

    typed = {f"--{name.replace('_', '-')}": options[name] for name in NAMES}
    given = [name for name, value in typed.items() if value is not None and value is not False]
    ways = [name for name in WAYS if name in given]
    if len(ways) != 1:
        got = " and ".join(ways) or "none"
        raise InputError(f"expected one of {', '.join(WAYS)}, got {got}", tuple(ways[1:2]))
    base = None if typed["--base-region"] is None else _read_base(typed["--base-region"], unit)
    read = {"--position": _read_about_position, "--look-at": _read_sight, "--goal": _read_file}[ways[0]]
    others = [name for name in given if name not in (ways[0], "--base-region")]
    goal = read(typed, others, unit, angles)
    return goal if base is None else _set_base(goal, base)


def _set_base(goal: "Target | Region", base: "BaseRegion") -> "Region":
    from ikde.model.region import Region

    return (goal if isinstance(goal, Region) else Region.of(goal)).with_base(base)


def _read_file(typed: Mapping[str, Any], others: list[str], unit: LengthUnit, angles: AngleUnit) -> "Target | Region":
    from ikde.errors import InputError
    from ikde.io.goal_file import load_goal

    if others:
        raise InputError(ALONE.format("--goal", ", ".join(others)), (others[0],))
    return load_goal(typed["--goal"])


def _read_sight(typed: Mapping[str, Any], others: list[str], unit: LengthUnit, angles: AngleUnit) -> "Region":
    from ikde.errors import InputError
    from ikde.formats.units import ANGLES_RAD, LENGTHS_M
    from ikde.model.region import Region

    if wrong := [name for name in others if name not in ("--distance", "--axis", "--cone")]:
        raise InputError(ALONE.format("--look-at", ", ".join(wrong)), (wrong[0],))
    if typed["--distance"] is None:
        raise InputError("--look-at needs a --distance, least and largest")
    point, distance = ([x * LENGTHS_M[unit] for x in typed[name]] for name in ("--look-at", "--distance"))
    cone = None if typed["--cone"] is None else typed["--cone"] * ANGLES_RAD[angles]
    if cone is not None and typed["--axis"] is None:
        raise InputError("--cone of --look-at is about a direction of sight; give an --axis")
    names = {"p_world_point": "--look-at", "distance_m": "--distance", "angle_rad": "--cone"} | {
        "axis_world_tool": "--axis"
    }
    return _named(names, lambda: Region.look_at(point, distance, typed["--axis"], cone))


def _read_about_position(
    typed: Mapping[str, Any], others: list[str], unit: LengthUnit, angles: AngleUnit
) -> "Target | Region":
    from ikde.errors import InputError
    from ikde.formats.units import ANGLES_RAD, LENGTHS_M
    from ikde.io.target import make_target
    from ikde.model.region import Region

    if "--distance" in others:
        raise InputError("a --distance is from the point of --look-at", ("--distance",))
    quat_wxyz, rpy, axis = (typed[name] for name in ("--quat-wxyz", "--rpy", "--axis"))
    target = make_target(typed["--position"], quat_wxyz, rpy, axis, unit, angles)
    rules = [name for name in ("--rotation-box", "--free-turn", "--cone") if name in others]
    if len(rules) > 1:
        raise InputError(f"{' and '.join(rules)} both say which orientations will do; give one", (rules[1],))
    if not rules and "--tolerance-box" not in others:
        return target
    box = _read_three(typed["--tolerance-box"], "--tolerance-box", LENGTHS_M[unit])
    names = {"position_m": "--tolerance-box", "rotation_rad": "--rotation-box", "angle_rad": "--cone"}
    if typed["--free-turn"]:
        return _named({**names, "target": "--free-turn"}, lambda: Region.turn(target, position_m=box))
    if typed["--cone"] is not None:
        angle = typed["--cone"] * ANGLES_RAD[angles]
        return _named({**names, "target": "--cone"}, lambda: Region.cone(target, angle, box))
    rotation = _read_three(typed["--rotation-box"], "--rotation-box", ANGLES_RAD[angles])
    return _named(names, lambda: Region.box(target, box, rotation))


def _named(names: Mapping[str, str], make: Any) -> Any:
    """What `make` gives; its errors name options."""
    from ikde.errors import InputError

    try:
        return make()
    except InputError as error:
        raise InputError(error.message, tuple(names.get(str(key), key) for key in error.where[:1])) from None


def _read_three(text: str | None, option: str, unit: float) -> list[float] | float:
    """A number either way, or three, in m or rad; 0 where nothing is given."""
    from ikde.errors import InputError, quoted
    from ikde.io.joint_text import split_values

    if text is None:
        return 0.0
    try:
        numbers = [float(word) * unit for word in split_values(text)]
    except ValueError:
        numbers = []
    if len(numbers) not in (1, 3):
        raise InputError(f"expected a number, or three, got {quoted(text)}", (option,))
    return numbers[0] if len(numbers) == 1 else numbers


def _read_base(text: str, unit: LengthUnit) -> "BaseRegion":
    """A base region from `x,y x,y ...`, or from a file."""
    from ikde.errors import InputError, quoted
    from ikde.formats.units import LENGTHS_M
    from ikde.io.goal_file import load_base_region
    from ikde.io.joint_text import FILE_ENDINGS
    from ikde.model.base_region import BaseRegion

    if text.endswith(FILE_ENDINGS):
        return load_base_region(Path(text))
    try:
        corners = [[float(number) * LENGTHS_M[unit] for number in word.split(",")] for word in text.split()]
    except ValueError:
        corners = []
    if not corners or any(len(corner) != 2 for corner in corners):
        raise InputError(
            f"expected corners as x,y x,y x,y .., or a YAML or JSON file, got {quoted(text)}", ("--base-region",)
        )
    return _named({"corners": "--base-region"}, lambda: BaseRegion(corners))

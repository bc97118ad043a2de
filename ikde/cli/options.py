"""Options that several commands share, and how they become objects."""

import os
import shlex
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from enum import StrEnum
from functools import partial
from pathlib import Path
from shutil import get_terminal_size
from typing import TYPE_CHECKING, Annotated, Any

import typer
from typer.core import TyperCommand, TyperGroup

from ikde.cli.candidates import ROBOT, offer_joints, offer_robots, offer_section
from ikde.cli.output import print_note, print_written, use_color

if TYPE_CHECKING:
    from ikde.kernels.arrays import Floats
    from ikde.model.collision_model import CollisionModel
    from ikde.model.region import Region
    from ikde.model.robot import Robot
    from ikde.model.target import Target


class LengthUnit(StrEnum):
    """Units of lengths on the command line."""

    m = "m"
    mm = "mm"


class AngleUnit(StrEnum):
    """Units of angles on the command line."""

    rad = "rad"
    deg = "deg"


FRAMED = 70  # columns from which on a command's help has frames
FIGURE_ENDINGS = (".png", ".svg", ".pdf")

OUTPUT = "Units and output"
of_target = partial(typer.Option, rich_help_panel="Target")  # headings of the help, in the order of the options
of_freedom = partial(typer.Option, rich_help_panel="Freedom of the target")
of_robot = partial(typer.Option, rich_help_panel="Robot")
of_collision = partial(typer.Option, rich_help_panel="Collision")
of_search = partial(typer.Option, rich_help_panel="Search")
of_output = partial(typer.Option, rich_help_panel=OUTPUT)

RobotOption = Annotated[
    str,
    of_robot(
        metavar="NAME|FILE", envvar=ROBOT, autocompletion=offer_robots, help="A robot of `ikde robots`, or its file."
    ),
]
RobotArgument = Annotated[
    str,
    typer.Argument(
        metavar="NAME|FILE",
        envvar=ROBOT,
        autocompletion=offer_robots,
        help="A robot of `ikde robots list`, or its file.",
    ),
]
QOption = Annotated[
    str | None,
    of_robot(
        metavar="Q",
        autocompletion=offer_joints("="),
        help="Joint values: numbers, name=value pairs (joints left out are at home), or a file (default: home).",
    ),
]
DetectorOption = Annotated[
    str | None,
    of_collision(
        metavar="NAME|none",
        autocompletion=offer_section("detectors", "none"),
        help="What counts as self-collision (default: the robot's).",
    ),
]
PairsOption = Annotated[
    str | None,
    of_collision(
        metavar="LIST",
        autocompletion=offer_section("pairs", "non_adjacent"),
        help="Pair list instead of the detector's, e.g. non_adjacent.",
    ),
]
SafeDistanceOption = Annotated[float | None, of_collision(help="Clearance at which collision begins, in --unit.")]
UnitOption = Annotated[LengthUnit, of_output(help="Unit of lengths, in and out.")]
AnglesOption = Annotated[AngleUnit, of_output(help="Unit of angles, in and out.")]
PrintedUnitOption = Annotated[LengthUnit, of_output("--unit", help="Unit of lengths that are printed.")]
PrintedAnglesOption = Annotated[AngleUnit, of_output("--angles", help="Unit of angles that are printed.")]
ConventionOption = Annotated[
    str | None,
    of_output(
        metavar="NAME",
        autocompletion=offer_section("conventions"),
        help="Convention of joint values, in and out (default: the robot's own).",
    ),
]
JsonOption = Annotated[bool, of_output("--json", help="Print JSON, always in m, rad and s.")]
PlotOption = Annotated[Path | None, of_output(metavar="FILE", help="Draw robot and spheres (.png, .svg, .pdf).")]


class _Helpful:
    """What a command and a group have in common: the look of their `--help`, where flags and arguments have no type."""

    def get_params(self, ctx: Any) -> Any:
        """The parameters, `--help` among them."""
        parameters: Any = super().get_params(ctx)  # type: ignore[misc]
        for parameter in parameters:
            if getattr(parameter, "is_flag", False):
                parameter.metavar = ""
            elif parameter.param_type_name == "argument":  # its name says what it is
                parameter.display_type_rich = lambda ctx: None
        return parameters

    def format_help(self, ctx: Any, formatter: Any) -> None:
        """Write it as wide as the terminal, also a dumb one, in colours where results have them."""
        from typer import rich_utils

        rich_utils.MAX_WIDTH = get_terminal_size().columns
        if os.environ.get("TERM", "").lower() in ("dumb", "unknown"):  # rich takes such a terminal for 80 columns
            rich_utils.FORCE_TERMINAL = False
        rich_utils.COLOR_SYSTEM = "standard" if use_color() else None
        super().format_help(ctx, formatter)  # type: ignore[misc]


class Group(_Helpful, TyperGroup):
    """Commands under one name."""


class Command(_Helpful, TyperCommand):
    """A command whose `--help` stands beside `--json`: options without a heading would come before all others."""

    def get_help_option(self, ctx: Any) -> Any:
        """The option, with its heading."""
        option: Any = super().get_help_option(ctx)
        if option is not None:
            option.rich_help_panel = OUTPUT
        return option

    def format_help(self, ctx: Any, formatter: Any) -> None:
        """Write it, without frames where they would leave no room for the names of options."""
        self.rich_markup_mode = "rich" if get_terminal_size().columns >= FRAMED else None
        super().format_help(ctx, formatter)

    def invoke(self, ctx: Any) -> Any:
        """Run it, unless the environment is wrong."""
        check_environment()
        return super().invoke(ctx)


def check_environment() -> None:
    """Raise `InputError` for a word that is none in `$IKDE_COMPILE` or `$IKDE_KERNELS`; else nothing is imported."""
    if os.environ.get("IKDE_COMPILE"):
        from ikde.solver.background import choose_way

        choose_way()
    if os.environ.get("IKDE_KERNELS") not in (None, "", "written", "tables"):
        from ikde.model.generate.module import kernel_kind

        kernel_kind()


def read_q(
    robot: "Robot", text: str | None, unit: LengthUnit, angles: AngleUnit, convention: str | None, key: str = "q"
) -> "Floats":
    """Joint values [N] in the robot's own convention; joints that are not named stay at home."""
    from ikde.model.convention import convention_offsets

    convention_offsets(robot, convention)  # a wrong name is an error even if nothing is to be converted
    if text is None:
        return robot.home
    from ikde.io.joint_text import parse_joints
    from ikde.solver.joints import read_joints

    return read_joints(robot, parse_joints(robot, text, unit, angles, key), convention, default=robot.home)


def read_collision(
    robot: "Robot", name: str | None, pairs: str | None, safe_distance: float | None, unit: LengthUnit
) -> "CollisionModel":
    """The collision model that the options describe."""
    from dataclasses import replace

    from ikde.errors import InputError
    from ikde.formats.units import LENGTHS_M
    from ikde.model.collision_model import CollisionModel
    from ikde.model.names import MAX_NAME_LENGTH

    detector = CollisionModel.of(robot, name).detector
    if detector is None:
        if pairs is not None or safe_distance is not None:
            raise InputError("--pairs and --safe-distance need a detector, and there is none")
        return CollisionModel(robot=robot, detector=None)
    if pairs is not None:
        if pairs not in robot.pair_lists:
            known = ", ".join(robot.pair_lists)
            raise InputError(f"no pair list is called {pairs!r}; {robot.name} has {known}", ("pairs",))
        detector = replace(detector, pairs=pairs, name=f"{detector.name} over {pairs}"[:MAX_NAME_LENGTH])
    if safe_distance is not None:
        if not 0.0 <= safe_distance < float("inf"):
            raise InputError(f"expected a distance of at least 0, got {safe_distance:g}", ("safe-distance",))
        detector = replace(detector, safe_distance_m=safe_distance * LENGTHS_M[unit])
    return CollisionModel.of(robot, detector)


def note_unchecked(robot: "Robot", asked: str | None = None) -> None:
    """Say on stderr that self-collision is not checked, if the robot has no default detector and none was asked for."""
    from ikde.model.pairs import explain_no_detector
    from ikde.model.robot import NO_DETECTOR

    if asked is None and robot.default_detector == NO_DETECTOR:
        print_note(f"ikde: self-collision is not checked: {explain_no_detector(robot)}")


def read_freeze(
    robot: "Robot", text: str | None, unit: LengthUnit, angles: AngleUnit, convention: str | None
) -> Mapping[str, float | None] | None:
    """Frozen joints with their value in the robot's own convention, or None for their start."""
    if text is None:
        return None
    from ikde.io.joint_text import parse_freeze
    from ikde.solver.joints import read_joints

    frozen = parse_freeze(robot, text, unit, angles)
    given = {name: value for name, value in frozen.items() if value is not None}
    own = dict(zip(robot.joint_names, read_joints(robot, given, convention, default=robot.home), strict=True))
    return {name: float(own[name]) if name in given else None for name in frozen}


def read_choices(text: str | None, known: Sequence[str], option: str) -> tuple[str, ...]:
    """The names in `a,b`; all that are known if nothing is said."""
    words = known if text is None else tuple(filter(None, text.split(",")))
    if not words or not set(words) <= set(known):
        raise typer.BadParameter(f"expected some of {', '.join(known)}, got {text!r}", param_hint=option)
    return tuple(words)


def repeat_command(words: Sequence[str], options: Mapping[str, object]) -> str:
    """The command that makes a page again; of an option that is None there is nothing, of one that is True its name."""
    given = {f"--{key}": value for key, value in options.items() if value is not None}
    parts = [part for key, value in given.items() for part in ([key] if value is True else [key, str(value)])]
    return shlex.join(["ikde", *words, *parts, "--out", "FOLDER"])


def read_de(text: str | None) -> dict[str, Any]:
    """Settings of the differential evolution by name, from `population=80,strategy=best/1`."""
    from dataclasses import fields

    from ikde.errors import InputError, nearest, quoted
    from ikde.solver.settings import DeSettings

    kinds, given = {field.name: type(field.default) for field in fields(DeSettings)}, {}
    for word in (text or "").replace(",", " ").split():
        name, _, value = word.partition("=")
        if name not in kinds:
            raise InputError(
                f"unknown key {quoted(name)}{nearest(name, kinds)}; expected {', '.join(kinds)}", ("--de",)
            )
        if name in given:
            raise InputError("this key is given twice", (f"--de {name}",))
        try:
            given[name] = kinds[name](value)
        except ValueError:
            number = "a whole number" if kinds[name] is int else "a number"
            raise InputError(f"expected {name}={number}, got {quoted(word)}", (f"--de {name}",)) from None
    return given


@contextmanager
def named_as_typed() -> Iterator[None]:
    """An error about a setting of the DE names the option that it came with: `--de population`, as `read_de` does."""
    from ikde.errors import InputError

    try:
        yield
    except InputError as error:
        if error.where[:2] != ("settings", "de"):
            raise
        raise InputError(error.message, (" ".join(["--de", *map(str, error.where[2:])]),)) from None


def check_drawable(path: Path | None) -> None:
    """Find out before the work is done that a figure cannot be written."""
    from ikde.errors import FileError

    if path is None:
        return
    if path.suffix.lower() not in FIGURE_ENDINGS:
        raise FileError(path, f"cannot be drawn: expected a name that ends in {', '.join(FIGURE_ENDINGS)}")
    if not path.parent.is_dir() or path.is_dir():
        raise FileError(path, "cannot be written: expected a file name in a folder that exists")


def check_positive(value: float | None, option: str, most: float | None = None) -> None:
    """Raise `InputError` unless the option is left out or a number above 0; an angle, of up to half a turn: `most`."""
    from ikde.errors import InputError

    if value is not None and not 0.0 < value < float("inf"):
        raise InputError(f"expected a finite number above 0, got {value:g}", (option,))
    if value is not None and most is not None and value > most:
        raise InputError(f"expected at most {most:g}, half a turn, got {value:g}", (option,))


def draw(
    path: Path | None,
    collision: "CollisionModel",
    q: "Floats",
    target: "Target | None" = None,
    *,
    region: "Region | None" = None,
    alternative: int | None = None,
    as_json: bool = False,
) -> None:
    """Draw a configuration if a path is given, and say so."""
    if path is None:
        return
    from ikde.plot.pose import plot_pose, save_figure
    from ikde.scene.drawn_pose import draw_pose

    save_figure(plot_pose(draw_pose(collision, q, target=target, region=region, alternative=alternative)), path)
    print_written(path, as_json=as_json)

"""Options that several commands share, and how they become objects."""

from collections.abc import Mapping
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ikde.cli.output import print_note

if TYPE_CHECKING:
    from ikde.kernels.arrays import Floats
    from ikde.model.collision_model import CollisionModel
    from ikde.model.robot import Robot


class LengthUnit(StrEnum):
    """Units of lengths on the command line."""

    m = "m"
    mm = "mm"


class AngleUnit(StrEnum):
    """Units of angles on the command line."""

    rad = "rad"
    deg = "deg"


FIGURE_ENDINGS = (".png", ".svg", ".pdf")

RobotOption = Annotated[
    str, typer.Option("--robot", metavar="NAME|FILE", help="A robot of `ikde robots`, or its file.")
]
UnitOption = Annotated[LengthUnit, typer.Option("--unit", help="Unit of lengths, in and out.")]
AnglesOption = Annotated[AngleUnit, typer.Option("--angles", help="Unit of angles, in and out.")]
ConventionOption = Annotated[
    str | None, typer.Option("--convention", help="How joints are counted, in and out (default: the robot's own).")
]
JsonOption = Annotated[bool, typer.Option("--json", help="Print JSON, always in m, rad and s.")]
PlotOption = Annotated[
    Path | None, typer.Option("--plot", metavar="FILE", help="Draw robot and spheres (.png, .svg, .pdf).")
]
DetectorOption = Annotated[
    str | None,
    typer.Option("--detector", metavar="NAME|none", help="What counts as self-collision (default: the robot's)."),
]
PairsOption = Annotated[
    str | None, typer.Option("--pairs", metavar="LIST", help="Pair list instead of the detector's, e.g. non_adjacent.")
]
SafeDistanceOption = Annotated[
    float | None, typer.Option("--safe-distance", help="Clearance at which collision begins, in --unit.")
]
QOption = Annotated[
    str | None,
    typer.Option(
        "--q",
        metavar="Q",
        help="Joint values: numbers in one string, name=value pairs, or a YAML/JSON file (default: home).",
    ),
]


def read_q(
    robot: "Robot", text: str | None, unit: LengthUnit, angles: AngleUnit, convention: str | None, key: str = "q"
) -> "Floats":
    """Joint values [N] in the robot's own convention; joints that are not named stay at home."""
    from ikde.io.joint_text import parse_joints
    from ikde.model.convention import convention_offsets
    from ikde.solver.joints import read_joints

    convention_offsets(robot, convention)  # a wrong name is an error even if nothing is to be converted
    if text is None:
        return robot.home
    return read_joints(robot, parse_joints(robot, text, unit, angles, key), convention, default=robot.home)


def read_collision(
    robot: "Robot", name: str | None, pairs: str | None, safe_distance: float | None, unit: LengthUnit
) -> "CollisionModel":
    """The collision model that the options describe."""
    from dataclasses import replace

    from ikde.errors import InputError
    from ikde.files.entries import LENGTHS_M
    from ikde.model.collision_model import CollisionModel
    from ikde.model.names import LONGEST_NAME

    detector = CollisionModel.of(robot, name).detector
    if detector is None:
        if pairs is not None or safe_distance is not None:
            raise InputError("--pairs and --safe-distance need a detector, and there is none")
        return CollisionModel(robot=robot, detector=None)
    if pairs is not None:
        if pairs not in robot.pair_lists:
            known = ", ".join(robot.pair_lists)
            raise InputError(f"no pair list is called {pairs!r}; {robot.name} has {known}", ("pairs",))
        detector = replace(detector, pairs=pairs, name=f"{detector.name} over {pairs}"[:LONGEST_NAME])
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
    from ikde.io.joint_text import parse_freeze
    from ikde.solver.joints import read_joints

    if text is None:
        return None
    frozen = parse_freeze(robot, text, unit, angles)
    given = {name: value for name, value in frozen.items() if value is not None}
    own = dict(zip(robot.joint_names, read_joints(robot, given, convention, default=robot.home), strict=True))
    return {name: float(own[name]) if name in given else None for name in frozen}


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


def draw(path: Path | None, collision: "CollisionModel", q: "Floats", target: object = None) -> None:
    """Draw a configuration if a path is given."""
    from ikde.plot.pose import plot_pose, save_figure
    from ikde.scene.drawn_pose import draw_pose

    if path is None:
        return
    pose = draw_pose(collision, q, target=target)  # type: ignore[arg-type]
    save_figure(plot_pose(pose), path)

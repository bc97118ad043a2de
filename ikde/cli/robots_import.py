"""`ikde robots import`: a robot file from a URDF."""

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from ikde.cli.options import AngleUnit, JsonOption, LengthUnit, PrintedAnglesOption, PrintedUnitOption
from ikde.cli.output import page_width, print_json, print_result, say_written, use_color


class BaseChoice(StrEnum):
    """What a robot stands on."""

    urdf = "urdf"
    fixed = "fixed"
    omni = "omni"
    differential = "differential"
    mecanum = "mecanum"


ToolsOption = Annotated[
    list[str] | None,
    typer.Option(
        metavar="LINK|NAME=LINK",
        help="The tool (default: the only end that a joint moves); of several arms NAME=LINK, again and again.",
    ),
]
CompareOption = Annotated[
    list[str] | None,
    typer.Option(metavar="LINK:LINK", help="Compare a pair that would be left out; as often as you like."),
]


def import_robot(
    file: Annotated[
        str,
        typer.Argument(metavar="FILE|NAME", help="A URDF file, or one of installed example-robot-data or rtb-data."),
    ],
    out: Annotated[Path | None, typer.Option("--out", "-o", metavar="FILE", help="The robot file to write.")] = None,
    tool: ToolsOption = None,
    base: Annotated[
        BaseChoice, typer.Option(help="urdf: as it is. fixed: a floating root is held. Others: x, y, yaw.")
    ] = BaseChoice.urdf,
    base_reach: Annotated[
        float, typer.Option(metavar="M", help="Limits of the base's x and y, either way, in m.")
    ] = 100.0,
    srdf: Annotated[
        Path | None, typer.Option(metavar="FILE", help="An SRDF: its states are home, its disabled pairs left out.")
    ] = None,
    hold: Annotated[
        list[str] | None, typer.Option(metavar="JOINT=VALUE", help="Freeze a joint, in m or rad; as often as you like.")
    ] = None,
    compare: CompareOption = None,
    package_path: Annotated[
        list[Path] | None, typer.Option(metavar="FOLDER", help="A further folder with meshes; as often as you like.")
    ] = None,
    spheres: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Take the links' spheres from cuRobo's robot file, an XRDF or an SRDF."),
    ] = None,
    no_spheres: Annotated[
        bool, typer.Option("--no-spheres", help="Make no spheres: no collisions are checked.")
    ] = False,
    protrusion: Annotated[
        float, typer.Option(metavar="MM", help="How far spheres may stand out of shapes, in mm.")
    ] = 20.0,
    mesh_scale: Annotated[float, typer.Option(metavar="X", help="What meshes are scaled by: 0.001 if in mm.")] = 1.0,
    unit: PrintedUnitOption = LengthUnit.mm,
    angles: PrintedAnglesOption = AngleUnit.deg,
    as_json: JsonOption = False,
) -> None:
    """Read a URDF: the joints that move the tool, spheres on all links, pairs to compare. All decisions are listed.

    Example: ikde robots import arm.urdf --tool gripper_link --base omni -o arm.yaml
    """
    from ikde.errors import InputError
    from ikde.io.robot_writer import write_robot
    from ikde.io.robots import check_kept, find_urdf
    from ikde.io.urdf_import.imported import list_notes
    from ikde.io.urdf_import.options import ImportOptions, read_holds, read_pairs, read_tools
    from ikde.io.urdf_import.read_urdf import read_urdf
    from ikde.report.numbers import Units
    from ikde.report.robot_import import format_import, import_json

    if spheres is not None and no_spheres:
        raise InputError("expected one of --spheres and --no-spheres, got both")
    path, folders = find_urdf(file)
    check_kept(out, path, srdf, spheres)
    imported = read_urdf(
        path,
        ImportOptions(
            tool=read_tools(tool or []),
            base=base.value,
            base_reach_m=base_reach,
            hold=read_holds(hold or []),
            compare=read_pairs(compare or []),
            srdf=srdf,
            package_paths=(*(package_path or []), *folders),
            spheres=spheres or not no_spheres,
            protrusion_m=protrusion / 1000.0,
            mesh_scale=mesh_scale,
        ),
    )
    if out is not None:
        write_robot(imported.robot, out, list_notes(imported))
    if as_json:
        print_json(import_json(imported))
    else:
        print_result(format_import(imported, Units(unit, angles), color=use_color(), width=page_width()))
    say_written(out, as_json=as_json)
